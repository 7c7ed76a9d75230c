"""One walk: the scene is stepped, what a fitness needs is recorded, and a verdict says whether it counts."""

import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.rollout import rollout as step_through
from numpy.typing import NDArray

from walkerlab.genes import Floats
from walkerlab.genome import Genome
from walkerlab.phenotype import Phenotype
from walkerlab.scene import Scene, compile_scene, ticks
from walkerlab.settings import Settings, Simulation

SETTLE_CHUNK = 0.25  # s, after each of which a settling body is looked at
SETTLE_LIMIT = 3.0  # s, after which it walks whether it came to rest or not
REST_SPEED = 0.02  # m/s of the centre of mass, under which a body is at rest

VERDICTS = {
    "ok": "The walk counts.",
    "unstable": "The physics broke down: MuJoCo warned, or a number was not finite.",
    "too fast": "It moved faster than Simulation.max_speed allows: thrown, not walking.",
    "airborne": "It was off the ground for longer than Simulation.max_airborne: flying, not walking.",
    "out of arena": "It left the ground that was built.",
}
"""Each verdict that a walk can get, in words for people."""

_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


@dataclass(frozen=True, eq=False)
class Rollout:
    """One recorded walk, from the moment the body has settled; a sample at each tick of the gait's clock.

    Attributes:
        time: (n,) s since the gait began.
        com: (n, 3) centre of mass, m; x forward, y left, z up.
        on_ground: (n,) whether any part of the body touched the ground.
        phenotype: the robot that walked.
        settled: s that the body was given to come to rest before the walk.
        verdict: ``ok``, or why the walk does not count: a key of ``VERDICTS``.
        poses: (n, nq) generalized positions as in ``mjData.qpos``; (0, nq) if they were not asked for.
    """

    time: Floats
    com: Floats
    on_ground: NDArray[np.bool_]
    phenotype: Phenotype
    settled: float
    verdict: str
    poses: Floats

    @property
    def counts(self) -> bool:
        """Whether the verdict is ``ok``."""
        return self.verdict == "ok"


def simulate(genome: Genome | str, settings: Settings, *, poses: bool = True) -> Rollout:
    """Let one individual walk, and record it.

    Args:
        genome: a genome or its text; brought within the robot limits first.
        settings: of terrain, robot and simulation.
        poses: whether to record every pose, for looking at; a fitness needs none.

    Raises:
        GenomeError: if a text is no genome.
    """
    return walk(compile_scene(genome, settings), poses=poses)


def walk(scene: Scene, *, poses: bool = True) -> Rollout:
    """Settle the body without drive until it rests, then let it walk for the settings' duration, and judge.

    The physics runs in C from the first step to the last: the controls are known before the walk.
    """
    model, simulation = scene.model, scene.simulation
    data = mujoco.MjData(model)
    with _warnings_counted_not_printed():
        state, settled = _settle(scene, data)
        n_steps = round(simulation.duration / simulation.timestep) + 1
        states, sensors = _step(model, data, state, scene.controls(n_steps)[np.newaxis])
    first = np.union1d(ticks(n_steps, simulation.timestep)[0], n_steps - 1)
    # A sensor is read before its step and a state after it: the state that a sensor saw is the one before.
    com, on_ground = sensors[0, first, :3], sensors[0, first, 3] > 0
    positions = np.concatenate([state, states[0, :-1]])[first, 1 : 1 + model.nq] if poses else np.empty((0, model.nq))
    time = first.astype(np.float64) * simulation.timestep
    warned = any(data.warning.number)
    for record in (time, com, on_ground, positions):
        record.setflags(write=False)
    verdict = _judge(time, com, on_ground, scene, warned=warned)
    return Rollout(time, com, on_ground, scene.phenotype, settled, verdict, positions)


def _settle(scene: Scene, data: mujoco.MjData) -> tuple[Floats, float]:
    """Hold the pose of rest until the body is still: the (1, n_state) state reached, and the seconds it took."""
    model, timestep = scene.model, scene.simulation.timestep
    scene.place(data)
    state = np.empty((1, mujoco.mj_stateSize(model, _STATE)))
    mujoco.mj_getState(model, data, state[0], _STATE)
    n_steps = round(SETTLE_CHUNK / timestep)
    hold = np.tile(scene.rest, (1, n_steps, 1))
    settled = 0.0
    while settled < SETTLE_LIMIT:
        states, sensors = _step(model, data, state, hold)
        state, com = states[:, -1].copy(), sensors[0, :, :3]
        settled += SETTLE_CHUNK
        if np.linalg.norm(com[-1] - com[n_steps // 2]) < REST_SPEED * (n_steps - 1 - n_steps // 2) * timestep:
            break
    return state, settled


def _step(model: mujoco.MjModel, data: mujoco.MjData, state: Floats, controls: Floats) -> tuple[Floats, Floats]:
    """Step on from a state as if nobody had looked: the solver starts from where it was."""
    warmstart = data.qacc_warmstart[np.newaxis].copy()
    return step_through(model, [data], state, controls, initial_warmstart=warmstart)


def _judge(time: Floats, com: Floats, on_ground: NDArray[np.bool_], scene: Scene, *, warned: bool) -> str:
    """Name the first rule that the walk breaks, or ``ok``."""
    simulation: Simulation = scene.simulation
    if warned or not np.isfinite(com).all():
        return "unstable"
    speed = np.linalg.norm(np.diff(com, axis=0), axis=1) / np.diff(time)
    if speed.max(initial=0.0) > simulation.max_speed * scene.phenotype.body_length:
        return "too fast"
    if _longest_flight(time, on_ground) > simulation.max_airborne:
        return "airborne"
    low, high = scene.bounds
    if (com[:, :2] < low).any() or (com[:, :2] > high).any():
        return "out of arena"
    return "ok"


def _longest_flight(time: Floats, on_ground: NDArray[np.bool_]) -> float:
    """Return the longest time [s] from leaving the ground to touching it again, or to the end of the record."""
    edges = np.flatnonzero(np.diff(~on_ground, prepend=False, append=False))
    left, touched = edges[::2], np.minimum(edges[1::2], len(time) - 1)
    return float(np.max(time[touched] - time[left], initial=0.0))


_thread = threading.local()


@contextmanager
def _warnings_counted_not_printed() -> Generator[None]:
    """Keep MuJoCo's warnings of this thread's walk off the screen; ``mjData.warning`` counts them all the same."""
    if mujoco.get_mju_user_warning() is not _hear:
        _hear.others = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(_hear)
    _thread.walks = True
    try:
        yield
    finally:
        _thread.walks = False


class _Ear:
    """MuJoCo has one handler of warnings for all threads: this one passes on what is not about a walk of ours."""

    others: Callable[[str], None] | None = None

    def __call__(self, warning: str) -> None:
        if not getattr(_thread, "walks", False) and self.others:
            self.others(warning)


_hear = _Ear()
