"""Script that evolves the walker that the panel shows before the first run.

    python -m walkerlab.commands.walker data/walker.json

It evolves with the default settings for about 5,000 evaluations, which takes a few minutes. It writes the champion, its
settings, and the shares of its fitness that remain at a quarter of the timestep and from other starts.
"""

import json
import sys
from pathlib import Path

from walkerlab.evolution.run import Run
from walkerlab.evolution.running import evolve
from walkerlab.runfile.records import birth_rows
from walkerlab.settings.settings import Settings
from walkerlab.system.files import file_path, write_text

N_GENERATIONS = 86  # with 60 robots and 2 elites, 4,990 evaluations


def write_walker(run: Run, path: Path) -> None:
    """Write the champion of a run to a JSON file.

    Args:
        run: Run with the default settings, except for the number of generations.
        path: File to write; an existing file is replaced.
    """
    champion = run.champion
    confirmation = run.confirm()
    walker = {
        "command": "python -m walkerlab.commands.walker data/walker.json",
        "settings": run.settings.changes(),
        "n_trials": len(birth_rows(run.records)),
        "distance": champion.fitness,
        "kept_at_quarter_timestep": round(confirmation.kept_finer, 3),
        "kept_from_other_starts": round(confirmation.kept_nudged, 3),
        "genome": str(champion.genome),
    }
    write_text(path, json.dumps(walker, indent=2) + "\n")


if __name__ == "__main__":
    write_walker(evolve(Settings().with_(generations=N_GENERATIONS)), file_path(sys.argv[1]))
