"""Conditions of an experiment: names, settings and optimisers, as users give them and as files store them."""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any, cast

from walkerlab.evolution.evolution import Evolution
from walkerlab.evolution.founders import read_founders
from walkerlab.evolution.rerating import function_facts
from walkerlab.evolution.stored_functions import check_storable, restore_settings
from walkerlab.experiment.optimisers import Optimiser
from walkerlab.ga.slots import unbound_keywords
from walkerlab.runfile.history import Founder, read_founder
from walkerlab.runfile.provenance import UNKNOWN_SOURCE, source_digest
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.choices import Camera, Choice
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import did_you_mean, function_name, number_text, short_repr
from walkerlab.simulation.fitness import check_user_function

MAX_NAME = 100  # characters
OPTIMISER_FACT = "optimiser function"


@dataclass(frozen=True)
class Condition:
    """One condition of an experiment.

    Attributes:
        name: Name of the condition.
        settings: Settings of its runs, apart from the seed.
        optimiser: Name of the optimiser; "" for the genetic algorithm.
        function: The optimiser; None for the genetic algorithm, and in an experiment that was read from a file.
        founders: Genomes given for generation 0.
    """

    name: str
    settings: Settings
    optimiser: str = ""
    function: Optimiser | None = None
    founders: tuple[Founder, ...] = ()

    def for_seed(self, seed: int) -> Settings:
        """Return the settings of the run with a seed."""
        return self.settings.with_(seed=seed)

    def to_plain(self) -> dict[str, Any]:
        """Return the condition as the file of an experiment stores it."""
        plain: dict[str, Any] = {
            "name": self.name,
            "optimiser": self.optimiser,
            "settings": self.for_seed(0).model_dump(),
        }
        if self.founders:
            plain["population"] = [asdict(founder) for founder in self.founders]
        return json.loads(json.dumps(plain))

    @classmethod
    def from_plain(cls, plain: dict[str, Any]) -> "Condition":
        """Return the condition that a file contains.

        Raises:
            TypeError: If a value is of the wrong type.
            KeyError: If a value is missing.
            ValueError: If a value is not allowed.
        """
        name, optimiser = plain["name"], plain["optimiser"]
        if not all(
            isinstance(text, str) and text.isprintable() and len(text) <= MAX_NAME for text in (name, optimiser)
        ):
            raise ValueError("the name of a condition is not a single line of text")
        founders = tuple(map(read_founder, plain.get("population", [])))
        return cls(name, restore_settings(plain["settings"]), optimiser, founders=founders)

    @property
    def world(self) -> object:
        """Terrain and simulation, without the camera: conditions with the same world are compared with each other."""
        return self.settings.terrain, self.settings.simulation.model_copy(update={"camera": Camera.side})

    def function_facts(self) -> dict[str, str]:
        """Return the name and the source digest of each user function."""
        facts = function_facts(self.settings)
        if self.function is not None:
            digest = source_digest(self.function) or UNKNOWN_SOURCE
            facts[OPTIMISER_FACT] = f"{self.optimiser} (source {digest})"
        return facts


def read_conditions(given: object, population: object = None) -> list[Condition]:
    """Check the conditions that a user gives, before anything runs.

    Args:
        given: Dict from names to ``Settings``, optimisers, or pairs of an optimiser and ``Settings``.
        population: Genomes for generation 0 of all conditions, or a dict from names of conditions to genomes.

    Raises:
        TypeError: If a condition is something else.
        SettingsError: If a name is not valid, or the conditions cannot be compared.
        ValueError: If ``population`` is not valid.
    """
    if not isinstance(given, Mapping) or not given:
        raise TypeError(
            'conditions must be a dict from names to settings, as in wl.compare({"gentle": a, "harsh": b}); got '
            f"{short_repr(given)}"
        )
    entries: dict[Any, Any] = dict(cast(Mapping[Any, Any], given))
    for name in entries:
        if not isinstance(name, str) or not name.strip() or not name.isprintable() or len(name) > MAX_NAME:
            raise SettingsError(
                f"a condition has the name {short_repr(name)}; it must be one line of 1 to {MAX_NAME} characters"
            )
    settings = [entry for entry in entries.values() if isinstance(entry, Settings)]
    conditions = [_read_condition(name, entry, settings) for name, entry in entries.items()]
    conditions = [replace(one, founders=founders) for one, founders in _read_populations(population, conditions)]
    for condition in conditions:
        if condition.function is None:
            Evolution(condition.settings, population=condition.founders or None)  # checks the user functions
        else:
            check_storable(condition.settings)
            check_user_function(condition.settings)
    first = conditions[0].settings.algorithm.fitness
    for condition in conditions:
        if (other := condition.settings.algorithm.fitness) != first:
            raise SettingsError(
                f"the conditions {conditions[0].name!r} and {condition.name!r} have different fitness "
                f"functions ({_value_name(first)} and {_value_name(other)}), whose values cannot be compared. Give all "
                "conditions the same fitness function."
            )
    return conditions


