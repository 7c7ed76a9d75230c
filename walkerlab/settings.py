"""Everything that a class can set: four domains, each number with its range, unit and meaning."""

from collections.abc import Callable, Mapping
from typing import Any, Self, cast

from pydantic import ValidationInfo, field_validator, model_validator

from walkerlab.quantity import (
    Choice,
    Domain,
    OneOf,
    SettingsModel,
    did_you_mean,
    limits,
    one_of,
    quantity,
    told_with,
    vector,
)

_TINY = 1e-12  # m; room for the rounding of floats, as 3 × 0.1 is more than 0.3


class Structure(Choice):
    """The shape of the ground, seen from the side; robots walk to the right."""

    flat = 0, "______________ a level plane"
    incline = 1, "___---‾‾‾ a plane that rises, or falls, along the way"
    stairs = 2, "____┌──┌──┌── steps that go up along the way"


class Fitness(Choice):
    """What makes one robot better than another."""

    distance = 0, "net forward travel of the centre of mass after settling, in m"
    velocity = 1, "mean forward speed over the last two thirds of the walk, in m/s"


class Selection(Choice):
    """Who becomes a parent."""

    gradient = 0, "chance grows in proportion to fitness"
    top_half = 1, "the better half, each equally often"
    tournament = 2, "the best of a few drawn by chance"
    rank = 3, "chance grows with rank, not with fitness itself"
    uniform = 4, "anybody: no selection pressure at all"


class Crossover(Choice):
    """How two or more parents make children."""

    paired = 0, "front half of one parent, rear half of the other; what is left makes the second child"
    randomized = 1, "each feature comes from a parent drawn afresh from all that were selected"
    weighted = 2, "the poorer parent is moved towards the better, more so the larger the gap"
    one_point = 3, "the gene string is cut at one random place and its ends are swapped"
    uniform = 4, "a coin is tossed for each gene of a couple"
    none = 5, "children are copies; only mutation changes them"


class Mutation(Choice):
    """How children come to differ from their parents."""

    randomized = 0, "each feature has the same chance to change, relative to its value"
    favored = 1, "one named feature is far likelier to change than the others"
    micro = 2, "small steps; the body plan stays"
    macro = 3, "large jumps; whole segments come and go"
    gaussian = 4, "each feature has the same chance to change, relative to its range"


class Feature(Choice):
    """What a gene can stand for. All from ``length`` on are given once for each segment."""

    segments = 0, "how many segments are grown"
    frequency = 1, "strides per second, the same for all legs"
    length = 2, "length of the segment"
    mass = 3, "mass of the segment and its legs"
    legs = 4, "whether the segment has a pair of legs (1) or none (0)"
    leg_length = 5, "length of each leg, thigh and shank together"
    leg_force = 6, "greatest torque at the hip and at the knee"
    hip_amplitude = 7, "how far the thigh swings to either side"
    hip_phase = 8, "when in the stride the thigh swings forward"
    hip_offset = 9, "where the thigh rests: positive is forward"
    knee_amplitude = 10, "how far the shank swings to either side"
    knee_phase = 11, "how far the shank is ahead of its thigh in the stride"
    knee_offset = 12, "where the shank rests: positive is forward"
    stride = 13, "how far the right leg is behind the left in the stride; half a turn is a trot"


class Camera(Choice):
    """From where a walk is watched."""

    side = 0, "beside the robot, level"
    front = 1, "ahead of it, looking back"
    top = 2, "from straight above"
    chase = 3, "behind and above, following"
    orbit = 4, "slowly round the robot"


class Terrain(Domain, frozen=True):
    """The ground, and the forces over it."""

    structure: Structure = one_of(Structure.flat, about="the shape of the ground")
    incline: float = quantity(
        10.0, low=-30.0, high=30.0, unit="deg", about="the slope of the incline structure; positive is uphill"
    )
    step_height: float = quantity(0.08, low=0.01, high=0.4, unit="m", about="the rise of each stair")
    step_depth: float = quantity(0.4, low=0.1, high=2.0, unit="m", about="the tread of each stair, along the way")
    gravity: tuple[float, float, float] = vector(
        (0.0, 0.0, -9.81), low=-30.0, high=30.0, unit="m/s²", about="the pull on everything; z is up"
    )


