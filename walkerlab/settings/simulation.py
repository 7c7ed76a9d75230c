"""The settings of the simulation: length and precision of a walk, and the limits above which it does not count."""

from typing import Annotated, Any

from walkerlab.settings.choices import Camera, Guard, Recording
from walkerlab.settings.fields import OneOf, Quantity
from walkerlab.settings.glossary import DisplayedDomain


class Simulation(DisplayedDomain, frozen=True):
    """Duration and time step of a walk, the guards that decide whether it counts, and the camera that shows it."""

    duration: Annotated[float, Quantity(low=1.0, high=120.0, unit="s", about="the length of the measured walk")] = 8.0
    timestep: Annotated[float, Quantity(low=0.0005, high=0.01, unit="s", about="the time step of the physics")] = 0.005
    n_starts: Annotated[
        int,
        Quantity(
            low=1,
            high=20,
            about="the number of slightly different starts from which every robot walks; its poorest walk counts",
            whole=True,
        ),
    ] = 1
    camera: Annotated[Camera, OneOf(Camera, about="the viewpoint from which a walk is shown")] = Camera.side
    max_speed: Annotated[
        float,
        Quantity(low=1.0, high=1000.0, unit="body lengths/s", about="the speed above which a walk does not count"),
    ] = 10.0
    max_airborne: Annotated[
        float,
        Quantity(low=0.05, high=1000.0, unit="s", about="the time off the ground above which a walk does not count"),
    ] = 0.5
    forgive: Annotated[
        Any,
        OneOf(
            Guard,
            about="the list of guards that are off, to watch evolution cheat; by default none",
            several=True,
        ),
    ] = Guard.none
    record: Annotated[
        Any,
        OneOf(
            Recording,
            about="the list of what walks record in addition, for your own fitness function or descriptors; by default "
            "none",
            several=True,
        ),
    ] = Recording.none


NO_EFFECT_ON_WALKS = {"camera": Camera.side, "record": Recording.none}
"""Defaults of the settings that change neither walks nor their fitness."""
