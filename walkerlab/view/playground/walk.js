// One live walk: the model, the start, settling and the gait, as in world/scene.py and simulation/.
const CAPSULE = 3; // mjtGeom.mjGEOM_CAPSULE
const FULL_TURN = 2 * Math.PI;

// ------------------------------------------------------------------------------------------------------------- model

// Compiles the model of a robot: `write_individual`, translated from Python, writes its sizes into the model of its body plan.
function compileModel(mj, page, robot, world) {
  const plan = bodyPlan(robot);
  page.specs ??= {};
  const spec = page.specs[plan] ??= mj.parseXMLString(page.models[plan]);
  const find = (kind, as) => (name) => as(mj.mjs_findElement(spec, mj.mjtObj[`mjOBJ_${kind}`], name));
  const findGeom = find("GEOM", mj.mjs_asGeom);
  const described = {
    body: find("BODY", mj.mjs_asBody), joint: find("JOINT", mj.mjs_asJoint), site: find("SITE", mj.mjs_asSite),
    tendon: find("TENDON", mj.mjs_asTendon), actuator: find("ACTUATOR", mj.mjs_asActuator),
    geom(name) { // `write_individual` sets the ends of a capsule, which replace the position in the file
      const geom = findGeom(name);
      geom.pos.fill(0);
      return geom;
    },
  };
  write_individual(described, robot, page.robot);
  if (page.has_slope) findGeom("plane").quat.set([Math.cos(world.slope / 2), 0, -Math.sin(world.slope / 2), 0]);
  const model = mj.mj_compile(spec);
  setServoDamping(page, model);
  applyWorld(page, model, world);
  return model;
}

// Computes the damping of the servos from the damping ratio as MuJoCo 3.17 does; earlier versions divide by another inertia.
function setServoDamping(page, model) {
  for (let servo = 0; servo < model.nu; servo++) {
    const inertia = 1 / model.dof_invweight0[model.jnt_dofadr[model.actuator_trnid[2 * servo]]];
    const stiffness = model.actuator_gainprm[servo * model.actuator_gainprm.length / model.nu];
    model.actuator_biasprm[servo * model.actuator_biasprm.length / model.nu + 2] = -2 * page.damping_ratio * Math.sqrt(stiffness * inertia);
  }
}

// Writes gravity, wind and friction into a compiled model; they can change during a walk.
function applyWorld(page, model, world) {
  const { opt } = model;
  opt.gravity.set(world.gravity);
  const isWindy = world.wind.some((speed) => speed !== 0);
  opt.wind.set(world.wind);
  opt.density = isWindy ? page.air.density : 0;
  opt.viscosity = isWindy ? page.air.viscosity : 0;
  const now = model.walkerlabTexture ?? page.world.texture;
  if (world.texture === now) return;
  const { sliding, torsional, rolling } = page.textures[world.texture];
  for (let geom = 0; geom < model.ngeom; geom++) {
    if (!model.geom_priority[geom]) continue; // the robot and its loads take the friction of the ground
    const ratio = rolling / page.textures[now].rolling; // the rolling friction of an obstacle grows with its size
    model.geom_friction.set([sliding, torsional, model.geom_friction[3 * geom + 2] * ratio], 3 * geom);
  }
  model.walkerlabTexture = world.texture;
}

// -------------------------------------------------------------------------------------------------------------- gait

function gaitOf(robot) { // the motion of each servo, in the order of the actuators
  return robot.segments.flatMap(({ legs }) => !legs ? [] : [0, legs.stride].flatMap((behind) => [legs.hip, legs.knee].map(
    ({ amplitude, phase, offset }) => ({ amplitude, phase, offset, legPhase: legs.phase - behind }))));
}

function strideAngle(strides, duty) {
  const position = modulo(strides + 0.25, 1);
  return Math.PI * (position < 1 - duty ? position / (1 - duty) : 1 + (position - (1 - duty)) / duty) - Math.PI / 2;
}

const modulo = (value, base) => ((value % base) + base) % base;

// -------------------------------------------------------------------------------------------------------------- walk

