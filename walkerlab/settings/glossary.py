"""Tables of settings with values, meanings and defaults, as notebooks and reports show them."""

from dataclasses import dataclass
from typing import Any, cast

from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import MIN_MAX, FieldDeclaration, OneOf
from walkerlab.settings.model import Domain
from walkerlab.settings.values import function_name, number_text, vector_text
from walkerlab.text.templates import Markup, render

GROUND_DRAWING = "_-‾/\\┌─ "  # characters of the drawings in front of the sentences of ``Structure``


@dataclass(frozen=True)
class Row:
    """One setting as text.

    Attributes:
        name: Name of the field.
        value: Value with its unit: ``0.05 m``, ``3 to 12 kg``, ``(0, 0, -1.62) m/s², moon``, ``gradient``.
        about: Meaning of the setting.
        choice: Sentence about the chosen member; "" for a number.
        default: Default, written like ``value``.
        changed: Whether the value differs from the default.
    """

    name: str
    value: str
    about: str
    choice: str
    default: str
    changed: bool


class DisplayedDomain(Domain, frozen=True):
    """Domain that notebooks display as a table."""

    def _repr_html_(self) -> str:
        return render("text/output.html", content=[glossary(self, unfold=True)])


def glossary_rows(domain: Domain) -> list[Row]:
    """Return each setting as text, in the order of declaration."""
    defaults = {name: field.default for name, field in type(domain).model_fields.items()}
    return [
        Row(
            name=name,
            value=_value_text(declared, getattr(domain, name)),
            about=declared.about,
            choice=_choice_text(getattr(domain, name)) if isinstance(declared, OneOf) else "",
            default=_value_text(declared, defaults[name]),
            changed=getattr(domain, name) != defaults[name],
        )
        for name, declared in domain.declared().items()
    ]


def glossary(domain: Domain, *, unfold: bool = False) -> Markup:
    """Return a table of a domain: first the changed settings in bold, then the others, folded.

    Args:
        domain: Settings of one domain.
        unfold: Whether to show all settings unfolded if none is changed.
    """
    rows = glossary_rows(domain)
    return render(
        "settings/glossary.html",
        name=type(domain).__name__,
        changed=[row for row in rows if row.changed],
        others=[row for row in rows if not row.changed],
        unfold=unfold,
    )


def _value_text(declared: FieldDeclaration, value: Any) -> str:
    """Write the value of a setting with its unit; choices and functions by name."""
    if isinstance(declared, OneOf):
        items = cast(tuple[Any, ...], value if isinstance(value, tuple) else (value,))
        return ", ".join(item.name if isinstance(item, Choice) else function_name(item) for item in items)
    if not declared.components:
        return f"{number_text(value)}{declared.unit_suffix}"
    if declared.components == MIN_MAX:
        return f"{number_text(value[0])} to {number_text(value[1])}{declared.unit_suffix}"
    preset = next((f", {name}" for name, known in declared.presets.items() if known == value), "")
    return f"{vector_text(value)}{declared.unit_suffix}{preset}"


def _choice_text(value: Any) -> str:
    """Return the sentence about a choice, the joined sentences of several, or the name of a function."""
    match value:
        case Choice():
            return value.about.lstrip(GROUND_DRAWING)
        case tuple():
            return "; ".join(map(_choice_text, cast(tuple[Any, ...], value)))
        case _:
            return f"the function {function_name(value)}"
