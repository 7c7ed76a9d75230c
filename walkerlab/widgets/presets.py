"""Named worlds: the default terrain and loads with some changes."""

from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from walkerlab.settings.model import SettingsError
from walkerlab.settings.settings import Settings

START_PRESET, START_ABOUT = "start", "the settings at the start"  # first of the presets of a class
LOADS = ("carry_weight", "drag_weight")  # settings of the robot that belong to a world; its limits do not


@dataclass(frozen=True)
class Preset:
    """A named world.

    Attributes:
        about: Short description.
        changes: Settings of terrain and loads that differ from the defaults, as arguments of ``Settings.with_``.
    """

    about: str
    changes: dict[str, Any] = field(default_factory=dict[str, Any])


PRESETS: dict[str, Preset] = {
    "Earth": Preset("a level sports floor: the default"),
    "Moon": Preset("a sixth of the weight on Earth, on dust", {"gravity": "moon", "texture": "sand"}),
    "Mars": Preset(
        "less than half the weight on Earth, with rocks",
        {
            "gravity": "mars", "structure": "rough", "texture": "sand", "hill_height": 0.08,
            "obstacle": "rock", "obstacle_size": 0.12, "obstacle_density": 0.4,
        },
    ),
    "Ice": Preset("very slippery ground", {"texture": "ice"}),
    "Sandy stairs": Preset(
        "low steps of sand",
        {"structure": "stairs", "texture": "sand", "step_height": 0.04, "step_depth": 0.6},
    ),
    "Gravel with rocks": Preset(
        "coarse gravel with larger loose rocks",
        {
            "texture": "gravel", "texture_density": 0.3, "texture_size": 0.1,
            "obstacle": "rock", "obstacle_size": 0.15, "obstacle_density": 0.4,
        },
    ),
    "Grassy hills": Preset(
        "hills covered with grass",
        {"structure": "rough", "texture": "grass", "hill_height": 0.25, "hill_length": 2.2},
    ),
    "Muddy slope": Preset("a gentle slope of mud", {"structure": "incline", "incline": 3.0, "texture": "mud"}),
    "Trenches": Preset(
        "a concrete floor with gaps to step over",
        {"structure": "gaps", "texture": "concrete", "gap_width": 0.12, "gap_distance": 0.8},
    ),
    "Storm": Preset("headwind, on grass", {"texture": "grass", "wind": (-10.0, 0.0, 0.0)}),
    "Caravan": Preset("a load on the back and a sledge behind", {"carry_weight": 2.0, "drag_weight": 4.0}),
}  # fmt: skip
"""Presets, keyed by name; robots within the limits can walk in each of them."""


@dataclass(frozen=True)
class FormPreset:
    """A named world in the menu of a form.

    Attributes:
        about: Short description.
        settings: Every setting that the preset sets, as arguments of ``Settings.with_``; all others are kept.
    """

    about: str
    settings: dict[str, Any]


def choose_presets(
    start: Settings, given: Mapping[str, Mapping[str, Any]] | None, complete: Collection[str], fixed: Collection[str]
) -> dict[str, FormPreset]:
    """Return the presets of a form, keyed by name.

    Args:
        start: Initial settings of the form.
        given: Named worlds after ``start`` itself: by name, the settings that differ from it. If None, the built-in
            presets that change only complete domains, and no fixed setting.
        complete: Names of the domains whose settings are all shown.
        fixed: Names of the settings that keep their initial values.
    """
    locations = Settings.field_locations()

    def values(settings: Settings, names: Iterable[str]) -> dict[str, Any]:
        return {name: getattr(getattr(settings, locations[name][0]), locations[name][1]) for name in names}

    if given is not None:
        domains = {locations[name][0] for changes in given.values() for name in changes}
        worlds = {START_PRESET: (START_ABOUT, start)} | {
            name: (describe_changes(changes), start.with_(**changes)) for name, changes in given.items()
        }
        names = [name for name, (domain, _) in locations.items() if domain in domains]
        return {title: FormPreset(about, values(settings, names)) for title, (about, settings) in worlds.items()}
    kept = values(start, fixed)
    chosen: dict[str, FormPreset] = {}
    world = [name for name, (domain, _) in locations.items() if domain == "terrain" or name in LOADS]
    names = [name for name in world if locations[name][0] in complete]
    for title, built_in in PRESETS.items():
        if "terrain" not in complete or not {*built_in.changes} <= {*names} - kept.keys():
            continue
        with suppress(SettingsError):  # the fixed values do not fit to the others
            settings = Settings().with_(**{**built_in.changes, **kept})
            chosen[title] = FormPreset(built_in.about, values(settings, names))
    return chosen


def describe_changes(changes: Mapping[str, Any]) -> str:
    """Describe a preset of a class by its settings: ``structure stairs, step height 0.05``."""
    return ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in changes.items())
