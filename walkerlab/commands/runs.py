"""Commands ``evolve``, ``resume``, ``show``, ``table`` and ``rescue``."""

from __future__ import annotations  # Run is imported for type checking only

import argparse
import sys
from typing import TYPE_CHECKING

from walkerlab.commands.terminal import EXIT_INTERRUPTED, print_safely
from walkerlab.system.file_sets import OutputError
from walkerlab.system.files import display_path, folder_path, quote_path
from walkerlab.system.interrupts import interrupts_held
from walkerlab.text.escape import printable

if TYPE_CHECKING:
    from walkerlab.evolution.run import Run
    from walkerlab.evolution.stopping import Stop


def evolve_command(arguments: argparse.Namespace) -> int:
    """Run an evolution and write it into a new folder; return the exit code."""
    with interrupts_held():
        from walkerlab.commands import flags
        from walkerlab.evolution.loading import load
        from walkerlab.runfile.opening import RunFileError
        from walkerlab.runfile.paths import RUN_FILE
        from walkerlab.simulation.workers import n_cores
        from walkerlab.view import summary

    settings = flags.build_settings(vars(arguments), arguments.unknown_words)
    stop = _build_stop(arguments)
    path = folder_path(arguments.out, "--out") / RUN_FILE
    if path.exists():
        raise RunFileError(
            f"{display_path(arguments.out)} already holds a run, and a run is never overwritten.\n"
            f"Resume it:        walkerlab {_resume_words(load(path))}\n"
            f"Start a new one:  walkerlab evolve --out ANOTHER-FOLDER"
        )
    if not arguments.quiet:
        print(summary.describe_start(settings, n_cores()), flush=True)
    with interrupts_held():
        from walkerlab.evolution import running  # imports mujoco
    try:
        run = running.evolve(settings, path, progress=not arguments.quiet, stop=stop)
    except KeyboardInterrupt:
        if not path.exists() or not (run := load(path)).n_generations:
            raise
    return _finish(run, quiet=arguments.quiet)


def resume_command(arguments: argparse.Namespace) -> int:
    """Resume a run; if it is complete, write missing output files. Return the exit code."""
    with interrupts_held():
        from walkerlab.commands import flags
        from walkerlab.evolution import outputs
        from walkerlab.evolution.loading import load, reject_version_1
        from walkerlab.evolution.stored_functions import restore_user_functions
        from walkerlab.runfile import experiments, paths
        from walkerlab.runfile.opening import RunFileError
        from walkerlab.simulation.workers import n_cores
        from walkerlab.view import summary

    stop = _build_stop(arguments)
    changes = flags.given_settings(vars(arguments))
    if experiments.is_experiment(paths.locate_run_file(arguments.path)):
        folder = arguments.path if arguments.path.is_dir() else arguments.path.parent
        raise RunFileError(
            f"{display_path(arguments.path)} contains an experiment, not a run. Continue it with: walkerlab compare "
            f"--out {quote_path(folder)}"
        )
    run = load(arguments.path)
    reject_version_1(run)
    run = restore_user_functions(run, {}, replaced=changes)
    done = run.n_generations
    settings = run.settings.with_(**changes)
    wanted = settings.algorithm.generations
    if done == wanted and run.path and not changes.keys() - {"generations"}:
        if not outputs.are_there(run.path):  # the run was stopped before they were written
            _write_outputs(run)
        if not arguments.quiet:
            print(f"All {done} generations are done; to continue: walkerlab {_resume_words(run)}")
        return 0
    if not arguments.quiet and done < wanted:
        print(summary.describe_start(settings, n_cores(), done=done), flush=True)
    with interrupts_held():
        from walkerlab.evolution import running
    run = running.resume(arguments.path, progress=not arguments.quiet, stop=stop, **changes)
    return _finish(run, quiet=arguments.quiet)


def _build_stop(arguments: argparse.Namespace) -> Stop | None:
    """Return the conditions under which the run stops, from the flags; None without any.

    Raises:
        StopError: If a value is not allowed.
    """
    from walkerlab.commands import flags
    from walkerlab.evolution.stopping import Stop

    conditions = flags.stop_conditions(vars(arguments))
    return Stop(**conditions) if conditions else None


def _resume_words(run: Run) -> str:
    """Return the arguments that resume a run; if it is complete, with twice as many generations."""
    done = run.n_generations
    wanted = run.settings.algorithm.generations
    return f"resume {_run_path(run)}" + (f" --generations {2 * done}" if done == wanted else "")


def _run_path(run: Run) -> str:
    """Return the shortest quoted path of a run: its folder, if the file has the default name."""
    from walkerlab.runfile.paths import RUN_FILE

    assert run.path
    return quote_path(run.path.parent if run.path.name == RUN_FILE else run.path)


def _finish(run: Run, *, quiet: bool) -> int:
    """Write the output files, print a summary and the next commands, and return the exit code."""
    with interrupts_held():
        from walkerlab.evolution import outputs
        from walkerlab.view import summary

    assert run.path
    folder = run.path.parent
    wanted = run.settings.algorithm.generations
    is_stopped = run.n_generations < wanted
    if is_stopped and not (quiet and run.stop_reason):
        print(f"\n{_describe_stopped_run(run)}", file=sys.stderr if quiet else sys.stdout)
    if not quiet:
        print()
        print_safely(summary.describe_champion(run.records, run.settings.model_dump()))
        if run.champion.verdict == "ok":
            print(run.confirm())
        print("\nDrawing the report …", flush=True)
    _write_outputs(run)
    if not quiet:
        print(f"\nFiles in the folder {display_path(folder)}:")
        print("\n".join(f"  {name:13} {about}" for name, about in outputs.OUTPUT_FILES.items()))
        print("\nNext commands:")
        next_steps = {
            f"show {_run_path(run)}": "summary of the run, and the ancestors of the champion",
            _resume_words(run): "evolve more generations",
            "lab": "open the notebooks",
        }
        width = max(map(len, next_steps))
        print("\n".join(f"  walkerlab {words:{width}}   {about}" for words, about in next_steps.items()))
    return EXIT_INTERRUPTED if is_stopped and not run.stop_reason else 0


