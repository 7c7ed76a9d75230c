"""What ``evolve``, ``resume``, ``show`` and ``rescue`` do."""

from __future__ import annotations  # a run is named here before what it takes is loaded

import argparse
import sys
from typing import TYPE_CHECKING

from walkerlab.commands.terminal import INTERRUPTED, tell
from walkerlab.system.file_sets import OutputError
from walkerlab.system.files import folder_path, quoted, shown
from walkerlab.system.interrupts import interrupts_held
from walkerlab.text.html import printable

if TYPE_CHECKING:
    from walkerlab.evolution.run import Run


def evolve(given: argparse.Namespace) -> int:
    """Evolve into a new folder."""
    with interrupts_held():
        from walkerlab.commands import flags
        from walkerlab.evolution.loading import load
        from walkerlab.runfile.paths import RUN_FILE
        from walkerlab.runfile.store import RunFileError
        from walkerlab.simulation.workers import n_cores
        from walkerlab.view import summary

    settings = flags.settings_of(vars(given), given.strangers)
    path = folder_path(given.out, "--out") / RUN_FILE
    if path.exists():
        raise RunFileError(
            f"{shown(given.out)} holds a run already, and a run is never overwritten.\n"
            f"Go on with it:    walkerlab {_to_go_on(load(path))}\n"
            f"Begin a new one:  walkerlab evolve --out ANOTHER-FOLDER"
        )
    if not given.quiet:
        print(summary.opening(settings, n_cores()), flush=True)
    with interrupts_held():
        from walkerlab.evolution import running  # for which mujoco is loaded
    try:
        run = running.evolve(settings, path, progress=not given.quiet)
    except KeyboardInterrupt:
        if not path.exists() or not (run := load(path)).n_generations:
            raise
    return _finish(run, quiet=given.quiet)


def resume(given: argparse.Namespace) -> int:
    """Go on with a run, or if it is done, write what is missing beside it."""
    with interrupts_held():
        from walkerlab.evolution import outputs
        from walkerlab.evolution.loading import load
        from walkerlab.evolution.stored_functions import restore_user_functions
        from walkerlab.simulation.workers import n_cores
        from walkerlab.view import summary

    run = restore_user_functions(load(given.path), {})
    done, wanted = run.n_generations, given.generations
    wanted = run.settings.algorithm.generations if wanted is None else wanted
    if done == wanted and run.path:
        if not outputs.are_there(run.path):  # stopped when all but these was done
            _write_outputs(run)
        if not given.quiet:
            print(f"All {done} generations are done; to go on: walkerlab {_to_go_on(run)}")
        return 0
    if not given.quiet and done < wanted:
        print(summary.opening(run.settings.with_(generations=wanted), n_cores(), done=done), flush=True)
    with interrupts_held():
        from walkerlab.evolution import running
    return _finish(running.resume(given.path, given.generations, progress=not given.quiet), quiet=given.quiet)


def _to_go_on(run: Run) -> str:
    """Give the words that resume a run: to its end, or if it is there, to twice as many generations."""
    done, wanted = run.n_generations, run.settings.algorithm.generations
    return f"resume {_named(run)}" + (f" --generations {2 * done}" if done == wanted else "")


def _named(run: Run) -> str:
    """Name a run as briefly as a shell takes it: by its folder, if its file is the run file of that folder."""
    from walkerlab.runfile.paths import RUN_FILE

    assert run.path
    return quoted(run.path.parent if run.path.name == RUN_FILE else run.path)


