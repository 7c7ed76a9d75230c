"""The fitness of a walk so far, from which the reward of each step follows."""

import math

import mujoco
import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Fitness
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import IDLE_WORK
from walkerlab.world.assembly import Sensor


class Progress:
    """Measures a walk step by step; the increases of its fitness add up to the fitness of the whole walk.

    The forward travel counts for ``velocity`` only in the last two thirds of the walk, as in the fitness.
    """

    def __init__(self, settings: Settings) -> None:
        """Prepare for walks with these settings.

        Raises:
            ValueError: If the fitness is a user function.
        """
        fitness = settings.algorithm.fitness
        if not isinstance(fitness, Fitness):
            raise ValueError(
                "the fitness is a function of your own, which rates whole walks, so it gives no reward for a step. "
                "Give reward=function, from the physics after a step to a number"
            )
        self._fitness = fitness
        self._duration = settings.simulation.duration
        self._timestep = settings.simulation.timestep

    def begin(self, data: mujoco.MjData) -> None:
        """Begin to measure a walk."""
        self._start = data.sensordata[Sensor.COM].copy()
        self._later_start = self._start[0]
        self._later_time = 0.0
        self._work = 0.0
        self._angle = data.qpos.copy()
        self._speed = data.qvel.copy()
        self._value = 0.0

    def add_step(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Add a physics step: the work of the servos, and the start of the part that counts for the velocity."""
        joint = model.actuator_trnid[:, 0]
        angle = self._angle[model.jnt_qposadr[joint]]
        before = self._speed[model.jnt_dofadr[joint]]
        after = data.qvel[model.jnt_dofadr[joint]]
        bias = model.actuator_biasprm
        target = model.actuator_gainprm[:, 0] * data.ctrl
        torque = np.clip(target + bias[:, 1] * angle + bias[:, 2] * after, *model.actuator_forcerange.T)
        self._work += float(np.abs(torque * (before + after) / 2).sum()) * self._timestep
        self._angle[:] = data.qpos
        self._speed[:] = data.qvel
        if data.time - self._timestep < self._duration / 3 - self._timestep / 2:
            self._later_start = data.sensordata[Sensor.COM][0]
            self._later_time = data.time

    def take_increase(self, data: mujoco.MjData) -> float:
        """Return the increase of the fitness since the last call."""
        value = self._rate(data.sensordata[Sensor.COM])
        increase = value - self._value
        self._value = value
        return increase

    def _rate(self, com: Floats) -> float:
        distance = float(com[0] - self._start[0])
        match self._fitness:
            case Fitness.velocity:
                return float(com[0] - self._later_start) / (self._duration - self._later_time or math.inf)
            case Fitness.efficiency:
                return distance / (IDLE_WORK + self._work)
            case Fitness.straightness:
                return distance - abs(float(com[1] - self._start[1]))
            case _:
                return distance
