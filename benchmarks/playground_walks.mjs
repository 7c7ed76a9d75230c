// Simulates walks in Node with the scripts of a playground page, and prints one JSON object per line; see playground.py.
//
//     node benchmarks/playground_walks.mjs PHYSICS_SCRIPT MUJOCO_JS MUJOCO_WASM TASKS
import { copyFileSync, readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [script, library, binary, tasks] = process.argv.slice(2);
const module = `${library.replace(/\.js$/, "")}.mjs`; // Node reads the type of a module from its name
copyFileSync(library, module);
const { default: loadMujoco } = await import(pathToFileURL(module));
const { Walk, expressRobot, parseGenome } = new Function(`${readFileSync(script, "utf8")}
return { Walk, expressRobot, parseGenome };`)();
const mj = await loadMujoco({ wasmBinary: readFileSync(binary) });

const FIELDS = ["body_mass", "body_inertia", "body_pos", "body_ipos", "geom_size", "geom_pos", "geom_friction", "jnt_stiffness",
  "dof_armature", "dof_damping", "actuator_gainprm", "actuator_biasprm", "actuator_forcerange", "qpos0"];

for (const { page, genomes } of JSON.parse(readFileSync(tasks, "utf8"))) {
  for (const text of genomes) {
    const robot = expressRobot(page, parseGenome(page, text));
    const walk = new Walk(mj, page, robot, page.world);
    const model = Object.fromEntries(FIELDS.map((name) => [name, [...walk.model[name]]]));
    const start = performance.now();
    while (!walk.verdict) walk.step();
    walk.stepLevelWalk(Infinity);
    const seconds = (performance.now() - start) / 1000;
    console.log(JSON.stringify({ model, seconds, com: walk.trace.com, distance: walk.distance, velocity: walk.velocity,
      settled: walk.trace.settled, verdict: walk.verdict.name, reason: walk.verdict.reason }));
    walk.delete();
  }
}
