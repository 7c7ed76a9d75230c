"""Docstrings and signatures of walkerlab as reStructuredText.

In a docstring, an indented block is code, and the section ``Returns`` contains no types. In a signature, aliases such
as ``Floats`` appear by name.
"""

import re
from collections.abc import Iterable, Iterator
from itertools import chain, takewhile
from typing import Any

import numpy as np
from docutils import nodes
from numpy.typing import ArrayLike, NDArray
from sphinx.addnodes import desc_annotation
from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, GoogleDocstring
from sphinx.util.inspect import signature, stringify_signature
from sphinx.util.typing import stringify_annotation
from traitlets import HasTraits

from walkerlab.ga import genes

MODES = ("fully-qualified-except-typing", "smart")  # of Sphinx, for full and for short names

ALIASES: dict[str, Any] = {
    f"~{genes.__name__}.Floats": genes.Floats,
    f"~{genes.__name__}.Indices": genes.Indices,
    "~numpy.typing.NDArray[bool]": NDArray[np.bool_],
    "str | ~numpy.typing.ArrayLike": str | ArrayLike,  # the union without the repetition of str
    "~numpy.typing.ArrayLike": ArrayLike,
}
"""Definition of each alias, keyed by its name."""

DEFINITIONS = {stringify_annotation(alias, mode): name for name, alias in ALIASES.items() for mode in MODES}
"""Name of each alias, keyed by the text of its definition."""

RESULT_FIELDS = {"Returns:": ":returns:", "Yields:": ":yields:"}
"""Field of reStructuredText for the result, keyed by the heading of its section."""

INDENT = " " * 4

NAPOLEON = Config(napoleon_use_ivar=True, napoleon_attr_annotations=False)


def name_aliases(
    _app: Sphinx, _what: str, _name: str, described: object, _options: object, arguments: str | None, result: str | None
) -> tuple[str | None, str | None]:
    """Replace definitions by names in a signature; use that of ``__init__`` for widgets, whose base class hides it."""
    if isinstance(described, type) and issubclass(described, HasTraits):
        arguments = stringify_signature(signature(described.__init__, bound_method=True), unqualified_typehints=True)
    return arguments and _with_names(arguments), result and _with_names(result)


def name_aliases_of_properties(_app: Sphinx, page: nodes.document) -> None:
    """Replace definitions by names in the types of properties, which autodoc does not offer for changes."""
    for node in page.findall(desc_annotation):
        for definition, name in DEFINITIONS.items():
            if _without_modules(definition) in node.astext():
                node[:] = [nodes.Text(node.astext().replace(_without_modules(definition), _without_modules(name)))]


def convert_docstring(app: Sphinx, what: str, name: str, described: object, options: object, lines: list[str]) -> None:
    """Convert a docstring in Google's format, in place."""
    converted = list(_mark_code(_with_result_fields(iter(lines))))
    kind = "method" if what in ("attribute", "property") else what  # otherwise words before a colon become the type
    lines[:] = GoogleDocstring(converted, NAPOLEON, app, kind, name, described, options).lines()


def _with_names(text: str) -> str:
    """Return the text of annotations with the names of aliases instead of their definitions."""
    for definition, name in DEFINITIONS.items():
        text = text.replace(definition, name)
    return text


def _without_modules(text: str) -> str:
    """Return the text of annotations as a page shows it."""
    return re.sub(r"~?(\w+\.)+", "", text)


def _with_result_fields(lines: Iterator[str]) -> Iterator[str]:
    """Yield lines; a section about the result becomes a field, followed by a blank line."""
    for line in lines:
        if line in RESULT_FIELDS:
            yield from chain([RESULT_FIELDS[line]], takewhile(str.strip, lines), [""])
        else:
            yield line


def _mark_code(lines: Iterable[str]) -> Iterator[str]:
    """Yield lines; a block that is indented more than the paragraph in front of it becomes a literal block."""
    previous = [" ", " "]
    for line in lines:
        if line.startswith(INDENT) and not previous[-1] and previous[-2][:1].strip():
            yield from ["::", ""]
        yield line
        previous = [*previous[-1:], line]


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect both conversions to autodoc."""
    app.connect("autodoc-process-signature", name_aliases)
    app.connect("doctree-read", name_aliases_of_properties)
    app.connect("autodoc-process-docstring", convert_docstring)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
