"""Cost of a world: the same robots in it and on plain flat ground, evaluated on one thread.

A figure of 2 means twice the time. Every body plan is built beforehand.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import walkerlab as wl
from benchmarks.timing import N_WALKS, measure_ratios, print_note, time_call
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


def rows(n_pairs: int) -> Iterator[tuple[str, str, list[float]]]:
    """Yield the relative cost of each world."""
    flat = wl.Settings()
    genomes = wl.generate_robot_population(flat.robot, N_WALKS // 8 or 1, seed=0)
    with ThreadPoolExecutor(1) as thread:
        evaluate_on_flat = partial(time_call, wl.evaluate, genomes, flat, thread)
        evaluate_on_flat()  # builds every body plan
        for name, changes in WORLDS.items():
            world = flat.with_(**changes)
            layout = compute_layout(world.terrain)
            if len(layout.pieces) or len(layout.obstacles):
                print_note(f"{name}: {len(layout.pieces)} pieces and {len(layout.obstacles)} obstacles")
            evaluate_in_world = partial(time_call, wl.evaluate, genomes, world, thread)
            evaluate_in_world()
            yield name, "world / flat", measure_ratios(n_pairs, evaluate_in_world, evaluate_on_flat)
