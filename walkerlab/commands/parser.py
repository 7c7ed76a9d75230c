"""Parser of the command line: the commands, their arguments and the functions that run them."""

import argparse
from collections.abc import Mapping
from difflib import get_close_matches

from walkerlab.commands import comparing, doctor, flags, lab, ranking, runs


def create_parser() -> tuple[argparse.ArgumentParser, Mapping[str, argparse.ArgumentParser]]:
    """Create the parser of the command line; return it and the parser of each command, keyed by name."""
    parser = argparse.ArgumentParser(
        prog="walkerlab",
        description="Evolve walking robots with a genetic algorithm.",
        epilog="Start with: walkerlab evolve",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND", required=True)

    def add_command(name: str, run: object, about: str, usage: str) -> argparse.ArgumentParser:
        command = commands.add_parser(
            name,
            help=about,
            description=f"{about[0].upper()}{about[1:]}.",
            usage=f"walkerlab {name} {usage}",
            formatter_class=flags.HelpFormatter,
            allow_abbrev=False,
        )
        command.set_defaults(run=run)
        return command

    evolve = add_command(
        "evolve",
        runs.evolve_command,
        "evolve robots and write the run into a new folder",
        "[--out FOLDER] [--quiet] [--stop-after TIME] [--target X] [--patience N] [--SETTING VALUE ...]",
    )
    evolve.add_argument(
        "--out", type=flags.parse_path, default="walk", metavar="FOLDER", help="folder of the run [walk]"
    )
    evolve.add_argument("--quiet", action="store_true", help="print only errors")
    flags.add_stop_flags(evolve)
    flags.add_flags(evolve)

    resume = add_command(
        "resume",
        runs.resume_command,
        "resume a run",
        "PATH [--generations N] [--quiet] [--stop-after TIME] [--target X] [--patience N] [--SETTING VALUE ...]",
    )
    resume.add_argument("path", type=flags.parse_path, metavar="PATH", help="run file or its folder")
    resume.add_argument("--quiet", action="store_true", help="print only errors")
    flags.add_stop_flags(resume)
    flags.add_flags(resume)

    compare = add_command(
        "compare",
        comparing.compare_command,
        "compare conditions over several seeds, or continue such an experiment",
        "[NAME:CHANGES ...] [--random-search] [--seeds SEEDS] [--out FOLDER] [--quiet] [--SETTING VALUE ...]",
    )
    compare.add_argument(
        "conditions",
        nargs="*",
        metavar="NAME:CHANGES",
        help='name of a condition and its changed settings, as in harsh:"selection=tournament(size=7) n_elites=0"; '
        "without conditions, the experiment in FOLDER is continued",
    )
    compare.add_argument(
        "--random-search", action="store_true", help="add random search with the same number of evaluations"
    )
    compare.add_argument("--seeds", type=comparing.parse_seeds, metavar="SEEDS", help="seeds, as in 0-4 or 1,5,7 [0-9]")
    compare.add_argument(
        "--out", type=flags.parse_path, default="comparison", metavar="FOLDER", help="folder for the files [comparison]"
    )
    compare.add_argument("--quiet", action="store_true", help="print only errors")
    flags.add_flags(compare)

    league = add_command(
        "league",
        ranking.league_command,
        "rank the genomes and runs in a folder, and write the leaderboard as a page",
        "FOLDER [--mystery FILE] [--rounds N] [--out PAGE] [--SETTING VALUE ...]\n"
        "       walkerlab league --seal SETTINGS [--out FILE]",
    )
    ranking.add_arguments(league)
    flags.add_flags(league)

    show = add_command("show", runs.show_command, "print a summary of a run", "PATH")
    show.add_argument("path", type=flags.parse_path, metavar="PATH", help="run file or its folder")

    table = add_command(
        "table",
        runs.table_command,
        "write the table of a run for a spreadsheet",
        'PATH FILE.xlsx\n       walkerlab table PATH FILE.csv [--decimal ","]',
    )
    table.add_argument("path", type=flags.parse_path, metavar="PATH", help="run file or its folder")
    table.add_argument("file", type=flags.parse_path, metavar="FILE", help="file to write, ending in .xlsx or .csv")
    table.add_argument(
        "--decimal",
        choices=(".", ","),
        default=".",
        help='decimal mark of a .csv file; "," for a German or French spreadsheet [.]',
    )

    rescue = add_command(
        "rescue", runs.rescue_command, "save the intact generations of a damaged run", "PATH [--out FOLDER]"
    )
    rescue.add_argument("path", type=flags.parse_path, metavar="PATH", help="run file or its folder")
    rescue.add_argument(
        "--out", type=flags.parse_path, default="rescued", metavar="FOLDER", help="folder of the new run [rescued]"
    )

    add_command("doctor", doctor.run_doctor, "check this computer and print how to fix each fault", "")

    lab_command = add_command(
        "lab",
        lab.run_lab,
        "open JupyterLab on copies of the notebooks",
        "[--class FILE] [--teacher] [--no-browser] [--port N] [--allow-root]",
    )
    lab_command.add_argument(
        "--class", dest="class_file", metavar="FILE", help="settings of a class: fixed settings, budget, shared folder"
    )
    lab_command.add_argument(
        "--teacher", action="store_true", help="also copy the notebooks with answers, the guides and the sheets"
    )
    lab_command.add_argument("--no-browser", action="store_true", help="print the address without opening a browser")
    lab_command.add_argument("--port", type=int, metavar="N", help="port of the server on this computer")
    lab_command.add_argument("--allow-root", action="store_true", help="allow the user root, as in a container")
    return parser, commands.choices


def describe_unknown_command(word: str, commands: Mapping[str, object]) -> str:
    """Return the message for an unknown command, with the most similar command or a list of all."""
    guess = get_close_matches(word, commands, n=1)
    advice = f"Did you mean: walkerlab {guess[0]}?" if guess else f"The commands are {', '.join(commands)}."
    return f"There is no command {word!r}. {advice}"
