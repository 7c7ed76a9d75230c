"""How near evaluation comes to its floor: the same compiled models and controls, stepped from C on all cores.

    python benchmarks/floor.py [--walks 200] [--runs 5] [--structure flat]

Prints a line for each run and the median ratio, floor time over evaluation time: 1 would be no cost but physics.
"""

import argparse
from concurrent.futures import ThreadPoolExecutor
from statistics import median
from time import perf_counter

import mujoco
import numpy as np
from mujoco.rollout import rollout as step_through

import walkerlab as wl
from walkerlab.algorithm import generate_robot_population
from walkerlab.evaluation import n_cores

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


def prepare(genome, settings):
    """Compile one world, and lay out the controls of settling and walking as one array."""
    scene = wl.compile_scene(wl.Genome(genome), settings)
    settled = wl.simulate(scene.genome, settings, poses=False).settled
    timestep, duration = settings.simulation.timestep, settings.simulation.duration
    hold = np.tile(scene.rest, (round(settled / timestep), 1))
    controls = np.concatenate([hold, scene.controls(round(duration / timestep) + 1)])
    data = mujoco.MjData(scene.model)
    scene.place(data)
    state = np.empty(mujoco.mj_stateSize(scene.model, STATE))
    mujoco.mj_getState(scene.model, data, state, STATE)
    return scene.model, data, state[np.newaxis], controls[np.newaxis]


def step(world):
    model, data, state, controls = world
    step_through(model, [data], state, controls)


def timed(work):
    start = perf_counter()
    work()
    return perf_counter() - start


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--walks", type=int, default=200)
    options.add_argument("--runs", type=int, default=5)
    options.add_argument("--structure", default="flat")
    given = options.parse_args()

    settings = wl.Settings(terrain=wl.Terrain(structure=given.structure))
    genomes = generate_robot_population(settings.robot, given.walks, seed=0)
    worlds = [prepare(genome, settings) for genome in genomes]
    wl.evaluate(genomes, settings)  # starts the workers, and has them build every body plan
    with ThreadPoolExecutor(n_cores()) as threads:
        ratios = []
        for run in range(given.runs):
            floor = timed(lambda: list(threads.map(step, worlds)))
            whole = timed(lambda: wl.evaluate(genomes, settings))
            ratios.append(floor / whole)
            print(f"run {run}: floor {floor:.2f} s, evaluate {whole:.2f} s, ratio {ratios[-1]:.3f}")
    print(f"{given.structure}, {given.walks} walks on {n_cores()} cores: median ratio {median(ratios):.3f}")


if __name__ == "__main__":
    main()
