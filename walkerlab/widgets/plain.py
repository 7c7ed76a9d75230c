"""Settings as plain ipywidgets controls, for ``Interactive`` and for ipywidgets' ``interact`` and ``link``.

from ipywidgets import interact

@interact(height=wl.widgets.slider("step_height"))
def show(height): ...
"""

import math
from collections.abc import Iterable
from typing import Any

import ipywidgets

from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import MIN_MAX, OneOf, Quantity
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import did_you_mean, vector_text
from walkerlab.widgets.controls import MAX_BUTTONS, MAX_SLIDER_RANGE, round_up, setting_label, use_labels

DESCRIPTION_STYLE = {"description_width": "150px"}
LAYOUT = {"width": "480px"}


def slider(name: str, settings: Settings | None = None) -> Any:
    """Return a plain control for one setting, with its label, unit, range and meaning from the declaration.

    A number has a ``FloatSlider`` or an ``IntSlider``; a whole number without a practical upper limit has a
    ``BoundedIntText``. A range of numbers has a ``FloatRangeSlider`` or an ``IntRangeSlider``. A vector has a
    ``FloatsInput`` or, with presets, a ``Dropdown``. A choice of one option has ``ToggleButtons`` or, with many
    options, a ``Dropdown``; a choice of several options has a ``SelectMultiple``. The ``value`` of each control can be
    passed to ``settings.with_``. A slider updates its value when it is released, because a walk takes a moment to
    simulate; with ``control.continuous_update = True``, it updates its value while it moves.

    Args:
        name: Name of the setting, as for ``settings.with_``: ``"step_height"``, ``"terrain_seed"``.
        settings: Settings with the initial value; the defaults if None.

    Raises:
        ValueError: If there is no setting with this name, or its initial value is a user function or a list of
            operators.
    """
    domain, field = _locate(name)
    initial = getattr(settings or Settings(), domain)
    declared = type(initial).declared()[field]
    unit = getattr(declared, "unit", "")
    label = setting_label(field, domain)
    common: dict[str, Any] = {
        "description": f"{label} [{unit}]" if unit else label,
        "tooltip": use_labels(declared.about),
        "style": DESCRIPTION_STYLE,
        "layout": LAYOUT,
    }
    value = getattr(initial, field)
    if isinstance(declared, OneOf):
        return _choice_control(name, declared, value, common)
    default = type(initial).model_fields[field].default
    return _number_control(declared, value, slider_step(declared, default), common)


def sliders(names: Iterable[str], settings: Settings | None = None) -> dict[str, Any]:
    """Return a dict of plain controls, keyed by setting: ``interactive_output(show, wl.widgets.sliders([...]))``.

    Args:
        names: Names of the settings.
        settings: Settings with the initial values; the defaults if None.

    Raises:
        ValueError: As for ``slider``.
    """
    return {name: slider(name, settings) for name in names}


def _locate(name: str) -> tuple[str, str]:
    locations = Settings.field_locations()
    if name not in locations:
        raise ValueError(f"there is no setting {name!r}.{did_you_mean(name, locations)}")
    return locations[name]


def slider_step(declared: Quantity, default: float | tuple[float, ...]) -> float:
    """Return the step of a plain slider: a round number, about a hundredth of the range, that divides the default.

    Args:
        declared: Declaration of the setting.
        default: Default of the setting.
    """
    if declared.whole:
        return 1
    numbers = [*(default if isinstance(default, tuple) else (default,)), declared.high]
    step = round_up((declared.high - declared.low) / 100)
    while not all(math.isclose(n := (number - declared.low) / step, round(n), abs_tol=1e-6) for number in numbers):
        step = round_up(step / 2.5)
    return step


def _number_control(declared: Quantity, value: Any, step: float, common: dict[str, Any]) -> Any:
    limits = {"min": declared.low, "max": declared.high}
    if declared.components == MIN_MAX:
        kind = ipywidgets.IntRangeSlider if declared.whole else ipywidgets.FloatRangeSlider
        return kind(value=value, step=step, **_slider_traits(declared, step), **limits, **common)
    if declared.presets:
        options = {f"{preset} {vector_text(vector)}": vector for preset, vector in declared.presets.items()}
        known = {} if value in options.values() else {vector_text(value): value}
        return ipywidgets.Dropdown(options=options | known, value=value, **common)
    if declared.components:
        return ipywidgets.FloatsInput(value=list(value), format=".4g", **limits, **common)
    if declared.whole and declared.high - declared.low > MAX_SLIDER_RANGE:
        return ipywidgets.BoundedIntText(value=value, step=1, **limits, **common)
    kind = ipywidgets.IntSlider if declared.whole else ipywidgets.FloatSlider
    return kind(value=value, step=step, **_slider_traits(declared, step), **limits, **common)


def _slider_traits(declared: Quantity, step: float) -> dict[str, Any]:
    n_decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return {"continuous_update": False} | ({} if declared.whole else {"readout_format": f".{n_decimals}f"})


def _choice_control(name: str, declared: OneOf, value: Any, common: dict[str, Any]) -> Any:
    chosen = value if isinstance(value, tuple) else (value,)
    is_list = len(chosen) > 1 and declared.functions
    if is_list or any(not isinstance(one, Choice) for one in chosen):
        what = "a list of operators" if is_list else "a user function"
        raise ValueError(f"{name} is {what}, which a plain control cannot show; use wl.widgets.Form")
    options = [(choice.name.replace("_", " "), choice.name) for choice in declared.choices]
    names = tuple(one.name for one in chosen)
    if declared.several and not declared.functions:
        return ipywidgets.SelectMultiple(options=options, value=names, rows=5, **common)
    if len(options) <= MAX_BUTTONS:
        tooltips = [choice.about for choice in declared.choices]
        return ipywidgets.ToggleButtons(options=options, value=names[0], tooltips=tooltips, **common)
    return ipywidgets.Dropdown(options=options, value=names[0], **common)
