"""What a world costs: the same walkers in it and on bare flat ground, evaluated on one thread.

2 is twice the time. Every body plan is built beforehand.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import walkerlab as wl
from benchmarks.timing import WALKS, in_turn, note, seconds
from walkerlab.world.placement import compute_layout

WORLDS = {
    "20 boxes": {"obstacle": "box", "obstacle_density": 20 / 90},
    "20 balls": {"obstacle": "ball", "obstacle_density": 20 / 90},
    "20 cylinders": {"obstacle": "cylinder", "obstacle_density": 20 / 90},
    "20 rocks": {"obstacle": "rock", "obstacle_density": 20 / 90},
    "20 logs": {"obstacle": "log", "obstacle_density": 20 / 90},
    "60 rocks": {"obstacle": "rock", "obstacle_density": 60 / 90},
    "2,000 pieces": {"texture": "gravel", "texture_density": 0.0525},
    "2,000 pieces, 20 rocks": {
        "texture": "gravel", "texture_density": 0.0525, "obstacle": "rock", "obstacle_density": 20 / 90,
    },
    "stairs": {"structure": "stairs"},
    "hills": {"structure": "rough"},
    "gaps": {"structure": "gaps"},
    "a pack": {"carry_weight": 2.0},
    "a sledge": {"drag_weight": 2.0},
    "wind": {"wind": (-3.0, 0.0, 0.0)},
}  # fmt: skip


def rows(pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield what each world costs."""
    bare = wl.Settings()
    genomes = wl.generate_robot_population(bare.robot, WALKS // 8 or 1, seed=0)
    with ThreadPoolExecutor(1) as thread:
        on_bare = partial(seconds, wl.evaluate, genomes, bare, thread)
        on_bare()  # has every body plan built
        for name, changes in WORLDS.items():
            world = bare.with_(**changes)
            layout = compute_layout(world.terrain)
            if len(layout.pieces) or len(layout.obstacles):
                note(f"{name}: {len(layout.pieces)} pieces and {len(layout.obstacles)} obstacles")
            in_world = partial(seconds, wl.evaluate, genomes, world, thread)
            in_world()
            yield name, "world / flat", in_turn(pairs, in_world, on_bare)
