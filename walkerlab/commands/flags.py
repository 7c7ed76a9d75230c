"""Command-line flags for all settings, created from their declarations."""

import argparse
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import FieldDeclaration, OneOf, Quantity
from walkerlab.settings.model import Domain, report_together
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import number_text
from walkerlab.system.files import PathError, absolute_path

NEGATIVE_NUMBER = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)
"""Start of an argument that is a negative number, not a flag."""

DOMAINS: dict[str, type[Domain]] = {name: type(domain) for name, domain in Settings()}


class HelpFormatter(argparse.HelpFormatter):
    """Help formatter that names each value of a flag with several values: ``--segments MIN MAX``."""

    def _format_args(self, action: argparse.Action, default_metavar: str) -> str:
        names_values = isinstance(action.metavar, str) and action.nargs == "+"
        return str(action.metavar) if names_values else super()._format_args(action, default_metavar)


def parse_path(text: str) -> Path:
    """Parse the path of a file or folder.

    Raises:
        ArgumentTypeError: If the text is not a valid path.
    """
    try:
        return absolute_path(text, "the path")
    except PathError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def flag_names() -> dict[tuple[str, str], str]:
    """Return the flag of each setting, such as ``--step-height`` for ``("terrain", "step_height")``."""
    return {place: f"--{word.replace('_', '-')}" for word, place in Settings.field_locations().items()}


def add_flags(parser: argparse.ArgumentParser) -> None:
    """Add a flag for each setting to a parser, grouped by domain; flags that are not given are not in the namespace."""
    parser._negative_number_matcher = NEGATIVE_NUMBER  # by default, argparse treats -1. and -1e5 as flags
    groups = {domain: parser.add_argument_group(domain, model.summary()) for domain, model in DOMAINS.items()}
    for (domain, field), flag in flag_names().items():
        model = DOMAINS[domain]
        declared = model.declared()[field]
        default = model.model_fields[field].default
        groups[domain].add_argument(
            flag,
            dest=f"{domain}.{field}",
            type=parse_value,
            nargs="+" if _takes_several(declared) else None,
            metavar=_metavar(declared),
            help=f"{declared.about}: {declared.range} [{_format_default(default)}]".replace("%", "%%"),
            default=argparse.SUPPRESS,
        )


STOP_FLAGS = {
    "--stop-after": ("after", "TIME", "begin no new generation after this time, such as 90s, 10min or 1h"),
    "--target": ("target", "X", "stop when the best fitness is this high"),
    "--patience": ("patience", "N", "stop after this number of generations without a fitter robot"),
}
"""Flag of each condition under which a run stops: field of ``Stop``, placeholder and help."""


def add_stop_flags(parser: argparse.ArgumentParser) -> None:
    """Add a flag for each condition under which a run stops."""
    for flag, (field, metavar, about) in STOP_FLAGS.items():
        parser.add_argument(flag, dest=f"stop_{field}", type=parse_value, metavar=metavar, help=about)


def stop_conditions(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the conditions under which a run stops, as arguments of ``Stop``; empty if there is no flag for any."""
    fields = [field for field, *_ in STOP_FLAGS.values()]
    return {field: values[f"stop_{field}"] for field in fields if values[f"stop_{field}"] is not None}


def build_settings(values: Mapping[str, Any], unknown_words: Sequence[str] = ()) -> Settings:
    """Create settings from parsed flags.

    Args:
        values: Value of each given setting, keyed by ``domain.field``; other keys are ignored.
        unknown_words: Arguments that the parser did not recognise.

    Raises:
        SettingsError: If a setting is invalid or an argument unknown; all errors are reported together, one per line.
    """
    domains: dict[str, Any] = {domain: {} for domain in DOMAINS}
    for place, value in values.items():
        domain, dot, field = place.partition(".")
        if dot:
            domains[domain][field] = _unpack_preset(value)
    with report_together(_describe_unknown(unknown_words)):
        return Settings(**domains)


def given_settings(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that have a flag, keyed by the name that ``Settings.with_`` takes.

    Args:
        values: Value of each given setting, keyed by ``domain.field``; other keys are ignored.
    """
    places = {f"{domain}.{field}": name for name, (domain, field) in Settings.field_locations().items()}
    return {places[place]: _unpack_preset(value) for place, value in values.items() if place in places}


def _describe_unknown(words: Sequence[str]) -> list[str]:
    """Describe each unknown flag, or each unknown word if no flag is unknown, with the most similar flag."""
    known = [*flag_names().values(), *STOP_FLAGS]
    unknown = [word for word in words if word.startswith("--")] or words
    guesses = [get_close_matches(word, known, n=1) for word in unknown]
    return [
        f"There is no flag {word!r}. "
        + (f"Did you mean {guess[0]}?" if guess else "List all flags: walkerlab evolve --help")
        for word, guess in zip(unknown, guesses, strict=True)
    ]


def parse_value(text: str) -> int | float | str:
    """Convert a string to a number if possible; the settings check the value."""
    for number in (int, float):
        with suppress(ValueError):
            return number(text)
    return text


def _unpack_preset(value: Any) -> Any:
    """Return the name of a preset without its list, as in ``--gravity moon``; any other value unchanged."""
    match value:
        case [str(name)]:
            return name
        case _:
            return value


def _takes_several(declared: FieldDeclaration) -> bool:
    return bool(declared.components) if isinstance(declared, Quantity) else declared.several


def _metavar(declared: FieldDeclaration) -> str:
    match declared:
        case OneOf(several=True):
            return "NAME [NAME ...]"
        case OneOf():
            return "NAME"
        case Quantity(components=()):
            return "N" if declared.whole else "X"
        case _:
            presets = f" | {' | '.join(declared.presets)}" if declared.presets else ""
            return " ".join(component.upper() for component in declared.components) + presets


def _format_default(default: Any) -> str:
    match default:
        case Choice():
            return default.name
        case tuple():
            return " ".join(map(number_text, default))
        case _:
            return number_text(default)
