"""The settings of the simulation: length and precision of a walk, and the rules that it must keep."""

from typing import Any

from walkerlab.settings.choices import Camera, Guard
from walkerlab.settings.fields import one_of, quantity
from walkerlab.settings.glossary import ShownDomain


class Simulation(ShownDomain, frozen=True):
    """How long a walk is, how finely it is computed, and how it is judged and watched."""

    duration: float = quantity(8.0, low=1.0, high=120.0, unit="s", about="the length of the measured walk")
    timestep: float = quantity(0.005, low=0.0005, high=0.01, unit="s", about="the step of the physics")
    n_starts: int = quantity(
        1, low=1, high=20, about="how many starts, each a little different, every robot walks from; its poorest counts"
    )
    camera: Camera = one_of(Camera.side, about="from where a walk is watched")
    max_speed: float = quantity(
        10.0, low=1.0, high=1000.0, unit="body lengths/s", about="the speed over which a walk does not count"
    )
    max_airborne: float = quantity(
        0.5, low=0.05, high=1000.0, unit="s", about="the time off the ground over which a walk does not count"
    )
    forgive: Any = one_of(
        Guard.none, several=True, about="the guards that are off, to watch evolution cheat; none of them as a rule"
    )
