"""The result of a class: the runs in a shared folder, pooled in one table."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from walkerlab.evolution.loading import load
from walkerlab.evolution.run import Run
from walkerlab.lessons.exercises import LessonError
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.settings.values import code_text, pluralize
from walkerlab.system.files import display_path

MAX_NAMED = 5  # files that a warning names


def pool(folder: str | Path) -> pd.DataFrame:
    """Read the runs of a folder and of the folders in it, and return a table with a row for each run.

    ``wl.plots.best_of_each_run`` draws the table.

    Args:
        folder: Folder with run files, such as ``ada.walk`` or ``ada/run.walk``.

    Returns:
        Table with the columns ``name`` (of the file, or of its folder), ``condition`` (the settings in which the runs
        differ), ``seed``, ``file`` and those of the champion in ``run.records``, fittest first.

    Warns:
        UserWarning: If files are left out: damaged files, unfinished runs, runs with another fitness than most, and
            copies of a run.

    Raises:
        LessonError: If there is no such folder, or it has no usable run file.
    """
    folder = Path(folder).expanduser()
    if not folder.is_dir():
        raise LessonError(f"there is no folder {display_path(folder.absolute())}; write the path of the shared folder.")
    runs, left_out = _read_runs(folder)
    if left_out:
        named = "; ".join(left_out[:MAX_NAMED]) + ("; …" if len(left_out) > MAX_NAMED else "")
        warnings.warn(f"{pluralize(len(left_out), 'file')} left out: {named}", stacklevel=2)
    if not runs:
        raise LessonError(f"the folder {display_path(folder.absolute())} has no run file (.walk) that can be used.")
    conditions = _describe_conditions({path: run.settings.changes() for path, run in runs.items()})
    rows = [_row(folder, path, run, conditions[path]) for path, run in runs.items()]
    table = pd.concat(rows).sort_values("fitness", ascending=False, kind="stable", ignore_index=True)
    table.attrs |= next(iter(runs.values())).records.attrs
    return table


def _read_runs(folder: Path) -> tuple[dict[Path, Run], list[str]]:
    """Return the usable runs, keyed by path, and a clause for each other file that says why it is left out."""
    runs: dict[Path, Run] = {}
    left_out: list[str] = []
    for path in sorted(folder.rglob("*.walk")):
        name = path.relative_to(folder).as_posix()
        try:
            run = load(path)
        except RunFileError as error:
            left_out.append(f"{name}: {error}")
            continue
        if run.n_generations <= run.rated_since:
            left_out.append(f"{name}: no generation is complete")
        else:
            runs[path] = run
    names = [run.records.attrs["fitness"] for run in runs.values()]
    common = max(names, key=names.count, default="")
    first_of: dict[tuple[Any, ...], str] = {}
    for path, run in list(runs.items()):
        name = path.relative_to(folder).as_posix()
        key = (str(run.settings.changes()), run.n_generations, str(run.champion.genome))
        if run.records.attrs["fitness"] != common:
            left_out.append(f"{name}: its fitness is {run.records.attrs['fitness']}, that of the others {common}")
            del runs[path]
        elif first_of.setdefault(key, name) != name:
            left_out.append(f"{name}: the same run as {first_of[key]}")
            del runs[path]
    return runs, left_out


def _describe_conditions(changes: Mapping[Path, Mapping[str, Any]]) -> dict[Path, str]:
    """Return the settings in which the runs differ, apart from the seed: ``mutation='macro'``; "default" if empty."""
    texts = {
        path: {f"{name}={code_text(value)}": None for name, value in each.items() if name != "seed"}
        for path, each in changes.items()
    }
    shared = set.intersection(*map(set, texts.values()))
    return {path: ", ".join(text for text in each if text not in shared) or "default" for path, each in texts.items()}


def _row(folder: Path, path: Path, run: Run, condition: str) -> pd.DataFrame:
    inside = path.relative_to(folder)
    name = inside.parts[0] if len(inside.parts) > 1 else (folder.name if path.name == RUN_FILE else path.stem)
    records = run.records
    row = records[records.individual == run.champion.individual].head(1)
    facts = {"name": name, "condition": condition, "seed": run.settings.algorithm.seed, "file": inside.as_posix()}
    return pd.DataFrame([facts], index=row.index).join(row)
