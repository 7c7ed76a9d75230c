// Plays recorded walks on a K3D plot. `recording` is the JSON data that page.py describes in its docstring.
(K3D, recording) => {
  "use strict";
  const TRANSFORM_CHANNELS = 8; // per mesh: position, unit quaternion (w, x, y, z), scale along z
  const CAMERA_CHANNELS = 6; // per camera: eye, target
  const POINT_CHANNELS = 3; // per centre of mass
  const MIN_MARK_SPACING = 28; // pixels between two marks
  const MARK_MARGIN = 9; // pixels from the upper and lower edge of the picture, within which no marks are written
  const ROBOT_RADIUS = 0.3; // m from the centre of mass of a robot, within which no marks are written
  const MAX_NAME_TAGS = 8; // maximum number of walks with a name above the picture
  const MAX_PHONE_WIDTH = 520, MAX_NAMES_ON_PHONE = 4; // pixels; walks in the list on a phone, above which the list is compact
  const RANKING_INTERVAL = 0.25; // s of the walk between two updates of the order of the list
  const TAG_HEIGHT = 0.25; // m from the centre of mass to the lower end of the line to its name
  const TAG_ROW = 22; // pixels between two rows of names
  const MAX_TAG_SHARE = 0.4; // share of the height of the picture that names may cover; the others are hidden
  const TAG_GAP = 6; // pixels between two names in a row
  const NOT_EQUAL = 517, REPLACE = 7681; // three.js constants for stencils
  const MIN_ASPECT = 4 / 3; // width over height; in a narrower window the camera moves back until everything is visible
  const MAX_FRAME_TIME = 0.2; // s; maximum advance of the time in a frame, for instance after the browser was paused
  const KEY_STEP = 0.1; // s, for the arrow keys
  const PLAY_PATH = "M5 3 L17 10 L5 17 Z", PAUSE_PATH = "M5 3 H8.5 V17 H5 Z M11.5 3 H15 V17 H11.5 Z"; // SVG; fonts may lack them

  const world = K3D.getWorld(), target = document.getElementById("canvasTarget");
  const { channels, nTimes } = unpack(recording.channels, recording.resolution.length);
  const firstCameraChannel = TRANSFORM_CHANNELS * recording.meshes.length;
  const firstPathChannel = firstCameraChannel + CAMERA_CHANNELS * recording.cameras.length;
  const meshes = recording.meshes.map((id) => world.ObjectsById[id]);
  meshes.forEach((mesh) => { mesh.matrixAutoUpdate = false; mesh.frustumCulled = false; });

  // A pixel that one shadow has darkened is marked in the stencil, so that no other shadow darkens it again.
  for (const id of recording.shadows) {
    const { material } = world.ObjectsById[id];
    Object.assign(material, { stencilWrite: true, stencilRef: 1, stencilFunc: NOT_EQUAL, stencilZPass: REPLACE, depthWrite: false });
  }
  const footprints = recording.footprints.map(({ mesh, times }) => ({ geometry: world.ObjectsById[mesh].geometry, times }));

  const state = { time: 0, playing: false, speed: 1, loop: true, camera: recording.camera, lastPoint: null };

  // ---------------------------------------------------------------------------------------------------- recording

  // Decodes the output of tracks.pack_channels.
  function unpack(text, count) {
    const bytes = fflate.unzlibSync(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)));
    const firstValues = new Float64Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + 8 * count));
    const differences = new Int32Array(bytes.buffer.slice(bytes.byteOffset + 8 * count, bytes.byteOffset + bytes.length));
    const nDifferences = differences.length / count;
    const channels = [];
    for (let c = 0; c < count; c++) {
      const values = new Float64Array(nDifferences + 1);
      const unit = recording.resolution[c];
      let sum = Math.round(firstValues[c] / unit);
      values[0] = sum * unit;
      for (let i = 0; i < nDifferences; i++) { sum += differences[c * nDifferences + i]; values[i + 1] = sum * unit; }
      channels.push(values);
    }
    return { channels, nTimes: nDifferences + 1 };
  }

  function interpolate(channel, time) {
    const x = Math.min(Math.max(time / recording.duration, 0), 1) * (nTimes - 1);
    const i = Math.min(Math.floor(x), nTimes - 2), fraction = x - i;
    return channels[channel][i] * (1 - fraction) + channels[channel][i + 1] * fraction;
  }

  const interpolateAll = (first, count, time) => Array.from({ length: count }, (_, k) => interpolate(first + k, time));

  const centreOfMass = (walk, time) => interpolateAll(firstPathChannel + POINT_CHANNELS * walk, POINT_CHANNELS, time);

  // ------------------------------------------------------------------------------------------------------ drawing

  function placeMesh(mesh, [x, y, z, w, i, j, k, scale]) {
    mesh.position.set(x, y, z);
    mesh.quaternion.set(i, j, k, w).normalize();
    mesh.scale.set(1, 1, scale);
    mesh.updateMatrix();
    mesh.matrixWorldNeedsUpdate = true;
  }

  function aimCamera() {
    if (state.camera === "free") { followFirstWalk(); return; }
    const number = Math.max(recording.cameras.findIndex(({ name }) => name === state.camera), 0);
    const values = interpolateAll(firstCameraChannel + CAMERA_CHANNELS * number, CAMERA_CHANNELS, state.time);
    const eye = values.slice(0, 3), centre = values.slice(3);
    const back = Math.max(1, MIN_ASPECT * target.clientHeight / target.clientWidth);
    const movedEye = eye.map((value, axis) => centre[axis] + back * (value - centre[axis]));
    K3D.setCamera([...movedEye, ...centre, ...recording.cameras[number].up]);
  }

  // Moves the free camera as far as the first walk has moved since the last call; the user controls its direction.
  function followFirstWalk() {
    const point = centreOfMass(0, state.time);
    if (state.lastPoint) {
      const movement = point.map((value, axis) => value - state.lastPoint[axis]);
      const eyeTargetUp = world.controls.getCameraArray();
      K3D.setCamera(eyeTargetUp.map((value, axis) => value + (axis < CAMERA_CHANNELS ? movement[axis % 3] : 0)));
    }
    state.lastPoint = point;
  }

  function draw() {
    meshes.forEach((mesh, number) =>
      placeMesh(mesh, interpolateAll(TRANSFORM_CHANNELS * number, TRANSFORM_CHANNELS, state.time)));
    for (const { geometry, times } of footprints) {
      const after = times.findIndex((time) => time > state.time);
      geometry.setDrawRange(0, recording.footprint_indices * (after < 0 ? times.length : after));
    }
    aimCamera();
    K3D.render();
    updateControls();
    updateLabels();
  }

  // ---------------------------------------------------------------------------------------------------- page parts

  const make = (tag, properties = {}, ...children) => {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(properties)) {
      if (name in node && name !== "list") node[name] = value; else node.setAttribute(name, value);
    }
    node.append(...children);
    return node;
  };

  const hasTags = recording.walks.length > 1 && recording.walks.length <= MAX_NAME_TAGS;
  const tags = recording.walks.map((walk) => {
    const tag = make("div", { className: "tag" }, make("span", { textContent: walk.label }));
    tag.style.setProperty("--colour", walk.colour);
    return tag;
  });
  const marks = recording.marks.map(({ text }) => make("div", { className: "mark", textContent: text }));
  const overlay = make("div", { className: "overlay", ariaHidden: "true" }, ...marks, ...(hasTags ? tags : []));

  const distances = recording.walks.map(() => make("b", { className: "distance", title: "Distance forward of the centre of " +
    "mass. The marks on the ground are distances from the foremost point of the robot at the start." }));
  const entries = recording.walks.map((walk, number) => {
    const dot = make("span", { className: "dot" });
    dot.style.setProperty("--colour", walk.colour);
    const facts = make("dl", {}, ...walk.facts.flatMap(([name, value]) => [
      make("dt", { textContent: name }), make("dd", { textContent: value })]));
    const verdict = make("p", { className: walk.counts ? "verdict" : "verdict rejected", textContent: walk.verdict });
    const head = make("summary", {}, make("span", { className: "place" }), dot, make("span", { className: "name", textContent: walk.label }), distances[number],
      make("span", { className: "sign", textContent: walk.counts ? "✓" : "✗", title: walk.verdict }));
    return make("details", { open: recording.walks.length === 1 && innerWidth > 620, ontoggle: () => fitPicture() }, head, verdict, facts);
  });
  const isRanked = recording.walks.length > (innerWidth > MAX_PHONE_WIDTH ? MAX_NAME_TAGS : MAX_NAMES_ON_PHONE); // a compact list in the present order
  const walkList = make("section", { className: isRanked ? "walks ranked" : "walks", ariaLabel: "Walks" }, ...entries);

  // Sorts the list by the distance at this time; walks that do not count come last.
  let rankedAt = -1;
  function rankWalks() {
    const moment = Math.floor(state.time / RANKING_INTERVAL);
    if (moment === rankedAt) return;
    rankedAt = moment;
    const covered = recording.walks.map((walk, number) => centreOfMass(number, state.time)[0] - walk.start);
    const counts = recording.walks.map((walk) => Number(walk.counts));
    recording.walks.map((_, number) => number)
      .sort((one, other) => counts[other] - counts[one] || covered[other] - covered[one])
      .forEach((number, place) => {
        entries[number].style.order = place;
        entries[number].querySelector(".place").textContent = counts[number] ? `${place + 1}.` : "–";
      });
  }

  const playButton = make("button", { className: "play", type: "button" });
  playButton.innerHTML = '<svg viewBox="0 0 20 20" width="18" height="18" aria-hidden="true"><path/></svg>';
  const slider = make("input", { type: "range", min: 0, max: recording.duration, step: recording.duration / (nTimes - 1),
    value: 0, className: "time", ariaLabel: "Time in seconds" });
  const clock = make("output", { className: "clock" });
  const makeMenu = (label, options, selected) => make("select", { ariaLabel: label, title: label }, ...options.map(
    ([value, text]) => make("option", { value, textContent: text, selected: value === selected })));
  const speedMenu = makeMenu("Speed", [[0.1, "0.1×"], [0.25, "¼×"], [0.5, "½×"], [1, "1×"], [2, "2×"], [4, "4×"]], 1);
  const cameraNames = [...recording.cameras.map(({ name }) => name), "free"];
  const cameraMenu = makeMenu("Camera", cameraNames.map((name) => [name, name]), state.camera);
  const loopBox = make("input", { type: "checkbox", checked: true });
  const controls = make("div", { className: "player-controls", role: "group", ariaLabel: "Player" }, playButton, slider, clock, speedMenu,
    make("label", { title: "Repeat the walk" }, loopBox, "loop"), cameraMenu);

  const distanceBetween = (one, other) => Math.hypot(one[0] - other[0], one[1] - other[1]);

  // Returns the place of a point of the world on the screen, and whether it is inside the picture.
  function toScreen([x, y, z]) {
    const { x: right, y: up, z: depth } = world.camera.position.clone().set(x, y, z).project(world.camera);
    const place = [(right + 1) / 2 * target.clientWidth, (1 - up) / 2 * target.clientHeight];
    const isWithin = place[1] > MARK_MARGIN && place[1] < target.clientHeight - MARK_MARGIN;
    return { place, isInside: Math.abs(right) < 1.05 && isWithin && depth < 1 };
  }

  // Moves a label to a point of the world and returns its place on the screen. The label is hidden, and `last` returned,
  // if the point is outside the picture, on a robot, or too near to `last`, the place of the previous label.
  function placeLabel(node, point, robots, last) {
    const { place, isInside } = toScreen(point);
    const isFree = !(last && distanceBetween(place, last) < MIN_MARK_SPACING) &&
      robots.every(({ centre, radius }) => distanceBetween(place, centre) > radius);
    const isVisible = isInside && isFree;
    node.style.display = isVisible ? "" : "none";
    if (isVisible) node.style.translate = `calc(${place[0]}px - 50%) ${place[1]}px`;
    return isVisible ? place : last;
  }

  function updateLabels() {
    world.camera.updateMatrixWorld();
    const robots = recording.walks.map((_, number) => {
      const [x, y, z] = centreOfMass(number, state.time);
      const centre = toScreen([x, y, z]).place;
      return { centre, radius: distanceBetween(centre, toScreen([x, y, z + ROBOT_RADIUS]).place) };
    });
    marks.reduce((last, node, number) => placeLabel(node, recording.marks[number].position, robots, last), null);
    if (hasTags) placeTags();
  }

  // Writes the names at the top of the picture, above the robots, with a line down to each robot; names never overlap.
  function placeTags() {
    const places = tags.map((tag, number) => {
      const [x, y, z] = centreOfMass(number, state.time);
      const point = world.camera.position.clone().set(x, y, z + TAG_HEIGHT).project(world.camera);
      const isVisible = Math.abs(point.x) < 1 && point.y < 1.2 && point.z < 1;
      tag.style.display = isVisible ? "" : "none";
      return { tag, isVisible, x: (point.x + 1) / 2 * target.clientWidth, y: (1 - point.y) / 2 * target.clientHeight };
    }).filter(({ isVisible }) => isVisible);
    const rowEnds = [];
    for (const { tag, x, y } of places.sort((one, other) => one.x - other.x)) {
      const width = tag.firstChild.offsetWidth;
      const left = Math.max(0, Math.min(x - width / 2, target.clientWidth - width));
      let row = rowEnds.findIndex((end) => end + TAG_GAP <= left);
      if (row < 0) row = rowEnds.length;
      if ((row + 1) * TAG_ROW > MAX_TAG_SHARE * target.clientHeight) { tag.style.display = "none"; continue; }
      rowEnds[row] = left + width;
      tag.style.translate = `${left}px ${row * TAG_ROW}px`;
      tag.style.setProperty("--x", `${x - left}px`);
      tag.style.setProperty("--length", `${Math.max(0, y - row * TAG_ROW - TAG_ROW + 2)}px`);
    }
  }

  function updateControls() {
    recording.walks.forEach((walk, number) => {
      const [x] = centreOfMass(number, state.time);
      distances[number].textContent = `${(x - walk.start).toFixed(2).replace(/^-(0\.00)$/, "$1")} m`;
    });
    if (isRanked) rankWalks();
    slider.value = state.time;
    slider.ariaValueText = clock.textContent = `${state.time.toFixed(2)} s`;
    playButton.querySelector("path").setAttribute("d", state.playing ? PAUSE_PATH : PLAY_PATH);
    playButton.ariaLabel = playButton.title = state.playing ? "Pause (space)" : "Play (space)";
    cameraMenu.value = state.camera;
  }

  // ---------------------------------------------------------------------------------------------------- user input

  let lastFrame = null; // ms
  let request = 0;

  function advance(now) {
    if (!state.playing) return;
    if (lastFrame !== null) state.time += Math.min((now - lastFrame) / 1000, MAX_FRAME_TIME) * state.speed;
    lastFrame = now;
    if (state.time >= recording.duration) {
      if (state.loop) state.time %= recording.duration;
      else { state.time = recording.duration; pause(); }
    }
    draw();
    request = requestAnimationFrame(advance);
  }

  function play() {
    if (state.playing) return;
    if (state.time >= recording.duration) state.time = 0;
    state.playing = true;
    lastFrame = null;
    request = requestAnimationFrame(advance);
  }

  function pause() { state.playing = false; cancelAnimationFrame(request); updateControls(); }

  function seek(time) { state.time = Math.min(Math.max(time, 0), recording.duration); draw(); }

  function setCamera(name) { state.camera = name; state.lastPoint = null; draw(); }

  function freeCamera() {
    if (state.camera === "free") return;
    state.camera = "free";
    state.lastPoint = centreOfMass(0, state.time);
    updateControls();
  }

  playButton.onclick = () => (state.playing ? pause() : play());
  slider.oninput = () => { const time = Number(slider.value); pause(); seek(time); };
  speedMenu.onchange = () => { state.speed = Number(speedMenu.value); };
  cameraMenu.onchange = () => (cameraMenu.value === "free" ? freeCamera() : setCamera(cameraMenu.value));
  loopBox.onchange = () => { state.loop = loopBox.checked; };
  target.addEventListener("pointerdown", (event) => { if (event.target.tagName === "CANVAS") freeCamera(); });
  // In a notebook the wheel scrolls; it zooms only when the camera is free or Ctrl is pressed.
  document.addEventListener("wheel", (event) => {
    if (event.target.tagName !== "CANVAS") return;
    if (window !== parent && state.camera !== "free" && !event.ctrlKey) event.stopPropagation();
    else freeCamera();
  }, { capture: true, passive: true });
  K3D.on(K3D.events.CAMERA_CHANGE, updateLabels);
  document.addEventListener("keydown", (event) => {
    const { tagName, type } = event.target;
    const isOnControl = ["SELECT", "BUTTON", "SUMMARY"].includes(tagName) || type === "checkbox"; // these use the keys themselves
    if (event.key === " " && !isOnControl) { event.preventDefault(); playButton.onclick(); }
    if (isOnControl || tagName === "INPUT") return;
    if (event.key === "ArrowLeft") { pause(); seek(state.time - KEY_STEP); }
    if (event.key === "ArrowRight") { pause(); seek(state.time + KEY_STEP); }
  });
  addEventListener("resize", () => requestAnimationFrame(draw));

  // Places the picture below the list of walks, which therefore never covers a robot.
  function fitPicture() {
    document.body.style.setProperty("--list-height", `${walkList.offsetHeight}px`);
    K3D.resizeHelper();
    requestAnimationFrame(draw);
  }

  document.body.append(overlay, walkList, controls);
  new ResizeObserver(fitPicture).observe(walkList);
  window.walkerlab = { K3D, state, play, pause, seek, setCamera, close: () => { pause(); K3D.disable(); } };
  draw();
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play();
}
