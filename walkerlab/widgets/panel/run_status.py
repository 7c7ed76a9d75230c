"""Text about a run in the panel, and the robot whose walk the panel shows."""

from walkerlab.evolution.forecast import describe_duration, estimate_seconds, n_walks
from walkerlab.evolution.fragility import further_starts
from walkerlab.evolution.live import LiveRun, State
from walkerlab.runfile.records import find_champion
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.system.errors import WalkerlabError
from walkerlab.text.numbers import with_unit
from walkerlab.widgets.panel.pre_evolved import load_pre_evolved_walker
from walkerlab.widgets.panel.run_folders import ListedRun
from walkerlab.widgets.panel.transport import Transport
from walkerlab.widgets.panel.walker_view import ShownWalker


def describe_state(live: LiveRun) -> str:
    """Describe the state and the progress of a live run in a sentence."""
    total = live.settings.algorithm.generations
    done = f"{live.n_generations} of {pluralize(total, 'generation')} done"
    match live.state:
        case State.running:
            left = "" if live.seconds_left is None else f", {describe_duration(live.seconds_left)} left"
            return f"Running: {done}{left}. The pictures follow."
        case State.failed:
            return f"Failed: {done}. {error_text(live.error)}"
        case State.finished if live.run.stop_reason:
            return f"Finished: {done} in {live.seconds:.0f} s, because {live.run.stop_reason}."
        case State.finished:
            last = f", the last {total - live.n_earlier}" if live.n_earlier else ""
            return f"Finished: {pluralize(total, 'generation')}{last} in {live.seconds:.0f} s."
        case state:
            return f"{state.capitalize()}: {done} ({live.seconds:.0f} s)."


def show_state(transport: Transport, live: LiveRun) -> None:
    """Show the state and the progress of a live run in the run controls."""
    with transport.hold_sync():
        transport.state = live.state
        transport.words = describe_state(live)
        transport.share = live.n_done / live.n_walks if live.n_walks else 1.0


def error_text(error: BaseException | None) -> str:
    """Return the message of an error, with its type unless the message is written for users."""
    return str(error) if isinstance(error, WalkerlabError) else f"{type(error).__name__}: {error}"


def describe_forecast(settings: Settings, last: LiveRun | None) -> str:
    """Describe the size and the duration of a new run, from the speed of the last run if it was in the same world.

    Args:
        settings: Settings of the run.
        last: Last run of the panel; None before the first.
    """
    algorithm = settings.algorithm
    if last and last.seconds_per_walk and _world_of(last.settings) == _world_of(settings):
        seconds = last.seconds_per_walk * n_walks(settings)
    else:
        seconds = estimate_seconds(settings)
    run = f"{algorithm.generations} generations of {algorithm.population_size} robots"
    return f"A new run: {run}, {describe_duration(seconds)}."


def _world_of(settings: Settings) -> tuple[object, ...]:
    """Return the domains of settings that a walk depends on."""
    return settings.terrain, settings.robot, settings.simulation


def best_walker(entry: ListedRun | None, generation: int | None, run_name: str = "") -> ShownWalker:
    """Return the robot whose walk the panel shows: the best of a run, or the pre-evolved one before any run.

    Args:
        entry: Selected run; None if no run is selected.
        generation: Generation whose best robot is shown; None for the best of the whole run.
        run_name: Name of the run, if there are several; it is included in the texts.
    """
    run = entry.visible if entry else None
    n_missing = entry.n_missing if entry else 0
    if run is None or not run.n_generations:
        walker = load_pre_evolved_walker()
        seconds = walker.settings.simulation.duration
        words = (
            f"Evolved in {walker.n_trials:,} trials: {with_unit(walker.distance, 'm')} in {seconds:g} s. "
            f"Press Start to evolve your own."
        )
        if entry and entry.live and not entry.live.is_over:
            words = "Your first robots are walking. The walker below is the pre-evolved one."
        return ShownWalker(walker.genome, walker.settings, "Pre-evolved walker", words)
    records = run.records
    best = find_champion(records if generation is None else records.loc[records.generation == generation])
    name, unit = name_and_unit(run.settings.algorithm.fitness)
    is_beginning = bool(entry and entry.live and not entry.live.n_generations)
    provisional = " (provisional)" if is_beginning and further_starts(run.settings) else ""
    result = f"{name} {with_unit(best.fitness, unit)}{provisional}" if best.verdict == "ok" else "no walk counted yet"
    in_run = f" in {run_name}" if run_name else ""
    if is_beginning:
        first = f"first {len(records)}" if n_missing else len(records)
        which = f"Best of the {first} random robots{in_run}"
    elif generation is not None:
        which = f"Best of generation {generation}{in_run}"
    elif entry and entry.live and not entry.live.is_over:
        which = f"Best so far{in_run}"
    else:
        which = f"Best of {run_name or 'the run'}"
    robot = (
        f"robot {best.individual}" if is_beginning else f"robot {best.individual}, born in generation {best.generation}"
    )
    name_of_robot = robot.capitalize() + (f", {run_name}" if run_name else "")
    settings = run.settings
    if generation is not None:
        settings = [stage.settings for stage in run.stages if stage.first <= generation][-1]
    words = f"{which}: {robot}, {result}.".replace(" m.", "\N{NO-BREAK SPACE}m.")
    return ShownWalker(best.genome, settings, name_of_robot, words)
