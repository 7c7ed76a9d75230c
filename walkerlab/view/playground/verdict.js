// The verdict of a walk: the guards of simulation/validity.py, with the limits in `page.guards`.

function groundHeight(page, world, x, y) { // the same as ground_height in world/heights.py
  const ground = page.ground;
  switch (ground.structure) {
    case "stairs":
      return ground.step_height * Math.max(0, Math.floor((x - ground.landing) / ground.step_depth) + 1);
    case "gaps":
      return ground.gaps.some(([start, end]) => start < x && x < end) ? -ground.trench_depth : 0;
    case "rough": {
      const rows = ground.hills.length, columns = ground.hills[0].length;
      const clamp = (value, high) => Math.min(Math.max(value, 0), high);
      const column = clamp((x - ground.landing) / ground.arena_length * (columns - 1), columns - 1.000001);
      const row = clamp((y / ground.arena_width + 0.5) * (rows - 1), rows - 1.000001);
      const i = Math.floor(row), j = Math.floor(column), u = row - i, v = column - j;
      const corner = u < v ? ground.hills[i][j + 1] : ground.hills[i + 1][j];
      return (1 - Math.max(u, v)) * ground.hills[i][j] + Math.abs(u - v) * corner + Math.min(u, v) * ground.hills[i + 1][j + 1];
    }
    default:
      return x * Math.tan(world.slope);
  }
}

const meanSpeed = ({ time, com }) => (com.at(-1)[0] - com[0][0]) / time.at(-1);

function pushesOf(world) { // components of gravity and wind along the ground in the walking direction
  const forward = [Math.cos(world.slope), 0, Math.sin(world.slope)];
  return [dot(world.gravity, forward), dot(world.wind, forward)];
}

const isPushedForward = (world) => Math.max(...pushesOf(world)) > 0;

// As remove_pushes in simulation/pushes.py. A slope stays, but gravity is at right angles to it, which is the same as level ground.
function withoutPushes(world) {
  const [gravityPush, windPush] = pushesOf(world);
  const [x, y, z] = world.gravity;
  const weight = Math.hypot(x, z);
  const gravity = gravityPush > 0 ? [weight * Math.sin(world.slope), y, -weight * Math.cos(world.slope)] : world.gravity;
  return { ...world, gravity, wind: windPush > 0 ? [0, world.wind[1], world.wind[2]] : world.wind };
}

// Returns the verdict of the walk so far: its name, and the reason, with the measured value and the limit.
function judge(page, trace, walk) {
  if (trace.warnings) return { name: "unstable", reason: `MuJoCo gave ${trace.warnings} warning${trace.warnings > 1 ? "s" : ""}` };
  const bad = trace.com.findIndex((point, i) => ![...point, ...(trace.load[i] ?? [])].every(Number.isFinite));
  if (bad >= 0) return { name: "unstable", reason: `at ${trace.time[bad].toFixed(2)} s a value was not finite` };
  for (const [name, findFault] of Object.entries(GUARDS)) {
    const reason = page.forgive.includes(name) ? "" : findFault(trace, page.guards, page, walk);
    if (reason) return { name: name.replaceAll("_", " "), reason };
  }
  return { name: "ok", reason: "" };
}

