"""The terrain: shape of the ground, what lies on it, and the forces acting over it."""

import math
from typing import Self

from pydantic import model_validator

from walkerlab.settings.choices import Obstacle, Structure, Texture
from walkerlab.settings.fields import one_of, quantity, vector
from walkerlab.settings.glossary import ShownDomain
from walkerlab.settings.values import number_text

PLANETS = {
    "earth": (0.0, 0.0, -9.81),
    "moon": (0.0, 0.0, -1.62),
    "mars": (0.0, 0.0, -3.71),
    "jupiter": (0.0, 0.0, -24.79),
}
"""Gravity at the surface, m/s²; from NASA's planetary fact sheets."""

FIELD = (18.0, 6.0)  # m along and across the way, on which pieces and obstacles are strewn
MAX_PIECES = 6000  # of texture, among which a walk takes some three times as long to compute as on bare ground
WHOLE_PIECE = 1.25  # widths of a piece that a tread must be deep
CROWDED = 0.3  # part of the ground within the reach of an obstacle, over which there is no way through
REACH = {
    Obstacle.none: 0.0,
    Obstacle.box: 0.71,
    Obstacle.ball: 0.5,
    Obstacle.cylinder: 0.5,
    Obstacle.rock: 0.6,
    Obstacle.log: 1.3,
}
"""How far an obstacle reaches from its middle, as a share of its size; a log is longer than it is thick."""
SPREAD = 0.25  # how much larger or smaller than its size an obstacle may be, as a share


class Terrain(ShownDomain, frozen=True):
    """The ground, what lies on it, and the forces over it."""

    structure: Structure = one_of(Structure.flat, about="the shape of the ground")
    incline: float = quantity(
        10.0, low=-30.0, high=30.0, unit="deg", about="the slope of the incline structure; positive is uphill"
    )
    step_height: float = quantity(0.08, low=0.01, high=0.4, unit="m", about="the rise of each stair")
    step_depth: float = quantity(0.4, low=0.1, high=2.0, unit="m", about="the tread of each stair, along the way")
    hill_height: float = quantity(
        0.12, low=0.0, high=0.6, unit="m", about="the height of a rough ground's hills over its hollows"
    )
    hill_length: float = quantity(1.5, low=0.8, high=6.0, unit="m", about="the distance between a rough ground's hills")
    gap_width: float = quantity(0.1, low=0.02, high=1.0, unit="m", about="the width of each trench, along the way")
    gap_distance: float = quantity(0.8, low=0.2, high=5.0, unit="m", about="the level ground between two trenches")
    texture: Texture = one_of(Texture.rubber, about="what the ground is made of, which decides the grip")
    texture_size: float = quantity(
        0.06,
        low=0.02,
        high=0.3,
        unit="m",
        about="the width of the pieces that are fixed to the ground, here and there",
    )
    texture_density: float = quantity(
        0.0, low=0.0, high=1.0, about="the part of the ground that such pieces cover; 0 is bare ground"
    )
    obstacle: Obstacle = one_of(Obstacle.none, about="what lies about on the ground, to be pushed or climbed over")
    obstacle_size: float = quantity(0.1, low=0.03, high=1.0, unit="m", about="the width of an obstacle, give or take")
    obstacle_density: float = quantity(
        0.25, low=0.0, high=2.0, unit="per m²", about="how many obstacles lie on each square metre"
    )
    gravity: tuple[float, float, float] = vector(
        PLANETS["earth"],
        low=-30.0,
        high=30.0,
        unit="m/s²",
        about="the pull on everything; z is up",
        presets=PLANETS,
    )
    wind: tuple[float, float, float] = vector(
        (0.0, 0.0, 0.0), low=-40.0, high=40.0, unit="m/s", about="how the air moves; it pushes all that stands in it"
    )
    seed: int = quantity(
        0, low=0, high=2**31 - 1, about="the seed of where pieces, obstacles and hills are: same seed, same ground"
    )

    @property
    def n_pieces(self) -> int:
        """About how many pieces of texture it takes; the more of the ground they cover, the more they overlap."""
        length, width = FIELD
        overlap = 1 + self.texture_density
        return round(overlap * self.texture_density * length * width / (math.pi / 4 * self.texture_size**2))

    @model_validator(mode="after")
    def _room_for_all(self) -> Self:
        """Refuse more than a computer can bear, or the ground."""
        faults: list[str] = []
        if self.n_pieces > MAX_PIECES:
            larger = math.ceil(100 * self.texture_size * math.sqrt(self.n_pieces / MAX_PIECES)) / 100
            mend = f"Terrain.texture_size {larger:g} m would do" if larger <= 0.3 else "lower the density"
            faults.append(
                f"Terrain.texture_size {number_text(self.texture_size)} m and "
                f"Terrain.texture_density {number_text(self.texture_density)} "
                f"ask for some {self.n_pieces} pieces; {MAX_PIECES} at most are laid, or walks would take "
                f"too long to compute. At this density, {mend}."
            )
        level = {Structure.stairs: "step_depth", Structure.gaps: "gap_distance"}.get(self.structure)
        if level and self.texture_density and WHOLE_PIECE * self.texture_size > getattr(self, level):
            faults.append(
                f"Terrain.texture_size is {number_text(self.texture_size)} m; its pieces do not fit on ground of "
                f"Terrain.{level} {number_text(getattr(self, level))} m, "
                f"of which they may take up {1 / WHOLE_PIECE:.0%}."
            )
        reach = (1 + SPREAD) * REACH[self.obstacle] * self.obstacle_size
        if level and 2 * reach > getattr(self, level):
            faults.append(
                f"Terrain.obstacle_size is {number_text(self.obstacle_size)} m; such a {self.obstacle.name} can be "
                f"{2 * reach:.2g} m long, and Terrain.{level} is {number_text(getattr(self, level))} m: "
                "it does not fit."
            )
        crowd = self.obstacle_density * math.pi * (REACH[self.obstacle] * self.obstacle_size) ** 2
        if crowd > CROWDED:
            faults.append(
                f"Terrain.obstacle_density {number_text(self.obstacle_density)} per m² and Terrain.obstacle_size "
                f"{number_text(self.obstacle_size)} m leave no way through; at this size, a density of "
                f"{math.floor(100 * self.obstacle_density * CROWDED / crowd) / 100:g} per m² would do."
            )
        if faults:
            raise ValueError("\n".join(faults))
        return self