class Robot(Domain, frozen=True):
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
        if self.leg_pairs[0] > self.leg_pairs[1]:
            faults.append(f"Robot.legs is {self.legs}; legs come in pairs, so it must hold an even number between.")
        if self.leg_pairs[0] > most:
            faults.append(
                f"Robot.legs asks for {self.legs[0]} legs or more, but Robot.segments allows {most} segments, "
                f"each with one pair: {2 * most} legs at most."
            )
        if fewest * shortest > long + _TINY:
            faults.append(
                f"Robot.segments and Robot.segment_length ask for {fewest} × {shortest:g} = {fewest * shortest:g} m "
                f"or more, but Robot.body_length allows {long:g} m."
            )
        if most * longest < short - _TINY:
            faults.append(
                f"Robot.segments and Robot.segment_length allow {most} × {longest:g} = {most * longest:g} m at most, "
                f"but Robot.body_length asks for {short:g} m or more."
            )
        if not faults and self.segment_range[0] > self.segment_range[1]:
            faults.append(
                f"Robot.segments, Robot.legs, Robot.body_length and Robot.segment_length cannot hold together: a body "
                f"of {short:g} to {long:g} m from segments of {shortest:g} to {longest:g} m with {self.legs[0]} legs "
                f"or more needs at least {self.segment_range[0]} segments, and at most {self.segment_range[1]} fit."
            )
        if faults:
            raise ValueError("\n".join(faults))
        return self


class Algorithm(Domain, frozen=True):
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


class Simulation(Domain, frozen=True):
    """How long a walk is, how finely it is computed, and how it is judged and watched."""

    duration: float = quantity(8.0, low=1.0, high=120.0, unit="s", about="the length of the measured walk")
    timestep: float = quantity(0.005, low=0.0005, high=0.01, unit="s", about="the step of the physics")
    camera: Camera = one_of(Camera.side, about="from where a walk is watched")
    max_speed: float = quantity(
        10.0, low=1.0, high=1000.0, unit="body lengths/s", about="the speed over which a walk does not count"
    )
    max_airborne: float = quantity(
        0.5, low=0.05, high=1000.0, unit="s", about="the time off the ground over which a walk does not count"
    )


class Settings(SettingsModel, frozen=True):
    """All that a run is made from."""

    terrain: Terrain = Terrain()
    robot: Robot = Robot()
    algorithm: Algorithm = Algorithm()
    simulation: Simulation = Simulation()

    def with_(self, **changes: Any) -> Self:
        """Return a copy with some settings changed, each named alone: ``s.with_(selection="top_half", duration=4)``.

        A whole domain may be named as well: ``s.with_(terrain=Terrain(structure="stairs"), duration=4)``.

        Raises:
            SettingsError: if no domain has such a setting, or the value will not do.
        """
        owners, faults = self._owners(), list[str]()
        parts: dict[str, Any] = dict(self)
        for name in sorted(changes, key=owners.__contains__):  # whole domains come first
            if name in owners:
                parts[owners[name]] = dict(parts[owners[name]]) | {name: changes[name]}
                continue
            try:
                parts[name] = self._domain(name, changes[name])
            except ValueError as fault:  # the others are held against the domain as it was
                faults.append(str(fault))
        with told_with(faults):
            return type(self)(**parts)

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
            if isinstance(declared, OneOf) and str(value) in declared.choices.__members__
        ]
        guess = f" Did you mean {name}={kind.__name__}({fields[0]}={value!r})?" if fields else ""
        raise ValueError(
            f"Settings.{name} is {value!r}; it must be a {kind.__name__}, or a dict of its settings.{guess}"
        )

    @classmethod
    def advice(cls, name: str) -> str:
        """Say what might have been meant by a name that there is not, looking into the domains as well."""
        owners = cls._owners()
        if name in owners:
            return f" It is one of {owners[name]}: {owners[name]}={owners[name].capitalize()}({name}=…)."
        return did_you_mean(name, [*cls.model_fields, *owners]) or super().advice(name)

    @classmethod
    def _owners(cls) -> dict[str, str]:
        """Say for each single setting of which domain it is."""
        return {name: domain for domain, field in cls.model_fields.items() for name in dict(field.default)}