const GUARDS = {
  bad_start: ({ overlap }, { max_start_overlap: limit }) => overlap <= limit ? ""
    : `at the start it was ${overlap.toFixed(3)} m deep in another body; ${limit} m is allowed`,
  restless: ({ creep, settled }, { max_rest_speed: limit }) => creep <= limit ? ""
    : `after ${settled} s without drive it still moved at ${creep.toFixed(2)} m/s; ${limit} m/s is allowed`,
  jittering(trace, { max_drive_frequency }) {
    const end = trace.time.at(-1);
    const limit = max_drive_frequency + 1 / end;
    const frequency = driveFrequency(trace);
    return frequency > limit ? `a joint was driven at ${frequency.toFixed(1)} Hz; ${limit.toFixed(1)} Hz is allowed` : "";
  },
  too_fast({ time, com }, { max_speed: limit }, page, { robot }) {
    const speed = com.slice(1).map((point, i) =>
      Math.hypot(...point.map((value, axis) => value - com[i][axis])) / (time[i + 1] - time[i]) / robot.body_length);
    return describeExcess(time.slice(1), speed, limit, (value) => `it moved at ${value.toFixed(1)} body lengths/s; ${limit} body lengths/s is allowed`);
  },
  too_high(trace, { max_rise: limit }, page, walk) {
    const height = comHeights(trace, page, walk, (heights) => Math.max(...heights));
    const rise = height.map((value) => (value - height[0]) / walk.robot.body_length);
    return describeExcess(trace.time, rise, limit,
      (value) => `its centre of mass was ${value.toFixed(2)} body lengths higher than at rest; ${limit} body lengths is allowed`);
  },
  sunk: ({ time, sink }, { max_sink: limit }) => describeExcess(time, sink, limit,
    (value) => `a part of it was ${value.toFixed(3)} m deep in the ground; ${limit} m is allowed`),
  airborne({ time, on_ground }, { max_airborne: limit }) {
    const [start, duration] = longestPeriod(time, on_ground.map((value) => !value));
    return duration <= limit ? ""
      : `from ${start.toFixed(2)} s on it was off the ground for ${duration.toFixed(2)} s; ${limit} s is allowed`;
  },
  fell(trace, { min_height, max_time_down: limit }, page, walk) {
    const height = comHeights(trace, page, walk, (heights) => [...heights].sort((a, b) => a - b)[2]);
    const [start, duration] = longestPeriod(trace.time, height.map((value) => value < min_height * height[0] && height[0] > 0));
    return duration <= limit ? "" : `from ${start.toFixed(2)} s on its centre of mass was below ` +
      `${Math.round(100 * min_height)}% of its height at rest for ${duration.toFixed(2)} s; ${limit} s is allowed`;
  },
  out_of_arena({ time, com }, { arena: [low, high] }) {
    const finite = (value, otherwise) => value ?? otherwise; // JSON has no infinity
    const outside = com.map((point) => Math.max(...[0, 1].map((axis) =>
      Math.max(finite(low[axis], -Infinity) - point[axis], point[axis] - finite(high[axis], Infinity)))));
    return describeExcess(time, outside, 0, (value) => `it was ${value.toFixed(2)} m outside the arena; 0 m is allowed`);
  },
  load_lost({ time, com, load, rope }, limits, page, { world }) {
    if (!load.length) return "";
    const lead = load.map(([x], i) => x - com[i][0]);
    const depth = load.map(([x, y, z]) => groundHeight(page, world, x, y) - z);
    const { max_rope_stretch, max_load_lead, max_sledge_sink } = limits;
    return describeExcess(time, rope, max_rope_stretch,
      (value) => `the rope was stretched to ${value.toFixed(2)} times its length; ${max_rope_stretch} times is allowed`) ||
      describeExcess(time, lead, max_load_lead,
        (value) => `the sledge was ${value.toFixed(2)} m ahead of the robot; ${max_load_lead} m is allowed`) ||
      describeExcess(time, depth, max_sledge_sink,
        (value) => `the sledge was ${value.toFixed(2)} m deep in the ground; ${max_sledge_sink} m is allowed`);
  },
  overturned({ time, up }, { max_overturned_time: limit }, page, { world }) {
    const normal = [-Math.sin(world.slope), 0, Math.cos(world.slope)];
    const duration = up.slice(1).reduce((sum, vector, i) => sum + (dot(vector, normal) < 0 ? time[i + 1] - time[i] : 0), 0);
    return duration <= limit ? "" : `for ${duration.toFixed(2)} s in total it was on its back; ${limit} s is allowed`;
  },
  carried(trace, { min_level_share, max_rest_speed }) {
    const speed = meanSpeed(trace);
    const least = min_level_share * speed;
    if (speed <= max_rest_speed || !(trace.level_speed < least)) return "";
    return `it moved at ${speed.toFixed(2)} m/s, and on level ground in still air it moved at ` +
      `${trace.level_speed.toFixed(2)} m/s; ${least.toFixed(2)} m/s or more is required`;
  },
};

function driveFrequency({ time, targets }) { // of the servo target that reverses its direction most often, in Hz
  const reversals = (targets[0] ?? []).map((_, servo) => {
    const steps = targets.slice(1).map((target, i) => target[servo] - targets[i][servo]);
    return steps.slice(1).filter((step, i) => step * steps[i] < 0).length;
  });
  return Math.max(0, ...reversals) / 2 / time.at(-1);
}

function describeExcess(time, values, limit, describe) {
  let worst = 0;
  values.forEach((value, i) => { if (value > values[worst]) worst = i; });
  return values.length && values[worst] > limit ? `at ${time[worst].toFixed(2)} s ${describe(values[worst])}` : "";
}

// The height of the centre of mass above the ground below the robot at each sample; `reduce` combines five heights.
function comHeights({ com }, page, { robot, world }, reduce) {
  if (page.ground.structure === "gaps") return com.map(([, , z]) => z);
  const offsets = [-1, -0.5, 0, 0.5, 1].map((share) => share * robot.body_length / 2);
  return com.map(([x, y, z]) =>
    (z - reduce(offsets.map((offset) => groundHeight(page, world, x + offset, y)))) * Math.cos(world.slope));
}

function longestPeriod(time, holds) { // start and duration of the longest period in which a condition holds
  let longest = [NaN, 0], start = -1;
  for (let i = 0; i <= holds.length; i++) {
    if (holds[i] && start < 0) start = i;
    if (holds[i] || start < 0) continue;
    const duration = time[Math.min(i, time.length - 1)] - time[start];
    if (duration > longest[1]) longest = [time[start], duration];
    start = -1;
  }
  return longest;
}