def _read_condition(name: str, entry: Any, settings: list[Settings]) -> Condition:
    match entry:
        case Settings():
            return Condition(name, entry)
        case (function, Settings() as own) if callable(function):
            return Condition(name, own, function_name(function), function)
        case _ if callable(entry) and not isinstance(entry, type):
            if not settings:
                raise SettingsError(
                    f"condition {name!r} is the optimiser {function_name(entry)}, and no condition has settings. Give "
                    f"them with it: {{{name!r}: ({function_name(entry)}, wl.Settings())}}"
                )
            if any(task_of(one) != task_of(settings[0]) for one in settings):
                raise SettingsError(
                    f"condition {name!r} is the optimiser {function_name(entry)}, and the other conditions differ in "
                    "the ground, the robots, the walk, the fitness or the number of evaluations, so it is unclear "
                    "which of their settings it should use. Give it settings of its own: "
                    f"{{{name!r}: ({function_name(entry)}, settings)}}"
                )
            return Condition(name, settings[0], function_name(entry), entry)
        case _:
            require_settings(entry)
            raise AssertionError


def _read_populations(given: Any, conditions: list[Condition]) -> Iterator[tuple[Condition, tuple[Founder, ...]]]:
    """Yield each condition with the genomes given for its generation 0.

    Raises:
        ValueError: If a name is not that of a condition, or the genomes are not valid.
    """
    names = [condition.name for condition in conditions]
    by_name = cast(Mapping[Any, Any], given) if isinstance(given, Mapping) else None
    for name in by_name or ():
        if name not in names:
            raise ValueError(
                f"population contains {short_repr(name)}, but there is no condition of this name. The conditions are "
                f"{', '.join(map(repr, names))}.{did_you_mean(name, names)}"
            )
    if isinstance(given, Iterator):
        given = list(cast(Iterator[Any], given))  # an iterator can be read only once
    for condition in conditions:
        genomes = given if by_name is None else by_name.get(condition.name)
        founders = read_founders(genomes, condition.settings)
        if founders and condition.function and "population" not in unbound_keywords(condition.function):
            raise ValueError(
                f"condition {condition.name!r} has a first population, but its optimiser {condition.optimiser} does "
                "not take it. Add the keyword-only parameter population, which receives genomes, shape (n, n_genes)."
            )
        yield condition, founders


def task_of(settings: Settings) -> object:
    """Return everything that affects an optimiser: all settings except the operators."""
    algorithm = settings.algorithm
    kept = ("fitness", "population_size", "generations", "n_elites")
    plain = Algorithm().model_copy(update={name: getattr(algorithm, name) for name in kept})
    return settings.model_copy(update={"algorithm": plain})


def read_seeds(given: object) -> list[int]:
    """Check the seeds that a user gives.

    Raises:
        TypeError: If they are not an iterable.
        SettingsError: If one is not a valid seed, or occurs twice, or there are none.
    """
    if isinstance(given, int) and not isinstance(given, bool):
        raise TypeError(f"seeds is {given}; it must be several seeds, as in seeds=range({given})")
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise TypeError(f"seeds must be whole numbers, as in seeds=range(10); got {short_repr(given)}")
    seeds = [Algorithm(seed=seed).seed for seed in cast(Iterable[Any], given)]
    if not seeds:
        raise SettingsError("seeds is empty; pass at least one, as in seeds=range(10)")
    if len(set(seeds)) < len(seeds):
        repeated = next(seed for seed in seeds if seeds.count(seed) > 1)
        raise SettingsError(
            f"seed {repeated} occurs twice in seeds; the same seed gives the same run, which adds no evidence"
        )
    return seeds


def grid(settings: Settings, values: Mapping[str, object]) -> dict[str, Settings]:
    """Return a condition for each combination of values: ``mutation_rate=0.02, selection=rank``.

    Args:
        settings: Settings that all conditions share.
        values: Values of each single setting that varies.

    Raises:
        TypeError: If the values of a setting are not a list.
        SettingsError: If a name or a value is not valid, or two conditions are equal.
    """
    if not values:
        raise TypeError("sweep needs a setting with several values, as in wl.sweep(s, mutation_rate=[0.02, 0.08])")
    for name, given in values.items():
        if not isinstance(given, Iterable) or isinstance(given, str | Mapping):
            raise TypeError(f"{name} is {short_repr(given)}; in a sweep it must be a list of values, as in {name}=[…]")
    lists = {name: list(cast(Iterable[Any], given)) for name, given in values.items()}
    for name, given in lists.items():
        for value in given:
            require_settings(settings).with_(**{name: value})  # reports an error in any value before the grid is made
    conditions: dict[str, Settings] = {}
    for combination in product(*lists.values()):
        changes = dict(zip(lists, combination, strict=True))
        changed = settings.with_(**changes)
        name = ", ".join(f"{setting}={_value_name(_value_of(changed, setting))}" for setting in changes)
        if name in conditions:
            raise SettingsError(
                f"two conditions of the sweep would be called {name!r}; leave out repeated values, and give functions "
                "different names, or use wl.compare with names of your own"
            )
        conditions[name] = changed
    return conditions


def _value_of(settings: Settings, name: str) -> Any:
    domain, field = settings.field_locations().get(name, ("", name))
    return getattr(getattr(settings, domain), field) if domain else getattr(settings, name)


def _value_name(value: Any) -> str:
    """Write the value of a setting in the name of a condition."""
    match value:
        case Choice():
            return value.name
        case tuple():
            return f"({', '.join(map(_value_name, cast(tuple[Any, ...], value)))})"
        case bool():
            return str(value)
        case int() | float():
            return number_text(value)
        case _ if callable(value):
            return function_name(value)
        case _:
            return short_repr(value)