def _finish(run: Run, *, quiet: bool) -> int:
    """Write what belongs into the run's folder, and say what has come of it and what to do next."""
    with interrupts_held():
        from walkerlab.evolution import outputs
        from walkerlab.view import summary

    assert run.path
    folder, wanted = run.path.parent, run.settings.algorithm.generations
    is_stopped = run.n_generations < wanted
    if is_stopped:
        print(f"\n{kept(run)}", file=sys.stderr if quiet else sys.stdout)
    if not quiet:
        print()
        tell(summary.champion_story(run.records, run.settings.model_dump()))
        if run.champion.verdict == "ok":
            print(run.confirm())
        print("\nDrawing the report …", flush=True)
    _write_outputs(run)
    if not quiet:
        print(f"\nIn the folder {shown(folder)} there are now")
        print("\n".join(f"  {name:13} {about}" for name, about in outputs.FILES.items()))
        print("\nWhat next?")
        next_steps = {
            f"show {_named(run)}": "what happened, and the champion's family",
            _to_go_on(run): "evolve on",
            "lab": "play with walkers in notebooks",
        }
        width = max(map(len, next_steps))
        print("\n".join(f"  walkerlab {words:{width}}   {about}" for words, about in next_steps.items()))
    return INTERRUPTED if is_stopped else 0


def _write_outputs(run: Run) -> None:
    from walkerlab.evolution import outputs

    assert run.path
    try:
        outputs.write(run, run.path.parent)
    except OutputError as error:
        raise OutputError(
            f"The run is whole, but its output files are not. {error}\n"
            f"When that is fixed, all of them are made by: walkerlab resume {_named(run)}"
        ) from error


def show(given: argparse.Namespace) -> int:
    """Print a run."""
    from walkerlab.evolution.loading import load
    from walkerlab.runfile import paths, store
    from walkerlab.view import summary

    run, path = load(given.path), paths.locate(given.path)
    settings, records = run.settings.model_dump(), run.records
    tell(f"{shown(path)}: {run.n_generations} of {run.settings.algorithm.generations} generations")
    whose, made_with = store.read_facts(path)
    for about, facts in (("it has", whose), ("made with", made_with)):
        tell(f"{about} {', '.join(printable(f'{name} {fact}') for name, fact in facts.items())}")
    tell(f"\n{summary.changed_settings(settings)}")
    if not run.n_generations:
        tell(f"\nNo generation is done yet. Start with the first one: walkerlab {_to_go_on(run)}")
        return 0
    best = run.champion
    for part in (
        summary.by_generation(records, settings),
        summary.verdict_counts(records),
        summary.champion_story(records, settings),
        summary.gene(best),
        summary.descent(records, best.individual),
    ):
        tell(f"\n{part}")
    return 0


def rescue(given: argparse.Namespace) -> int:
    """Save what is whole of a damaged run."""
    from walkerlab.evolution import loading
    from walkerlab.runfile.paths import RUN_FILE
    from walkerlab.runfile.store import RunFileError

    out = shown(folder_path(given.out, "--out"))
    if (given.out / RUN_FILE).exists():
        raise RunFileError(f"{out} holds a run already. Give the saved one another folder: --out ANOTHER-FOLDER")
    run = loading.rescue(given.path, given.out / RUN_FILE)
    done, wanted = run.n_generations, run.settings.algorithm.generations
    saved = f"{done} of {wanted} generations are whole, and" if done else "No generation is whole; the settings are"
    print(f"{saved} saved in {out}; {shown(given.path)} is left as it was.")
    print(f"Resume the run: walkerlab {_to_go_on(run)}")
    return 0


def stopped(given: argparse.Namespace) -> str:
    """Say how far a command had come that was stopped."""
    if given.run not in (evolve, resume):
        return "Stopped."
    from walkerlab.evolution.loading import load
    from walkerlab.runfile.store import RunFileError

    try:
        return kept(load(given.path if given.run is resume else given.out))
    except RunFileError:
        return "Stopped before any robot walked; there is no run file."


def kept(run: Run) -> str:
    """Say what is kept of a run that was stopped, and how to go on with it."""
    done, wanted = run.n_generations, run.settings.algorithm.generations
    kept = f"after {done} of {wanted} generations; all of these are kept"
    if not done:
        kept = "before the first generation was done; the settings are kept"
    return f"Stopped {kept}.\nResume with: walkerlab resume {_named(run)}"
