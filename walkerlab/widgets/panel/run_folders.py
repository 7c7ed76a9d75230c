"""The runs in a panel's list, their files and folders, and a description of how they differ."""

import re
import time
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from walkerlab.evolution.live import LiveRun
from walkerlab.evolution.resuming import PreparedRun, prepare_resume
from walkerlab.evolution.run import Run
from walkerlab.evolution.stages import find_changes
from walkerlab.evolution.stopping import Stop
from walkerlab.evolution.stored_functions import user_functions
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.runfile.records import RANDOM, EvaluationRow, tidy_table
from walkerlab.settings.glossary import glossary_rows
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.system.files import write_text
from walkerlab.text.numbers import with_unit
from walkerlab.widgets.controls import unused_settings

NAME_FILE = "name.txt"
TIMESTAMP_FORMAT = "%Y-%m-%d-%H%M%S"
_TIMESTAMP = re.compile(r"(\d{4}-\d\d-\d\d-\d{6})(-\d+)?")
N_FURTHER_GENERATIONS = 10  # proposed number of further generations of a complete run
MAX_DIFFERENCES = 4  # maximum number of settings named in the description of a run


@dataclass(frozen=True, eq=False)
class ListedRun:
    """A run in the list of a panel: a live run, or a run loaded from a file.

    Attributes:
        key: Identifier of the run in the list.
        settings: Settings of the run.
        source: Live run, or loaded run.
    """

    key: str
    settings: Settings
    source: LiveRun | Run

    @property
    def live(self) -> LiveRun | None:
        """The live run; None for a loaded run."""
        return self.source if isinstance(self.source, LiveRun) else None

    @property
    def run(self) -> Run:
        """The completed generations of the run."""
        return self.source.run if isinstance(self.source, LiveRun) else self.source

    @property
    def visible(self) -> Run:
        """The completed generations; until generation 0 is complete, the robots that have walked so far."""
        live = self.live
        if not live or live.n_generations or not (first := live.first_robots):
            return self.run
        rows = [
            {"generation": 0, "individual": number, "born": 0, "parents": "", "operators": RANDOM}
            | EvaluationRow.of(evaluation, str(evaluation.genome))._asdict()
            for number, evaluation in sorted(first.items())
        ]
        return Run(live.settings, tidy_table(pd.DataFrame(rows)))

    @property
    def n_missing(self) -> int:
        """Number of robots of generation 0 that have not walked yet; 0 once the generation is complete."""
        live = self.live
        if not live or live.n_generations:
            return 0
        return live.settings.algorithm.population_size - len(live.first_robots)

    @property
    def state(self) -> str:
        """The state of the run, in a few words."""
        if self.live:
            return self.live.state
        n, total = self.run.n_generations, self.settings.algorithm.generations
        return "loaded" if n == total else f"loaded, {n} of {total}"


def new_live_run(
    settings: Settings, folder: Path, executor: Executor | None, on_change: Callable[[LiveRun], None], stop: Stop | None
) -> tuple[LiveRun, str]:
    """Create a run with a run file in a new subfolder, or without a file if the folder is not writable.

    Returns:
        The run, and a note that it will not be saved; "" if it has a file.
    """
    try:
        return LiveRun(settings, new_run_path(folder), executor, stop=stop, on_change=on_change), ""
    except (RunFileError, OSError) as error:
        return LiveRun(settings, None, executor, stop=stop, on_change=on_change), f"This run will not be saved. {error}"


def new_run_path(folder: Path) -> Path:
    """Return the path of a new run file in a new subfolder, which is named after the current time."""
    stamp = time.strftime(TIMESTAMP_FORMAT)
    names = (stamp if n == 1 else f"{stamp}-{n}" for n in range(1, 1000))
    return next(folder / name / RUN_FILE for name in names if not (folder / name).exists())


def find_run_files(folder: Path) -> list[str]:
    """Return the paths of the run files in a folder and in its subfolders, newest first."""
    found = [path for name in ("*.walk", f"*/{RUN_FILE}") for path in folder.glob(name) if path.is_file()]
    return [str(path) for path in sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)]


