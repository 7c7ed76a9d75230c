"""Check that an experiment can be continued with these conditions and functions; warn about added seeds."""

import warnings
from pathlib import Path
from typing import Any

from walkerlab.experiment.conditions import Condition
from walkerlab.runfile import provenance
from walkerlab.runfile.experiments import StoredExperiment
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.provenance import UNKNOWN_SOURCE
from walkerlab.settings.values import pluralize
from walkerlab.system.files import display_path


def check_continuation(path: Path, stored: StoredExperiment, planned: list[Condition], seeds: list[int]) -> list[int]:
    """Check that a stored experiment can be continued with these conditions, and return all of its seeds.

    Raises:
        RunFileError: If the experiment has other conditions, or was made with different code for a user function.
    """
    theirs = {plain["name"]: plain for plain in stored.conditions}
    ours = {condition.name: condition.to_plain() for condition in planned}
    elsewhere = "Give this experiment another file, or open the stored one with wl.load_experiment."
    if list(theirs) != list(ours):
        raise RunFileError(
            f"{display_path(path)} contains an experiment with the conditions {', '.join(map(repr, theirs))}; got "
            f"{', '.join(map(repr, ours))}. {elsewhere}"
        )
    if changed := [name for name in ours if ours[name] != theirs[name]]:
        raise RunFileError(
            f"{display_path(path)} contains an experiment whose condition {changed[0]!r} has settings other than "
            f"those given: {_describe_changes(theirs[changed[0]], ours[changed[0]])}. {elsewhere}"
        )
    for (number, _), run in stored.runs.items():
        facts = planned[number].function_facts()
        for name, fact in facts.items():
            then = run.made_with.get(name, fact)
            if then != fact and UNKNOWN_SOURCE not in then + fact:
                raise RunFileError(
                    f"{display_path(path)} was made with different code for the {name} of condition "
                    f"{planned[number].name!r}. An experiment must not mix the results of two functions. {elsewhere}"
                )
    added = [seed for seed in seeds if seed not in stored.seeds]
    places = [(number, seed) for number in range(len(planned)) for seed in stored.seeds]
    is_complete = all(place in stored.runs and stored.runs[place].is_finished for place in places)
    made_with = next((run.made_with for run in stored.runs.values()), {})
    changed_versions = provenance.describe_differences(made_with, provenance.current_facts())
    if changed_versions and (added or not is_complete):
        warnings.warn(
            f"{display_path(path)} was made with {changed_versions}. The runs that have ended stay the same. In later "
            "runs, the last digits can differ from those that the same versions would give.",
            stacklevel=4,
        )
    if added and is_complete:
        warnings.warn(
            f"{pluralize(len(added), 'seed')} added to a complete experiment. If seeds are added because the result is "
            "not clear, p-values become too small: adding seeds until a difference appears eventually finds one by "
            "chance. Choose the number of seeds before the experiment.",
            stacklevel=4,
        )
    return [*stored.seeds, *added]


def _describe_changes(theirs: dict[str, Any], ours: dict[str, Any]) -> str:
    """List the settings in which two conditions differ, at most three of them."""
    pairs = {"optimiser": (theirs["optimiser"], ours["optimiser"])} | {
        f"{domain}.{field}": (theirs["settings"].get(domain, {}).get(field), value)
        for domain, fields in ours["settings"].items()
        for field, value in fields.items()
    }
    found = [f"{name} is {then!r:.60}, not {now!r:.60}" for name, (then, now) in pairs.items() if then != now]
    if theirs.get("population") != ours.get("population"):
        found.append("population has other genomes")
    return "; ".join(found[:3])
