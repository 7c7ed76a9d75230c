"""Compare the default genetic algorithm with random search at equal evaluations, on four kinds of ground.

    python -m benchmarks.random_search --folder FOLDER [--seeds 10]

All settings but those of the ground are the defaults: 1,452 walks in each run. The whole experiment is one call of
``wl.compare``; its file is ``FOLDER/random_search.walk``, and the same command continues it. The report and the tables
of docs/experiments.md are written next to it.
"""

import argparse
import time
from pathlib import Path

import walkerlab as wl
from benchmarks.walker_jobs import GROUNDS, create_settings
from walkerlab.experiment.optimisers import Optimiser
from walkerlab.experiment.summary import Summary
from walkerlab.system.files import write_text


def create_conditions() -> dict[str, wl.Settings | tuple[Optimiser, wl.Settings]]:
    """Return the conditions for ``wl.compare``: both searches on each ground."""
    conditions: dict[str, wl.Settings | tuple[Optimiser, wl.Settings]] = {}
    for ground in GROUNDS:
        settings = create_settings(ground, {})
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
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    conditions = create_conditions()
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
