"""Tables of the settings and of their choices, made from the declarations of the fields."""

from typing import cast

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.domains.python import PythonDomain
from sphinx.util.docutils import SphinxDirective

import walkerlab as wl
from walkerlab.settings.choices import Choice
from walkerlab.settings.fields import FieldDeclaration, OneOf
from walkerlab.settings.glossary import GROUND_DRAWING, glossary_rows
from walkerlab.settings.model import Domain

ALTERNATIVES_IN_GUIDE = "/docs/operators.md"


class SettingsTable(SphinxDirective):
    """Describe a class of settings: the unit, range, default and meaning of each field. The argument is its name."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the description of the class."""
        domain: type[Domain] = getattr(wl, self.arguments[0])
        names = {place: name for name, place in wl.Settings.field_locations().items()}
        rows: list[list[str]] = []
        for row, declared in zip(glossary_rows(domain()), domain.declared().values(), strict=True):
            name = names[domain.__name__.lower(), row.name]
            alias = f"<br>(`{name}` in `with_`)" if name != row.name else ""
            unit = getattr(declared, "unit", "")
            default = row.default.replace(f" {unit}", "") if unit else f"`{row.default}`"
            rows.append([f"`{row.name}`{alias}", unit, _range(declared), default, row.about])
        table = markdown_table(["setting", "unit", "range", "default", "meaning"], rows)
        described = self.parse_text_to_nodes(_class_text(domain, f"{domain.summary()}\n\n{table}"))
        (found,) = (node for part in described for node in part.findall(nodes.table))
        found["classes"].append("settings")
        for setting, line in zip(domain.declared(), list(found.findall(nodes.row))[1:], strict=True):
            name = f"walkerlab.{domain.__name__}.{setting}"  # so that links and the search find each setting
            line["ids"].append(name)
            cast(PythonDomain, self.env.get_domain("py")).note_object(name, "attribute", name, location=line)
        return described


class ChoiceTable(SphinxDirective):
    """Describe an enumeration: the name, code and meaning of each member. The argument is its name."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the description of the class."""
        choices: type[Choice] = getattr(wl, self.arguments[0])
        rows = [[f"`{choice.name}`", str(choice.value), choice.about.lstrip(GROUND_DRAWING)] for choice in choices]
        summary, _, _ = (choices.__doc__ or "").partition("\n")
        table = markdown_table(["name", "code", "meaning"], rows)
        return self.parse_text_to_nodes(_class_text(choices, f"{summary}\n\n{table}"))


def markdown_table(head: list[str], rows: list[list[str]]) -> str:
    """Write a table in Markdown; vertical bars in the cells are escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


def _class_text(described: type, content: str) -> str:
    name = described.__name__
    return f"::::{{py:class}} walkerlab.{name}\n:canonical: {described.__module__}.{name}\n\n{content}\n::::"


def _range(declared: FieldDeclaration) -> str:
    """Write the allowed values without the unit, which has a column; choices as a link to their table."""
    if isinstance(declared, OneOf):
        name = declared.choices.__name__
        some = "one or several of" if declared.several else "one of"
        or_function = f", or [your function]({ALTERNATIVES_IN_GUIDE})" if declared.functions else ""
        return f"{some} {{py:class}}`~walkerlab.{name}`{or_function}"
    numbers = declared.range.removesuffix(declared.unit_suffix)
    components = f"{', '.join(declared.components)}: " if declared.components else ""
    presets = f", or {', '.join(f'`{name}`' for name in declared.presets)}" if declared.presets else ""
    return f"{components}{numbers}{presets}"


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("settings-table", SettingsTable)
    app.add_directive("choice-table", ChoiceTable)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