class Walk {
  // Places a robot at the start. `step` then simulates one step: first the body settles, then it walks.
  constructor(mj, page, robot, world) {
    Object.assign(this, { mj, page, robot, world });
    this.model = compileModel(mj, page, robot, world);
    this.data = new mj.MjData(this.model);
    this.gait = gaitOf(robot);
    this.timestep = this.model.opt.timestep;
    this.duration = page.duration;
    this.restart();
  }

  delete() { this.data.delete(); this.model.delete(); this.level?.delete(); }

  restart() {
    this.level?.delete();
    this.level = null;
    this.mj.mj_resetData(this.model, this.data);
    this.rest = this.gait.map(({ offset }) => offset);
    this.place();
    this.data.ctrl.set(this.rest);
    this.trace = { time: [], com: [], on_ground: [], up: [], sink: [], load: [], rope: [], targets: [], settled: 0, creep: Infinity,
      overlap: this.startOverlap(), warnings: 0, level_speed: NaN };
    this.restTime = 0;
    this.steps = 0; // in the current phase
    this.phase = "settling";
    this.isChanged = false; // whether robot or world changed during the measured walk
    this.isOutdated = false; // whether they changed later
    this.strideShift = 0; // so that a new frequency continues the stride
    this.verdict = null;
    this.isBroken = false; // whether the simulation diverged
  }

  // Simulates until the gait begins, which is limited to a few seconds of simulated time.
  settleNow() { while (this.phase === "settling") this.step(); }

  get time() { return this.phase === "settling" ? 0 : this.steps * this.timestep; } // s since the gait began

  get com() { return this.data.subtree_com.slice(3, 6); } // of the robot at the start of the last step

  // ----------------------------------------------------------------------------------------------------------- start

  id(kind, name) { return this.mj.mj_name2id(this.model, this.mj.mjtObj[`mjOBJ_${kind}`].value, name); }

  get ropeLength() { return this.page.robot.drag_weight ? this.model.tendon_range[1] : 0; }

  place() { // the same as Scene.place in world/scene.py
    const { mj, model, data, page } = this;
    const pitch = this.world.slope;
    const alongSlope = [Math.cos(pitch / 2), 0, -Math.sin(pitch / 2), 0];
    const forward = [Math.cos(pitch), 0, Math.sin(pitch)];
    const up = [-Math.sin(pitch), 0, Math.cos(pitch)];
    this.rest.forEach((angle, servo) => { data.qpos[model.jnt_qposadr[model.actuator_trnid[2 * servo]]] = angle; });
    data.qpos.set(alongSlope, 3);
    mj.mj_kinematics(model, data);
    let lowest = Infinity, foremost = -Infinity;
    for (let geom = 0; geom < model.ngeom; geom++) {
      if (model.geom_type[geom] !== CAPSULE || model.body_rootid[model.geom_bodyid[geom]] !== page.robot_body) continue;
      const [radius, half] = model.geom_size.slice(3 * geom, 3 * geom + 2);
      for (const end of [-half, half]) {
        const point = [0, 1, 2].map((axis) => data.geom_xpos[3 * geom + axis] + end * data.geom_xmat[9 * geom + 3 * axis + 2]);
        lowest = Math.min(lowest, dot(point, up) - radius);
        foremost = Math.max(foremost, dot(point, forward) + radius);
      }
    }
    const raise = page.start_clearance + page.pieces_top - lowest;
    const back = Math.max(0, foremost);
    for (let axis = 0; axis < 3; axis++) data.qpos[axis] += raise * up[axis] - back * forward[axis];
    if (!this.ropeLength) return;
    mj.mj_kinematics(model, data);
    const [hitch, ring] = page.rope_ends.map((name) => this.id("SITE", name));
    const tail = data.site_xpos.slice(3 * hitch, 3 * hitch + 3);
    const ringPosition = model.site_pos.slice(3 * ring, 3 * ring + 3);
    const drop = dot(tail, up) - page.pieces_top - page.start_clearance - ringPosition[2];
    const reach = Math.sqrt(Math.max(0, this.ropeLength ** 2 - drop ** 2)) - page.rope_slack;
    const along = dot(tail, forward) - reach - ringPosition[0];
    const position = forward.map((value, axis) => along * value + (page.pieces_top + page.start_clearance) * up[axis]);
    position[1] = tail[1];
    data.qpos.set([...position, ...alongSlope], model.jnt_qposadr[model.body_jntadr[this.sledgeBody]]);
  }

