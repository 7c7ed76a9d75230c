"""One walk: the scene is stepped, what a fitness needs is recorded, and a verdict says whether it counts."""

import math
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from mujoco.rollout import rollout as step_through

from walkerlab.assembly import ANYTHING, COM, DEPTH, GROUND, ITSELF, LOAD, ROPE
from walkerlab.genes import Floats, Indices
from walkerlab.genome import Genome
from walkerlab.judge import VERDICTS, Trace, judge
from walkerlab.markup import facts, shown
from walkerlab.number_format import significant, with_unit
from walkerlab.quantity import count
from walkerlab.randomness import stream
from walkerlab.readonly import ReadOnlyArrays
from walkerlab.scene import Scene, compile_scene, ticks
from walkerlab.settings import Settings

SETTLE_CHUNK = 0.25  # s, after each of which a settling body is looked at
SETTLE_LIMIT = 3.0  # s, after which it walks whether it came to rest or not
REST_SPEED = 0.02  # m/s of the centre of mass, under which a body is at rest

SHIFT, TURN, BEND = 0.02, 0.03, 0.03  # m to the side, rad of the body, rad of each joint: standard deviations

_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


@dataclass(frozen=True, eq=False)
class Rollout(ReadOnlyArrays, Trace):
    """One recorded walk: its trace, and whether it counts.

    Attributes:
        verdict: ``ok``, or why the walk does not count: a key of ``VERDICTS``.
        reason: the figures behind the verdict, in words; "" if it is ``ok``.
        poses: (n, nq) generalized positions as in ``mjData.qpos``; (0, nq) if they were not asked for.
    """

    verdict: str
    reason: str
    poses: Floats

    @property
    def counts(self) -> bool:
        """Whether the verdict is ``ok``."""
        return self.verdict == "ok"

    @property
    def distance(self) -> float:
        """Net forward travel of the centre of mass after settling, in m; negative if it went backward."""
        return float(self.com[-1, 0] - self.com[0, 0])

    @property
    def velocity(self) -> float:
        """Mean forward speed over the last two thirds of the walk, in m/s: what is left once the start is over."""
        start = int(np.searchsorted(self.time, self.time[-1] / 3))
        return float((self.com[-1, 0] - self.com[start, 0]) / (self.time[-1] - self.time[start]))

    def __repr__(self) -> str:
        """Say in a line what came of it: the arrays would fill pages."""
        why = f", {self.reason}" if self.reason else ""
        went = f"{with_unit(self.distance, 'm')} in {self.time[-1]:g} s"
        return f"Rollout({went}, verdict {self.verdict}{why}; {len(self.poses)} poses)"

    def _repr_html_(self) -> str:
        robot, speed = self.phenotype, self.velocity
        grown = f"{count(len(robot.segments), 'segment')}, {count(robot.n_legs, 'leg')}"
        body = f"{grown}, {with_unit(robot.weight, 'kg')}, {with_unit(robot.body_length, 'm')} long"
        known = (
            ("verdict", f"{self.verdict}: {VERDICTS.get(self.verdict, '')}"),
            *([("reason", self.reason)] if self.reason else []),
            ("distance", f"{with_unit(self.distance, 'm')} forward"),
            (
                "velocity",
                f"{with_unit(speed, 'm/s')} over the last two thirds, "
                f"{significant(speed / robot.body_length)} body lengths a second",
            ),
            ("duration", f"{self.time[-1]:g} s, after {self.settled:g} s to come to rest"),
            ("work", f"{with_unit(self.work[-1], 'J')}, done by the legs"),
            ("body", body),
            ("poses", f"{len(self.poses)} recorded" if len(self.poses) else "not recorded"),
        )
        return shown(facts("A walk", known))


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


def walk(
    scene: Scene, data: mujoco.MjData | None = None, *, nudge: Floats | None = None, poses: bool = True
) -> Rollout:
    """Settle the body without drive until it rests, then let it walk for the settings' duration, and judge.

    The physics runs in C from the first step to the last: the controls are known before the walk.

    Args:
        scene: the compiled world.
        data: of its model, to walk in, whatever has been there; a new one if None.
        nudge: (nv,) small turns and shifts of the start, as in ``Scene.place``.
        poses: whether to record every pose.
    """
    model, timestep = scene.model, scene.settings.simulation.timestep
    data = mujoco.MjData(model) if data is None else data
    mujoco.mj_resetData(model, data)
    with _warnings_counted_not_printed():
        scene.place(data, nudge)
        overlap = _overlap(scene, data)
        state, settled, creep = _settle(scene, data)
        n_steps = round(scene.settings.simulation.duration / timestep) + 1
        controls = scene.controls(n_steps)
        states, sensors = _step(model, data, state, controls[np.newaxis])
    first = _moments(n_steps, timestep)
    # A sensor is read before its step and a state after it: the state that a sensor saw is the one before.
    seen, sensed = np.concatenate([state, states[0, first[1:] - 1]]), sensors[0, first]
    time = first.astype(np.float64) * timestep
    trace = Trace(
        time=time,
        com=sensed[:, COM],
        on_ground=sensed[:, ANYTHING] > sensed[:, ITSELF],
        sink=np.maximum(0.0, -np.where(sensed[:, GROUND] > 0, sensed[:, DEPTH], 0.0)),
        work=_work(model, time, seen, controls[first]),
        load=sensed[:, LOAD] if scene.rope else np.empty((0, 3)),
        rope=sensed[:, ROPE] / scene.rope if scene.rope else np.empty(0),
        phenotype=scene.phenotype,
        settled=settled,
        creep=creep,
        overlap=overlap,
        drive=_drive(time, controls[first]),
        warnings=int(sum(data.warning.number)),
    )
    record = seen[:, 1 : 1 + model.nq] if poses else np.empty((0, model.nq))
    verdict, reason = judge(trace, scene.settings)
    return Rollout(**vars(trace), verdict=verdict, reason=reason, poses=record)


