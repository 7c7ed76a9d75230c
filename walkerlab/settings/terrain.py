"""The terrain: shape and material of the ground, the objects on it, gravity and wind."""

import math
from typing import Annotated, Self

from pydantic import model_validator

from walkerlab.settings.choices import Obstacle, Structure, Texture
from walkerlab.settings.fields import XYZ, OneOf, Quantity
from walkerlab.settings.glossary import DisplayedDomain
from walkerlab.settings.values import number_text

PLANET_GRAVITY = {
    "earth": (0.0, 0.0, -9.81),
    "moon": (0.0, 0.0, -1.62),
    "mars": (0.0, 0.0, -3.71),
    "jupiter": (0.0, 0.0, -24.79),
}
"""Gravity at the surface, m/s²; from NASA's planetary fact sheets."""

PLACEMENT_AREA = (18.0, 6.0)  # m along and across the walking direction; pieces and obstacles are placed on this area
MAX_PIECES = 6000  # maximum number of texture pieces; a walk then takes about three times as long to compute
MIN_LEVEL_LENGTH = 1.25  # smallest length of level ground, in widths of a texture piece
MAX_COVERED_SHARE = 0.3  # largest share of the ground within the reach of obstacles; above it, no path is left
OBSTACLE_REACH = {
    Obstacle.none: 0.0,
    Obstacle.box: 0.71,
    Obstacle.ball: 0.5,
    Obstacle.cylinder: 0.5,
    Obstacle.rock: 0.6,
    Obstacle.log: 1.3,
}
"""Distance from the centre of an obstacle to its farthest point, as a share of its size; a log is longer than wide."""
OBSTACLE_SIZE_SPREAD = 0.25  # largest deviation of an obstacle from ``obstacle_size``, as a share

_LEVEL_GROUND = {Structure.stairs: "step_depth", Structure.gaps: "gap_distance"}
"""Setting with the length of each level piece of ground, for structures that have such pieces."""


