"""Run an evolution to its end, with a progress bar: a new one, or one that is resumed from its file."""

from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from tqdm.auto import tqdm

from walkerlab.evolution.arguments import reject_unknown_arguments
from walkerlab.evolution.evolution import Evolution
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.founders import FirstPopulation
from walkerlab.evolution.generation import Generation
from walkerlab.evolution.interruption import interrupted_message
from walkerlab.evolution.resuming import prepare_resume
from walkerlab.evolution.run import Run
from walkerlab.evolution.stopping import Stop
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.text.numbers import format_significant


def evolve(
    settings: Settings | None = None,
    path: str | Path | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    *,
    population: FirstPopulation | None = None,
    stop: Stop | None = None,
    on_generation: Callable[[Generation], object] | None = None,
    **unknown: Any,
) -> Run:
    """Evolve walkers from a first generation; Ctrl-C stops and returns the generations that are done.

    If Ctrl-C comes before the first generation is done, ``KeyboardInterrupt`` is raised; a run file then contains only
    the settings.

    Args:
        settings: Complete settings of the run; the defaults if None.
        path: Run file, created before the first walk; if None, the run is discarded when it is no longer referenced.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a progress bar.
        population: First individuals of generation 0, brought within the limits; the others are random. Genomes, their
            texts, or individuals; or a run or its table, whose last generation is used, best first. The column
            ``operators`` of the new table shows their origin.
        stop: Conditions under which the run stops before its last generation, such as ``wl.Stop(after="10min",
            target=8, patience=20)``; the run file records which of them stopped it.
        on_generation: Function that is called with each ``Generation`` once it is stored. If it raises an error,
            the run ends and is saved.
        **unknown: Rejected; individual settings belong in ``settings``.

    Returns:
        The run: ``.records``, ``.champion``, ``.lineage(individual)``.

    Warns:
        UserWarning: Once in a run, if one very low fitness removes the pressure from ``gradient`` selection, or if the
            fitness function rejects every robot of a generation.

    Raises:
        OperatorError: If a user function does not do what its slot requires.
        RunFileError: If ``path`` exists already or cannot be written.
        SettingsError: If the settings freeze genes, and there is no ``population``.
        TypeError: If an argument is of the wrong type, or its name is unknown.
        ValueError: If ``population`` contains no genomes or too many, or one of them is not valid.
        WorkersLostError: If the workers do not answer, or run out of memory.

    Every error has a note that names the file with the run so far, and its path as ``error.saved_path``. A run without
    a file is saved in ``kept.walk`` if a generation is done.
    """
    reject_unknown_arguments("evolve", unknown)
    settings = Settings() if settings is None else require_settings(settings)
    with _progress_bar(settings, progress) as bar:
        evolution = Evolution(settings, path, executor, on_walks=bar.update, stop=stop, population=population)
        return _run_to_end(evolution, bar, on_generation)


def resume(
    path: str | Path,
    generations: int | None = None,
    executor: Executor | None = None,
    progress: bool = True,
    *,
    rerate: bool = False,
    stop: Stop | None = None,
    on_generation: Callable[[Generation], object] | None = None,
    **changes: Any,
) -> Run:
    """Continue a run; its table becomes the same as that of an uninterrupted run.

    Changed settings begin a new stage: ``wl.resume(path, 40, structure="stairs")``. Robots keep their numbers and
    parents. If the terrain, the loads, the simulation or the fitness changes, the last generation is simulated again,
    but only to choose parents, and the champion is the best of the new stage. ``run.stages`` lists the stages.

    Args:
        path: Run file, or the folder that contains it.
        generations: Total number of generations; if None, the number in the settings.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a progress bar.
        rerate: Whether to continue from new ratings of the last generation if its fitness function has changed.
            Earlier generations keep their numbers, and the champion is taken from later ones.
        stop: Conditions under which the run stops, as for ``evolve``; those of earlier calls no longer apply.
        on_generation: Function that is called with each ``Generation``, as for ``evolve``.
        **changes: Changed settings for further generations, by name; and user functions by slot, if the run was made
            with any: ``mutation=my_mutation``. If one of these is a fitness function, the last generation is simulated
            again to check that its ratings are the same.

    Warns:
        UserWarning: If the run was made with other versions or on another kind of processor, or the source of an
            operator has changed.

    Raises:
        RunFileError: If the file does not exist, is not a run, is damaged, or was made by version 0.1; if a user
            function is missing or differs from the recorded one; or if the fitness function rates the last generation
            differently from the file.
        SettingsError: If ``generations`` is out of range, a setting is unknown or has an invalid value, or a setting
            cannot change within a run.
    """
    prepared = prepare_resume(path, generations, changes, stacklevel=3)
    done = prepared.run.n_generations
    with _progress_bar(prepared.settings, progress, done=done) as bar:
        options: dict[str, Any] = {"executor": executor, "on_walks": bar.update, "stop": stop}
        evolution = prepared.create_evolution(rerate, **options)
        del prepared  # frees the memory of its table, which is in the file
        return _run_to_end(evolution, bar, on_generation)


def _progress_bar(settings: Settings, progress: bool, done: int = 0) -> Any:
    total = n_walks(settings, done)
    return tqdm(total=total, unit=" walks", disable=not progress or not total, leave=True)


def _run_to_end(evolution: Evolution, bar: Any, on_generation: Callable[[Generation], object] | None = None) -> Run:
    """Run until the last generation, a condition of ``stop`` or Ctrl-C, and show the progress."""
    try:
        for generation in evolution:
            best = generation.champion
            result = f"best {format_significant(best.fitness)}" if best.verdict == "ok" else "no walk counted"
            bar.set_postfix_str(f"generation {generation.number}, {result}")
            if on_generation:
                _call_back(on_generation, generation, evolution)
    except KeyboardInterrupt:
        if not evolution.n_generations:
            raise KeyboardInterrupt(interrupted_message(evolution.path, evolution.settings)) from None
    return evolution.run


def _call_back(on_generation: Callable[[Generation], object], generation: Generation, evolution: Evolution) -> None:
    """Call a function with a generation; if it raises an error, the run is saved and the error says where."""
    try:
        on_generation(generation)
    except Exception as error:
        evolution.save_run_after(error)
        raise
