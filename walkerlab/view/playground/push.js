// Forces that the user applies to a robot: by dragging it with a finger or the mouse, and with a button.
const GRAB_DISTANCE = 60; // pixels within which a robot is grabbed
const PULL_STIFFNESS = 40; // N/m per kg of the robot
const PULL_DAMPING = 6; // N·s/m per kg of the robot, which limits its speed
const MAX_PULL = 1.2; // times the weight of the robot on earth
const PUSH_TIME = 0.15; // s
const PUSH_STRENGTH = 1.2; // times the weight of the robot on earth
const EARTH_GRAVITY = 9.81; // m/s²

class Pusher {
  constructor(view, walks) { // walks: a function that returns the walks
    Object.assign(this, { view, walks, grab: null, pushes: new Map() });
    this.line = document.querySelector(".pull line");
    const { target } = view;
    const listen = (name, act) => target.addEventListener(name, (event) => { if (act(event)) event.stopPropagation(); }, { capture: true });
    listen("pointerdown", (event) => this.start(event));
    listen("pointermove", (event) => this.move(event));
    listen("pointerup", () => this.end());
    listen("pointercancel", () => this.end());
    // Touch events follow pointer events; the camera must not move while a robot is dragged.
    for (const name of ["touchstart", "touchmove", "mousedown", "mousemove"]) listen(name, () => this.grab !== null);
  }

  place(event) {
    const box = this.view.target.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  start(event) { // grabs the nearest segment, and returns whether one is near enough
    const [x, y] = this.place(event);
    let nearest = GRAB_DISTANCE;
    this.walks().forEach((walk, number) => walk.robot.segments.forEach((_, index) => {
      const geom = walk.id("GEOM", `walker/trunk${index + 1}`);
      const point = this.pointOf(walk, number, geom);
      const shown = this.view.project(point);
      const distance = Math.hypot(shown.x - x, shown.y - y);
      if (distance >= nearest) return;
      nearest = distance;
      this.grab = { number, index, depth: shown.depth, x, y };
    }));
    if (this.grab) this.view.target.setPointerCapture(event.pointerId);
    return this.grab !== null;
  }

  move(event) {
    if (!this.grab) return false;
    [this.grab.x, this.grab.y] = this.place(event);
    return true;
  }

  end() {
    const wasGrabbed = this.grab !== null;
    this.grab = null;
    return wasGrabbed;
  }

  push(number) { // pushes a robot to the left
    this.pushes.set(number, PUSH_TIME);
  }

  pointOf({ data }, number, geom) {
    const [x, y, z] = data.geom_xpos.subarray(3 * geom, 3 * geom + 3);
    return [x, y + this.view.drawing.robots[number].lane, z];
  }

  apply(walk, number) { // sets the forces of the next step; called before each step
    const forces = walk.data.xfrc_applied;
    forces.fill(0);
    const weight = EARTH_GRAVITY * py.sum(walk.robot.segments.map(({ mass }) => mass));
    if ((this.pushes.get(number) ?? 0) > 0) {
      this.pushes.set(number, this.pushes.get(number) - walk.timestep);
      forces[6 * walk.page.robot_body + 1] = PUSH_STRENGTH * weight;
      walk.isChanged ||= !walk.verdict;
    }
    if (this.grab?.number !== number) return;
    const geom = walk.id("GEOM", `walker/trunk${this.grab.index + 1}`);
    const body = walk.model.geom_bodyid[geom];
    const point = this.pointOf(walk, number, geom);
    const goal = this.view.unproject(this.grab.x, this.grab.y, this.grab.depth);
    const last = this.grab.point ?? point;
    this.grab.point = point;
    const pull = goal.map((value, axis) => (PULL_STIFFNESS * (value - point[axis]) -
      PULL_DAMPING * (point[axis] - last[axis]) / walk.timestep) * weight / EARTH_GRAVITY);
    const scale = Math.min(1, MAX_PULL * weight / Math.max(Math.hypot(...pull), 1e-9));
    forces.set(pull.map((value) => scale * value), 6 * body);
    walk.isChanged ||= !walk.verdict;
  }

  draw() { // draws a line from the grabbed segment to the finger or the mouse
    this.line.style.display = this.grab ? "" : "none";
    if (!this.grab) return;
    const { number, index, x, y } = this.grab;
    const walk = this.walks()[number];
    const from = this.view.project(this.pointOf(walk, number, walk.id("GEOM", `walker/trunk${index + 1}`)));
    for (const [name, value] of Object.entries({ x1: from.x, y1: from.y, x2: x, y2: y })) this.line.setAttribute(name, value);
  }
}