  get sledgeBody() { return this.ropeLength ? this.id("BODY", "sledge/") : -1; }

  *contacts() {
    const contacts = this.data.contact;
    for (let i = 0; i < this.data.ncon; i++) {
      const contact = contacts.get(i);
      const geoms = [...contact.geom];
      yield { geoms, roots: geoms.map((geom) => this.model.body_rootid[this.model.geom_bodyid[geom]]), dist: contact.dist, pos: [...contact.pos] };
      contact.delete();
    }
    contacts.delete();
  }

  startOverlap() {
    this.mj.mj_fwdPosition(this.model, this.data);
    const roots = [this.page.robot_body, this.sledgeBody];
    let depth = 0;
    for (const { roots: [a, b], dist } of this.contacts()) {
      if (a !== b && (roots.includes(a) || roots.includes(b))) depth = Math.max(depth, -dist);
    }
    return depth;
  }

  supportMargin() { // the same as _support_margin in simulation/starts.py
    this.mj.mj_fwdPosition(this.model, this.data);
    const com = this.com;
    const isRobot = (root) => root === this.page.robot_body;
    const points = [...this.contacts()].filter(({ roots: [a, b] }) => isRobot(a) !== isRobot(b))
      .map(({ pos }) => pos.map((value, axis) => value - com[axis]));
    const gravity = [...this.model.opt.gravity];
    if (!points.length || !gravity.some((value) => value !== 0)) return -Infinity;
    const sideways = perpendicular(gravity);
    const flat = points.map((point) => sideways.map((axis) => dot(point, axis)));
    const n = this.page.settling.n_margin_directions;
    let margin = Infinity;
    for (let i = 0; i < n; i++) {
      const direction = [Math.cos(i * FULL_TURN / n), Math.sin(i * FULL_TURN / n)];
      margin = Math.min(margin, Math.max(...flat.map((point) => dot(point, direction))));
    }
    return margin;
  }

  // ----------------------------------------------------------------------------------------------------------- steps

  step() { // simulates one physics step
    const { mj, model, data } = this;
    if (this.phase === "walking") this.drive();
    mj.mj_step(model, data);
    if (this.phase === "settling") this.settle(); else this.record();
  }

  drive() { // sets new servo targets at the first step of each control step
    const rate = this.page.control_rate;
    const controlStep = (step) => Math.floor(step * this.timestep * rate + 1e-9);
    const now = controlStep(this.steps);
    this.isControlStep = this.steps === 0 || now !== controlStep(this.steps - 1);
    if (!this.isControlStep) return;
    const time = now / rate;
    const ramp = Math.min(time / this.page.ramp_time, 1);
    this.targets = this.gait.map(({ amplitude, phase, offset, legPhase }) => {
      const strides = this.robot.frequency * time + legPhase / FULL_TURN + this.strideShift;
      return offset + ramp * amplitude * Math.sin(strideAngle(strides, this.robot.duty) + phase);
    });
    this.data.ctrl.set(this.targets);
  }

  settle() {
    const { chunk, max_time, rest_speed, min_rest_time, min_support_margin } = this.page.settling;
    const nSteps = Math.round(chunk / this.timestep);
    const middle = Math.floor(nSteps / 2);
    const step = this.steps % nSteps;
    const com = this.reading("com");
    if (step === middle) this.comAtMiddle = com;
    this.steps += 1;
    if (step < nSteps - 1) return;
    const { trace } = this;
    trace.settled += chunk;
    trace.creep = Math.hypot(...com.map((value, axis) => value - this.comAtMiddle[axis])) / ((nSteps - 1 - middle) * this.timestep);
    this.restTime = trace.creep <= rest_speed ? this.restTime + chunk : 0;
    const isSupported = this.restTime > 0 && this.supportMargin() >= min_support_margin;
    if (isSupported || trace.settled >= max_time || this.restTime >= min_rest_time || this.countWarnings()) {
      this.phase = "walking";
      this.steps = 0;
    }
  }

