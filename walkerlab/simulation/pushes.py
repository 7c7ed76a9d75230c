"""What pushes a robot forward without its legs: a slope, the direction of gravity, or the wind.

A robot that only trembles slides down an icy slope, because moving contacts grip less than resting ones. To find out
whether a robot walks, it is simulated again in the same world without a push, where it must reach a share of its speed.
"""

import math
from typing import Any

import numpy as np

from walkerlab.settings.choices import Structure
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.world.heights import slope

LEVEL_WALK_DURATION = 4.0  # s; long enough for the mean speed of a gait, and half as expensive as the walk itself


def is_pushed_forward(terrain: Terrain) -> bool:
    """Return whether gravity or the wind has a component along the ground in the walking direction."""
    return max(_pushes(terrain)) > 0


def remove_pushes(settings: Settings) -> Settings:
    """Return the settings of a shorter walk in the same world without the forward push.

    If gravity pushes, a slope becomes level ground, and gravity points straight down. If the wind pushes, its forward
    component is removed.
    """
    terrain = settings.terrain
    gravity_push, wind_push = _pushes(terrain)
    changes: dict[str, Any] = {}
    if gravity_push > 0:
        x, y, z = terrain.gravity
        changes["gravity"] = (0.0, y, -math.hypot(x, z))
        if terrain.structure == Structure.incline:
            changes["structure"] = Structure.flat
    if wind_push > 0:
        changes["wind"] = (0.0, *terrain.wind[1:])
    simulation = settings.simulation
    duration = min(simulation.duration, LEVEL_WALK_DURATION)
    return settings.model_copy(  # magnitude of gravity and timestep may be outside the ranges of the settings
        update={
            "terrain": terrain.model_copy(update=changes),
            "simulation": simulation.model_copy(update={"duration": duration}),
        }
    )


def _pushes(terrain: Terrain) -> tuple[float, float]:
    """Return the components of gravity [m/s²] and wind [m/s] along the ground in the walking direction."""
    pitch = slope(terrain)
    forward = [math.cos(pitch), 0.0, math.sin(pitch)]
    return float(np.dot(terrain.gravity, forward)), float(np.dot(terrain.wind, forward))
