"""Named worlds: the default settings of terrain and robot with some changes."""

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from walkerlab.settings.model import Domain
from walkerlab.settings.settings import Settings

WORLD_DOMAINS = ("terrain", "robot")  # domains that a preset sets; algorithm and simulation are unchanged


@dataclass(frozen=True)
class Preset:
    """A named world.

    Attributes:
        about: Short description.
        changes: Settings of terrain and robot that differ from the defaults, as arguments of ``Settings.with_``.
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


def available_presets(shown: Collection[str]) -> dict[str, dict[str, Domain]]:
    """Return the presets that change only shown domains: the settings of each shown domain, keyed by preset.

    Args:
        shown: Names of the domains whose settings are all shown.
    """
    locations = Settings.field_locations()
    return {
        name: {
            domain: getattr(Settings().with_(**preset.changes), domain) for domain in WORLD_DOMAINS if domain in shown
        }
        for name, preset in PRESETS.items()
        if {locations[change][0] for change in preset.changes} <= {*shown} and "terrain" in shown
    }
