"""The runs in a panel's list, their files and folders, and a description of how they differ."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from walkerlab.evolution.live import LiveRun
from walkerlab.evolution.run import Run
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.settings.glossary import glossary_rows
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.text.numbers import with_unit

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
    def state(self) -> str:
        """The state of the run, in one word."""
        return self.live.state if self.live else "loaded"


def new_run_path(folder: Path) -> Path:
    """Return the path of a new run file in a new subfolder, which is named after the current time."""
    stamp = time.strftime("%Y-%m-%d-%H%M%S")
    names = (stamp if n == 1 else f"{stamp}-{n}" for n in range(1, 1000))
    return next(folder / name / RUN_FILE for name in names if not (folder / name).exists())


def find_run_files(folder: Path) -> list[str]:
    """Return the paths of the run files in a folder and in its subfolders, newest first."""
    found = [path for name in ("*.walk", f"*/{RUN_FILE}") for path in folder.glob(name) if path.is_file()]
    return [str(path) for path in sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)]


def run_name(path: Path) -> str:
    """Return the name of a run: the name of its file, or of its folder if the file has the standard name."""
    return path.resolve().parent.name if path.name == RUN_FILE else path.stem


def best_result(run: Run) -> str:
    """Return the fitness of the champion of a run as text; empty if no generation is complete."""
    if not run.n_generations:
        return ""
    champion = run.champion
    unit = name_and_unit(run.settings.algorithm.fitness)[1]
    return with_unit(champion.fitness, unit) if champion.verdict == "ok" else "no walk counted"


def describe_differences(all_settings: Sequence[Settings]) -> list[str]:
    """Describe each of several settings by the values in which they differ.

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
    return [_shorten([f"{place[1]} {rows[place].value}" for place in differing]) for rows in tables]


def _shorten(differences: list[str]) -> str:
    n_more = len(differences) - MAX_DIFFERENCES
    more = f" and {n_more} more" if n_more > 0 else ""
    return ", ".join(differences[:MAX_DIFFERENCES]).replace("_", " ") + more
