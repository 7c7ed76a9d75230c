"""Settings written as text: ``mutation_rate=0.3``, ``selection=tournament(size=7)``, ``legs=2,6``."""

import re
from functools import partial
from typing import Any

from walkerlab.commands.flags import parse_value
from walkerlab.genome.breeding import OPERATOR_MODULES
from walkerlab.settings.choices import Choice
from walkerlab.settings.model import SettingsError
from walkerlab.settings.values import did_you_mean

OPERATOR_TYPES: dict[str, type[Choice]] = {kind.__name__.lower(): kind for kind in OPERATOR_MODULES}
"""Kind of operator of each slot: ``selection``, ``crossover`` and ``mutation``."""

_COMMA = re.compile(r",(?![^(]*\))")
_SPACE = re.compile(r"\s+(?![^(]*\))")
_CALL = re.compile(r"(\w+)\((.*)\)")


def parse_condition(text: str) -> tuple[str, dict[str, Any]]:
    """Parse the name of a condition and its changed settings: ``gentle:selection=tournament(size=2) n_elites=0``.

    Args:
        text: Name, colon, and changed settings separated by spaces; the list of settings can be empty.

    Raises:
        SettingsError: If the text does not have this form, or there is no such operator.
    """
    name, colon, changes = text.partition(":")
    if not colon or not name.strip():
        raise SettingsError(
            f"condition {text!r} must have a name, a colon and changed settings, as in "
            '"harsh:selection=tournament(size=7)"; without changes: "default:"'
        )
    values: dict[str, Any] = {}
    for change in filter(None, _SPACE.split(changes.strip())):
        setting, equals, value = change.partition("=")
        if not equals or not value:
            raise SettingsError(f"condition {name!r}: {change!r} must be SETTING=VALUE, as in mutation_rate=0.3")
        setting = setting.replace("-", "_")
        values[setting] = parse_setting(setting, value)
    return name.strip(), values


def parse_setting(name: str, text: str) -> Any:
    """Parse the value of a setting; several values are separated by commas.

    Args:
        name: Name of the setting.
        text: Its value; an operator can have arguments: ``tournament(size=7)``.

    Raises:
        SettingsError: If there is no such operator.
    """
    parts = [_parse_part(name, part) for part in _COMMA.split(text)]
    return parts if len(parts) > 1 else parts[0]


def _parse_part(name: str, text: str) -> Any:
    """Parse one value, or an operator with arguments.

    Raises:
        SettingsError: If there is no such operator.
    """
    call = _CALL.fullmatch(text)
    if not call or name not in OPERATOR_TYPES:
        return parse_value(text)
    kind = OPERATOR_TYPES[name]
    if call[1] not in kind.__members__:
        raise SettingsError(
            f"{name}={text}: there is no operator {call[1]!r} for {name}; the operators are "
            f"{', '.join(kind.__members__)}.{did_you_mean(call[1], kind.__members__)}"
        )
    pairs = (pair.partition("=") for pair in call[2].split(",") if pair.strip())
    keywords = {keyword.strip(): parse_value(value.strip()) for keyword, _, value in pairs}
    return partial(getattr(OPERATOR_MODULES[kind], call[1]), **keywords)
