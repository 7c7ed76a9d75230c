"""API reference: entries made from docstrings, a list of all public names, and a warning for each without an entry."""

import inspect
from pydoc import locate
from types import ModuleType
from typing import cast

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.domains.python import PythonDomain
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxDirective
from sphinx.util.logging import getLogger
from sphinx.util.nodes import make_refnode

import walkerlab as wl
from extension.settings import markdown_table

logger = getLogger(__name__)


class Api(SphinxDirective):
    """Describe functions and classes from their docstrings.

    The argument is a public module, as in ``walkerlab.plots``; the content is the list of names, by default all that
    the module has.
    """

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the descriptions."""
        path = self.arguments[0]
        owner = cast(ModuleType, locate(path))
        names = " ".join(self.content).split() or _exported_names(owner)
        lines = [f".. auto{_directive(getattr(owner, name))}:: {path}.{name}" for name in names]
        return self.parse_text_to_nodes("\n".join(["```{eval-rst}", *lines, "```"]))


class PublicNames(SphinxDirective):
    """Show a table of all names of ``walkerlab`` with the first sentence about each."""

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        rows: list[list[str]] = []
        for name in dir(wl):
            summary, _, _ = (inspect.getdoc(getattr(wl, name)) or "").partition("\n")
            rows.append([f"{{py:obj}}`wl.{name} <walkerlab.{name}>`", summary.replace("``", "`")])
        return self.parse_text_to_nodes(markdown_table(["name", "meaning"], rows))


def warn_of_missing_names(_app: Sphinx, env: BuildEnvironment) -> None:
    """Log a warning for each public name that has no entry in the API reference."""
    described = cast(PythonDomain, env.get_domain("py")).objects
    for name in dir(wl):
        if f"walkerlab.{name}" not in described:
            logger.warning("docs/api has no entry for walkerlab.%s", name)


def link_short_name(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, content: nodes.TextElement
) -> nodes.reference | None:
    """Link a name without its module, as in ``Raises``, to the only entry with this name."""
    described = cast(PythonDomain, env.get_domain("py")).objects
    target = node["reftarget"]
    places = {(entry.docname, entry.node_id) for name, entry in described.items() if name.split(".")[-1] == target}
    if node["refdomain"] != "py" or len(places) != 1:
        return None
    ((page, anchor),) = places
    return make_refnode(app.builder, node["refdoc"], page, anchor, content)


def _exported_names(module: ModuleType) -> list[str]:
    """Return the functions and classes of a module that belong to walkerlab."""
    members = {name: value for name, value in vars(module).items() if not name.startswith("_")}
    return [
        name
        for name, value in members.items()
        if (inspect.isfunction(value) or inspect.isclass(value)) and value.__module__.startswith(wl.__name__)
    ]


def _directive(described: object) -> str:
    """Return the kind of a description: ``exception``, ``class`` or ``function``."""
    if not isinstance(described, type):
        return "function"
    return "exception" if issubclass(described, BaseException) else "class"


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives, and check the names when all pages have been read."""
    app.add_directive("api", Api)
    app.add_directive("public-names", PublicNames)
    app.connect("missing-reference", link_short_name)
    app.connect("env-check-consistency", warn_of_missing_names)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
