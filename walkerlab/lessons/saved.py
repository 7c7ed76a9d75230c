"""Script that evolves the small saved runs of the lessons, so that a lesson can start with results.

    python -m walkerlab.lessons.saved data/runs [NAME ...]

Each run has a run file ``NAME.walk`` and a text file ``NAME.json`` with the settings that differ from the defaults and
the figures of its champion. All runs together take a few minutes. Without names, all runs are evolved.
"""

import json
import sys
from pathlib import Path
from typing import Any

from walkerlab.evolution.run import Run
from walkerlab.evolution.running import evolve
from walkerlab.lessons.saved_runs import RUN_CHANGES
from walkerlab.runfile.records import birth_rows
from walkerlab.settings.settings import Settings
from walkerlab.system.files import write_text
from walkerlab.text.numbers import with_unit


def save_run(name: str, folder: Path) -> Run:
    """Evolve a run and write its two files; existing files are replaced.

    Args:
        name: Name in ``RUN_CHANGES``.
        folder: Folder of the files; created if it is missing.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.walk"
    path.unlink(missing_ok=True)
    run = evolve(Settings().with_(**RUN_CHANGES[name]), path, progress=False)
    write_text(folder / f"{name}.json", json.dumps(describe_run(run), indent=2) + "\n")
    return run


def describe_run(run: Run) -> dict[str, Any]:
    """Return the command, the settings and the figures of a saved run, as JSON data."""
    champion = run.champion
    return {
        "command": "python -m walkerlab.lessons.saved data/runs",
        "settings": run.settings.changes(),
        "n_trials": len(birth_rows(run.records)),
        "fitness": champion.fitness,
        "genome": str(champion.genome),
    }


if __name__ == "__main__":
    for each in sys.argv[2:] or RUN_CHANGES:
        saved = save_run(each, Path(sys.argv[1]))
        print(f"{each}: best {with_unit(saved.champion.fitness, 'm')}", flush=True)
