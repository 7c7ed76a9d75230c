"""Evaluation compared with its floor: the same models and controls, stepped from C on all cores.

The figure is floor time over evaluation time; 1 would mean that nothing but physics takes time. The floor is the
fastest plain way: all worlds are compiled and placed beforehand, and one thread per core steps them through settling
and walking without recording anything, the costliest first, so that no core is idle at the end. Evaluation is
``wl.evaluate`` from end to end, with running workers that have built every body plan. ``evolve`` is a whole run, from
its first generation to its table, compared with the floor of each robot that walked in it, once.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import mujoco
import numpy as np
from mujoco.rollout import rollout

import walkerlab as wl
from benchmarks.timing import N_WALKS, measure_ratios, time_call
from benchmarks.worlds import WORLDS
from walkerlab.simulation.stepping import disable_step_timers
from walkerlab.simulation.workers import n_cores

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
PIECES_AND_ROCKS = "2,000 pieces, 20 rocks"
GROUNDS = {
    "flat": {},
    "stairs": WORLDS["stairs"],
    PIECES_AND_ROCKS: WORLDS[PIECES_AND_ROCKS],
    "a pack and a sledge": WORLDS["a pack"] | WORLDS["a sledge"],
}

Walk = Callable[[], object]
"""Steps one prepared world through its walk."""


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the speed relative to the floor on each ground, and in a run."""
    for ground, changes in GROUNDS.items():
        settings = wl.Settings().with_(**changes)
        genomes = wl.generate_robot_population(settings.robot, N_WALKS, seed=0)
        evaluate = partial(wl.evaluate, genomes, settings)
        yield ground, "floor / evaluate", compare_with_floor(n_pairs, genomes, settings, evaluate)
    n_generations = max(2, N_WALKS // 20)
    settings = wl.Settings().with_(population_size=max(4, N_WALKS // 2), generations=n_generations)
    evolve = partial(wl.evolve, settings, progress=False)
    genomes = evolve().records.drop_duplicates("individual").genome
    ratios = compare_with_floor(n_pairs, genomes, settings, evolve)
    yield f"evolve, {n_generations} generations", "floor / evolve", ratios


def compare_with_floor(n_pairs, genomes, settings, function) -> list[float]:
    """Return the floor time of some robots divided by the time of a function that simulates them."""
    disable_step_timers()  # as in the workers
    with ThreadPoolExecutor(n_cores()) as threads:
        walks = list(threads.map(partial(prepare_walk, settings=settings), genomes))
        costs = list(threads.map(time_call, walks))
        costliest_first = [walks[i] for i in np.argsort(costs)[::-1]]
        for _ in range(2):  # so that each worker has built every body plan
            function()
        return measure_ratios(
            n_pairs,
            lambda: time_call(lambda: list(threads.map(lambda walk: walk(), costliest_first))),
            lambda: time_call(function),
        )


def prepare_walk(genome, settings) -> Walk:
    """Compile and place one world and compute the controls of settling and walking; only stepping remains."""
    scene = wl.compile_scene(genome, settings)
    settled = wl.simulate(scene.genome, settings, poses=False).settled
    timestep = settings.simulation.timestep
    duration = settings.simulation.duration
    hold = np.tile(scene.rest, (round(settled / timestep), 1))
    controls = np.concatenate([hold, scene.controls(round(duration / timestep) + 1)])
    data = mujoco.MjData(scene.model)
    scene.place(data)
    state = np.empty((1, mujoco.mj_stateSize(scene.model, STATE)))
    mujoco.mj_getState(scene.model, data, state[0], STATE)
    return partial(rollout, [scene.model], [data], state, controls[np.newaxis], nstep=len(controls), skip_checks=True)
