// Plays recorded walks on a K3D plot. `reel` is what walkerlab/viewer/replay.py wrote: see its docstring.
(K3D, reel) => {
  "use strict";
  const world = K3D.getWorld(), target = document.getElementById("canvasTarget");
  const { channels, moments } = unpack(reel.channels, reel.finest.length);
  const PLACE = 8, SIGHT = 6; // channels of a thing, and of a camera
  const NEAR = 28; // pixels between two marks
  const CROWD = 8; // walks from which on tags are dots, or they would hide the walkers
  const SHAPE = 4 / 3; // width over height from which on all is in the picture; from narrower ones a camera steps back
  const firstSight = PLACE * reel.things.length;
  const firstPath = firstSight + SIGHT * reel.cameras.length;
  const meshes = reel.things.map((id) => world.ObjectsById[id]);
  meshes.forEach((mesh) => { mesh.matrixAutoUpdate = false; mesh.frustumCulled = false; });

  const state = { time: 0, playing: false, speed: 1, loop: true, camera: reel.camera, last: null };

  // ------------------------------------------------------------------------------------------------ the numbers

  function unpack(text, count) {
    const bytes = fflate.unzlibSync(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)));
    const head = new Float64Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + 8 * count));
    const steps = new Int32Array(bytes.buffer.slice(bytes.byteOffset + 8 * count, bytes.byteOffset + bytes.length));
    const length = steps.length / count;
    const all = [];
    for (let c = 0; c < count; c++) {
      const values = new Float64Array(length + 1);
      const unit = reel.finest[c];
      let sum = Math.round(head[c] / unit);
      values[0] = sum * unit;
      for (let i = 0; i < length; i++) { sum += steps[c * length + i]; values[i + 1] = sum * unit; }
      all.push(values);
    }
    return { channels: all, moments: length + 1 };
  }

  function at(channel, time) {
    const x = Math.min(Math.max(time / reel.seconds, 0), 1) * (moments - 1);
    const i = Math.min(Math.floor(x), moments - 2), part = x - i;
    return channels[channel][i] * (1 - part) + channels[channel][i + 1] * part;
  }

  const several = (start, count, time) => Array.from({ length: count }, (_, k) => at(start + k, time));

  // ------------------------------------------------------------------------------------------------- the picture

  function place(mesh, [x, y, z, w, i, j, k, stretch]) {
    mesh.position.set(x, y, z);
    mesh.quaternion.set(i, j, k, w).normalize();
    mesh.scale.set(1, 1, stretch);
    mesh.updateMatrix();
    mesh.matrixWorldNeedsUpdate = true;
  }

  function aim() {
    const number = Math.max(reel.cameras.findIndex(({ name }) => name === state.camera), 0);
    const sight = several(firstSight + SIGHT * number, SIGHT, state.time);
    if (state.camera !== "free") {
      const [eye, seen] = [sight.slice(0, 3), sight.slice(3)];
      const back = Math.max(1, SHAPE * target.clientHeight / target.clientWidth);
      K3D.setCamera([...eye.map((value, axis) => seen[axis] + back * (value - seen[axis])), ...seen, ...reel.cameras[number].up]);
    } else { // where the user has turned it to, but going along
      const spot = several(firstPath, 3, state.time);
      if (state.last) {
        const now = world.controls.getCameraArray();
        const moved = spot.map((value, axis) => value - state.last[axis]);
        K3D.setCamera(now.map((value, axis) => value + (axis < 6 ? moved[axis % 3] : 0)));
      }
      state.last = spot;
    }
  }

  function draw() {
    meshes.forEach((mesh, number) => place(mesh, several(PLACE * number, PLACE, state.time)));
    aim();
    K3D.render();
    tell();
    label();
  }

  // ------------------------------------------------------------------------------------------------ what is said

  const make = (tag, words = {}, ...children) => {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(words)) {
      if (name in node && name !== "list") node[name] = value; else node.setAttribute(name, value);
    }
    node.append(...children);
    return node;
  };

  const tags = reel.walks.map((walk) => {
    const tag = make("div", { className: reel.walks.length > CROWD ? "tag small" : "tag" }, walk.label);
    tag.style.setProperty("--colour", walk.colour);
    return tag;
  });
  const marks = reel.marks.map(({ text }) => make("div", { className: "mark", textContent: text }));
  const overlay = make("div", { className: "overlay", ariaHidden: "true" }, ...marks, ...(tags.length > 1 ? tags : []));

  const ways = reel.walks.map(() => make("b", { className: "way", title: "how far its centre of mass has come; the marks on the " +
    "ground are metres from where its foremost point stood" }));
  const rows = reel.walks.map((walk, number) => {
    const dot = make("span", { className: "dot" });
    dot.style.setProperty("--colour", walk.colour);
    const facts = make("dl", {}, ...walk.facts.flatMap(([name, value]) => [
      make("dt", { textContent: name }), make("dd", { textContent: value })]));
    const verdict = make("p", { className: walk.counts ? "verdict" : "verdict void", textContent: walk.verdict });
    const head = make("summary", {}, dot, make("span", { className: "name", textContent: walk.label }), ways[number],
      make("span", { className: "sign", textContent: walk.counts ? "✓" : "✗", title: walk.verdict }));
    return make("details", { open: reel.walks.length === 1 && innerWidth > 620 }, head, verdict, facts);
  });
  const board = make("section", { className: "board", ariaLabel: "the walks" }, ...rows);

  const SIGNS = { play: "M5 3 L17 10 L5 17 Z", pause: "M5 3 H8.5 V17 H5 Z M11.5 3 H15 V17 H11.5 Z" }; // fonts may lack them
  const button = make("button", { className: "play", type: "button" });
  button.innerHTML = '<svg viewBox="0 0 20 20" width="18" height="18" aria-hidden="true"><path/></svg>';
  const slider = make("input", { type: "range", min: 0, max: reel.seconds, step: reel.seconds / (moments - 1), value: 0,
    className: "time", ariaLabel: "time in seconds" });
  const clock = make("output", { className: "clock" });
  const choice = (label, values, chosen) => make("select", { ariaLabel: label, title: label }, ...values.map(
    ([value, words]) => make("option", { value, textContent: words, selected: value === chosen })));
  const speeds = choice("speed", [[0.1, "0.1×"], [0.25, "¼×"], [0.5, "½×"], [1, "1×"], [2, "2×"], [4, "4×"]], 1);
  const cameras = choice("camera", [...reel.cameras.map(({ name }) => [name, name]), ["free", "free"]], state.camera);
  const loop = make("input", { type: "checkbox", checked: true });
  const bar = make("div", { className: "bar", role: "group", ariaLabel: "player" }, button, slider, clock, speeds,
    make("label", { title: "begin again at the end" }, loop, "loop"), cameras);

  // Puts words at a place of the world, unless that is out of sight or too near to where the last words were put.
  function put(node, [x, y, z], last = null) {
    const { x: right, y: up, z: depth } = world.camera.position.clone().set(x, y, z).project(world.camera);
    const spot = [(right + 1) / 2 * target.clientWidth, (1 - up) / 2 * target.clientHeight];
    const near = last && Math.hypot(spot[0] - last[0], spot[1] - last[1]) < NEAR;
    const seen = !near && Math.abs(right) < 1.05 && Math.abs(up) < 1.05 && depth < 1;
    node.style.display = seen ? "" : "none";
    if (seen) node.style.translate = `calc(${spot[0]}px - 50%) ${spot[1]}px`;
    return seen ? spot : last;
  }

  function label() {
    world.camera.updateMatrixWorld();
    marks.reduce((last, node, number) => put(node, reel.marks[number].at, last), null);
    if (tags.length > 1) tags.forEach((tag, number) => {
      const [x, y, z] = several(firstPath + 3 * number, 3, state.time);
      put(tag, [x, y, z + 0.35]);
    });
  }

  function tell() {
    reel.walks.forEach((walk, number) => {
      ways[number].textContent = `${(at(firstPath + 3 * number, state.time) - walk.start + 0).toFixed(2).replace(/^-(0\.00)$/, "$1")} m`;
    });
    slider.value = state.time;
    slider.ariaValueText = clock.textContent = `${state.time.toFixed(2)} s`;
    button.querySelector("path").setAttribute("d", state.playing ? SIGNS.pause : SIGNS.play);
    button.ariaLabel = button.title = state.playing ? "pause (space)" : "play (space)";
    cameras.value = state.camera;
  }

  // ------------------------------------------------------------------------------------------------ what is done

  let before = null, next = 0;
  function frame(now) {
    if (!state.playing) return;
    state.time += before === null ? 0 : Math.min((now - before) / 1000, 0.2) * state.speed;
    before = now;
    if (state.time >= reel.seconds) {
      if (state.loop) state.time %= reel.seconds;
      else { state.time = reel.seconds; pause(); }
    }
    draw();
    next = requestAnimationFrame(frame);
  }
  function play() {
    if (state.playing) return;
    if (state.time >= reel.seconds) state.time = 0;
    state.playing = true;
    before = null;
    next = requestAnimationFrame(frame);
  }
  function pause() { state.playing = false; cancelAnimationFrame(next); tell(); }
  function seek(time) { state.time = Math.min(Math.max(time, 0), reel.seconds); draw(); }
  function look(camera) { state.camera = camera; state.last = null; draw(); }
  const free = () => { if (state.camera !== "free") { state.camera = "free"; state.last = several(firstPath, 3, state.time); tell(); } };

  button.onclick = () => (state.playing ? pause() : play());
  slider.oninput = () => { const time = Number(slider.value); pause(); seek(time); };
  speeds.onchange = () => { state.speed = Number(speeds.value); };
  cameras.onchange = () => (cameras.value === "free" ? free() : look(cameras.value));
  loop.onchange = () => { state.loop = loop.checked; };
  target.addEventListener("pointerdown", (event) => { if (event.target.tagName === "CANVAS") free(); });
  // In a notebook the wheel scrolls, and zooms only once somebody has taken hold of the view.
  document.addEventListener("wheel", (event) => {
    if (event.target.tagName !== "CANVAS") return;
    if (window !== parent && state.camera !== "free" && !event.ctrlKey) event.stopPropagation();
    else free();
  }, { capture: true, passive: true });
  K3D.on(K3D.events.CAMERA_CHANGE, label);
  document.addEventListener("keydown", (event) => {
    const { tagName, type } = event.target, typing = ["SELECT", "BUTTON", "SUMMARY"].includes(tagName) || type === "checkbox";
    if (event.key === " " && !typing) { event.preventDefault(); button.onclick(); }
    if (typing || tagName === "INPUT") return;
    if (event.key === "ArrowLeft") { pause(); seek(state.time - 0.1); }
    if (event.key === "ArrowRight") { pause(); seek(state.time + 0.1); }
  });
  addEventListener("resize", () => requestAnimationFrame(draw));

  document.body.append(overlay, board, bar);
  window.walkerlab = { K3D, state, play, pause, seek, look, close: () => { pause(); K3D.disable(); } };
  draw();
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play();
}
