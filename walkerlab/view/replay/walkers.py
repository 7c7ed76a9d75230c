"""Who walks in a replay: each has a name, a colour and a lane."""

import colorsys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast

import numpy as np
from matplotlib.colors import to_rgb

from walkerlab.genome.genome import Genome
from walkerlab.settings.choices import Structure
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import brief
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.text.html import printable
from walkerlab.view.plots.style import RUNS
from walkerlab.view.replay.animation import Walk
from walkerlab.view.replay.meshes import RGB
from walkerlab.world.geometry import skins
from walkerlab.world.heights import arena_bounds
from walkerlab.world.scene import compile_scene

GAP = 0.35  # m between the lanes of a race
SHADES = (1.0, 0.6, 1.35)  # brightness of the first, the second and the third round of racers' colours


def line_up(walkers: Any, settings: Settings) -> tuple[Walk, ...]:
    """Let each walk, and place it: as ``replay`` says.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if there is nobody to walk.
    """
    named = list(_named(walkers))
    if not named:
        raise ValueError("there is nobody to walk: give replay a genome, or several")
    scenes = [compile_scene(genome, settings, scenery=True) for _, genome in named]
    rollouts = [poorest_walk(genome, settings) for _, genome in named]
    farthest = int(np.argmax([np.nan_to_num(rollout.distance, nan=-np.inf) for rollout in rollouts]))
    reaches = [max(float(np.abs(skin[:, 1]).max()) for skin, _ in skins(scene, scene.start)) for scene in scenes]
    lanes = _lanes(reaches, settings.terrain)
    return tuple(
        Walk(
            label=name,
            scene=scene,
            rollout=rollout,
            colour=_colour(i) if len(named) > 1 else None,
            lane=lane,
            reach=reach,
            loose=i == farthest,
        )
        for i, ((name, _), scene, rollout, lane, reach) in enumerate(
            zip(named, scenes, rollouts, lanes, reaches, strict=True)
        )
    )


def _named(walkers: Any) -> Iterable[tuple[str, Genome]]:
    """Yield each walker with its name; of two with the same, the second gets a number."""
    if isinstance(walkers, Settings):
        raise TypeError("first comes who walks, and then the settings: wl.replay(genome, settings)")
    walkers = getattr(walkers, "champion", walkers)  # of a run
    if hasattr(walkers, "columns"):
        Genome.of(walkers)  # which says how to choose from a table
    if isinstance(walkers, Mapping):
        pairs = [(printable(name), one) for name, one in walkers.items()]
    elif isinstance(walkers, str | Genome) or hasattr(walkers, "genome") or getattr(walkers, "ndim", 0) == 1:
        pairs = [(_name(walkers, ""), walkers)]
    elif not isinstance(walkers, Iterable):
        raise TypeError(f"replay takes a genome, an individual or a run, or several in a list; got {brief(walkers)}")
    else:
        walkers = list(cast(Iterable[Any], walkers))
        if numbers := [one for one in walkers if isinstance(one, int | np.integer)]:
            raise TypeError(
                f"replay takes genomes, individuals or runs; got the number {numbers[0]}. The champions of generations "
                f"are shown by run.replay({', '.join(map(str, numbers[:9]))})"
            )
        pairs = [(_name(one, f" {number}"), one) for number, one in enumerate(walkers, start=1)]
    seen = dict[str, int]()
    for name, one in pairs:
        seen[name] = seen.get(name, 0) + 1
        yield f"{name} ({seen[name]})" if seen[name] > 1 else name, Genome.of(getattr(one, "genome", one))


def _name(one: Any, number: str) -> str:
    return f"robot {one.individual}" if hasattr(one, "individual") else f"robot{number}"


def _lanes(reaches: Sequence[float], terrain: Terrain) -> list[float]:
    """Return how far to the left each walks: side by side if the ground is the same everywhere across the way.

    Where the ground is too narrow for all, they come closer to each other.
    """
    if terrain.structure == Structure.rough or terrain.n_pieces or terrain.obstacle:
        return [0.0] * len(reaches)
    widths = 2 * np.array(reaches) + GAP
    middles = np.cumsum(widths) - widths / 2
    (_, right), (_, left) = arena_bounds(terrain)
    squeeze = min(1.0, (left - right) / float(widths.sum()))
    return (squeeze * (middles[::-1] - widths.sum() / 2)).tolist()


def _colour(number: int) -> RGB:
    """Give each racer a colour; after the last, the first again, darker and then lighter."""
    hue, light, full = colorsys.rgb_to_hls(*to_rgb(RUNS[number % len(RUNS)]))
    return colorsys.hls_to_rgb(hue, min(0.85, light * SHADES[number // len(RUNS) % len(SHADES)]), full)