class Terrain(DisplayedDomain, frozen=True):
    """The ground, the objects on it, gravity and wind."""

    structure: Annotated[Structure, OneOf(Structure, about="the shape of the ground")] = Structure.flat
    incline: Annotated[
        float,
        Quantity(low=-30.0, high=30.0, unit="deg", about="the slope of the incline structure; positive is uphill"),
    ] = 10.0
    step_height: Annotated[float, Quantity(low=0.01, high=0.4, unit="m", about="the rise of each stair")] = 0.08
    step_depth: Annotated[
        float, Quantity(low=0.1, high=2.0, unit="m", about="the tread of each stair, in the walking direction")
    ] = 0.4
    hill_height: Annotated[
        float,
        Quantity(low=0.0, high=0.6, unit="m", about="the height of the hills of rough ground above its hollows"),
    ] = 0.12
    hill_length: Annotated[
        float, Quantity(low=0.8, high=6.0, unit="m", about="the distance between the hills of rough ground")
    ] = 1.5
    gap_width: Annotated[
        float, Quantity(low=0.02, high=1.0, unit="m", about="the width of each trench, in the walking direction")
    ] = 0.1
    gap_distance: Annotated[
        float, Quantity(low=0.2, high=5.0, unit="m", about="the length of level ground between two trenches")
    ] = 0.8
    texture: Annotated[Texture, OneOf(Texture, about="the material of the ground, which determines the grip")] = (
        Texture.rubber
    )
    texture_size: Annotated[
        float, Quantity(low=0.02, high=0.3, unit="m", about="the width of the texture pieces fixed to the ground")
    ] = 0.06
    texture_density: Annotated[
        float, Quantity(low=0.0, high=1.0, about="the share of the ground that texture pieces cover; 0 is bare ground")
    ] = 0.0
    obstacle: Annotated[
        Obstacle, OneOf(Obstacle, about="the kind of loose obstacles on the ground, to be pushed or climbed over")
    ] = Obstacle.none
    obstacle_size: Annotated[
        float,
        Quantity(
            low=0.03, high=1.0, unit="m", about=f"the width of an obstacle, plus or minus {OBSTACLE_SIZE_SPREAD:.0%}"
        ),
    ] = 0.1
    obstacle_density: Annotated[
        float, Quantity(low=0.0, high=2.0, unit="per m²", about="the number of obstacles on each square metre")
    ] = 0.25
    gravity: Annotated[
        tuple[float, float, float],
        Quantity(
            low=-30.0,
            high=30.0,
            unit="m/s²",
            about="the acceleration of gravity; z is up",
            components=XYZ,
            presets=PLANET_GRAVITY,
        ),
    ] = PLANET_GRAVITY["earth"]
    wind: Annotated[
        tuple[float, float, float],
        Quantity(
            low=-40.0,
            high=40.0,
            unit="m/s",
            about="the velocity of the air, which pushes everything that stands in it",
            components=XYZ,
        ),
    ] = (0.0, 0.0, 0.0)
    seed: Annotated[
        int,
        Quantity(
            low=0,
            high=2**31 - 1,
            about="the seed of the positions of pieces, obstacles and hills: same seed, same ground",
            whole=True,
        ),
    ] = 0

    @property
    def n_pieces(self) -> int:
        """Approximate number of texture pieces; the overlap increases with their density."""
        length, width = PLACEMENT_AREA
        overlap = 1 + self.texture_density
        return round(overlap * self.texture_density * length * width / (math.pi / 4 * self.texture_size**2))

    @model_validator(mode="after")
    def _validate_space(self) -> Self:
        """Reject more pieces and obstacles than can be computed, or than fit on the ground."""
        errors = self._texture_errors() + self._obstacle_errors()
        if errors:
            raise ValueError("\n".join(errors))
        return self

    def _texture_errors(self) -> list[str]:
        errors: list[str] = []
        size = number_text(self.texture_size)
        if self.n_pieces > MAX_PIECES:
            larger = math.ceil(100 * self.texture_size * math.sqrt(self.n_pieces / MAX_PIECES)) / 100
            fix = f"Terrain.texture_size {larger:g} m would work" if larger <= 0.3 else "lower the density"
            errors.append(
                f"Terrain.texture_size {size} m and Terrain.texture_density {number_text(self.texture_density)} "
                f"require about {self.n_pieces} pieces; at most {MAX_PIECES} are allowed, because more would make "
                f"walks too slow to compute. At this density, {fix}."
            )
        level = _LEVEL_GROUND.get(self.structure)
        if level and self.texture_density and MIN_LEVEL_LENGTH * self.texture_size > getattr(self, level):
            errors.append(
                f"Terrain.texture_size is {size} m; its pieces do not fit on ground of "
                f"Terrain.{level} {number_text(getattr(self, level))} m, "
                f"of which a piece may take up at most {1 / MIN_LEVEL_LENGTH:.0%}."
            )
        return errors

    def _obstacle_errors(self) -> list[str]:
        errors: list[str] = []
        size = number_text(self.obstacle_size)
        level = _LEVEL_GROUND.get(self.structure)
        reach = (1 + OBSTACLE_SIZE_SPREAD) * OBSTACLE_REACH[self.obstacle] * self.obstacle_size
        if level and 2 * reach > getattr(self, level):
            errors.append(
                f"Terrain.obstacle_size is {size} m; such a {self.obstacle.name} can be "
                f"{2 * reach:.2g} m long, and Terrain.{level} is {number_text(getattr(self, level))} m: "
                "it does not fit."
            )
        covered = self.obstacle_density * math.pi * (OBSTACLE_REACH[self.obstacle] * self.obstacle_size) ** 2
        if covered > MAX_COVERED_SHARE:
            lower = math.floor(100 * self.obstacle_density * MAX_COVERED_SHARE / covered) / 100
            errors.append(
                f"Terrain.obstacle_density {number_text(self.obstacle_density)} per m² and Terrain.obstacle_size "
                f"{size} m leave no way through; at this size, a density of {lower:g} per m² would work."
            )
        return errors
