// Loads MuJoCo and runs the page: time, the player's buttons and the results.
const MAX_FRAME_TIME = 1; // s; maximum time that is simulated per frame, for instance after the browser was paused
const MAX_COMPUTE_TIME = 0.25; // s of computing per frame; a slow computer shows slow motion instead of stopping
const LEVEL_STEPS = 40; // steps per frame of the walk on level ground that the verdict may require
const VERDICT_INTERVAL = 0.5; // s between two verdicts during a walk
const SLOW_FRAME = 0.06; // s between two frames
const MAX_SLOW_FRAMES = 4; // in a row, before the resolution is lowered
const MIN_PIXEL_RATIO = 0.5;
const MAX_DISTANCE = 110; // m from the start; beyond it the walk restarts, because the drawn ground ends
const PLAY_PATH = "M5 3 L17 10 L5 17 Z", PAUSE_PATH = "M5 3 H8.5 V17 H5 Z M11.5 3 H15 V17 H11.5 Z";

async function decompress(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

async function loadMujoco(files) {
  if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined") return null;
  const text = new TextDecoder().decode(await decompress(files["mujoco.js"]));
  const script = text.replace(/export default \w+;/, "").replaceAll("import.meta.url", "document.baseURI"); // not in a module
  const load = new Function(`${script}\nreturn loadMujoco;`)();
  return load({ wasmBinary: await decompress(files["mujoco.wasm"]), printErr: () => {} });
}

const UNSUPPORTED = "This browser cannot run the page, because it lacks DecompressionStream or WebAssembly. Open the page in a current " +
  "Chrome, Edge, Firefox (115 or newer) or Safari (16.4 or newer).";

async function startPlayground(K3D, data, loading) { // loading: promise of MuJoCo
  const message = document.querySelector(".message");
  const showFailure = (text) => {
    message.textContent = text;
    message.classList.add("failed");
  };
  try {
    const mj = await loading;
    if (!mj) { showFailure(UNSUPPORTED); return; }
    const page = JSON.parse(new TextDecoder().decode(await decompress(data)));
    message.textContent = "";
    window.walkerlab = new Playground(K3D, page, mj);
  } catch (error) {
    showFailure(`The page could not start: ${error.message}`);
    throw error;
  }
}

class Playground {
  constructor(K3D, page, mj) {
    Object.assign(this, { K3D, page, mj, isPlaying: false, speed: 1, pending: new Set(), listeners: [] });
    this.state = { world: page.world, genomes: page.robots.map(({ genome }) => genome), selected: 0 };
    this.walks = this.state.genomes.map((_, number) => this.newWalk(number));
    this.view = new View(K3D, page);
    this.view.slope = page.world.slope;
    this.walks.forEach((walk, number) => this.view.setRobot(number, walk));
    this.pusher = new Pusher(this.view, () => this.walks);
    this.controls = new Controls(page, this.state, (what, detail) => this.handleChange(what, detail));
    this.addScores();
    this.addPlayer();
    this.draw(0);
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.play();
  }

  newWalk(number) {
    const walk = new Walk(this.mj, this.page, expressRobot(this.page, this.state.genomes[number]), this.state.world);
    walk.settleNow();
    return walk;
  }

  // --------------------------------------------------------------------------------------------------------- changes

  handleChange(what, detail) {
    if (what === "message") { this.showMessage(detail); return; }
    if (what === "world" && "slope" in detail) what = "all";
    this.pending.add(what); // applied before the next frame, because a slider may move several times between two frames
    if (!this.isPlaying) requestAnimationFrame(() => { this.applyChanges(); this.draw(0); });
    if (what !== "world") this.listeners.forEach((listener) => listener(this.genome));
  }

  applyChanges() {
    const changes = this.pending;
    this.pending = new Set();
    const { selected, world } = this.state;
    if (changes.has("all")) {
      this.view.setSlope(world.slope);
      this.walks.forEach((_, number) => this.replaceWalk(number));
      return;
    }
    if (changes.has("world")) for (const walk of this.walks) walk.setWorld(world);
    if (changes.has("body")) this.replaceWalk(selected);
    else if (changes.has("strength")) this.changeStrength(selected);
    else if (changes.has("gait")) this.walks[selected].setGait(expressRobot(this.page, this.state.genomes[selected]));
    if (changes.size) this.view.setRobot(selected, this.walks[selected]);
  }

  replaceWalk(number) { // a new body walks from the start
    this.walks[number].delete();
    this.walks[number] = this.newWalk(number);
    this.view.setRobot(number, this.walks[number]);
    this.view.smooth = null; // the camera follows the new walk at once
    this.restartScore(number);
  }

  changeStrength(number) { // the walk continues with stronger or weaker servos
    const old = this.walks[number];
    const walk = new Walk(this.mj, this.page, expressRobot(this.page, this.state.genomes[number]), this.state.world);
    for (const name of ["qpos", "qvel", "ctrl", "qacc_warmstart"]) walk.data[name].set(old.data[name]);
    for (const name of ["steps", "phase", "trace", "restTime", "strideShift", "verdict", "targets", "comAtMiddle", "isChanged"]) walk[name] = old[name];
    walk.noteChange();
    this.walks[number] = walk;
    old.delete();
  }

  get genome() { return formatGenome(this.page, this.state.genomes[this.state.selected]); }

  setGenome(text) { this.controls.use(text); } // for a notebook

  onGenome(listener) { this.listeners.push(listener); }

  // ------------------------------------------------------------------------------------------------------------ time

  play() {
    if (this.isPlaying) return;
    this.isPlaying = true;
    this.lastFrame = null;
    this.showPlayer();
    requestAnimationFrame((now) => this.advance(now));
  }

  pause() { this.isPlaying = false; this.showPlayer(); }

  restart() {
    this.applyChanges();
    this.walks.forEach((walk, number) => {
      walk.restart();
      walk.settleNow();
      this.restartScore(number);
    });
    this.view.smooth = null;
    this.draw(0);
    this.play();
  }

  close() { this.pause(); this.K3D.disable(); } // releases the WebGL context

  advance(now) {
    if (!this.isPlaying) return;
    const elapsed = this.lastFrame === null ? 0 : Math.min((now - this.lastFrame) / 1000, MAX_FRAME_TIME) * this.speed;
    if (this.lastFrame !== null) this.adaptResolution((now - this.lastFrame) / 1000);
    this.lastFrame = now;
    this.applyChanges();
    this.simulate(elapsed);
    this.draw(elapsed);
    requestAnimationFrame((later) => this.advance(later));
  }

  simulate(seconds) {
    this.timeToSimulate = (this.timeToSimulate ?? 0) + seconds;
    const { timestep } = this.walks[0];
    const end = performance.now() + 1000 * MAX_COMPUTE_TIME;
    for (; this.timeToSimulate >= timestep && performance.now() < end; this.timeToSimulate -= timestep) {
      this.walks.forEach((walk, number) => {
        if (walk.isBroken) return;
        this.pusher.apply(walk, number);
        walk.step();
      });
    }
    this.timeToSimulate = Math.min(this.timeToSimulate, timestep);
    for (const walk of this.walks) walk.stepLevelWalk(LEVEL_STEPS);
    if (this.walks.some(({ data }) => Math.hypot(data.qpos[0], data.qpos[1]) > MAX_DISTANCE)) this.restart();
  }

  draw(elapsed) {
    this.view.draw(this.walks, elapsed);
    this.pusher.draw();
    this.showScores();
  }

  // ---------------------------------------------------------------------------------------------------------- player

  addPlayer() {
    const find = (name) => document.querySelector(`.transport .${name}`);
    this.playButton = find("play");
    this.playButton.onclick = () => (this.isPlaying ? this.pause() : this.play());
    find("restart").onclick = () => this.restart();
    find("push").onclick = () => this.pusher.push(this.state.selected);
    for (const button of [this.playButton, find("restart"), find("push")]) button.disabled = false;
    const speeds = [[0.1, "0.1×"], [0.25, "¼×"], [0.5, "½×"], [1, "1×"], [2, "2×"], [4, "4×"]];
    const speedMenu = find("speed");
    speedMenu.append(...speeds.map(([value, text]) => make("option", { value, textContent: text, selected: value === 1 })));
    speedMenu.onchange = () => { this.speed = Number(speedMenu.value); };
    const cameraMenu = find("camera");
    cameraMenu.append(...[...Object.keys(this.page.drawing.cameras), "free"].map((name) => make("option", { value: name, textContent: name })));
    cameraMenu.value = this.page.camera;
    const setCamera = (name) => { cameraMenu.value = name; this.view.setCamera(name); this.draw(0); };
    cameraMenu.onchange = () => setCamera(cameraMenu.value);
    this.view.target.addEventListener("pointerdown", () => this.view.camera === "free" || setCamera("free"));
    this.view.target.addEventListener("wheel", () => this.view.camera === "free" || setCamera("free"), { capture: true, passive: true });
    document.addEventListener("keydown", (event) => {
      const isOnControl = ["SELECT", "BUTTON", "SUMMARY", "INPUT", "TEXTAREA"].includes(event.target.tagName);
      if (event.key !== " " || isOnControl) return;
      event.preventDefault();
      this.playButton.onclick();
    });
    addEventListener("resize", () => requestAnimationFrame(() => this.draw(0)));
    this.showPlayer();
  }

  showPlayer() {
    this.playButton.querySelector("path").setAttribute("d", this.isPlaying ? PAUSE_PATH : PLAY_PATH);
    this.playButton.ariaLabel = this.playButton.title = this.isPlaying ? "Pause (space)" : "Play (space)";
  }

  adaptResolution(frameTime) { // lowers the resolution on computers that draw slowly, such as those without a graphics card
    this.slowFrames = frameTime > SLOW_FRAME ? (this.slowFrames ?? 0) + 1 : 0;
    const { renderer } = this.K3D.getWorld();
    if (this.slowFrames < MAX_SLOW_FRAMES || renderer.getPixelRatio() <= MIN_PIXEL_RATIO) return;
    this.slowFrames = 0;
    renderer.setPixelRatio(Math.max(MIN_PIXEL_RATIO, 0.7 * renderer.getPixelRatio()));
  }

  showMessage(text) { document.querySelector(".message").textContent = text; }

  // --------------------------------------------------------------------------------------------------------- results

  addScores() {
    this.scores = this.page.robots.map(({ label, colour }) => {
      const dot = make("span", { className: "dot" });
      dot.style.setProperty("--colour", colour);
      const distance = make("b", { className: "distance", title: "Forward distance of the centre of mass since the gait began" });
      const clock = make("span", { className: "clock" });
      const verdict = make("p", { className: "verdict" });
      document.querySelector(".score").append(make("div", { className: "robot" },
        make("p", { className: "name" }, dot, make("span", { textContent: label }), distance, clock), verdict));
      return { distance, clock, verdict, nextVerdict: 0, isDone: false, result: "", before: "" };
    });
  }

  restartScore(number) { // the result of the last measured walk is kept, to compare
    const score = this.scores[number];
    Object.assign(score, { nextVerdict: 0, isDone: false, before: score.result || score.before, result: "" });
  }

  showScores() {
    this.walks.forEach((walk, number) => {
      const score = this.scores[number];
      if (walk.isBroken) { this.showResult(score, walk); return; }
      const start = walk.trace.com[0];
      const distance = start ? walk.reading("com")[0] - start[0] : 0;
      score.distance.textContent = `${distance.toFixed(2).replace(/^-(0\.00)$/, "$1")} m`;
      score.clock.textContent = `${walk.time.toFixed(1)} s`;
      if (walk.verdict) { this.showResult(score, walk); return; }
      if (walk.trace.time.length < 3) { this.showVerdict(score, `The walk is measured for ${walk.duration} s.`, ""); return; }
      if (walk.time < score.nextVerdict) return;
      score.nextVerdict = walk.time + VERDICT_INTERVAL;
      walk.trace.warnings = walk.countWarnings();
      const { name, reason } = judge(this.page, walk.trace, walk);
      if (walk.isChanged) this.showVerdict(score, "The walk was changed by hand. Restart to measure it.", "");
      else if (name === "ok") this.showVerdict(score, `${walk.velocity.toFixed(2)} m/s. The walk counts so far.`, "");
      else this.showVerdict(score, `Does not count: ${name}, ${reason}.`, "rejected");
    });
  }

  showResult(score, walk) {
    if (score.isDone && score.isOutdated === walk.isOutdated) return;
    score.isOutdated = walk.isOutdated;
    const result = `In ${walk.duration} s: ${walk.distance.toFixed(2)} m, ${walk.velocity.toFixed(2)} m/s.`;
    if (walk.isOutdated) this.showVerdict(score, `${result} Changed after that. Press Restart to measure it again.`, "");
    else if (walk.isChanged) this.showVerdict(score, `${result} The walk was changed by hand. Restart to measure it.`, "");
    else if (walk.needsLevelWalk) this.showVerdict(score, `${result} Checking whether the robot also walks on level ground …`, "");
    else if (walk.verdict.name === "ok") this.showVerdict(score, `${result} The walk counts: in these ${walk.duration} s no rule was broken.`, "counts");
    else this.showVerdict(score, `${result} Does not count: ${walk.verdict.name}, ${walk.verdict.reason}.`, "rejected");
    score.isDone = !walk.needsLevelWalk;
    const counted = walk.verdict.name === "ok" ? "" : " (did not count)";
    if (score.isDone && !walk.isChanged) score.result = `${walk.distance.toFixed(2)}\u00a0m${counted}`;
  }

  showVerdict({ verdict, before }, text, kind) {
    if (before) text += ` Before:\u00a0${before}.`;
    if (verdict.textContent !== text) verdict.textContent = text;
    verdict.className = `verdict ${kind}`;
  }
}
