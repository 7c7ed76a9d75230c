"""Docstrings and signatures of walkerlab as reStructuredText.

In a docstring, an indented block is code, and the section ``Returns`` contains no types. In a signature, aliases such
as ``Floats`` appear by name.
"""

from collections.abc import Iterable, Iterator
from itertools import chain, takewhile

from numpy.typing import ArrayLike
from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, GoogleDocstring
from sphinx.util.typing import stringify_annotation

from walkerlab.ga import genes

MODES = ("fully-qualified-except-typing", "smart")  # of Sphinx, for full and for short names

ALIASES = {
    stringify_annotation(alias, mode): f"~{genes.__name__}.{name}"
    for name, alias in (("Floats", genes.Floats), ("Indices", genes.Indices))
    for mode in MODES
} | {stringify_annotation(ArrayLike, mode): "~numpy.typing.ArrayLike" for mode in MODES}
"""Name of each alias, keyed by the text of its definition."""

RESULT_FIELDS = {"Returns:": ":returns:", "Yields:": ":yields:"}
"""Field of reStructuredText for the result, keyed by the heading of its section."""

INDENT = " " * 4


def name_aliases(
    _app: Sphinx, _what: str, _name: str, _object: object, _options: object, arguments: str | None, result: str | None
) -> tuple[str | None, str | None]:
    """Replace definitions by names in the text of a signature."""
    for definition, name in ALIASES.items():
        arguments = arguments and arguments.replace(definition, name)
        result = result and result.replace(definition, name)
    return arguments, result


def convert_docstring(
    app: Sphinx, what: str, name: str, described: object, options: object, lines: list[str]
) -> None:
    """Convert a docstring in Google's format, in place."""
    converted = list(_mark_code(_with_result_fields(iter(lines))))
    kind = "method" if what in ("attribute", "property") else what  # otherwise words before a colon become the type
    lines[:] = GoogleDocstring(converted, Config(napoleon_use_ivar=True), app, kind, name, described, options).lines()


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
    app.connect("autodoc-process-docstring", convert_docstring)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
