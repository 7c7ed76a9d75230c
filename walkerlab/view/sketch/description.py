"""Descriptions of drawings in English: used as alternative texts and as labels."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from walkerlab.genome.phenotype import Phenotype
from walkerlab.settings.choices import Obstacle, Structure
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import PLANET_GRAVITY, Terrain
from walkerlab.settings.values import pluralize
from walkerlab.world.heights import LANDING_LENGTH

MIN_DIRECTION_SHARE = 0.1  # share of a vector's length; smaller components are left out of its description

_PLANET_NAMES = {"earth": "the earth", "moon": "the moon", "mars": "Mars", "jupiter": "Jupiter"}
_DIRECTIONS = (("forward", "backward"), ("to the left", "to the right"), ("up", "down"))
"""Names of the positive and the negative direction along x, y and z."""
_OBSTACLE_PLURALS = {
    Obstacle.box: "boxes",
    Obstacle.ball: "balls",
    Obstacle.cylinder: "tins",
    Obstacle.rock: "rocks",
    Obstacle.log: "logs",
}


class Force(NamedTuple):
    """Gravity or wind.

    Attributes:
        kind: ``gravity`` or ``wind``.
        vector: Acceleration [m/s²] or wind velocity [m/s], along x, y and z.
        description: Description without a capital letter or full stop.
    """

    kind: str
    vector: tuple[float, float, float]
    description: str


def describe_robot(robot: Phenotype) -> str:
    """Return the numbers of segments and legs, the weight and the length of a robot."""
    return (
        f"{pluralize(len(robot.segments), 'segment')}, {pluralize(robot.n_legs, 'leg')}, {robot.weight:.3g} kg, "
        f"{robot.body_length:.3g} m long"
    )


def describe_world(settings: Settings, robot: Phenotype | None) -> str:
    """Describe the terrain, its forces, and the robot at its start if there is one."""
    terrain = settings.terrain
    sentences = [_describe_ground(terrain), *_describe_objects(terrain)]
    if robot:
        sentences.append(f"A robot stands at the start: {describe_robot(robot)}.")
        loads: list[str] = []
        if settings.robot.carry_weight:
            loads.append(f"carries a pack of {settings.robot.carry_weight:g} kg")
        if settings.robot.drag_weight:
            loads.append(f"drags a sledge of {settings.robot.drag_weight:g} kg")
        if loads:
            sentences.append(f"It {' and '.join(loads)}.")
    sentences += [f"{force.description[0].upper()}{force.description[1:]}." for force in unusual_forces(terrain)]
    return " ".join(sentences)


def unusual_forces(terrain: Terrain) -> Iterator[Force]:
    """Yield gravity if it differs from the earth's, and wind if there is any."""
    if terrain.gravity != PLANET_GRAVITY["earth"]:
        yield Force("gravity", terrain.gravity, _describe_gravity(terrain.gravity))
    if any(terrain.wind):
        description = f"wind, {math.hypot(*terrain.wind):.3g} m/s {_describe_direction(terrain.wind)}"
        yield Force("wind", terrain.wind, description)


def _describe_gravity(gravity: tuple[float, float, float]) -> str:
    if not any(gravity):
        return "no gravity"
    planet = next((f" of {_PLANET_NAMES[name]}" for name, vector in PLANET_GRAVITY.items() if vector == gravity), "")
    return f"gravity{planet}, {math.hypot(*gravity):.3g} m/s² {_describe_direction(gravity)}"


def _describe_direction(vector: tuple[float, float, float]) -> str:
    """Return the direction of a vector, such as "forward and down"."""
    smallest = MIN_DIRECTION_SHARE * math.hypot(*vector)
    names = [
        negative if component < 0 else positive
        for component, (positive, negative) in zip(vector, _DIRECTIONS, strict=True)
        if abs(component) > smallest
    ]
    return " and ".join(", ".join(names).rsplit(", ", 1))


def _describe_ground(terrain: Terrain) -> str:
    ground = f"ground of {terrain.texture.name}"
    begin = f"begin {LANDING_LENGTH:g} m ahead"
    match terrain.structure:
        case Structure.incline if terrain.incline:
            return f"The {ground} slopes {'up' if terrain.incline > 0 else 'down'}hill at {abs(terrain.incline):g}°."
        case Structure.stairs:
            rise, depth = terrain.step_height, terrain.step_depth
            return f"Level {ground}; stairs {begin}, each {rise:g} m high and {depth:g} m deep."
        case Structure.rough if terrain.hill_height:
            rise, length = terrain.hill_height, terrain.hill_length
            return f"Level {ground}; hills {begin}, up to {rise:g} m high and about {length:g} m apart."
        case Structure.gaps:
            width, distance = terrain.gap_width, terrain.gap_distance
            return f"Level {ground}; gaps {begin}, each {width:g} m wide, with {distance:g} m between them."
        case _:
            return f"Level {ground}."


def _describe_objects(terrain: Terrain) -> Iterator[str]:
    """Yield a sentence for the texture pieces and one for the obstacles, where there are any."""
    if terrain.texture_density:
        yield f"Pieces {terrain.texture_size:g} m wide cover {terrain.texture_density:.0%} of it."
    if terrain.obstacle and terrain.obstacle_density:
        obstacles = _OBSTACLE_PLURALS[terrain.obstacle]
        yield f"Loose {obstacles} about {terrain.obstacle_size:g} m wide, {terrain.obstacle_density:g} per m²."
