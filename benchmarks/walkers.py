"""Measure how well champions walk on four grounds, against random search and CMA-ES at equal numbers of evaluations.

    python -m benchmarks.walkers run --folder FOLDER [--seeds 0-19] [--ground flat,stairs] [--methods evolution,cma]
        [--evaluations 1452,5000] [--jobs N] [--minutes M] [--set algorithm.selection=tournament ...]
    python -m benchmarks.walkers report FOLDER [FOLDER ...]

``run`` searches with each method on each ground and from each seed, and stores the measures of each champion in the
folder. The same command resumes after an interruption or after ``--minutes``. ``report`` prints a folder as Markdown
tables; with several folders, it compares the others with the first one by paired differences for each seed.

``--set`` changes settings, for example to compare operators: ``--set selection=tournament mutation=gaussian,micro`` or
``--set 'selection=tournament(size=7)'``. Each folder holds the results of one set of changes.
"""

import argparse
import json
import re
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import walkerlab as wl
from benchmarks.searches import METHODS
from benchmarks.walker_jobs import GROUNDS, Job, create_settings, run_jobs
from benchmarks.walker_tables import compare_folders, describe_folder
from walkerlab.settings.values import did_you_mean
from walkerlab.simulation.workers import n_cores
from walkerlab.system.files import write_text

SEEDS = {ground: range(20 if ground == "flat" else 8) for ground in GROUNDS}
"""Seeds of each ground, unless ``--seeds`` gives others."""

BUDGETS = (1452, 5000)
"""Numbers of evaluations: those of the default run, and as many as the table in ``docs/speed.md`` has."""

CHANGES_FILE = "changes.json"


def parse_changes(words: Sequence[str]) -> dict[str, str]:
    """Parse changes of settings, such as ``algorithm.selection=tournament`` or ``selection=tournament``.

    Returns:
        Texts of values by ``domain.field``.

    Raises:
        ValueError: If a word has no value, or there is no setting of that name.
    """
    locations = {name: f"{domain}.{field}" for name, (domain, field) in wl.Settings.field_locations().items()}
    changes: dict[str, str] = {}
    for word in words:
        name, _, text = word.partition("=")
        if not text:
            raise ValueError(f"--set {word} has no value; write NAME=VALUE, such as selection=tournament")
        location = locations.get(name, name)
        if location not in locations.values():
            raise ValueError(f"--set {word}: there is no setting {name!r}.{did_you_mean(name, locations)}")
        changes[location] = text
    return changes


def parse_seeds(text: str) -> list[int]:
    """Parse seeds such as ``0-7`` or ``0,3,5-7``.

    Raises:
        ArgumentTypeError: If the text is not a list of seeds.
    """
    if not re.fullmatch(r"\d+(-\d+)?(,\d+(-\d+)?)*", text):
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of seeds, such as 0-7 or 0,3,5-7")
    seeds: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        seeds += range(int(first), int(last or first) + 1)
    return seeds


def prepare_folder(folder: Path, changes: Mapping[str, str]) -> None:
    """Create a folder of results, or check that it belongs to the same changes of settings.

    Raises:
        ValueError: If it belongs to other changes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / CHANGES_FILE
    if not path.exists():
        write_text(path.absolute(), json.dumps(changes, indent=1, sort_keys=True) + "\n")
    elif (stored := json.loads(path.read_text(encoding="utf-8"))) != changes:
        words = " ".join(f"{place}={text}" for place, text in stored.items()) or "nothing"
        raise ValueError(f"{folder} holds results with --set {words}; choose another --folder")


def run(arguments: argparse.Namespace) -> int:
    """Run all jobs that are not done; return the exit code: 0 if all are done, 3 if the time was too short."""
    changes = parse_changes(arguments.set)
    for ground in arguments.ground:
        create_settings(ground, changes)
    prepare_folder(arguments.folder, changes)
    end = time.time() + 60 * arguments.minutes if arguments.minutes else float("inf")
    seeds = {ground: arguments.seeds or SEEDS[ground] for ground in arguments.ground}
    jobs = [
        Job(arguments.folder, ground, method, seed, tuple(arguments.evaluations), changes, end)
        for seed in sorted({seed for ground in seeds for seed in seeds[ground]})
        for ground in arguments.ground
        for method in arguments.methods
        if seed in seeds[ground]
    ]
    waiting = [job for job in jobs if not job.is_done]
    print(f"{len(jobs) - len(waiting)} of {len(jobs)} searches are done", flush=True)
    for message in run_jobs(waiting, arguments.jobs):
        print(message, flush=True)
    n_left = sum(not job.is_done for job in waiting)
    print(f"{n_left} searches are left; repeat the command to resume them" if n_left else "all searches are done")
    return 3 if n_left else 0


def report(arguments: argparse.Namespace) -> int:
    """Print the tables of one folder, or the comparison of several."""
    folders = arguments.folders
    print(describe_folder(folders[0]) if len(folders) == 1 else compare_folders(folders))
    return 0


def create_parser() -> argparse.ArgumentParser:
    """Create the parser of the command line."""

    def names_from(allowed: Mapping[str, object]) -> Any:
        def names(text: str) -> list[str]:
            words = text.split(",")
            if unknown := [word for word in words if word not in allowed]:
                raise argparse.ArgumentTypeError(f"{unknown[0]!r} is unknown; allowed are {', '.join(allowed)}")
            return words

        return names

    def numbers(text: str) -> list[int]:
        if not re.fullmatch(r"[1-9]\d*(,[1-9]\d*)*", text):
            raise argparse.ArgumentTypeError(f"{text!r} is not a list of whole numbers, such as 1452,5000")
        return sorted({int(word) for word in text.split(",")})

    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.walkers",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("run", help="search and measure", allow_abbrev=False)
    command.set_defaults(function=run)
    command.add_argument("--folder", type=Path, required=True, help="folder of the results")
    command.add_argument("--seeds", type=parse_seeds, help="seeds, such as 0-7 [0-19 on flat ground, else 0-7]")
    command.add_argument("--ground", type=names_from(GROUNDS), default=list(GROUNDS), help=", ".join(GROUNDS))
    command.add_argument("--methods", type=names_from(METHODS), default=list(METHODS), help=", ".join(METHODS))
    command.add_argument(
        "--evaluations", type=numbers, default=list(BUDGETS), help="numbers of walks, separated by commas [1452,5000]"
    )
    command.add_argument("--jobs", type=int, default=n_cores(), help="number of processes [%(default)s]")
    command.add_argument("--minutes", type=float, help="minutes after which to stop")
    command.add_argument("--set", nargs="+", action="extend", default=[], metavar="NAME=VALUE", help="settings")
    command = commands.add_parser("report", help="print results as Markdown")
    command.set_defaults(function=report)
    command.add_argument("folders", type=Path, nargs="+", metavar="FOLDER")
    return parser


def main() -> int:
    """Run the command line; return the exit code."""
    parser = create_parser()
    arguments = parser.parse_args()
    try:
        return arguments.function(arguments)
    except ValueError as error:  # settings errors are among them
        parser.error(str(error))
    except KeyboardInterrupt:
        print("stopped; repeat the command to resume", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
