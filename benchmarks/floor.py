"""How near evaluation comes to its floor: the same models and controls, stepped from C on all cores.

Floor time over evaluation time: 1 would be no cost but physics. The floor is the fastest plain way: every world is
compiled and placed beforehand, and a thread for each core steps it through settling and walk without a look at it,
keeping nothing, the costliest first, so that no core is idle at the end. Evaluation is `wl.evaluate` from end to end,
its workers started and every body plan built. `evolve` is a whole run, from its first generation to its table, against
the floor of each robot that walked in it, once.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import mujoco
import numpy as np
from mujoco.rollout import rollout

import walkerlab as wl
from benchmarks.timing import WALKS, in_turn, seconds
from benchmarks.worlds import WORLDS
from walkerlab.simulation.workers import n_cores

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
ROUGH = "2,000 pieces, 20 rocks"
GROUNDS = {
    "flat": {},
    "stairs": WORLDS["stairs"],
    ROUGH: WORLDS[ROUGH],
    "a pack and a sledge": WORLDS["a pack"] | WORLDS["a sledge"],
}

Walk = Callable[[], object]


def rows(pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield what is left of the floor's speed on each ground, and in a run."""
    for ground, changes in GROUNDS.items():
        settings = wl.Settings().with_(**changes)
        genomes = wl.generate_robot_population(settings.robot, WALKS, seed=0)
        evaluate = partial(wl.evaluate, genomes, settings)
        yield ground, "floor / evaluate", against_floor(pairs, genomes, settings, evaluate)
    n_generations = max(2, WALKS // 20)
    settings = wl.Settings().with_(population_size=max(4, WALKS // 2), generations=n_generations)
    evolve = partial(wl.evolve, settings, progress=False)
    genomes = evolve().records.drop_duplicates("individual").genome
    yield f"evolve, {n_generations} generations", "floor / evolve", against_floor(pairs, genomes, settings, evolve)


def against_floor(pairs, genomes, settings, work) -> list[float]:
    """Divide the floor's time for these robots by that of some work in which they walk."""
    with ThreadPoolExecutor(n_cores()) as threads:
        walks = list(threads.map(partial(prepare, settings=settings), genomes))
        costs = list(threads.map(seconds, walks))
        costliest_first = [walks[i] for i in np.argsort(costs)[::-1]]
        for _ in range(2):  # so that each worker has met every body plan
            work()
        return in_turn(
            pairs,
            lambda: seconds(lambda: list(threads.map(lambda walk: walk(), costliest_first))),
            lambda: seconds(work),
        )


def prepare(genome, settings) -> Walk:
    """Compile and place one world, and lay out the controls of settling and walking: what is left is to step it."""
    scene = wl.compile_scene(genome, settings)
    settled = wl.simulate(scene.genome, settings, poses=False).settled
    timestep, duration = settings.simulation.timestep, settings.simulation.duration
    hold = np.tile(scene.rest, (round(settled / timestep), 1))
    controls = np.concatenate([hold, scene.controls(round(duration / timestep) + 1)])
    data = mujoco.MjData(scene.model)
    scene.place(data)
    state = np.empty((1, mujoco.mj_stateSize(scene.model, STATE)))
    mujoco.mj_getState(scene.model, data, state[0], STATE)
    return partial(rollout, [scene.model], [data], state, controls[np.newaxis], nstep=len(controls), skip_checks=True)
