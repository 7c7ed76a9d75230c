"""Compare the default genetic algorithm with random search at equal evaluations, on four kinds of ground.

    python -m benchmarks.random_search --folder FOLDER [--seeds 10] [--defaults]

The budgets were fixed before each experiment. With ``--defaults``, the budget is the default one on all grounds. The
whole experiment is one call of ``wl.compare``; its file is ``FOLDER/random_search.walk``, and the same command
continues it. The report and the tables of docs/experiments.md are written next to it.
"""

import argparse
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import walkerlab as wl
from benchmarks.walker_jobs import GROUNDS, create_settings
from walkerlab.experiment.optimisers import Optimiser
from walkerlab.experiment.summary import Summary
from walkerlab.system.files import write_text

SHORT = {"population_size": 28, "generations": 30, "duration": 5.0}
BUDGETS = {"flat": SHORT, "incline": SHORT, "stairs": {}, "gravel": SHORT}
"""Settings of the budget that differ from the defaults, on each ground; it takes longer to learn to climb stairs."""


def create_conditions(budgets: Mapping[str, Any]) -> dict[str, wl.Settings | tuple[Optimiser, wl.Settings]]:
    """Return the conditions for ``wl.compare``: both searches on each ground.

    Args:
        budgets: Settings of the budget that differ from the defaults, by ground.
    """
    conditions: dict[str, wl.Settings | tuple[Optimiser, wl.Settings]] = {}
    for ground in GROUNDS:
        settings = create_settings(ground, {}).with_(**budgets.get(ground, {}))
        conditions[f"{ground}: evolution"] = settings
        conditions[f"{ground}: random search"] = (wl.random_search, settings)
    return conditions


def to_markdown(summary: Summary) -> str:
    """Return the sentence and the tables of an experiment in Markdown."""
    parts = [summary.text]
    for caption, header, cells in summary.tables():
        rows = [header, ["---", *["---:"] * (len(header) - 1)], *cells]
        parts += [f"{caption}:", "\n".join(f"| {' | '.join(row)} |" for row in rows)]
    return "\n\n".join(parts) + "\n"


def main() -> None:
    """Parse the arguments, run or continue the experiment, and print its result as Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--defaults", action="store_true", help="use the default budget on all grounds")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    conditions = create_conditions({} if arguments.defaults else BUDGETS)
    start = time.perf_counter()
    result = wl.compare(conditions, range(arguments.seeds), arguments.folder / "random_search.walk")
    minutes = (time.perf_counter() - start) / 60
    if not result.complete_seeds:
        print(result.status)
        return
    text = to_markdown(result.summary())
    write_text((arguments.folder / "random_search.md").absolute(), text)
    result.report(arguments.folder)
    print(f"{text}\n{minutes:.1f} min. {result.status}")


if __name__ == "__main__":
    main()
