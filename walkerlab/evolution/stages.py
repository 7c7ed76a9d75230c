"""Stages of a run: its generations with the same settings. ``resume`` with other settings begins a new stage."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from walkerlab.runfile.history import EarlierStage, Founder, History
from walkerlab.runfile.missing_functions import MissingFunction
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import NO_EFFECT_ON_WALKS
from walkerlab.settings.values import code_text

LOADS = ("carry_weight", "drag_weight")
"""Settings of the robot that do not limit its genome."""


@dataclass(frozen=True)
class Stage:
    """Generations of a run with the same settings.

    Attributes:
        first: Number of the first generation.
        settings: Settings of these generations.
        changes: New value of each setting that differs from the previous stage; empty for the first stage.
    """

    first: int
    settings: Settings = field(repr=False)
    changes: Mapping[str, Any] = field(default_factory=dict[str, Any])

    def __str__(self) -> str:
        """Return the changes as text: ``structure='stairs', mutation_rate=0.02``."""
        return ", ".join(f"{name}={code_text(value)}" for name, value in self.changes.items())


def plan_stages(stages: Sequence[Stage], settings: Settings, n_done: int) -> tuple[Stage, ...]:
    """Return the stages of a run whose further generations have the given settings.

    Args:
        stages: Stages so far.
        settings: Settings of the further generations.
        n_done: Number of generations that are done; a stage without any is replaced.

    Returns:
        Stages, the last with ``settings``; a new one is added only if settings other than the number of generations
        change.
    """
    earlier = [stage for stage in stages if stage.first < n_done]
    if not earlier:
        return (Stage(0, settings),)
    changes = find_changes(earlier[-1].settings, settings)
    if not changes:
        return (*earlier[:-1], replace(earlier[-1], settings=settings))
    return (*earlier, Stage(n_done, settings, changes))


def restore_stages(history: History, settings: Settings, earlier: Sequence[Settings]) -> tuple[Stage, ...]:
    """Return the stages of a stored run.

    Args:
        history: History of the run.
        settings: Settings of the last stage.
        earlier: Settings of the earlier stages.
    """
    all_settings = [*earlier, settings]
    firsts = [*(stage.first for stage in history.earlier), history.last_first]
    changes = [{}, *(find_changes(before, after) for before, after in zip(earlier, all_settings[1:], strict=True))]
    return tuple(Stage(*parts) for parts in zip(firsts, all_settings, changes, strict=True))


def record_history(stages: Sequence[Stage], founders: tuple[Founder, ...]) -> History:
    """Return what a run file records about stages and founders."""
    earlier = tuple(EarlierStage(stage.first, stage.settings.model_dump()) for stage in stages[:-1])
    return History(founders, earlier, stages[-1].first)


def find_changes(before: Settings, after: Settings) -> dict[str, Any]:
    """Return the new value of each setting that differs, except for the number of generations.

    User functions are compared by name and arguments, because a run file stores nothing else about them.
    """
    old, new = (settings.model_dump() for settings in (before, after))
    return {
        name: getattr(getattr(after, domain), setting)
        for name, (domain, setting) in Settings.field_locations().items()
        if name != "generations" and _identity(old[domain][setting]) != _identity(new[domain][setting])
    }


def changes_walks(changes: Mapping[str, Any]) -> bool:
    """Return whether robots walk or are rated differently with changed settings."""
    locations = Settings.field_locations()
    return any(
        name == "fitness" or (locations[name][0] != "algorithm" and name not in NO_EFFECT_ON_WALKS) for name in changes
    )


def check_changes(before: Settings, after: Settings) -> None:
    """Check that a run can continue with changed settings.

    Raises:
        SettingsError: If a setting cannot change within a run.
    """
    locations = Settings.field_locations()
    errors: list[str] = []
    for name, value in find_changes(before, after).items():
        domain, setting = locations[name]
        if name in _FIXED:
            reason = _FIXED[name]
        elif domain == "robot" and setting not in LOADS:
            reason = "the stored robots are within the limits that the run began with"
        else:
            continue
        stored = code_text(getattr(getattr(before, domain), setting))
        errors.append(
            f"{domain.capitalize()}.{setting} cannot change when a run is resumed, because {reason}: set it to "
            f"{stored}. To evolve with {name}={code_text(value)}, start a new run from the last generation of "
            f"this one: wl.evolve(run.settings.with_({name}={code_text(value)}), population=run)"
        )
    if errors:
        raise SettingsError("\n".join(errors))


_FIXED = {
    "population_size": "every generation of a run has the same size",
    "seed": "the random numbers of all its generations depend on it",
    "frozen": "the existing robots have different genes",
}
"""Settings of the algorithm that cannot change within a run, and why."""

_STAND_IN_MODULE = MissingFunction.__module__


def _identity(stored: Any) -> Any:
    """Return what identifies a stored value; without the module of a user function."""
    match stored:
        case list():
            return [_identity(item) for item in list[Any](stored)]
        case {"function": str(address), **rest}:
            module, _, name = address.rpartition(".")
            is_ours = module.startswith("walkerlab.") and module != _STAND_IN_MODULE
            return is_ours, name, rest
        case _:
            return stored
