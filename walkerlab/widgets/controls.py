"""The controls of the form as plain data: one for each setting, made from what was declared of it."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any, TypeAlias, cast

from walkerlab.settings.fields import PAIR, Declared, OneOf, Quantity
from walkerlab.settings.glossary import GROUND_DRAWING, rows_of
from walkerlab.settings.model import Domain
from walkerlab.settings.settings import Settings

Control: TypeAlias = dict[str, Any]
"""What a browser needs to know of one setting.

name, label, about, default and ``usual`` (the default in words), and a ``kind``:
``slider`` (with unit, low, high and stops), ``range`` (the same, of two thumbs), ``vector`` (the same, of named parts,
with presets), ``number`` (typed, or drawn by chance), ``choice`` (one of options), ``turns`` (options applied in turn)
or ``flags`` (any of the options).
"""

Values: TypeAlias = Mapping[str, Mapping[str, Any]]
"""Settings as plain data, by domain and field."""

OWN = "ƒ "
"""Put before the name of a function of the user's own, which no choice of ours has."""

MANY = 100_000  # whole numbers, among which a slider would find none
WIDE = 100  # times the least value that the greatest must be, for each decade to have the same room
ALTERNATIVES = {"incline", "step_height", "step_depth", "hill_height", "hill_length", "gap_width", "gap_distance"}
"""Settings of one structure or another, of which only those of the chosen one are to be seen."""

FEW = 6  # options that have a button each; more are in a list
MANTISSAS = [*range(10, 20), *range(20, 50, 2), *range(50, 100, 5)]
WAYS = {"x": "forward", "y": "left", "z": "up"}
PLACE = re.compile(rf"\b({'|'.join(name.capitalize() for name in Settings.model_fields)})\.(\w+)")
"""How messages name a setting: ``Terrain.step_height``."""


def controls_of(kind: type[Domain], own: Mapping[str, Sequence[str]] | None = None) -> list[Control]:
    """Make a control for each setting of a domain, in the order in which they were declared.

    Args:
        kind: the domain.
        own: by field, the user's own functions that can be chosen too, as ``"ƒ my_selection"``.
    """
    plain, rows = kind().model_dump(), {row.name: row for row in rows_of(kind())}
    return [
        {
            "name": name,
            "label": label(name),
            "about": in_words(declared.about),
            "default": plain[name],
            "usual": rows[name].default,
            "alternative": name in ALTERNATIVES,
        }
        | _fit_for(declared, plain[name], (own or {}).get(name, ()))
        for name, declared in kind.declared().items()
    ]


def _fit_for(declared: Declared, default: Any, own: Sequence[str]) -> Control:
    """Say which kind of control a setting has, and what that kind needs."""
    if isinstance(declared, OneOf):
        options = [
            {"name": member.name, "about": in_words(member.about.lstrip(GROUND_DRAWING))} for member in declared.choices
        ] + [{"name": name, "about": "a function of your own"} for name in own]
        if declared.several and not declared.functions:
            return {"kind": "flags", "options": [option for option in options if option["name"] != "none"]}
        return {"kind": "turns" if declared.several else "choice", "options": options, "few": len(options) <= FEW}
    numbers: Control = {"unit": declared.unit, "low": declared.low, "high": declared.high, "whole": declared.whole}
    if declared.whole and declared.high - declared.low > MANY:
        return {"kind": "number"} | numbers
    known = [default if declared.parts else [default], *declared.presets.values()]
    numbers["stops"] = stops(declared, {number for one in known for number in one})
    if not declared.parts:
        return {"kind": "slider"} | numbers
    if declared.parts == PAIR:
        return {"kind": "range"} | numbers
    presets = [{"name": name, "value": list(value)} for name, value in declared.presets.items()]
    return {"kind": "vector", "parts": [WAYS[part] for part in declared.parts], "presets": presets} | numbers


