"""The controls of the form as plain data, one for each setting, made from its declaration."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any, TypeAlias, cast

from walkerlab.settings.fields import MIN_MAX, FieldDeclaration, OneOf, Quantity
from walkerlab.settings.glossary import GROUND_DRAWING, glossary_rows
from walkerlab.settings.model import Domain
from walkerlab.settings.settings import Settings
from walkerlab.settings.terms import explain_term

Control: TypeAlias = dict[str, Any]
"""What the browser needs to know about one setting.

``name``, ``label``, ``about``, ``default``, ``default_text``, ``hidden_if_unused``, ``term`` and ``unit_term``
(explanations of its name and its unit) and a ``kind``: ``slider`` (with unit, low, high and stops), ``range`` (the
same, with two thumbs), ``vector`` (the same, with named components and presets), ``number`` (typed or random),
``choice`` (one of several options), ``sequence`` (options applied one after the other) or ``flags`` (any of the
options).
"""

Values: TypeAlias = Mapping[str, Mapping[str, Any]]
"""Settings as plain data, keyed by domain and field."""

FUNCTION_PREFIX = "ƒ "
"""Prefix of the names of user functions; no built-in option starts with it."""

MAX_SLIDER_RANGE = 100_000  # difference of the limits, above which whole numbers are typed
MIN_LOG_RATIO = 100  # ratio of the limits, from which the stops of a slider are logarithmic
HIDDEN_IF_UNUSED = {
    *("incline", "step_height", "step_depth", "hill_height", "hill_length", "gap_width", "gap_distance"),
    *("obstacle_size", "obstacle_density", "favored_gene", "record"),
}
"""Settings that apply to one option only; they are hidden while another one is selected."""

MAX_BUTTONS = 5  # maximum number of options that are shown as buttons; more are shown in a menu
MANTISSAS = [*range(10, 20), *range(20, 50, 2), *range(50, 100, 5)]
AXIS_DIRECTIONS = {"x": "forward", "y": "left", "z": "up"}
LABELS = {
    "terrain.seed": "terrain seed",
    "algorithm.seed": "evolution seed",
    "simulation.starts": "starts per robot",
    "simulation.forgive": "forgive guards",
}
"""Labels of the settings whose names are not clear without their domain."""

SETTING_NAME = re.compile(rf"\b({'|'.join(name.capitalize() for name in Settings.model_fields)})\.(\w+)")
"""Name of a setting in error messages: ``Terrain.step_height``."""


def make_controls(domain: type[Domain], functions: Mapping[str, Sequence[str]] | None = None) -> list[Control]:
    """Create a control for each setting of a domain, in the order of their declaration.

    Args:
        domain: Class of the domain.
        functions: Names of the user functions that are additional options, such as ``"ƒ my_selection"``, keyed by
            field.
    """
    defaults = domain().model_dump()
    rows = {row.name: row for row in glossary_rows(domain())}
    return [
        {
            "name": name,
            "label": setting_label(name, domain.__name__.lower()),
            "about": use_labels(declared.about),
            "term": explain_term(name),
            "unit_term": explain_term(getattr(declared, "unit", "")),
            "default": defaults[name],
            "default_text": rows[name].default,
            "hidden_if_unused": name in HIDDEN_IF_UNUSED,
        }
        | _kind_of_control(declared, defaults[name], (functions or {}).get(name, ()))
        for name, declared in domain.declared().items()
    ]


def _kind_of_control(declared: FieldDeclaration, default: Any, functions: Sequence[str]) -> Control:
    """Return the kind of control of a setting, and the entries that this kind requires."""
    if isinstance(declared, OneOf):
        options = [
            {"name": member.name, "about": use_labels(member.about.lstrip(GROUND_DRAWING))}
            for member in declared.choices
        ] + [{"name": name, "about": "your function"} for name in functions]
        if declared.several and not declared.functions:
            return {"kind": "flags", "options": [option for option in options if option["name"] != "none"]}
        if declared.several:
            return {"kind": "sequence", "options": options}
        return {"kind": "choice", "options": options, "as_buttons": len(options) <= MAX_BUTTONS}
    numbers: Control = {"unit": declared.unit, "low": declared.low, "high": declared.high, "whole": declared.whole}
    if declared.whole and declared.high - declared.low > MAX_SLIDER_RANGE:
        return {"kind": "number"} | numbers
    vectors = [default if declared.components else [default], *declared.presets.values()]
    numbers["stops"] = slider_stops(declared, {number for vector in vectors for number in vector})
    if not declared.components:
        return {"kind": "slider"} | numbers
    if declared.components == MIN_MAX:
        return {"kind": "range"} | numbers
    presets = [{"name": name, "value": list(value)} for name, value in declared.presets.items()]
    directions = [AXIS_DIRECTIONS[component] for component in declared.components]
    return {"kind": "vector", "directions": directions, "presets": presets} | numbers


def slider_stops(declared: Quantity, required: set[float]) -> list[float]:
    """Return the round numbers at which a slider stops, in ascending order from the lower to the upper limit.

    They are equidistant, or logarithmic over a wide range of positive numbers.

    Args:
        declared: Setting of the slider.
        required: Numbers that are stops even if they are not round, such as the default.
    """
    low, high = declared.low, declared.high
    start = low or high / 1000  # from 0, the logarithmic stops start at a thousandth of the upper limit
    if (low > 0 and high / low >= MIN_LOG_RATIO) or (low == 0 and high >= MIN_LOG_RATIO):
        decades = range(math.floor(math.log10(start)), math.ceil(math.log10(high)) + 1)
        found = {mantissa * 10.0 ** (decade - 1) for decade, mantissa in product(decades, MANTISSAS)}
        found = {number for number in found if number >= start}
    else:
        step = round_up((high - low) / 100)
        found = {step * n for n in range(math.ceil(low / step), math.floor(high / step) + 1)}
    exact = {float(f"{number:.9g}") for number in found}
    if declared.whole:
        exact = {number for number in exact if number == round(number)}
    return sorted({number for number in exact if low <= number <= high} | required | {low, high})


def round_up(number: float) -> float:
    """Return the smallest of …, 0.1, 0.2, 0.5, 1, 2, 5, 10, … that is not less than the given number."""
    power = 10.0 ** math.floor(math.log10(number))
    return next(power * digit for digit in (1, 2, 5, 10) if power * digit >= number * (1 - 1e-9))


def setting_label(name: str, domain: str = "") -> str:
    """Return the label of a setting: "elites" for ``n_elites``.

    Args:
        name: Name of the field.
        domain: Name of the domain; required for the names in ``LABELS``.
    """
    return LABELS.get(f"{domain}.{name}", name.removeprefix("n_").replace("_", " "))


def use_labels(message: str) -> str:
    """Replace the names of settings in a message with their labels."""
    labelled = SETTING_NAME.sub(lambda found: setting_label(found[2], found[1].lower()), message)
    return labelled[:1].upper() + labelled[1:] if SETTING_NAME.match(message) else labelled


# --------------------------------------------------------------------------------------------- unused settings


def unused_settings(values: Values) -> dict[str, str]:
    """Return the settings that have no effect with the other values, and why.

    Returns:
        Reasons, keyed by setting: ``{"terrain.step_height": "only for stairs"}``.
    """
    return {setting: reason for setting, (reason, is_used) in _USE_CONDITIONS.items() if not is_used(values)}


def _chosen_names(values: Values, setting: str) -> set[str]:
    """Return the names of the chosen options; a browser may have sent any value."""
    domain, _, field = setting.partition(".")
    chosen = values.get(domain, {}).get(field)
    return {str(option) for option in (cast(list[object], chosen) if isinstance(chosen, list) else [chosen])}


def _if_chosen(setting: str, *names: str) -> Callable[[Values], bool]:
    """Return the condition that one of the given options, or a user function, is chosen."""
    return lambda values: any(
        name in names or name.startswith(FUNCTION_PREFIX) for name in _chosen_names(values, setting)
    )


def _unless_chosen(setting: str, name: str) -> Callable[[Values], bool]:
    """Return the condition that neither the given option nor a user function is chosen."""
    return lambda values: not _if_chosen(setting, name)(values)


def _not_only(setting: str, *names: str) -> Callable[[Values], bool]:
    """Return the condition that an option other than the given ones is chosen."""
    return lambda values: not _chosen_names(values, setting) <= {*names}


def _has_random_terrain(values: Values) -> bool:
    """Return whether a part of the terrain is random."""
    return any(is_used(values) for is_used in (_is_rough, _has_texture, _has_obstacles))


_has_stairs = _if_chosen("terrain.structure", "stairs")
_is_rough = _if_chosen("terrain.structure", "rough")
_has_gaps = _if_chosen("terrain.structure", "gaps")
_has_texture = _not_only("terrain.texture_density", "0", "0.0")
_has_obstacles = _not_only("terrain.obstacle", "none")

_USE_CONDITIONS: dict[str, tuple[str, Callable[[Values], bool]]] = {
    "terrain.incline": ("only for incline", _if_chosen("terrain.structure", "incline")),
    "terrain.step_height": ("only for stairs", _has_stairs),
    "terrain.step_depth": ("only for stairs", _has_stairs),
    "terrain.hill_height": ("only for rough", _is_rough),
    "terrain.hill_length": ("only for rough", _is_rough),
    "terrain.gap_width": ("only for gaps", _has_gaps),
    "terrain.gap_distance": ("only for gaps", _has_gaps),
    "terrain.texture_size": ("density is 0", _has_texture),
    "terrain.obstacle_size": ("no obstacles", _has_obstacles),
    "terrain.obstacle_density": ("no obstacles", _has_obstacles),
    "terrain.seed": ("nothing is random", _has_random_terrain),
    "algorithm.mutation_scale": ("unused by macro", _not_only("algorithm.mutation", "macro")),
    "algorithm.favored_gene": ("only for favored", _if_chosen("algorithm.mutation", "favored")),
    "simulation.record": ("only for functions", _if_chosen("algorithm.fitness")),
    "simulation.max_speed": ("too fast forgiven", _unless_chosen("simulation.forgive", "too_fast")),
    "simulation.max_airborne": ("airborne forgiven", _unless_chosen("simulation.forgive", "airborne")),
}
"""Reason why a setting can be unused, and the condition under which it is used, keyed by setting."""
