"""The runs that a panel keeps, each in a folder of its own, and what tells them apart."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from walkerlab.evolution.live import LiveRun
from walkerlab.evolution.run import Run
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.settings.glossary import rows_of
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import label
from walkerlab.text.numbers import with_unit

MOST = 4  # settings named that tell a run apart


@dataclass(frozen=True, eq=False)
class Kept:
    """A run that is kept: one that lives here, or one that was loaded.

    Attributes:
        key: by which a panel knows it.
        settings: of the run.
        source: what it comes from.
    """

    key: str
    settings: Settings
    source: LiveRun | Run

    @property
    def live(self) -> LiveRun | None:
        """The run as it lives, if it does."""
        return self.source if isinstance(self.source, LiveRun) else None

    @property
    def run(self) -> Run:
        """All that is done so far."""
        return self.source.run if isinstance(self.source, LiveRun) else self.source

    @property
    def state(self) -> str:
        """What it is doing, in a word."""
        return self.live.state if self.live else "loaded"


def new_file(folder: Path) -> Path:
    """Name a run file in a folder of its own, after the time; what is there stays as it is."""
    stamp = time.strftime("%Y-%m-%d-%H%M%S")
    names = (stamp if n == 1 else f"{stamp}-{n}" for n in range(1, 1000))
    return next(folder / name / RUN_FILE for name in names if not (folder / name).exists())


def run_files(folder: Path) -> list[str]:
    """Return the run files in a folder, or in folders of it, the newest first."""
    found = [path for name in ("*.walk", f"*/{RUN_FILE}") for path in folder.glob(name) if path.is_file()]
    return [str(path) for path in sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)]


def name_of(path: Path) -> str:
    """Name a run after its file, or after its folder if the file is named as in all of them."""
    return path.resolve().parent.name if path.name == RUN_FILE else path.stem


def best_of(run: Run) -> str:
    """Say what the champion of a run has reached."""
    if not run.n_generations:
        return ""
    best, unit = run.champion, label(run.settings.algorithm.fitness)[1]
    return with_unit(best.fitness, unit) if best.verdict == "ok" else "no walk counted"


def told_apart(all_settings: Sequence[Settings]) -> list[str]:
    """Say for each of several settings what differs among them; of a single one, what differs from the default."""
    words = [{(name, row.name): row for name, part in one for row in rows_of(part)} for one in all_settings]
    if len(words) == 1:
        differing = [place for place, row in words[0].items() if row.changed]
    else:
        differing = [place for place in words[0] if len({rows[place].value for rows in words}) > 1] if words else []
    return [_listed([f"{place[1]} {rows[place].value}" for place in differing]) for rows in words]


def _listed(words: list[str]) -> str:
    more = f" and {len(words) - MOST} more" if len(words) > MOST else ""
    return ", ".join(words[:MOST]).replace("_", " ") + more