def stops(declared: Quantity, known: set[float]) -> list[float]:
    """Return the round numbers at which a slider stops, from the least to the greatest value.

    They are evenly spread; over a wide range of positive numbers each decade has the same room instead.

    Args:
        declared: the range.
        known: numbers that are stops as well, round or not: the default, for one.
    """
    low, high = declared.low, declared.high
    start = low or high / 1000  # nothing at all, then decades
    if (low > 0 and high / low >= WIDE) or (low == 0 and high >= WIDE):
        decades = range(math.floor(math.log10(start)), math.ceil(math.log10(high)) + 1)
        found = {mantissa * 10.0 ** (decade - 1) for decade, mantissa in product(decades, MANTISSAS)}
        found = {number for number in found if number >= start}
    else:
        step = _round_up((high - low) / 100)
        found = {step * n for n in range(math.ceil(low / step), math.floor(high / step) + 1)}
    exact = {float(f"{number:.9g}") for number in found}
    if declared.whole:
        exact = {number for number in exact if number == round(number)}
    return sorted({number for number in exact if low <= number <= high} | known | {low, high})


def _round_up(number: float) -> float:
    """Return the next of 1, 2, 5, 10, 20 … and of 0.5, 0.2, 0.1 … that is not under a number."""
    power = 10.0 ** math.floor(math.log10(number))
    return next(power * digit for digit in (1, 2, 5, 10) if power * digit >= number * (1 - 1e-9))


def label(name: str) -> str:
    """Name a setting as people do: ``n_elites`` is "elites"."""
    return name.removeprefix("n_").replace("_", " ")


def in_words(message: str) -> str:
    """Name settings as their labels do, where a message names them as in code."""
    told = PLACE.sub(lambda found: label(found[2]), message)
    return told[:1].upper() + told[1:] if PLACE.match(message) else told


# ------------------------------------------------------------------------------- which settings matter now


def idle(values: Values) -> dict[str, str]:
    """Say which settings change nothing as the others are, and why: ``{"terrain.step_height": "only for stairs"}``."""
    return {place: why for place, (why, matters) in _MATTERS.items() if not matters(values)}


def _names(values: Values, place: str) -> set[str]:
    """Return what is chosen, by name; a browser may have sent anything."""
    domain, _, field = place.partition(".")
    chosen = values.get(domain, {}).get(field)
    return {str(one) for one in (cast(list[object], chosen) if isinstance(chosen, list) else [chosen])}


def _with(place: str, *names: str) -> Callable[[Values], bool]:
    """Return whether one of some choices, or a function of the user's own, is chosen."""
    return lambda values: any(one in names or one.startswith(OWN) for one in _names(values, place))


def _without(place: str, *names: str) -> Callable[[Values], bool]:
    """Return whether anything but some choices is chosen."""
    return lambda values: not _names(values, place) <= {*names}


def _scattered(values: Values) -> bool:
    """Return whether any of the ground is left to chance."""
    return any(matters(values) for matters in (_ROUGH, _TEXTURED, _OBSTACLES))


_STAIRS, _ROUGH, _GAPS = (_with("terrain.structure", name) for name in ("stairs", "rough", "gaps"))
_TEXTURED, _OBSTACLES = _without("terrain.texture_density", "0", "0.0"), _without("terrain.obstacle", "none")

_MATTERS: dict[str, tuple[str, Callable[[Values], bool]]] = {
    "terrain.incline": ("only for incline", _with("terrain.structure", "incline")),
    "terrain.step_height": ("only for stairs", _STAIRS),
    "terrain.step_depth": ("only for stairs", _STAIRS),
    "terrain.hill_height": ("only for rough", _ROUGH),
    "terrain.hill_length": ("only for rough", _ROUGH),
    "terrain.gap_width": ("only for gaps", _GAPS),
    "terrain.gap_distance": ("only for gaps", _GAPS),
    "terrain.texture_size": ("density is 0", _TEXTURED),
    "terrain.obstacle_size": ("no obstacles", _OBSTACLES),
    "terrain.obstacle_density": ("no obstacles", _OBSTACLES),
    "terrain.seed": ("nothing by chance", _scattered),
    "algorithm.mutation_scale": ("macro needs none", _without("algorithm.mutation", "macro")),
    "algorithm.favored_gene": ("only for favored", _with("algorithm.mutation", "favored")),
    "simulation.max_speed": ("its guard is off", lambda values: not _with("simulation.forgive", "too_fast")(values)),
    "simulation.max_airborne": ("its guard is off", lambda values: not _with("simulation.forgive", "airborne")(values)),
}
"""By setting, why it may not matter, and whether it does."""
