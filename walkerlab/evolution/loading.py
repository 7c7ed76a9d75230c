"""Read a run from its file, even if the file is damaged."""

import warnings
from pathlib import Path

from walkerlab.evolution.founders import read_founders
from walkerlab.evolution.run import Run
from walkerlab.evolution.stages import restore_stages
from walkerlab.evolution.stored_functions import restore_settings
from walkerlab.genome.text import is_of_version_1
from walkerlab.runfile import paths, provenance, records, store
from walkerlab.runfile.missing_functions import remember_walks
from walkerlab.runfile.opening import DamagedError, RunFileError
from walkerlab.system import file_sets
from walkerlab.system.files import display_path
from walkerlab.text.escape import printable


def load(path: str | Path) -> Run:
    """Read a run from its file; user functions are known by name only, which is enough to view the run.

    ``resume`` and ``run.confirm(fitness=my_function)`` require the user functions themselves.

    Args:
        path: Run file, or the folder that contains it.

    Warns:
        UserWarning: If the run was made by version 0.1, whose robots walked differently.

    Raises:
        RunFileError: If the file does not exist, is not a run, or is damaged.
    """
    path = paths.locate_run_file(path)
    file_sets.restore(path.parent)
    plain, table = store.read(path)
    history = store.read_history(path)
    _, facts = store.read_facts(path)
    try:
        records.check_table(table)
        settings = restore_settings(plain)
        n_done = int(table.generation.nunique())
        since = provenance.rated_since(facts, n_done)
        earlier = [restore_settings(stage.settings) for stage in history.earlier]
        stages = restore_stages(history, settings, earlier)
        founders = read_founders(history.founders or None, settings)
        if history.last_first > n_done:
            raise ValueError(f"its last stage begins with generation {history.last_first}")
    except (TypeError, KeyError, ValueError, RecursionError) as error:
        raise DamagedError(path, str(error)) from error
    sizes = table.groupby("generation").size()
    if sizes.to_dict() != dict.fromkeys(range(len(sizes)), settings.algorithm.population_size):
        raise DamagedError(path, "its table has too few or too many robots")
    remember_walks(settings, table.loc[table.generation >= since, :])
    run = Run(settings, table, path, since, printable(facts.get(provenance.STOPPED, "")), stages, founders)
    if _is_made_by_version_1(run):
        warnings.warn(
            f"{display_path(path)} was made by walkerlab 0.1. Its table and genomes are complete, but its robots walk "
            "differently in this version, so that replays and pictures can differ from the table.",
            stacklevel=2,
        )
    return run


def reject_version_1(run: Run) -> None:
    """Check that the robots of a run walk in this version as they did when they were rated.

    Raises:
        RunFileError: If the run was made by version 0.1.
    """
    if _is_made_by_version_1(run):
        raise RunFileError(
            f"{display_path(run.path)} was made by walkerlab 0.1, whose robots walked differently, and cannot be "
            "resumed. Evolve again with its settings: wl.evolve(wl.load(path).settings, new_path)"
        )


def _is_made_by_version_1(run: Run) -> bool:
    return bool(run.n_generations) and is_of_version_1(str(run.records.genome[0]))


def rescue(path: str | Path, to: str | Path) -> Run:
    """Save the undamaged part of a damaged run, its generations before the damage, in a new run file.

    Args:
        path: Damaged run file, or the folder that contains it; it is not changed.
        to: Run file to create.

    Returns:
        The new run, which ``resume(to)`` continues; without generations if only the settings could be saved.

    Raises:
        RunFileError: If nothing can be recovered, or the new file exists already or cannot be created.
    """
    path = paths.locate_run_file(path)
    to = paths.new_path(to, "to")
    store.rescue(path, to)
    try:
        return load(to)
    except DamagedError as error:  # the damage is older than the seals of the generations
        to.unlink()
        raise RunFileError(f"nothing can be recovered from {display_path(path)}: {error.what}.") from error
