"""The walk of one robot as a dm_control environment, for reinforcement learning."""

import math
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
from dm_env import TimeStep, restart, specs
from numpy.typing import ArrayLike

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.interfaces.reward import Progress
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.simulation.footfalls import shank_geoms
from walkerlab.simulation.starts import settle
from walkerlab.simulation.stepping import STATE_PARTS, warnings_counted_not_printed
from walkerlab.world.assembly import ROBOT_BODY, Sensor, build_ground, composer_arguments
from walkerlab.world.entities import WrappedModel, composer, mjcf, observable
from walkerlab.world.scene import CONTROL_RATE, ROTATION, TRANSLATION, Scene, compile_scene

MAX_ANGLE = math.pi  # rad; greatest servo target, beyond what a genome can express
TIME_TOLERANCE = 0.5  # physics steps by which sums of time steps may fall short of the duration


class WalkTask(composer.Task):
    """Walk forward from the settled rest pose; the action holds the servo targets in rad.

    The reward of a step is the increase of the fitness of the walk so far, so that the return of an episode is the
    fitness of the walk. Guards against cheating are not applied. An episode ends after the duration in the settings.
    """

    def __init__(self, scene: Scene, reward: Callable[[Any], float] | None = None) -> None:
        """Build the entities.

        Args:
            scene: Compiled scene.
            reward: Function from the physics after a step to the reward; if None, the increase of the fitness.

        Raises:
            TypeError: If ``reward`` is not a function.
            ValueError: If the fitness is a user function, and ``reward`` is None.
        """
        if not (reward is None or callable(reward)):
            raise TypeError(f"reward must be a function from the physics to a number; got {short_repr(reward)}")
        self.scene = scene
        self._reward = reward
        self._progress = Progress(scene.settings) if reward is None else None
        settings = scene.settings
        self._ground = build_ground(*composer_arguments(scene.phenotype, settings.robot), settings.terrain, False)
        timestep = settings.simulation.timestep
        steps = 1 / CONTROL_RATE / timestep
        is_whole = math.isclose(steps, round(steps)) and math.isclose(
            settings.simulation.duration * CONTROL_RATE, round(settings.simulation.duration * CONTROL_RATE)
        )
        self.set_timesteps(timestep * round(steps) if is_whole else timestep, timestep)
        self._task_observables = _create_observables(scene)

    @property
    def root_entity(self) -> composer.Entity:
        """The ground, with the robot on it; the entities have nominal sizes, the physics has those of the robot."""
        return self._ground

    @property
    def task_observables(self) -> OrderedDict[str, Any]:
        """Observables by name."""
        return self._task_observables

    def action_spec(self, physics: Any) -> specs.BoundedArray:
        """Return the shape and the range of actions: the target of each servo, in rad."""
        names = "\t".join(physics.model.id2name(i, "actuator") for i in range(physics.model.nu))
        return specs.BoundedArray((physics.model.nu,), np.float64, -MAX_ANGLE, MAX_ANGLE, name=names)

    def begin(self, data: mujoco.MjData) -> None:
        """Begin to measure the progress of a walk."""
        if self._progress:
            self._progress.begin(data)

    def after_substep(self, physics: Any, random_state: Any) -> None:  # noqa: ARG002
        """Add the work of a physics step."""
        if self._progress:
            self._progress.add_step(physics.model.ptr, physics.data.ptr)

    def get_reward(self, physics: Any) -> float:
        """Return the reward of the last step."""
        if self._progress:
            return self._progress.take_increase(physics.data.ptr)
        assert self._reward
        return float(self._reward(physics))


class WalkEnvironment(composer.Environment):
    """The environment of ``wl.environment``: its physics is that of evaluation, bit for bit.

    Attributes:
        scene: Compiled scene, with the genome, the phenotype and the settings.
    """

    def __init__(self, scene: Scene, reward: Callable[[Any], float] | None = None) -> None:
        """Build the task and let the robot settle; see ``environment``."""
        self.scene = scene
        simulation = scene.settings.simulation
        self._settled = mujoco.MjData(scene.model)
        with warnings_counted_not_printed():
            scene.place(self._settled)
            state, _, _ = settle(scene, self._settled)
        mujoco.mj_setState(scene.model, self._settled, state[0], STATE_PARTS)
        self._settled.time = 0
        super().__init__(
            WalkTask(scene, reward),
            time_limit=simulation.duration - TIME_TOLERANCE * simulation.timestep,
            raise_exception_on_physics_error=False,
            strip_singleton_obs_buffer_dim=True,
            recompile_mjcf_every_episode=False,
        )

    @property
    def physics(self) -> Any:
        """Physics with the model and the state; its ``data`` holds the state of MuJoCo.

        Raises:
            RuntimeError: If the environment is closed.
        """
        self._require_open()
        return super().physics

    @property
    def centre_of_mass(self) -> Floats:
        """Centre of mass of the robot [m], shape (3,)."""
        return self.physics.data.sensordata[Sensor.COM].copy()

    def reset(self) -> TimeStep:
        """Begin an episode in the settled state.

        Raises:
            RuntimeError: If the environment is closed.
        """
        self._require_open()
        return super().reset()

    def step(self, action: ArrayLike) -> TimeStep:
        """Simulate a control step; targets beyond the range of actions are clipped.

        Raises:
            RuntimeError: If the environment is closed.
            ValueError: If the action has the wrong shape, or a target is NaN.
        """
        self._require_open()
        targets = np.asarray(action, dtype=np.float64)
        n_servos = self.scene.model.nu
        if targets.shape != (n_servos,):
            raise ValueError(f"action must have the shape ({n_servos},), a target for each servo; got {targets.shape}")
        if np.isnan(targets).any():
            raise ValueError(
                f"target {int(np.isnan(targets).argmax())} of the action is NaN; it must be a number, in rad"
            )
        with warnings_counted_not_printed():  # dm_control's handler of MuJoCo's warnings ends the process
            return super().step(targets.clip(-MAX_ANGLE, MAX_ANGLE))

    def close(self) -> None:
        """Free the physics; a closed environment cannot be used again."""
        if self._physics:
            super().close()

    def _require_open(self) -> None:
        if not self._physics:
            raise RuntimeError("this environment is closed; create another one: wl.environment(genome, settings)")

    def _recompile_physics(self) -> None:
        """Use the compiled model of the scene, which composer would compile with nominal sizes."""
        if not getattr(self, "_physics", None):
            self._physics = mjcf.Physics.from_model(WrappedModel(self.scene.model))
            self._physics.legacy_step = True

    def _reset_attempt(self) -> TimeStep:
        """Begin an episode in the settled state; resetting would change the warm start of the solver."""
        super()._reset_attempt()
        physics = self._physics
        mujoco.mj_copyData(physics.data.ptr, physics.model.ptr, self._settled)
        mujoco.mj_step1(physics.model.ptr, physics.data.ptr)
        self.task.begin(physics.data.ptr)
        self._observation_updater.reset(self._physics_proxy, self._random_state)
        return restart(self._observation_updater.get_observation())


