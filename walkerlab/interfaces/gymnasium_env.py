"""The walk of one robot as a Gymnasium environment; Gymnasium is an optional dependency."""

import os
from typing import Any, ClassVar

import gymnasium
import mujoco
import numpy as np
from gymnasium import spaces

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.interfaces.environment import MAX_ANGLE, environment
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.view import opengl
from walkerlab.world.cameras import FIELD_OF_VIEW, aim_camera
from walkerlab.world.heights import slope

PICTURE_SIZE = (640, 480)  # pixels; MuJoCo's default size of a picture that is not shown on a screen
MAX_OBSERVATION = {
    "joint_angles": 10.0,
    "joint_velocities": 1000.0,
    "touch": 1.0,
    "velocity": 100.0,
    "angular_velocity": 1000.0,
    "orientation": 1.0,
}
"""Greatest absolute value of each observation, in its unit; greater ones are clipped."""

ENVIRONMENT_ID = "walkerlab/Walker-v0"


class WalkerEnv(gymnasium.Env[Any, Any]):
    """The environment of ``wl.environment`` for Gymnasium; actions are scaled to the range from -1 to 1.

    Attributes:
        environment: The dm_control environment.
        action_scale: Servo target of the action 1, rad.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 50}  # pyright: ignore[reportIncompatibleVariableOverride]
    action_scale = MAX_ANGLE

    def __init__(
        self, genome: Genome | str, settings: Settings | None = None, reward: Any = None, render_mode: str | None = None
    ) -> None:
        """Compile the robot and its world; see ``gym_env``."""
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode is {short_repr(render_mode)}; it must be 'rgb_array' or None")
        self.environment = environment(genome, Settings() if settings is None else settings, reward=reward)
        self.render_mode = render_mode
        self.action_space = spaces.Box(-1.0, 1.0, self.environment.action_spec().shape, np.float64)
        self.observation_space = spaces.Dict(
            {
                name: spaces.Box(-MAX_OBSERVATION[name], MAX_OBSERVATION[name], spec.shape, np.float64)
                for name, spec in self.environment.observation_spec().items()
            }
        )
        self._renderer: Any = None
        self._path: list[Floats] = []
        self._is_over = True

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Floats], dict[str, Any]]:
        """Begin an episode in the settled rest pose, which is the same for every seed."""
        super().reset(seed=seed, options=options)
        timestep = self.environment.reset()
        self._path = [self._com()]
        self._is_over = False
        return self._clip(timestep.observation), self._info()

    def step(self, action: Floats) -> tuple[dict[str, Floats], float, bool, bool, dict[str, Any]]:
        """Set the servo targets for one control step; the episode is truncated after the duration of a walk.

        Raises:
            RuntimeError: If no episode has begun, or it has ended.
            ValueError: If the action has the wrong shape, or contains NaN.
        """
        if self._is_over:
            raise RuntimeError("no episode is in progress; call reset() first")
        timestep = self.environment.step(np.asarray(action, dtype=np.float64) * self.action_scale)
        self._path.append(self._com())
        is_diverged = timestep.last() and timestep.discount == 0
        self._is_over = bool(timestep.last())
        is_truncated = self._is_over and not is_diverged
        return self._clip(timestep.observation), float(timestep.reward), bool(is_diverged), is_truncated, self._info()

    def render(self) -> Any:
        """Return a picture from the camera in the settings, shape (height, width, 3); None without a render mode.

        Raises:
            RuntimeError: If OpenGL is not available.
        """
        if self.render_mode is None:
            return None
        model = self.environment.physics.model.ptr
        if self._renderer is None:
            model.vis.global_.fovy = FIELD_OF_VIEW
            self._renderer = _create_renderer(model)
        scene = self.environment.scene
        times: Floats = np.arange(len(self._path), dtype=np.float64) * self.environment.control_timestep()
        pitch = slope(scene.settings.terrain)
        size = scene.phenotype.body_length
        track = aim_camera(scene.settings.simulation.camera, times, np.array([self._path]), size, pitch)
        camera: Any = mujoco.MjvCamera()
        camera.lookat[:] = track.target[-1]
        camera.distance = track.distance[-1]
        camera.azimuth = track.azimuth[-1]
        camera.elevation = track.elevation[-1]
        self._renderer.update_scene(self.environment.physics.data.ptr, camera)
        return self._renderer.render()

    def close(self) -> None:
        """Free the renderer and the physics."""
        if self._renderer:
            self._renderer.close()
            self._renderer = None
        self.environment.close()
        self._is_over = True

    def _clip(self, observation: Any) -> dict[str, Floats]:
        return {
            name: np.nan_to_num(value).clip(-MAX_OBSERVATION[name], MAX_OBSERVATION[name])
            for name, value in observation.items()
        }

    def _com(self) -> Floats:
        return self.environment.centre_of_mass

    def _info(self) -> dict[str, Any]:
        return {"distance": float(self._path[-1][0] - self._path[0][0])}


def _create_renderer(model: mujoco.MjModel) -> mujoco.Renderer:
    """Create a renderer in this process, with the backend that ``MUJOCO_GL`` named when mujoco was imported.

    Raises:
        RuntimeError: If OpenGL is not available.
    """
    try:
        return mujoco.Renderer(model, PICTURE_SIZE[1], PICTURE_SIZE[0])
    except Exception as error:
        unset = "" if os.environ.get("MUJOCO_GL") else "; on Linux, set MUJOCO_GL=egl before mujoco is first imported"
        raise RuntimeError(
            f"{opengl.unavailable_message()}{unset}. If that does not help: {opengl.how_to_fix()}"
        ) from error


if ENVIRONMENT_ID not in gymnasium.registry:
    gymnasium.register(ENVIRONMENT_ID, entry_point=f"{__name__}:WalkerEnv")
