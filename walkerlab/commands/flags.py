"""The settings as flags: made from their declarations, so that none can be missing, or say what is not so."""

import argparse
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import Declared, OneOf, Quantity
from walkerlab.settings.model import Domain, report_together
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import number_text
from walkerlab.system.files import PathError, absolute_path

NEGATIVE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)
"""How a word begins that is a number for Python, and no flag."""

DOMAINS: dict[str, type[Domain]] = {name: type(domain) for name, domain in Settings()}


class Help(argparse.HelpFormatter):
    """Help in which a flag that takes several values names each of them: ``--segments MIN MAX``."""

    def _format_args(self, action: argparse.Action, default_metavar: str) -> str:
        several = isinstance(action.metavar, str) and action.nargs == "+"
        return str(action.metavar) if several else super()._format_args(action, default_metavar)


def path_of(text: str) -> Path:
    """Read the path of a file or folder."""
    try:
        return absolute_path(text, "the path")
    except PathError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def flag_names() -> dict[tuple[str, str], str]:
    """Name the flag of each setting: ``("terrain", "step_height")`` is ``--step-height``."""
    return {place: f"--{word.replace('_', '-')}" for word, place in Settings.places().items()}


def add_flags(parser: argparse.ArgumentParser) -> None:
    """Give a parser a flag for each setting, grouped by domain; what is not given leaves no trace."""
    parser._negative_number_matcher = NEGATIVE  # argparse by itself takes -1. and -1e5 for flags
    groups = {domain: parser.add_argument_group(domain, model.summary()) for domain, model in DOMAINS.items()}
    for (domain, field), flag in flag_names().items():
        model = DOMAINS[domain]
        declared, default = model.declared()[field], model.model_fields[field].default
        groups[domain].add_argument(
            flag,
            dest=f"{domain}.{field}",
            type=_value,
            nargs="+" if _takes_several(declared) else None,
            metavar=_metavar(declared),
            help=f"{declared.about}: {declared.range} [{_show(default)}]".replace("%", "%%"),
            default=argparse.SUPPRESS,
        )


def settings_of(given: Mapping[str, Any], strangers: Sequence[str] = ()) -> Settings:
    """Make the settings from parsed flags.

    Args:
        given: by ``domain.field``; other keys are passed over.
        strangers: words that the parser did not know.

    Raises:
        SettingsError: with every fault of the call, a line each.
    """
    parts: dict[str, Any] = {domain: {} for domain in DOMAINS}
    for place, value in given.items():
        domain, dot, field = place.partition(".")
        if dot:
            parts[domain][field] = _named(value)
    with report_together(_refusals(strangers)):
        return Settings(**parts)


def _refusals(strangers: Sequence[str]) -> list[str]:
    """Say of each unknown flag (or word, if no flag is unknown) what it may have been meant to be."""
    known = list(flag_names().values())
    unknown = [word for word in strangers if word.startswith("--")] or strangers
    guesses = [get_close_matches(word, known, n=1) for word in unknown]
    return [
        f"There is no flag {word!r}. " + (f"Did you mean {guess[0]}?" if guess else "See: walkerlab evolve --help")
        for word, guess in zip(unknown, guesses, strict=True)
    ]


def _value(text: str) -> int | float | str:
    """Read a number where there is one; the settings judge whether it will do."""
    for number in (int, float):
        with suppress(ValueError):
            return number(text)
    return text


def _named(value: Any) -> Any:
    """Take a lone word out of its list: the name of a preset, as in ``--gravity moon``."""
    match value:
        case [str(name)]:
            return name
        case _:
            return value


def _takes_several(declared: Declared) -> bool:
    return bool(declared.parts) if isinstance(declared, Quantity) else declared.several


def _metavar(declared: Declared) -> str:
    match declared:
        case OneOf(several=True):
            return "NAME [NAME ...]"
        case OneOf():
            return "NAME"
        case Quantity(parts=()):
            return "N" if declared.whole else "X"
        case _:
            named = f" | {' | '.join(declared.presets)}" if declared.presets else ""
            return " ".join(part.upper() for part in declared.parts) + named


def _show(default: Any) -> str:
    match default:
        case Choice():
            return default.name
        case tuple():
            return " ".join(map(number_text, default))
        case _:
            return number_text(default)