def _write_outputs(run: Run) -> None:
    from walkerlab.evolution import outputs

    assert run.path
    try:
        outputs.write_outputs(run, run.path.parent)
    except OutputError as error:
        raise OutputError(
            f"The run is complete, but its output files could not be written. {error}\n"
            f"After fixing this, write them with: walkerlab resume {_run_path(run)}"
        ) from error


def show_command(arguments: argparse.Namespace) -> int:
    """Print a summary of a run or an experiment; return the exit code."""
    from walkerlab.evolution.loading import load
    from walkerlab.runfile import experiments, paths, provenance, store
    from walkerlab.view import summary

    path = paths.locate_run_file(arguments.path)
    if path.is_file() and experiments.is_experiment(path):
        from walkerlab.experiment.experiment import load_experiment

        experiment = load_experiment(path)
        print_safely(f"{experiment!r}\n\n{experiment.summary()}")
        return 0
    run = load(arguments.path)
    settings = run.settings.model_dump()
    records = run.records
    print_safely(f"{display_path(path)}: {run.n_generations} of {run.settings.algorithm.generations} generations")
    run_facts, versions = store.read_facts(path)
    versions.pop(provenance.STOPPED, None)
    if run.stop_reason:
        print_safely(f"stopped because {run.stop_reason}")
    for title, facts in (("it has", run_facts), ("made with", versions)):
        if not facts:
            continue  # a run without generations
        print_safely(f"{title} {', '.join(printable(f'{name} {fact}') for name, fact in facts.items())}")
    for stage in run.stages[1:]:
        print_safely(f"from generation {stage.first} on with {printable(stage)}")
    print_safely(f"\n{summary.list_changed_settings(settings)}")
    if not run.n_generations:
        print_safely(f"\nNo generation is complete yet. Start the first one: walkerlab {_resume_words(run)}")
        return 0
    champion = run.champion
    for section in (
        summary.tabulate_generations(records, settings),
        summary.tabulate_verdicts(records),
        summary.describe_champion(records, settings),
        summary.describe_genome(champion),
        summary.tabulate_descent(records, champion.individual),
    ):
        print_safely(f"\n{section}")
    return 0


def table_command(arguments: argparse.Namespace) -> int:
    """Write the table of a run or an experiment for a spreadsheet; return the exit code."""
    from walkerlab.evolution.loading import load
    from walkerlab.runfile import experiments, paths
    from walkerlab.view.table_files import save_table

    path = paths.locate_run_file(arguments.path)
    if path.is_file() and experiments.is_experiment(path):
        from walkerlab.experiment.experiment import load_experiment

        records = load_experiment(path).records
    else:
        records = load(arguments.path).records
    try:
        file = save_table(records, arguments.file, decimal=arguments.decimal)
    except (ValueError, ModuleNotFoundError, OSError) as error:
        raise OutputError(f"{error}.") from error
    print_safely(f"{len(records):,} rows, one for each robot and generation, are in {display_path(file)}")
    return 0


def rescue_command(arguments: argparse.Namespace) -> int:
    """Save the intact generations of a damaged run in a new folder; return the exit code."""
    from walkerlab.evolution import loading
    from walkerlab.runfile.opening import RunFileError
    from walkerlab.runfile.paths import RUN_FILE

    out = display_path(folder_path(arguments.out, "--out"))
    if (arguments.out / RUN_FILE).exists():
        raise RunFileError(f"{out} already holds a run. Choose another folder for the saved one: --out ANOTHER-FOLDER")
    run = loading.rescue(arguments.path, arguments.out / RUN_FILE)
    done = run.n_generations
    wanted = run.settings.algorithm.generations
    saved = f"{done} of {wanted} intact generations are" if done else "No generation is intact; the settings are"
    print(f"{saved} saved in {out}; {display_path(arguments.path)} was not changed.")
    print(f"Resume the run: walkerlab {_resume_words(run)}")
    return 0


def describe_stop(arguments: argparse.Namespace) -> str:
    """Return the message for a command that was stopped: what is saved, and how to resume."""
    if arguments.run not in (evolve_command, resume_command):
        return "Stopped."
    from walkerlab.evolution.loading import load
    from walkerlab.runfile.opening import RunFileError

    try:
        return _describe_stopped_run(load(arguments.path if arguments.run is resume_command else arguments.out))
    except RunFileError:
        return "Stopped before the first walk; there is no run file."


def _describe_stopped_run(run: Run) -> str:
    """Return the message for a run that was stopped: what is saved, and how to resume it."""
    done = run.n_generations
    wanted = run.settings.algorithm.generations
    progress = f"after {done} of {wanted} generations, which are saved"
    if not done:
        progress = "before the first generation was complete; the settings are saved"
    if run.stop_reason:
        progress += f", because {run.stop_reason}"
    return f"Stopped {progress}.\nResume with: walkerlab resume {_run_path(run)}"