  reading(name) {
    const [start, count] = this.page.sensors[name];
    return [...this.data.sensordata.subarray(start, start + count)];
  }

  record() { // MuJoCo computes sensors before it moves the bodies: a reading belongs to the time before the step
    const { trace } = this;
    const isLast = this.steps === Math.round(this.duration / this.timestep);
    if ((this.isControlStep || isLast) && !this.verdict) {
      trace.time.push(this.steps * this.timestep);
      trace.com.push(this.reading("com"));
      trace.on_ground.push(this.reading("any_contact")[0] > this.reading("self_contact")[0]);
      trace.up.push(this.reading("up"));
      trace.sink.push(this.reading("ground_contact")[0] > 0 ? Math.max(0, -this.reading("ground_distance")[0]) : 0);
      trace.targets.push(this.targets);
      if (this.ropeLength) {
        trace.load.push(this.reading("sledge"));
        trace.rope.push(this.reading("rope")[0] / this.ropeLength);
      }
    }
    this.steps += 1;
    this.isBroken = this.isControlStep && (this.countWarnings() > 0 || !Number.isFinite(this.data.qpos[0]));
    if ((isLast || this.isBroken) && !this.verdict) this.finish();
  }

  finish() {
    this.trace.warnings = this.countWarnings();
    this.verdict = judge(this.page, this.trace, this);
    this.needsLevelWalk = this.verdict.name === "ok" && !this.page.forgive.includes("carried") &&
      isPushedForward(this.world) && meanSpeed(this.trace) > this.page.guards.max_rest_speed;
  }

  // Simulates some steps of the walk on level ground in still air that shows whether the robot was carried, if it is required.
  stepLevelWalk(count) {
    if (!this.needsLevelWalk) return;
    if (!this.level) {
      this.level = new Walk(this.mj, this.page, this.robot, withoutPushes(this.world));
      this.level.duration = Math.min(this.duration, this.page.guards.level_walk_duration);
    }
    for (let i = 0; i < count && !this.level.verdict; i++) this.level.step();
    if (!this.level.verdict) return;
    this.needsLevelWalk = false;
    this.trace.level_speed = this.level.verdict.name === "unstable" ? 0 : meanSpeed(this.level.trace) / Math.cos(this.world.slope);
    this.verdict = judge(this.page, this.trace, this);
    this.level.delete();
    this.level = null;
  }

  countWarnings() {
    const warnings = this.data.warning; // must not be deleted, because it belongs to the data
    let count = 0;
    for (let i = 0; i < warnings.size(); i++) {
      const warning = warnings.get(i);
      count += warning.number;
      warning.delete();
    }
    return count;
  }

  get distance() { // m, forward travel of the centre of mass in the measured walk
    const { com } = this.trace;
    return com.length ? com.at(-1)[0] - com[0][0] : 0;
  }

  get velocity() { // m/s, over the last two thirds
    const { time, com } = this.trace;
    if (time.length < 2) return 0;
    const start = time.findIndex((value) => value >= time.at(-1) / 3);
    return (com.at(-1)[0] - com[start][0]) / (time.at(-1) - time[start]);
  }

  // --------------------------------------------------------------------------------------------------------- changes

  // Changes the gait at once; the body must be the same.
  setGait(robot) {
    this.strideShift += (this.robot.frequency - robot.frequency) * Math.max(0, this.time);
    this.robot = robot;
    this.gait = gaitOf(robot);
    this.rest = this.gait.map(({ offset }) => offset);
    this.noteChange();
  }

  setWorld(world) {
    this.world = world;
    applyWorld(this.page, this.model, world);
    this.noteChange();
  }

  noteChange() { if (this.verdict) this.isOutdated = true; else this.isChanged = true; }
}

const dot = (a, b) => a.reduce((sum, value, axis) => sum + value * b[axis], 0);

function perpendicular(vector) { // two unit vectors at right angles to a vector and to each other
  const length = Math.hypot(...vector);
  const [x, y, z] = vector.map((value) => value / length);
  const sign = z < 0 ? -1 : 1;
  const a = -1 / (sign + z), b = x * y * a;
  return [[1 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]];
}