def environment(
    genome: Genome | str, settings: Settings, *, reward: Callable[[Any], float] | None = None
) -> WalkEnvironment:
    """Return a dm_control ``composer.Environment`` in which one robot walks, in the world that evaluation simulates.

    An episode begins in the settled rest pose and lasts for the duration in the settings. The action holds the target
    of each servo [rad], 50 times a second. Observations: ``joint_angles`` [rad], ``joint_velocities`` [rad/s],
    ``touch`` (for each leg, whether it touches something), ``velocity`` [m/s] and ``angular_velocity`` [rad/s] of the
    first segment in its own frame, and its ``orientation`` (rotation matrix, row by row). The reward is the increase of
    the fitness, so that the return of an episode is the fitness of the walk; guards against cheating are not applied.

    Args:
        genome: Genome or its text; repaired to be within the robot limits.
        settings: Settings of terrain, robot, fitness and simulation.
        reward: Function from the physics after a step to a reward; required if the fitness is a function of your own,
            which can rate whole walks only.

    Raises:
        GenomeError: If the text is not a valid genome.
        TypeError: If ``settings`` is not a ``Settings``, or ``reward`` is not a function.
        ValueError: If the fitness is a function of your own, and ``reward`` is None.
    """
    return WalkEnvironment(compile_scene(genome, settings, scenery=True), reward)


def gait_policy(environment: Any) -> Callable[[Any], Floats]:
    """Return the gait of the robot as a policy: a function from an observation, which it ignores, to an action.

    Args:
        environment: Environment from ``wl.environment`` or ``wl.gym_env``, even if Gymnasium has wrapped it.

    Raises:
        TypeError: If it is another environment.
    """
    inner: Any = getattr(environment, "unwrapped", environment)
    walk: Any = getattr(inner, "environment", inner)
    if not isinstance(walk, WalkEnvironment):
        raise TypeError(f"environment must come from wl.environment or wl.gym_env; got {short_repr(environment)}")
    timestep = walk.scene.settings.simulation.timestep
    controls = walk.scene.controls(round(walk.scene.settings.simulation.duration / timestep) + 1)
    scale: float = getattr(inner, "action_scale", 1.0)

    def follow_gait(observation: Any = None) -> Floats:  # noqa: ARG001
        step = min(round(walk.physics.time() / timestep), len(controls) - 1)
        return controls[step] / scale

    return follow_gait


def _create_observables(scene: Scene) -> OrderedDict[str, Any]:
    """Return the observables of a robot: joints, touch, and motion and orientation of the first segment."""
    model = scene.model
    is_robot = model.body_rootid[model.jnt_bodyid] == ROBOT_BODY
    hinges = np.flatnonzero(is_robot & (model.jnt_type == int(mujoco.mjtJoint.mjJNT_HINGE)))
    angles = model.jnt_qposadr[hinges]
    speeds = model.jnt_dofadr[hinges]
    shanks = shank_geoms(scene)

    def find_touch(physics: Any) -> Floats:
        data = physics.data.ptr
        geoms = data.contact.geom
        outer = geoms[scene.is_robot_geom[geoms].sum(axis=1) == 1]
        return np.isin(shanks, outer).astype(np.float64)

    def find_velocity(physics: Any) -> Floats:
        return physics.data.xmat[ROBOT_BODY].reshape(3, 3).T @ physics.data.qvel[TRANSLATION]

    functions: dict[str, Callable[[Any], Floats]] = {
        "joint_angles": lambda physics: physics.data.qpos[angles],
        "joint_velocities": lambda physics: physics.data.qvel[speeds],
        "touch": find_touch,
        "velocity": find_velocity,
        "angular_velocity": lambda physics: physics.data.qvel[ROTATION].copy(),
        "orientation": lambda physics: physics.data.xmat[ROBOT_BODY].copy(),
    }
    created = OrderedDict((name, observable.Generic(function)) for name, function in functions.items())
    for one in created.values():
        one.enabled = True
    return created
