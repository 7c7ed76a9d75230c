"""Everything that a class can set: four domains, each number with its range, unit and meaning."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Self, cast

from pydantic import ValidationInfo, field_validator, model_validator

from walkerlab.settings.choices import (
    Camera,
    Crossover,
    Feature,
    Fitness,
    Guard,
    Mutation,
    Obstacle,
    Selection,
    Structure,
    Texture,
)
from walkerlab.settings.fields import (
    Domain,
    OneOf,
    SettingsModel,
    brief,
    did_you_mean,
    limits,
    number_text,
    one_of,
    pasted,
    quantity,
    told_with,
    vector,
)
from walkerlab.settings.glossary import ShownDomain, glossary
from walkerlab.text.html import code, details, shown

LIGHTEST = 0.01  # kg that a load weighs, if there is one
_TINY = 1e-12  # m; room for the rounding of floats, as 3 × 0.1 is more than 0.3


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


class Robot(ShownDomain, frozen=True):
    """Limits that every robot obeys, whatever the operators do."""

    weight: tuple[float, float] = limits((3.0, 12.0), low=0.1, high=200.0, unit="kg", about="the robot's whole mass")
    body_length: tuple[float, float] = limits(
        (0.4, 1.2), low=0.05, high=8.0, unit="m", about="the front of the first to the end of the last segment"
    )
    segments: tuple[int, int] = limits((1, 4), low=1, high=8, about="the number of body segments")
    segment_length: tuple[float, float] = limits(
        (0.2, 0.5), low=0.05, high=2.0, unit="m", about="the length of each body segment"
    )
    legs: tuple[int, int] = limits((2, 8), low=2, high=16, about="the number of legs, which come in pairs")
    leg_force: tuple[float, float] = limits(
        (2.0, 20.0), low=0.1, high=500.0, unit="N·m", about="the greatest torque at each leg joint"
    )
    carry_weight: float = quantity(
        0.0, low=0.0, high=100.0, unit="kg", about="a pack fixed on the back, part of no limit; 0 is none"
    )
    drag_weight: float = quantity(
        0.0, low=0.0, high=100.0, unit="kg", about="a sledge on a rope behind, part of no limit; 0 is none"
    )

    @property
    def leg_pairs(self) -> tuple[int, int]:
        """The fewest and most pairs of legs within ``legs``."""
        return -(-self.legs[0] // 2), self.legs[1] // 2

    @property
    def segment_range(self) -> tuple[int, int]:
        """The fewest and most segments with which every limit can be held."""
        shortest, longest = self.segment_length
        need = (self.segments[0], self.leg_pairs[0], int(-(-(self.body_length[0] - _TINY) // longest)))
        room = (self.segments[1], int((self.body_length[1] + _TINY) // shortest))
        return max(need), min(room)

    @model_validator(mode="after")
    def _hold_together(self) -> Self:
        """Refuse limits that no robot can obey, naming the fields that clash."""
        (fewest, most), (shortest, longest), (short, long) = self.segments, self.segment_length, self.body_length
        faults: list[str] = []
        faults += [
            f"Robot.{load} is {number_text(weight)} kg; it must be 0, for none, or {LIGHTEST:g} to 100 kg."
            for load, weight in (("carry_weight", self.carry_weight), ("drag_weight", self.drag_weight))
            if 0 < weight < LIGHTEST
        ]
        if self.leg_pairs[0] > self.leg_pairs[1]:
            faults.append(f"Robot.legs is {self.legs}; legs come in pairs, so it must hold an even number between.")
        if self.leg_pairs[0] > most:
            faults.append(
                f"Robot.legs asks for {self.legs[0]} legs or more, but Robot.segments allows {most} segments, "
                f"each with one pair: {2 * most} legs at most."
            )
        if fewest * shortest > long + _TINY:
            faults.append(
                f"Robot.segments and Robot.segment_length ask for {fewest} × {number_text(shortest)} = "
                f"{fewest * shortest:g} m or more, but Robot.body_length allows {number_text(long)} m."
            )
        if most * longest < short - _TINY:
            faults.append(
                f"Robot.segments and Robot.segment_length allow {most} × {number_text(longest)} = "
                f"{most * longest:g} m at most, but Robot.body_length asks for {number_text(short)} m or more."
            )
        if not faults and self.segment_range[0] > self.segment_range[1]:
            faults.append(
                f"Robot.segments, Robot.legs, Robot.body_length and Robot.segment_length cannot hold together: a body "
                f"of {number_text(short)} to {number_text(long)} m from segments of {number_text(shortest)} to "
                f"{number_text(longest)} m with {self.legs[0]} legs or more needs at least "
                f"{self.segment_range[0]} segments, and at most {self.segment_range[1]} fit."
            )
        if faults:
            raise ValueError("\n".join(faults))
        return self


class Algorithm(ShownDomain, frozen=True):
    """The genetic algorithm: what is better, who breeds, how, and for how long."""

    fitness: Fitness | Callable[..., float] = one_of(
        Fitness.distance, functions=True, about="what makes one robot better than another"
    )
    selection: Any = one_of(Selection.gradient, functions=True, several=True, about="how parents are chosen")
    crossover: Any = one_of(Crossover.paired, functions=True, several=True, about="how parents make children")
    mutation: Any = one_of(Mutation.randomized, functions=True, several=True, about="how children are varied")
    population_size: int = quantity(60, low=4, high=10_000, about="how many robots each generation has")
    generations: int = quantity(
        25, low=1, high=10_000, about="how many generations are walked, counting the random first one"
    )
    n_elites: int = quantity(2, low=0, high=1_000, about="how many of the best live on unchanged")
    mutation_rate: float = quantity(0.08, low=0.0, high=1.0, about="the chance of each gene to change")
    mutation_scale: float = quantity(0.2, low=0.0, high=2.0, about="the size of a change, as a share of the value")
    favored_gene: Feature = one_of(Feature.leg_length, about="the feature that favored mutation changes most often")
    seed: int = quantity(0, low=0, high=2**31 - 1, about="the seed of all chance in the algorithm")

    @model_validator(mode="after")
    def _room_for_children(self) -> Self:
        if self.n_elites >= self.population_size:
            raise ValueError(
                f"Algorithm.n_elites is {self.n_elites}; it must be under Algorithm.population_size, "
                f"{self.population_size}, or no child would ever be born."
            )
        return self


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


class Settings(SettingsModel, frozen=True):
    """All that a run is made from."""

    terrain: Terrain = Terrain()
    robot: Robot = Robot()
    algorithm: Algorithm = Algorithm()
    simulation: Simulation = Simulation()

    def with_(self, *unnamed: object, **changes: Any) -> Self:
        """Return a copy with some settings changed, each named alone: ``s.with_(selection="top_half", duration=4)``.

        A whole domain may be named as well: ``s.with_(terrain=Terrain(structure="stairs"), duration=4)``.

        Raises:
            SettingsError: if no domain has such a setting, or the value will not do.
            TypeError: If a value is given without a name.
        """
        if unnamed:
            raise TypeError(f"with_ takes settings by name, as in s.with_(duration=4); got {brief(unnamed[0])}")
        places, faults = self.places(), list[str]()
        parts: dict[str, Any] = dict(self)
        for name in sorted(changes, key=places.__contains__):  # whole domains come first
            if name in places:
                domain, field = places[name]
                parts[domain] = dict(parts[domain]) | {field: changes[name]}
                continue
            try:
                parts[name] = self._domain(name, changes[name])
            except ValueError as fault:  # the others are held against the domain as it was
                faults.append(str(fault))
        with told_with(faults):
            return type(self)(**parts)

    def changes(self) -> dict[str, Any]:
        """Return each single setting that differs from its default: ``Settings().with_(**s.changes()) == s``."""
        return {
            name: getattr(getattr(self, domain), field)
            for name, (domain, field) in self.places().items()
            if getattr(getattr(self, domain), field) != getattr(type(self).model_fields[domain].default, field)
        }

    def as_python(self) -> str:
        """Write the code that makes them, given ``import walkerlab as wl``; functions are called by their names."""
        lines = [f"    {name}={pasted(value)}," for name, value in self.changes().items()]
        return "\n".join(["wl.Settings().with_(", *lines, ")"]) if lines else "wl.Settings()"

    def _repr_html_(self) -> str:
        return shown(*(glossary(domain) for _, domain in self), details("The same as Python", code(self.as_python())))

    @field_validator("*", mode="before")
    @classmethod
    def _check(cls, value: object, info: ValidationInfo) -> object:
        return cls._domain(info.field_name or "", value)

    @classmethod
    def _domain(cls, name: str, value: Any) -> Any:
        """Refuse what is no domain of this name, nor the settings of one; pass over names that there are not."""
        if name not in cls.model_fields:
            return value
        kind: type[Domain] = type(cls.model_fields[name].default)
        if isinstance(value, kind):
            return value
        if isinstance(value, Mapping):
            return dict(cast(Mapping[str, Any], value))
        fields = [
            field
            for field, declared in kind.declared().items()
            if isinstance(declared, OneOf) and isinstance(value, str) and value in declared.choices.__members__
        ]
        guess = f" Did you mean {name}={kind.__name__}({fields[0]}={value!r})?" if fields else ""
        raise ValueError(
            f"Settings.{name} is {brief(value)}; it must be a {kind.__name__}, or a dict of its settings.{guess}"
        )

    @classmethod
    def advice(cls, name: str) -> str:
        """Say what might have been meant by a name that there is not, looking into the domains as well."""
        places = cls.places()
        if name in places:
            domain, field = places[name]
            return f" It is one of {domain}: {domain}={domain.capitalize()}({field}=…)."
        return did_you_mean(name, [*cls.model_fields, *places]) or super().advice(name)

    @classmethod
    def places(cls) -> dict[str, tuple[str, str]]:
        """Name each single setting in one word, and say its domain and field.

        The word is the field's name. Where two domains have one of that name, it is the algorithm's, and the other is
        called after its domain as well: ``seed`` and ``terrain_seed``.
        """
        fields = {
            domain: list(type(field.default).model_fields)  # type: ignore[union-attr]
            for domain, field in cls.model_fields.items()
        }
        return {
            name if domain == "algorithm" or name not in fields["algorithm"] else f"{domain}_{name}": (domain, name)
            for domain, names in fields.items()
            for name in names
        }