def count_settling_steps(scene: Scene) -> int:
    """Return the number of steps for which ``walk`` holds the pose of rest before the gait starts."""
    data = mujoco.MjData(scene.model)
    with _warnings_counted_not_printed():
        scene.place(data)
        _, settled, _ = _settle(scene, data)
    return round(settled / SETTLE_CHUNK) * round(SETTLE_CHUNK / scene.settings.simulation.timestep)


def from_every_start(scene: Scene, data: mujoco.MjData | None = None, *, poses: bool) -> list[Rollout]:
    """Let a robot walk as evolution does: from each of its starts, the poorest of which counts."""
    starts = range(scene.settings.simulation.n_starts)
    return [walk(scene, data, nudge=nudge(scene, start), poses=poses) for start in starts]


def nudge(scene: Scene, number: int) -> Floats | None:
    """Draw the (nv,) small turns and shifts of a start: of the robot alone; none for the start of number 0."""
    if not number:
        return None
    model = scene.model
    scale = np.where(model.body_rootid[model.dof_bodyid] == 1, BEND, 0.0)
    scale[:6] = 0, SHIFT, 0, TURN, TURN, TURN
    return scale * stream(scene.settings.terrain.seed, "perturbation", number).standard_normal(model.nv)


@lru_cache(maxsize=16)
def _moments(n_steps: int, timestep: float) -> Indices:
    """Name the steps that are recorded: the first of each tick of the gait's clock, and the last of all."""
    moments = np.union1d(ticks(n_steps, timestep)[0], n_steps - 1)
    moments.setflags(write=False)
    return moments


def _overlap(scene: Scene, data: mujoco.MjData) -> float:
    """Return how deep [m] the robot or its sledge is in anything at the start; its own joints do not matter."""
    mujoco.mj_fwdPosition(scene.model, data)
    roots = scene.model.body_rootid[scene.model.geom_bodyid[data.contact.geom]]
    meets = (roots[:, 0] != roots[:, 1]) & np.isin(roots, scene.roots).any(axis=1)
    return float(np.max(-data.contact.dist, where=meets, initial=0.0))


def _settle(scene: Scene, data: mujoco.MjData) -> tuple[Floats, float, float]:
    """Hold the pose of rest until the body is still.

    Returns:
        The (1, n_state) state reached, the seconds it took, and the speed [m/s] at the end of them.
    """
    model, timestep = scene.model, scene.settings.simulation.timestep
    state = np.empty((1, mujoco.mj_stateSize(model, _STATE)))
    mujoco.mj_getState(model, data, state[0], _STATE)
    n_steps = round(SETTLE_CHUNK / timestep)
    hold = np.tile(scene.rest, (1, n_steps, 1))
    settled, speed = 0.0, math.inf
    while settled < SETTLE_LIMIT and speed > REST_SPEED:
        states, sensors = _step(model, data, state, hold)
        state, com = states[:, -1].copy(), sensors[0, :, COM]
        settled += SETTLE_CHUNK
        middle = n_steps // 2
        speed = float(np.linalg.norm(com[-1] - com[middle])) / ((n_steps - 1 - middle) * timestep)
    return state, settled, speed


def _step(model: mujoco.MjModel, data: mujoco.MjData, state: Floats, controls: Floats) -> tuple[Floats, Floats]:
    """Step on from a state as if nobody had looked: the solver starts from where it was.

    Args:
        model: of the world.
        data: to step in.
        state: (1, n_state).
        controls: (1, n_steps, nu), a row for each step.

    Returns:
        The (1, n_steps, n_state) states after the steps, and the (1, n_steps, n_sensor) readings before them.
    """
    n_steps = controls.shape[1]
    return step_through(
        [model],
        [data],
        state,
        controls,
        nstep=n_steps,
        initial_warmstart=data.qacc_warmstart[np.newaxis].copy(),
        state=np.empty((1, n_steps, state.shape[1])),
        sensordata=np.empty((1, n_steps, model.nsensordata)),
        skip_checks=True,  # of shapes, which takes as long as a hundred steps
    )


def _work(model: mujoco.MjModel, time: Floats, states: Floats, controls: Floats) -> Floats:
    """Add up what the servos have done so far, (n,) [J]: torque times speed, whichever way it goes."""
    joint = model.actuator_trnid[:, 0]
    angle = states[:, 1 + model.jnt_qposadr[joint]]
    speed = states[:, 1 + model.nq + model.jnt_dofadr[joint]]
    gain, bias = model.actuator_gainprm[:, 0], model.actuator_biasprm
    torque = np.clip(gain * controls + bias[:, 1] * angle + bias[:, 2] * speed, *model.actuator_forcerange.T)
    power = np.abs(torque * speed).sum(axis=1)
    return np.concatenate([[0.0], np.cumsum(power[:-1] * np.diff(time))])


def _drive(time: Floats, controls: Floats) -> float:
    """Return how often [Hz] the servo target that does so most turns round and back again."""
    steps = np.diff(controls, axis=0)
    turns = (steps[:-1] * steps[1:] < 0).sum(axis=0)
    return float(np.max(turns, initial=0)) / 2 / time[-1]


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
