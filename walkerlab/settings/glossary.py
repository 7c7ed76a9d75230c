"""Settings in words: what each is, what was chosen, and what differs from the default."""

from dataclasses import dataclass
from typing import Any, cast

from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import PAIR, Declared, OneOf
from walkerlab.settings.model import Domain
from walkerlab.settings.values import function_name, number_text, shown_numbers
from walkerlab.text.html import Html, details, join, shown, table, tag

DRAWN = "_-‾/\\┌─ "  # what grounds are drawn with before their words, which are enough here


@dataclass(frozen=True)
class Row:
    """One setting in words.

    Attributes:
        name: of the field.
        value: as people read it, with its unit: ``0.05 m``, ``3 to 12 kg``, ``(0, 0, -1.62) m/s², moon``, ``gradient``.
        about: what it is.
        choice: a sentence on what was chosen; "" for a number.
        default: as ``value``.
        changed: whether the two differ.
    """

    name: str
    value: str
    about: str
    choice: str
    default: str
    changed: bool


class ShownDomain(Domain, frozen=True):
    """The settings of one thing, as a notebook shows them."""

    def _repr_html_(self) -> str:
        return shown(glossary(self, unfold=True))


def rows_of(domain: Domain) -> list[Row]:
    """Say each setting in words, in the order in which they were declared."""
    defaults = {name: field.default for name, field in type(domain).model_fields.items()}
    return [
        Row(
            name=name,
            value=_in_words(declared, getattr(domain, name)),
            about=declared.about,
            choice=_about(getattr(domain, name)) if isinstance(declared, OneOf) else "",
            default=_in_words(declared, defaults[name]),
            changed=getattr(domain, name) != defaults[name],
        )
        for name, declared in domain.declared().items()
    ]


def glossary(domain: Domain, *, unfold: bool = False) -> Html:
    """Write a domain as a table for people: what differs from the default first and bold, the rest folded away.

    Args:
        domain: any of the four.
        unfold: whether all is to be seen at once if nothing differs.
    """
    rows, name = rows_of(domain), type(domain).__name__
    changed, others = ([row for row in rows if row.changed is which] for which in (True, False))
    if not changed and unfold:
        return _glossary(f"{name}: as by default", others)
    if not changed:
        return details(join(tag("b", name), ": as by default"), _glossary(name, others))
    the_rest = details(f"{len(others)} more of {name}, as by default", _glossary(name, others)) if others else ""
    return join(_glossary(f"{name}: what differs from the default (●)", changed), the_rest)


def _glossary(caption: str, rows: list[Row]) -> Html:
    columns = ["setting", "value", "meaning", *(["default"] if rows[0].changed else [])]
    lines = (
        [
            f"●\N{NO-BREAK SPACE}{row.name}" if row.changed else row.name,
            row.value,
            f"{row.about}: {row.choice}" if row.choice else row.about,
            *([row.default] if row.changed else []),
        ]
        for row in rows
    )
    return table(caption, columns, lines, classes=["strong" if row.changed else "" for row in rows])


def _in_words(declared: Declared, value: Any) -> str:
    """Show a setting to people."""
    if isinstance(declared, OneOf):
        several = cast(tuple[Any, ...], value if isinstance(value, tuple) else (value,))
        return ", ".join(one.name if isinstance(one, Choice) else function_name(one) for one in several)
    if not declared.parts:
        return f"{number_text(value)}{declared.its_unit}"
    if declared.parts == PAIR:
        return f"{number_text(value[0])} to {number_text(value[1])}{declared.its_unit}"
    preset = next((f", {name}" for name, known in declared.presets.items() if known == value), "")
    return f"{shown_numbers(value)}{declared.its_unit}{preset}"


def _about(value: Any) -> str:
    """Say what a choice means: of several, each in turn; of a function, that it is one."""
    match value:
        case Choice():
            return value.about.lstrip(DRAWN)
        case tuple():
            return "; ".join(map(_about, cast(tuple[Any, ...], value)))
        case _:
            return f"the function {function_name(value)}"
