"""Prepare a stored run for further generations, with the same or with changed settings."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from walkerlab.evolution.evolution import Evolution
from walkerlab.evolution.loading import load, reject_version_1
from walkerlab.evolution.rerating import changed_operators, function_facts
from walkerlab.evolution.run import Run
from walkerlab.evolution.stages import Stage, check_changes, plan_stages
from walkerlab.evolution.stored_functions import restore_user_functions, split_changes
from walkerlab.runfile import paths, provenance, store
from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.system.files import display_path


@dataclass(frozen=True)
class PreparedRun:
    """A stored run that is ready to be continued.

    Attributes:
        run: The run, with its user functions.
        path: Its run file.
        stages: Its stages; the last has the settings of the further generations.
        facts: Provenance of its last generation.
    """

    run: Run
    path: Path
    stages: tuple[Stage, ...]
    facts: Mapping[str, str] = field(repr=False)

    @property
    def settings(self) -> Settings:
        """Settings of the further generations."""
        return self.stages[-1].settings

    def create_evolution(self, rerate: bool = False, **options: Any) -> Evolution:
        """Return the evolution of the further generations; may simulate the last generation again.

        Args:
            rerate: As for ``resume``.
            **options: Keyword arguments of ``Evolution``.

        Raises:
            RunFileError: If the ratings of the last generation differ and ``rerate`` is false, or the file is damaged.
        """
        return Evolution.continue_run(self.run, self.path, self.stages, self.facts, rerate, **options)


def prepare_resume(
    path: str | Path, generations: int | None, changes: dict[str, Any], *, stacklevel: int = 2
) -> PreparedRun:
    """Load a run and plan its further generations, without any simulation.

    Args:
        path: Run file, or the folder that contains it.
        generations: Total number of generations; if None, the number in the settings.
        changes: Changed settings, keyed by name, and user functions, keyed by slot.
        stacklevel: Stack level of warnings.

    Raises:
        RunFileError: As for ``resume``.
        SettingsError: As for ``resume``.
    """
    run = load(path)
    reject_version_1(run)
    functions, changes = split_changes(run.settings, changes)
    run = restore_user_functions(run, functions, replaced=changes)
    path = paths.locate_run_file(path)
    done = run.n_generations
    _, facts = store.read_facts(path)
    if changed := provenance.describe_differences(facts, provenance.current_facts()):
        warnings.warn(
            f"{display_path(path)} was made with {changed}. The generations that are done stay the same. In later "
            "generations, the last digits can differ from those that the same versions would give, and so can all "
            "later results. The file records the versions of each generation.",
            stacklevel=stacklevel,
        )
    settings = run.settings.with_(**changes, **({} if generations is None else {"generations": generations}))
    check_changes(run.settings, settings)
    if settings.algorithm.generations < done:
        raise SettingsError(
            f"{display_path(path)} has {done} generations already; generations is the total and must be {done} or more."
        )
    stages = plan_stages(run.stages, settings, done)
    new = stages[-1].changes if stages[-1].first == done else {}
    if new and settings.algorithm.generations == done:
        raise SettingsError(
            f"{display_path(path)} already has all of its {done} generations, so none would have the new settings; "
            f"pass a larger total: generations={2 * done}"
        )
    same_slots = {slot: fact for slot, fact in facts.items() if slot.removesuffix(" function") not in new}
    if changed := changed_operators(same_slots, function_facts(settings)):
        warnings.warn(
            f"{display_path(path)} was made with different code for its {changed}. The run continues with the "
            "given functions; its file records for each generation which code it was made with.",
            stacklevel=stacklevel,
        )
    return PreparedRun(run, path, stages, facts)
