"""Rollouts: simulation of one walk, with everything recorded that a fitness or a verdict requires."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import mujoco
import numpy as np

from walkerlab.ga.genes import Floats, Indices
from walkerlab.genome.genome import Genome
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.choices import Guard, Recording
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.pushes import is_pushed_forward, remove_pushes
from walkerlab.simulation.recordings import RecordedQuantities, record_quantities
from walkerlab.simulation.starts import draw_nudge, settle, start_overlap
from walkerlab.simulation.stepping import positions_in, simulate_steps, velocities_in, warnings_counted_not_printed
from walkerlab.simulation.validity import MAX_REST_SPEED, UNSTABLE, VERDICTS, Trace, forgiven_guards, judge
from walkerlab.system.readonly import ReadOnlyArrays
from walkerlab.text.numbers import format_significant, with_unit
from walkerlab.text.templates import render
from walkerlab.world.assembly import Sensor
from walkerlab.world.compilation import assemble_in_place
from walkerlab.world.scene import Scene, compile_scene, control_steps


@dataclass(frozen=True, eq=False)
class Rollout(ReadOnlyArrays, RecordedQuantities, Trace):
    """One recorded walk: its trace and its verdict.

    On request, it also has ``joint_angles``, ``joint_velocities``, ``orientation`` and ``contact_forces``.

    Attributes:
        verdict: ``ok``, or why the walk does not count: a key of ``VERDICTS``.
        reason: Explanation of the verdict with the measured value and the limit; "" if the verdict is ``ok``.
        poses: Generalised positions as in ``mjData.qpos``, shape (n, nq); (0, nq) if they were not recorded.
        recorded: Quantities recorded on request, by name.
    """

    verdict: str
    reason: str
    poses: Floats
    recorded: Mapping[str, Floats] = field(default_factory=dict[str, Floats])

    def __post_init__(self) -> None:
        """Make each array read-only."""
        super().__post_init__()
        for array in self.recorded.values():
            array.setflags(write=False)

    @property
    def counts(self) -> bool:
        """Whether the verdict is ``ok``."""
        return self.verdict == "ok"

    @property
    def distance(self) -> float:
        """Net forward travel of the centre of mass after settling, in m; negative if the robot moved backward."""
        return float(self.com[-1, 0] - self.com[0, 0])

    @property
    def velocity(self) -> float:
        """Mean forward speed over the last two thirds of the walk, in m/s; excludes the start."""
        start = int(np.searchsorted(self.time, self.time[-1] / 3))
        return float((self.com[-1, 0] - self.com[start, 0]) / (self.time[-1] - self.time[start]))

    def __repr__(self) -> str:
        """Return a one-line summary; the arrays are too long to print."""
        why = f", {self.reason}" if self.reason else ""
        went = f"{with_unit(self.distance, 'm')} in {self.time[-1]:g} s"
        return f"Rollout({went}, verdict {self.verdict}{why}; {len(self.poses)} poses)"

    def _repr_html_(self) -> str:
        robot = self.phenotype
        speed = self.velocity
        parts = f"{pluralize(len(robot.segments), 'segment')}, {pluralize(robot.n_legs, 'leg')}"
        body = f"{parts}, {with_unit(robot.weight, 'kg')}, {with_unit(robot.body_length, 'm')} long"
        return render(
            "simulation/rollout.html",
            verdict=self.verdict,
            meaning=VERDICTS.get(self.verdict, ""),
            reason=self.reason,
            distance=with_unit(self.distance, "m"),
            velocity=with_unit(speed, "m/s"),
            relative_velocity=format_significant(speed / robot.body_length),
            duration=f"{self.time[-1]:g}",
            settled=f"{self.settled:g}",
            work=with_unit(self.work[-1], "J"),
            body=body,
            n_poses=len(self.poses),
        )


def simulate(
    genome: Genome | str,
    settings: Settings,
    *,
    poses: bool = True,
    record: str | Recording | Sequence[str | Recording] | None = None,
) -> Rollout:
    """Simulate the walk of one individual and record it.

    Args:
        genome: Genome or its text; repaired to be within the robot limits.
        settings: Settings of terrain, robot and simulation.
        poses: Whether to record poses, which replays and films require, but fitness functions do not.
        record: What to record in addition: any of ``joint_angles``, ``joint_velocities``, ``orientation`` and
            ``contact_forces``; if None, what the setting ``record`` lists.

    Raises:
        GenomeError: If the text is not a valid genome.
        SettingsError: If there is no such quantity to record.
    """
    if record is not None:
        settings = require_settings(settings).with_(record=record)
    return simulate_walk(compile_scene(genome, settings), poses=poses)


def simulate_walk(
    scene: Scene, data: mujoco.MjData | None = None, *, nudge: Floats | None = None, poses: bool = True
) -> Rollout:
    """Let the robot settle without drive, then simulate its walk for the duration in the settings, and judge it.

    All controls are known in advance, so the whole walk is simulated by one call of MuJoCo's C code.

    Args:
        scene: Compiled scene.
        data: Data of the scene's model, which is reset; new data if None.
        nudge: Small displacements of the start, as in ``Scene.place``, shape (nv,).
        poses: Whether to record poses.
    """
    model = scene.model
    timestep = scene.settings.simulation.timestep
    data = mujoco.MjData(model) if data is None else data
    mujoco.mj_resetData(model, data)
    with warnings_counted_not_printed():
        scene.place(data, nudge)
        overlap = start_overlap(scene, data)
        state, settled, creep = settle(scene, data)
        n_steps = round(scene.settings.simulation.duration / timestep) + 1
        controls = scene.controls(n_steps)
        states, sensors = simulate_steps(model, data, state, controls[np.newaxis])
    recorded = _recorded_steps(n_steps, timestep)
    # Sensors are computed before a step and states after it, so a reading belongs to the state after the previous step.
    recorded_states = np.concatenate([state, states[0, recorded[1:] - 1]])
    readings = sensors[0, recorded]
    targets = controls[recorded]
    ground_distance = np.where(readings[:, Sensor.GROUND_CONTACT] > 0, readings[:, Sensor.GROUND_DISTANCE], 0.0)
    time = recorded.astype(np.float64) * timestep
    trace = Trace(
        time=time,
        com=readings[:, Sensor.COM],
        on_ground=readings[:, Sensor.ANY_CONTACT] > readings[:, Sensor.SELF_CONTACT],
        up=readings[:, Sensor.UP],
        sink=np.maximum(0.0, -ground_distance),
        work=_cumulative_work(model, np.concatenate([state, states[0]]), controls)[recorded],
        load=readings[:, Sensor.SLEDGE] if scene.rope_length else np.empty((0, 3)),
        rope=readings[:, Sensor.ROPE] / scene.rope_length if scene.rope_length else np.empty(0),
        phenotype=scene.phenotype,
        settled=settled,
        creep=creep,
        overlap=overlap,
        drive=_drive_frequency(time, targets),
        warnings=int(sum(data.warning.number)),
        level_speed=math.nan,
    )
    positions = positions_in(model, recorded_states)
    recordings = record_quantities(scene, positions, velocities_in(model, recorded_states), readings)
    verdict, reason = judge(trace, scene.settings)
    if verdict == "ok" and _requires_level_walk(trace, scene.settings):
        trace = replace(trace, level_speed=_measure_level_speed(scene, nudge))
        verdict, reason = judge(trace, scene.settings)
    kept = positions if poses else np.empty((0, model.nq))
    return Rollout(**vars(trace), verdict=verdict, reason=reason, poses=kept, recorded=recordings)


def _requires_level_walk(trace: Trace, settings: Settings) -> bool:
    """Return whether a robot moved forward, and did not stand still, where something pushes it forward."""
    if Guard.carried in forgiven_guards(settings) or not is_pushed_forward(settings.terrain):
        return False
    return trace.mean_speed > MAX_REST_SPEED


def _measure_level_speed(scene: Scene, nudge: Floats | None) -> float:
    """Return the mean forward speed of the robot in its world without a push [m/s]; 0 if that simulation diverges."""
    settings = remove_pushes(scene.settings)
    model, data = assemble_in_place(scene.phenotype, settings)
    rollout = simulate_walk(replace(scene, model=model, settings=settings), data, nudge=nudge, poses=False)
    return 0.0 if rollout.verdict == UNSTABLE else rollout.mean_speed


def walk_from_every_start(
    scene: Scene, data: mujoco.MjData | None = None, *, poses: bool, starts: Sequence[int] | None = None
) -> list[Rollout]:
    """Simulate a walk from each start, as evolution does; the lowest fitness counts.

    Starts after the first walk that does not count are not simulated, because no fitness can be lower.

    Args:
        scene: Compiled scene.
        data: State of the simulation to use; a new one if None.
        poses: Whether to record poses.
        starts: Numbers of the starts; those in the settings if None.

    Returns:
        The walks in the order of the starts; only the last can be one that does not count.
    """
    rollouts: list[Rollout] = []
    for start in range(scene.settings.simulation.n_starts) if starts is None else starts:
        rollouts.append(simulate_walk(scene, data, nudge=draw_nudge(scene, start), poses=poses))
        if not rollouts[-1].counts:
            break
    return rollouts


@lru_cache(maxsize=16)
def _recorded_steps(n_steps: int, timestep: float) -> Indices:
    """Return the physics steps that are recorded: the first of each control step, and the last of the walk."""
    recorded = np.union1d(control_steps(n_steps, timestep)[0], n_steps - 1)
    recorded.setflags(write=False)
    return recorded


def _cumulative_work(model: mujoco.MjModel, states: Floats, targets: Floats) -> Floats:
    """Return the work of the servos before each physics step [J], shape (n,).

    Absolute torque times absolute speed, integrated over the physics steps; torque peaks just after each new target. As
    in the implicit integrator, the damping of a servo depends on the speed after the step.

    Args:
        model: Compiled model.
        states: State before each physics step, and after the last, shape (n + 1, n_state).
        targets: Servo targets of each physics step [rad], shape (n, nu).
    """
    joint = model.actuator_trnid[:, 0]
    angle = positions_in(model, states)[:-1, model.jnt_qposadr[joint]]
    speed = velocities_in(model, states)[:, model.jnt_dofadr[joint]]
    gain = model.actuator_gainprm[:, 0]
    bias = model.actuator_biasprm
    torque = np.clip(gain * targets + bias[:, 1] * angle + bias[:, 2] * speed[1:], *model.actuator_forcerange.T)
    work = np.abs(torque * (speed[:-1] + speed[1:]) / 2).sum(axis=1) * model.opt.timestep
    return np.concatenate([[0.0], np.cumsum(work[:-1])])


def _drive_frequency(time: Floats, targets: Floats) -> float:
    """Return the frequency [Hz] of the servo target that reverses its direction most often."""
    steps = np.diff(targets, axis=0)
    reversals = (steps[:-1] * steps[1:] < 0).sum(axis=0)
    return float(np.max(reversals, initial=0)) / 2 / time[-1]
