"""Command ``compare``: run several conditions with several seeds, and write a report."""

from __future__ import annotations  # Experiment and Settings are imported for type checking only

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from walkerlab.commands.terminal import EXIT_INTERRUPTED, print_safely
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import display_path, folder_path, quote_path
from walkerlab.system.interrupts import interrupts_held

if TYPE_CHECKING:
    from walkerlab.experiment.experiment import Experiment
    from walkerlab.settings.settings import Settings

RANDOM_SEARCH = "random search"
EXAMPLE = 'walkerlab compare gentle:"selection=tournament(size=2)" harsh:"selection=tournament(size=7)"'
FILES = {
    "report.html": "result, plots and settings as a page",
    "records.csv": "table of all robots",
    "tables/": "tables of the conditions and of their comparisons",
    "pictures/": "plots as SVG, PDF and PNG",
    "run.walk": "the experiment, to be continued or read with wl.load_experiment",
}


class ComparisonError(WalkerlabError):
    """Error of a comparison that has no conditions, or that cannot be restored from its file."""


def compare_command(arguments: argparse.Namespace) -> int:
    """Run or continue an experiment, print its result and write its report; return the exit code."""
    with interrupts_held():
        from walkerlab.commands import flags
        from walkerlab.experiment.compare import compare
        from walkerlab.runfile.opening import RunFileError
        from walkerlab.runfile.paths import RUN_FILE

    words = arguments.conditions + [word for word in arguments.unknown_words if ":" in word and word[0] != "-"]
    unknown = [word for word in arguments.unknown_words if word not in words]
    base = flags.build_settings(vars(arguments), unknown)
    path = folder_path(arguments.out, "--out") / RUN_FILE
    seeds = arguments.seeds or range(10)
    population: Any = None
    if words or arguments.random_search:
        conditions = build_conditions(words, base, random_search=arguments.random_search)
    else:
        if base != type(base)():
            raise ComparisonError(f"There is nothing to compare. Name at least two conditions: {EXAMPLE}")
        stored = _read_stored(path)
        conditions, population = _restore_conditions(stored)
        seeds = arguments.seeds or stored.seeds
    is_new = not path.exists()
    try:
        result = compare(conditions, seeds, path, progress=not arguments.quiet, population=population)
    except RunFileError as error:
        if is_new:
            raise
        raise RunFileError(
            f"{error}\nContinue the stored experiment: walkerlab compare --out {quote_path(arguments.out)}\n"
            "Start a new experiment:         walkerlab compare … --out ANOTHER-FOLDER"
        ) from error
    return _finish(result, arguments.out, quiet=arguments.quiet)


def parse_seeds(text: str) -> list[int]:
    """Parse seeds and ranges of seeds: ``0-9``, ``0,2,5`` or ``0-4,7``.

    Raises:
        ArgumentTypeError: If the text does not have this form.
    """
    seeds: list[int] = []
    for part in text.split(","):
        first, dash, last = part.partition("-")
        if not first.strip().isdecimal() or (dash and not last.strip().isdecimal()):
            raise argparse.ArgumentTypeError(f"{text!r} must be seeds or ranges of seeds, as in 0-9 or 0,2,5")
        seeds += range(int(first), int(last or first) + 1)
    return seeds


def build_conditions(words: list[str], base: Settings, *, random_search: bool) -> dict[str, Any]:
    """Return conditions in the form that ``wl.compare`` requires.

    Args:
        words: Conditions as text; ``evolution:`` if there are none.
        base: Settings that all conditions share.
        random_search: Whether to add random search, once for all conditions that differ only in their operators.

    Raises:
        SettingsError: If a condition or a setting is not valid, or a name occurs twice.
    """
    from walkerlab.commands.setting_texts import parse_condition
    from walkerlab.experiment.conditions import task_of
    from walkerlab.experiment.optimisers import random_search as search
    from walkerlab.settings.model import SettingsError

    conditions: dict[str, Any] = {}
    for word in words or ["evolution:"]:
        name, changes = parse_condition(word)
        if name in conditions:
            raise SettingsError(f"two conditions are called {name!r}; give each condition a different name")
        try:
            conditions[name] = base.with_(**changes)
        except SettingsError as error:
            raise SettingsError("\n".join(f"condition {name!r}: {line}" for line in str(error).splitlines())) from error
    if random_search:
        tasks: dict[str, Settings] = {}
        for name, settings in conditions.items():
            if not any(task_of(settings) == task_of(other) for other in tasks.values()):
                tasks[name] = settings
        for name, settings in tasks.items():
            label = f"{name}: {RANDOM_SEARCH}" if len(tasks) > 1 else RANDOM_SEARCH
            conditions[label] = (search, settings)
    return conditions


def _read_stored(path: Path) -> Experiment:
    """Return the experiment in a file, to be continued.

    Raises:
        ComparisonError: If the file does not exist.
    """
    from walkerlab.experiment.experiment import load_experiment

    if not path.exists():
        raise ComparisonError(
            f"There is nothing to compare, and {display_path(path.parent)} contains no experiment to be continued.\n"
            f"Name at least two conditions:            {EXAMPLE}\n"
            "Or compare evolution with random search: walkerlab compare --random-search"
        )
    return load_experiment(path)


def _restore_conditions(stored: Experiment) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return conditions and first populations of a stored experiment, in the form that ``wl.compare`` requires.

    Raises:
        ComparisonError: If the experiment has user functions, which are not stored in the file.
    """
    from walkerlab.experiment.optimisers import random_search

    for condition in stored.plan:
        functions = condition.function_facts()
        if functions or condition.optimiser not in ("", random_search.__name__):
            name = next(iter(functions.values()), condition.optimiser)
            raise ComparisonError(
                f"Condition {condition.name!r} has the function {name}, which the file does not contain. Continue the "
                "experiment in Python: repeat the call of wl.compare with the same path."
            )
    conditions = {one.name: (random_search, one.settings) if one.optimiser else one.settings for one in stored.plan}
    return conditions, {condition.name: condition.founders for condition in stored.plan if condition.founders}


def _finish(result: Experiment, folder: Path, *, quiet: bool) -> int:
    """Print the result and write the report; return the exit code."""
    is_stopped = len(result.complete_seeds) < len(result.seeds)
    if not quiet:
        print()
        print_safely(str(result.summary()))
    if result.complete_seeds:
        result.report(folder)
        if not quiet:
            print(f"\nFiles in the folder {display_path(folder)}:")
            print("\n".join(f"  {name:13} {about}" for name, about in FILES.items()))
    if is_stopped:
        print(f"\nStopped: {result.status.partition(';')[0]}.")
        print(f"Continue with: walkerlab compare --out {quote_path(folder)}")
    return EXIT_INTERRUPTED if is_stopped else 0
