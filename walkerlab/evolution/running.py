"""Run an evolution to its end, with a progress bar: a new one, or one that is resumed from its file."""

import warnings
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from tqdm.auto import tqdm

from walkerlab.evolution.evolution import Evolution, reject_unknown_arguments
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.interruption import interrupted_message
from walkerlab.evolution.loading import load
from walkerlab.evolution.rerating import changed_operators, function_facts
from walkerlab.evolution.run import Run
from walkerlab.evolution.stored_functions import restore_user_functions
from walkerlab.genome.text import is_of_version_1
from walkerlab.runfile import paths, provenance, store
from walkerlab.runfile.opening import RunFileError
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.system.files import display_path
from walkerlab.text.numbers import format_significant


def evolve(
    settings: Settings | None = None,
    path: str | Path | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    **unknown: Any,
) -> Run:
    """Evolve walkers from a random first generation; Ctrl-C stops and returns the generations that are done.

    If Ctrl-C comes before the first generation is done, ``KeyboardInterrupt`` is raised; a run file then contains only
    the settings.

    Args:
        settings: Complete settings of the run; the defaults if None.
        path: Run file, created before the first walk; if None, the run is discarded when it is no longer referenced.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a progress bar.
        **unknown: Rejected; individual settings belong in ``settings``.

    Returns:
        The run: ``.records``, ``.champion``, ``.lineage(individual)``.

    Warns:
        UserWarning: Once in a run, if one very low fitness removes the pressure from ``gradient`` selection, or if the
            fitness function rejects every robot of a generation.

    Raises:
        OperatorError: If a user function does not do what its slot requires.
        RunFileError: If ``path`` exists already or cannot be written.
        TypeError: If an argument is of the wrong type, or its name is unknown.
        WorkersLostError: If the workers do not answer, or run out of memory.

    Every error has a note that names the file with the run so far, and its path as ``error.saved_path``. A run without
    a file is saved in ``kept.walk`` if a generation is done.
    """
    reject_unknown_arguments("evolve", unknown)
    settings = Settings() if settings is None else require_settings(settings)
    with _progress_bar(settings, progress) as bar:
        return _run_to_end(Evolution(settings, path, executor, on_walks=bar.update), bar)


def resume(
    path: str | Path,
    generations: int | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    *,
    rerate: bool = False,
    **functions: Any,
) -> Run:
    """Continue a run; its table becomes the same as that of a run without an interruption.

    Args:
        path: Run file, or the folder that contains it.
        generations: Total number of generations; if None, the number in the settings.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a progress bar.
        rerate: Whether to continue from new ratings of the last generation if its fitness function has changed.
            Earlier generations keep their numbers, and the champion is taken from later ones.
        **functions: User functions by slot, if the run was made with any: ``mutation=my_mutation``. If one is a fitness
            function, the last generation is simulated again to check that its ratings are the same.

    Warns:
        UserWarning: If the run was made with other versions or on another kind of processor, or the source of an
            operator has changed.

    Raises:
        RunFileError: If the file does not exist, is not a run, is damaged, or was made by version 0.1; if a user
            function is missing or differs from the recorded one; or if the fitness function rates the last generation
            differently from the file.
        SettingsError: If ``generations`` is out of range.
    """
    run = restore_user_functions(load(path), functions)
    path = paths.locate_run_file(path)
    if run.n_generations and is_of_version_1(str(run.records.genome[0])):
        raise RunFileError(
            f"{display_path(path)} was made by walkerlab 0.1, whose robots walked differently, and cannot be resumed. "
            "Evolve again with its settings: wl.evolve(wl.load(path).settings, new_path)"
        )
    done = run.n_generations
    _, facts = store.read_facts(path)
    if changed := provenance.describe_differences(facts, provenance.current_facts()):
        warnings.warn(
            f"{display_path(path)} was made with {changed}. The generations that are done stay the same; later ones "
            "can differ in the last digits from what they would have been there, and so can everything that depends "
            "on them. The file records for each generation what it was made with.",
            stacklevel=2,
        )
    settings = run.settings if generations is None else run.settings.with_(generations=generations)
    if settings.algorithm.generations < done:
        raise SettingsError(
            f"{display_path(path)} has {done} generations already; generations is the total and must be {done} or more."
        )
    if changed := changed_operators(facts, function_facts(settings)):
        warnings.warn(
            f"{display_path(path)} was made with different code for its {changed}. The run continues with the "
            "given functions; its file records for each generation which code it was made with.",
            stacklevel=2,
        )
    with _progress_bar(settings, progress, done=done) as bar:
        evolution = Evolution.continue_run(run, path, settings, facts, rerate, executor=executor, on_walks=bar.update)
        del run  # frees the memory of its table, which is in the file
        return _run_to_end(evolution, bar)


def _progress_bar(settings: Settings, progress: bool, done: int = 0) -> Any:
    total = n_walks(settings, done)
    return tqdm(total=total, unit=" walks", disable=not progress or not total, leave=True)


def _run_to_end(evolution: Evolution, bar: Any) -> Run:
    """Run until the last generation or Ctrl-C, and show the progress."""
    try:
        for generation in evolution:
            best = generation.champion
            result = f"best {format_significant(best.fitness)}" if best.verdict == "ok" else "no walk counted"
            bar.set_postfix_str(f"generation {generation.number}, {result}")
    except KeyboardInterrupt:
        if not evolution.n_generations:
            raise KeyboardInterrupt(interrupted_message(evolution.path, evolution.settings)) from None
    return evolution.run
