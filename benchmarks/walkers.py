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
import hashlib
import json
import multiprocessing
import os
import platform
import re
import signal
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import walkerlab as wl
from benchmarks.champions import measure_champion
from benchmarks.searches import METHODS
from benchmarks.walker_tables import compare_folders, describe_folder
from walkerlab.commands.flags import build_settings, parse_value
from walkerlab.settings.values import did_you_mean
from walkerlab.simulation.pausable import PausableExecutor, Stopped
from walkerlab.simulation.workers import n_cores
from walkerlab.system.files import write_text

GROUNDS: dict[str, dict[str, Any]] = {
    "flat": {},
    "incline": {"terrain.structure": "incline", "terrain.incline": 10},
    "stairs": {"terrain.structure": "stairs", "terrain.step_height": 0.08},
    "gravel": {"terrain.texture": "gravel", "terrain.texture_density": 0.05, "terrain.obstacle": "rock"},
}
"""Settings of each ground that differ from the defaults."""

SEEDS = {ground: range(20 if ground == "flat" else 8) for ground in GROUNDS}
"""Seeds of each ground, unless ``--seeds`` gives others."""

BUDGETS = (1452, 5000)
"""Numbers of evaluations: those of the default run, and as many as the table in ``docs/speed.md`` has."""

OPERATOR_SLOTS = ("algorithm.selection", "algorithm.crossover", "algorithm.mutation")
CHANGES_FILE = "changes.json"


@dataclass(frozen=True)
class Job:
    """Search with one method from one seed on one ground.

    Attributes:
        folder: Folder of all results.
        ground: Name of the ground.
        method: Name of the search.
        seed: Seed of the search.
        budgets: Numbers of evaluations after which the champion is measured.
        changes: Texts of the changed settings by ``domain.field``.
        end: Time at which the search stops, in seconds since the epoch.
    """

    folder: Path
    ground: str
    method: str
    seed: int
    budgets: tuple[int, ...]
    changes: Mapping[str, str]
    end: float

    @property
    def path(self) -> Path:
        """Path of the files of this job, without suffix."""
        return self.folder / self.ground / f"{self.method}-{self.seed}"

    @property
    def name(self) -> str:
        """Name of this job in messages."""
        return f"{self.ground} {self.method} {self.seed}"

    def read_results(self) -> dict[str, Any]:
        """Return the stored measures of champions by number of evaluations."""
        path = self.path.with_suffix(".json")
        return json.loads(path.read_text(encoding="utf-8"))["champions"] if path.exists() else {}

    @property
    def is_done(self) -> bool:
        """Whether the champions of all budgets are measured."""
        return {str(budget) for budget in self.budgets} <= self.read_results().keys()


def run_job(job: Job) -> str:
    """Search, measure the champions and store the results; return a message."""
    if time.time() >= job.end:
        return ""
    settings = create_settings(job.ground, job.changes)
    job.path.parent.mkdir(parents=True, exist_ok=True)
    executor = PausableExecutor(lambda: ThreadPoolExecutor(1), lambda _: 1)
    timer = threading.Timer(max(0.0, min(job.end - time.time(), threading.TIMEOUT_MAX)), executor.stop)
    timer.daemon = True
    timer.start()
    try:
        champions = METHODS[job.method](settings, job.seed, job.budgets, job.path, executor)
    except Stopped:
        return f"{job.name}: stopped; to be resumed"
    finally:
        timer.cancel()
    results = job.read_results()
    for budget, champion in champions.items():
        if str(budget) not in results:
            results[str(budget)] = {
                "evaluations": champion.n_evaluations,
                **measure_champion(champion.genome, settings),
            }
    document = {
        **{name: getattr(job, name) for name in ("ground", "method", "seed")},
        "source": source_digest(),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores",
        "champions": results,
    }
    write_text(job.path.with_suffix(".json").absolute(), json.dumps(document, indent=1) + "\n")
    speeds = (
        f"{results[str(budget)]['body lengths/s'] or 0:.2f} body lengths/s at {budget:,}" for budget in job.budgets
    )
    return f"{job.name}: {', '.join(speeds)}"


def source_digest() -> str:
    """Return a digest of the source of walkerlab, so that results of different versions can be told apart."""
    assert wl.__file__
    digest = hashlib.sha256()
    for path in sorted(Path(wl.__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:8]


def run_jobs(jobs: Sequence[Job], n_processes: int) -> Iterator[str]:
    """Run jobs in several processes, each with one thread, and yield a message for each."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # inherited by the processes
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(n_processes, mp_context=context, initializer=_ignore_interrupts)
    try:
        futures = {pool.submit(run_job, job): job for job in jobs}
        for future in as_completed(futures):
            try:
                message = future.result()
            except Exception as error:
                message = f"{futures[future].name}: failed: {type(error).__name__}: {error}"
            if message:
                yield message
    except KeyboardInterrupt:  # files are complete at any time, so processes can be ended
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _ignore_interrupts() -> None:
    """Leave Ctrl-C to the main process, which ends the others."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def parse_changes(words: Sequence[str]) -> dict[str, str]:
    """Parse changes of settings, such as ``algorithm.selection=tournament`` or ``selection=tournament``.

    Returns:
        Texts of values by ``domain.field``.

    Raises:
        ValueError: If a word has no value, or there is no setting of that name.
    """
    places = {name: f"{domain}.{field}" for name, (domain, field) in wl.Settings.places().items()}
    changes: dict[str, str] = {}
    for word in words:
        name, _, text = word.partition("=")
        if not text:
            raise ValueError(f"--set {word} has no value; write NAME=VALUE, such as selection=tournament")
        place = places.get(name, name)
        if place not in places.values():
            raise ValueError(f"--set {word}: there is no setting {name!r}.{did_you_mean(name, places)}")
        changes[place] = text
    return changes


def create_settings(ground: str, changes: Mapping[str, str]) -> wl.Settings:
    """Create the settings of a ground with changes.

    Several values are separated by commas. An operator may have arguments: ``tournament(size=7)``.

    Args:
        ground: Name of the ground.
        changes: Texts of values by ``domain.field``.

    Raises:
        ValueError: If a value is not allowed.
    """
    values = dict(GROUNDS[ground])
    for place, text in changes.items():
        parts = [_parse_part(place, part) for part in re.split(r",(?![^(]*\))", text)]
        values[place] = parts if len(parts) > 1 else parts[0]
    return build_settings(values)


def _parse_part(place: str, text: str) -> Any:
    """Parse one value, or an operator with arguments.

    Raises:
        ValueError: If there is no such operator.
    """
    match = re.fullmatch(r"(\w+)\((.*)\)", text)
    if not match:
        return parse_value(text)
    operators = vars(import_module(f"walkerlab.ga.{place.partition('.')[2]}")) if place in OPERATOR_SLOTS else {}
    if match[1] not in operators:
        raise ValueError(f"--set {place}={text}: there is no operator {match[1]!r} for {place}")
    pairs = (pair.partition("=") for pair in match[2].split(",") if pair)
    return partial(operators[match[1]], **{name.strip(): parse_value(value) for name, _, value in pairs})


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