def save_name(path: Path, name: str) -> None:
    """Store the name that the user gave a run, beside its run file, unless the folder is not writable."""
    if path.name == RUN_FILE:
        with suppress(OSError):
            write_text(path.with_name(NAME_FILE), f"{name}\n")


def run_name(path: Path) -> str:
    """Return a readable name for a run: one given by the user, the time in the name of its folder, or another name."""
    with suppress(OSError, UnicodeDecodeError):
        if path.name == RUN_FILE and (name := path.with_name(NAME_FILE).read_text(encoding="utf-8").strip()):
            return name
    name = path.resolve().parent.name if path.name == RUN_FILE else path.stem
    if not (stamp := _TIMESTAMP.fullmatch(name)):
        return name
    try:
        moment = time.strptime(stamp[1], TIMESTAMP_FORMAT)
    except ValueError:
        return name
    return f"{moment.tm_mday} {time.strftime('%b, %H:%M:%S', moment)}{stamp[2] or ''}"


def n_further(entry: ListedRun) -> int:
    """Return the number of generations that are proposed to continue a run; 0 if it cannot be continued now."""
    if not entry.run.path or (entry.live and not entry.live.is_over):
        return 0
    return entry.settings.algorithm.generations - entry.run.n_generations or N_FURTHER_GENERATIONS


def prepare_further_generations(
    entry: ListedRun, n_generations: int, settings: Settings | None
) -> tuple[PreparedRun, str]:
    """Prepare a listed run to be continued, as ``wl.resume`` does.

    Args:
        entry: Run with a run file, which is not in progress.
        n_generations: Number of further generations.
        settings: Settings of the further generations, which begin a new stage; if None, those of the run.

    Returns:
        The prepared run, and the text of the warnings.

    Raises:
        RunFileError: If the run file cannot be continued.
        SettingsError: If one of the changed settings cannot change within a run.
        ValueError: If the run has no file.
    """
    run = entry.run
    if not run.path:
        raise ValueError("This run has no file, so it cannot be continued.")
    algorithm = (settings or entry.settings).algorithm
    functions = {slot: getattr(algorithm, slot) for slot in user_functions(entry.settings)}
    changes = find_changes(entry.settings, settings) if settings else {}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        prepared = prepare_resume(run.path, run.n_generations + n_generations, functions | changes)
    return prepared, "\n".join(str(warning.message) for warning in caught)


def best_result(run: Run) -> str:
    """Return the fitness of the champion of a run as text; empty if no generation is complete."""
    if not run.n_generations:
        return ""
    champion = run.champion
    unit = name_and_unit(run.settings.algorithm.fitness)[1]
    return with_unit(champion.fitness, unit) if champion.verdict == "ok" else "no walk counted"


def describe_differences(all_settings: Sequence[Settings]) -> list[str]:
    """Describe each of several settings by the values in which they differ, except those that have no effect.

    Args:
        all_settings: Settings of each run; a single one is compared with the defaults.
    """
    tables = [{(name, row.name): row for name, domain in one for row in glossary_rows(domain)} for one in all_settings]
    if not tables:
        return []
    if len(tables) == 1:
        differing = [place for place, row in tables[0].items() if row.changed]
    else:
        differing = [place for place in tables[0] if len({rows[place].value for rows in tables}) > 1]
    unused = [unused_settings(one.model_dump(mode="json")) for one in all_settings]
    return [
        _shorten([f"{place[1]} {rows[place].value}" for place in differing if ".".join(place) not in without])
        for rows, without in zip(tables, unused, strict=True)
    ]


def _shorten(differences: list[str]) -> str:
    n_more = len(differences) - MAX_DIFFERENCES
    more = f" and {n_more} more" if n_more > 0 else ""
    return ", ".join(differences[:MAX_DIFFERENCES]).replace("_", " ") + more
