"""The words of the command line, and what each calls."""

import argparse
from collections.abc import Mapping
from difflib import get_close_matches

from walkerlab.commands import doctor, flags, lab, runs


def grammar() -> tuple[argparse.ArgumentParser, Mapping[str, argparse.ArgumentParser]]:
    """Return the parser of all, and that of each command."""
    parser = argparse.ArgumentParser(
        prog="walkerlab",
        description="Evolve walking robots with a genetic algorithm.",
        epilog="Start with: walkerlab evolve",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND", required=True)

    def command(name: str, run: object, about: str, usage: str) -> argparse.ArgumentParser:
        added = commands.add_parser(
            name,
            help=about,
            description=f"{about[0].upper()}{about[1:]}.",
            usage=f"walkerlab {name} {usage}",
            formatter_class=flags.Help,
            allow_abbrev=False,
        )
        added.set_defaults(run=run)
        return added

    evolved = command(
        "evolve", runs.evolve, "evolve walkers into a new folder", "[--out FOLDER] [--quiet] [--SETTING VALUE ...]"
    )
    evolved.add_argument(
        "--out", type=flags.path_of, default="walk", metavar="FOLDER", help="where to put it all [walk]"
    )
    evolved.add_argument("--quiet", action="store_true", help="say nothing unless something is wrong")
    flags.add_flags(evolved)

    resume = command("resume", runs.resume, "go on with a run", "PATH [--generations N] [--quiet]")
    resume.add_argument("path", type=flags.path_of, metavar="PATH", help="a run file, or the folder with it")
    resume.add_argument("--generations", type=int, metavar="N", help="how many it shall have in all")
    resume.add_argument("--quiet", action="store_true", help="say nothing unless something is wrong")

    show = command("show", runs.show, "show what a run has brought forth", "PATH")
    show.add_argument("path", type=flags.path_of, metavar="PATH", help="a run file, or the folder with it")

    rescue = command("rescue", runs.rescue, "save what is whole of a damaged run", "PATH [--out FOLDER]")
    rescue.add_argument("path", type=flags.path_of, metavar="PATH", help="a run file, or the folder with it")
    rescue.add_argument(
        "--out", type=flags.path_of, default="rescued", metavar="FOLDER", help="where to put the new run [rescued]"
    )

    command("doctor", doctor.tell, "say what this machine can do, and how to mend what it cannot", "")

    opened = command(
        "lab", lab.run, "open JupyterLab on copies of the notebooks", "[--no-browser] [--port N] [--allow-root]"
    )
    opened.add_argument("--no-browser", action="store_true", help="only print the address")
    opened.add_argument("--port", type=int, metavar="N", help="the port to listen at, on this computer only")
    opened.add_argument("--allow-root", action="store_true", help="run as root, as in a container")
    return parser, commands.choices


def no_such_command(word: str, commands: Mapping[str, object]) -> str:
    """Say so, with the one that was meant."""
    guess = get_close_matches(word, commands, n=1)
    mend = f"Did you mean: walkerlab {guess[0]}?" if guess else f"There are {', '.join(commands)}."
    return f"There is no command {word!r}. {mend}"
