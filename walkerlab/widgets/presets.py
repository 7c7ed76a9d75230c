"""Worlds with a name: each is the default ground and limits, with some settings changed."""

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from walkerlab.settings.model import Domain
from walkerlab.settings.settings import Settings

WORLD = ("terrain", "robot")  # what a preset is about: the algorithm and the simulation stay as they are


@dataclass(frozen=True)
class Preset:
    """A world to start from.

    Attributes:
        about: what is there, in a few words.
        changes: settings of the terrain and the robot that are not the defaults, as ``Settings.with_`` takes them.
    """

    about: str
    changes: dict[str, Any] = field(default_factory=dict[str, Any])


PRESETS: dict[str, Preset] = {
    "Earth": Preset("a level sports floor: the default"),
    "Moon": Preset("a sixth of the weight on Earth, on dust", {"gravity": "moon", "texture": "sand"}),
    "Mars": Preset(
        "less than half the weight on Earth, among rocks",
        {
            "gravity": "mars", "structure": "rough", "texture": "sand", "hill_height": 0.08,
            "obstacle": "rock", "obstacle_size": 0.12, "obstacle_density": 0.4,
        },
    ),
    "Ice": Preset("feet slide at the slightest push", {"texture": "ice"}),
    "Sandy stairs": Preset(
        "low steps of sand, without end",
        {"structure": "stairs", "texture": "sand", "step_height": 0.04, "step_depth": 0.6},
    ),
    "Gravel with rocks": Preset(
        "coarse stones underfoot, and larger ones lying about",
        {
            "texture": "gravel", "texture_density": 0.3, "texture_size": 0.1,
            "obstacle": "rock", "obstacle_size": 0.15, "obstacle_density": 0.4,
        },
    ),
    "Grassy hills": Preset(
        "up and down, on a meadow",
        {"structure": "rough", "texture": "grass", "hill_height": 0.25, "hill_length": 2.2},
    ),
    "Muddy slope": Preset("gently uphill, in mud", {"structure": "incline", "incline": 3.0, "texture": "mud"}),
    "Trenches": Preset(
        "a pavement with gaps to step over",
        {"structure": "gaps", "texture": "concrete", "gap_width": 0.12, "gap_distance": 0.8},
    ),
    "Storm": Preset("a wind from ahead, over wet grass", {"texture": "grass", "wind": (-10.0, 0.0, 0.0)}),
    "Caravan": Preset("a pack on the back and a sledge behind", {"carry_weight": 2.0, "drag_weight": 4.0}),
}  # fmt: skip
"""By name; in each a robot within the limits can walk."""


def worlds(shown: Collection[str]) -> dict[str, dict[str, Domain]]:
    """Return the worlds that change only what is shown: by name, what each makes of the ground and of the limits.

    Args:
        shown: the domains of which all is to be seen.
    """
    places = Settings.places()
    return {
        name: {domain: getattr(Settings().with_(**preset.changes), domain) for domain in WORLD if domain in shown}
        for name, preset in PRESETS.items()
        if {places[change][0] for change in preset.changes} <= {*shown} and "terrain" in shown
    }
