"""What a drawing shows, in words: for those who cannot see it, and for those who wonder what they see."""

import math
from collections.abc import Iterator

from walkerlab.choices import Obstacle, Structure
from walkerlab.ground import LANDING
from walkerlab.phenotype import Phenotype
from walkerlab.quantity import count
from walkerlab.settings import PLANETS, Settings, Terrain

_NAMES = {"earth": "the earth", "moon": "the moon", "mars": "Mars", "jupiter": "Jupiter"}
_SIDES = (("forward", "backward"), ("to the left", "to the right"), ("up", "down"))
LEAST = 0.1  # share of a vector's length, under which it is not said that it points that way too


def measures(robot: Phenotype) -> str:
    """Say what a robot is made of: segments, legs, weight and length."""
    return (
        f"{count(len(robot.segments), 'segment')}, {count(robot.n_legs, 'leg')}, {robot.weight:.3g} kg, "
        f"{robot.body_length:.3g} m long"
    )


def in_words(settings: Settings, robot: Phenotype | None) -> str:
    """Say what is seen of a world, and of a robot at its start if there is one."""
    terrain, loads = settings.terrain, settings.robot
    said = [_shape(terrain), *_strewn(terrain)]
    if robot:
        carried = [f"carries a pack of {loads.carry_weight:g} kg"] * bool(loads.carry_weight)
        carried += [f"drags a sledge of {loads.drag_weight:g} kg"] * bool(loads.drag_weight)
        stands = f"A robot stands at the start: {measures(robot)}."
        said += [stands, *([f"It {' and '.join(carried)}."] if carried else [])]
    said += [f"{words[0].upper()}{words[1:]}." for _, _, words in forces(terrain)]
    return " ".join(said)


def forces(terrain: Terrain) -> Iterator[tuple[str, tuple[float, float, float], str]]:
    """Yield what pulls and pushes otherwise than on the earth on a calm day: its name, its vector, and it in words."""
    if terrain.gravity != PLANETS["earth"]:
        yield "gravity", terrain.gravity, _pull(terrain.gravity)
    if any(terrain.wind):
        yield "wind", terrain.wind, f"wind, {math.hypot(*terrain.wind):.3g} m/s {_way(terrain.wind)}"


def _pull(gravity: tuple[float, float, float]) -> str:
    of = next((f" of {_NAMES[name]}" for name, vector in PLANETS.items() if vector == gravity), "")
    if not any(gravity):
        return "no gravity: nothing is held down"
    return f"gravity{of}, {math.hypot(*gravity):.3g} m/s² {_way(gravity)}"


def _way(vector: tuple[float, float, float]) -> str:
    """Say where a vector points: "forward and down"."""
    least = LEAST * math.hypot(*vector)
    said = [sides[part < 0] for part, sides in zip(vector, _SIDES, strict=True) if abs(part) > least]
    return " and ".join(", ".join(said).rsplit(", ", 1))


def _shape(terrain: Terrain) -> str:
    of = f"ground of {terrain.texture.name}"
    match terrain.structure:
        case Structure.incline if terrain.incline:
            return f"The {of} goes {'up' if terrain.incline > 0 else 'down'}hill at {abs(terrain.incline):g}°."
        case Structure.stairs:
            rise, tread = terrain.step_height, terrain.step_depth
            return f"Level {of}; {LANDING:g} m ahead, stairs begin, each {rise:g} m high and {tread:g} m deep."
        case Structure.rough if terrain.hill_height:
            high, long = terrain.hill_height, terrain.hill_length
            return f"Level {of}; {LANDING:g} m ahead, hills begin, up to {high:g} m high and about {long:g} m apart."
        case Structure.gaps:
            wide, apart = terrain.gap_width, terrain.gap_distance
            return f"Level {of}; {LANDING:g} m ahead, trenches begin, each {wide:g} m wide, with {apart:g} m between."
        case _:
            return f"Level {of}."


def _strewn(terrain: Terrain) -> Iterator[str]:
    if terrain.texture_density:
        yield f"Pieces {terrain.texture_size:g} m wide cover {terrain.texture_density:.0%} of it."
    if terrain.obstacle and terrain.obstacle_density:
        things, size = _THINGS[terrain.obstacle], terrain.obstacle_size
        yield f"{things} about {size:g} m wide lie about, {terrain.obstacle_density:g} on each m²."


_THINGS = {
    Obstacle.box: "Boxes",
    Obstacle.ball: "Balls",
    Obstacle.cylinder: "Tins",
    Obstacle.rock: "Rocks",
    Obstacle.log: "Logs",
}
