"""The command line, described from its parsers."""

import argparse
import re
from textwrap import fill

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from extension.settings import markdown_table
from walkerlab.commands.parser import create_parser

USAGE_WIDTH = 80  # characters


class Commands(SphinxDirective):
    """Describe every command: what it does, its usage and its arguments."""

    def run(self) -> list[nodes.Node]:
        """Return a section for each command."""
        _, commands = create_parser()
        text = "\n\n".join(_command_text(name, parser) for name, parser in commands.items())
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def _command_text(name: str, parser: argparse.ArgumentParser) -> str:
    formatter = parser._get_formatter()  # the only way to fill in the values in the help of an argument
    arguments = [action for action in parser._actions if "." not in action.dest and action.dest != "help"]
    rows = [[f"`{_usage(action)}`", _escape(formatter._expand_help(action))] for action in arguments]
    usage = "\n".join(map(_wrap, parser.format_usage().removeprefix("usage: ").rstrip().split("\n")))
    takes_settings = len(arguments) + 1 < len(parser._actions)
    return "\n\n".join(
        [
            f"## walkerlab {name}",
            parser.description or "",
            f"```text\n{usage}\n```",
            *([markdown_table(["argument", "meaning"], rows)] if rows else []),
            *(["Each [setting](settings.md) has a flag."] if takes_settings else []),
        ]
    )


def _wrap(line: str) -> str:
    """Wrap a line of the usage, but not within brackets."""
    return fill(re.sub(r" (?=[^\[]*\])", "\0", line.strip()), USAGE_WIDTH, subsequent_indent=" " * 8).replace("\0", " ")


def _usage(action: argparse.Action) -> str:
    """Return the flag of an argument with its placeholder, or the placeholder of a positional one."""
    metavar = action.metavar if isinstance(action.metavar, str) else ""
    return " ".join([*action.option_strings, metavar]).strip()


def _escape(text: str) -> str:
    return text.replace("[", "\\[").replace("<", "\\<").replace("*", "\\*")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
