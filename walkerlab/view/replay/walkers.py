"""The robots of a replay: each is simulated and given a label, a colour and a lane."""

import colorsys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast

import numpy as np
from matplotlib.colors import to_rgb

from walkerlab.genome.genome import Genome
from walkerlab.settings.choices import Structure
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import short_repr
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.text.escape import printable
from walkerlab.view.plots.style import RUN_COLOURS
from walkerlab.view.replay.animation import Walk
from walkerlab.view.replay.meshes import RGB
from walkerlab.world.geometry import surface_points
from walkerlab.world.heights import arena_bounds
from walkerlab.world.scene import compile_scene

LANE_GAP = 0.35  # m between the lanes of a race
LIGHTNESS_FACTORS = (1.0, 0.6, 1.35)  # lightness of racers with the same hue
MAX_LIGHTNESS = 0.85
HUE_STEP = 0.46  # turns of the colour circle between a racer and the one with the same lightness, 18 places before
MAX_NAMED_NUMBERS = 9  # maximum number of generations listed in an error message


def simulate_walks(walkers: Any, settings: Settings) -> tuple[Walk, ...]:
    """Simulate the robots of a replay and place them in lanes; the arguments are those of ``replay``.

    Raises:
        GenomeError: If a string is not a valid genome.
        TypeError: If ``walkers`` is of another type than ``replay`` accepts.
        ValueError: If there are no robots.
    """
    genomes = list(_labelled_genomes(walkers))
    if not genomes:
        raise ValueError("there is no robot to replay; pass a genome, or a list of genomes with at least one")
    scenes = [compile_scene(genome, settings, scenery=True) for _, genome in genomes]
    rollouts = [poorest_walk(genome, settings) for _, genome in genomes]
    farthest = int(np.argmax([np.nan_to_num(rollout.distance, nan=-np.inf) for rollout in rollouts]))
    reaches = [
        max(float(np.abs(skin[:, 1]).max()) for skin, _ in surface_points(scene, scene.start)) for scene in scenes
    ]
    lanes = _lanes(reaches, settings.terrain)
    return tuple(
        Walk(
            label=label,
            scene=scene,
            rollout=rollout,
            colour=_racer_colour(i) if len(genomes) > 1 else None,
            lane=lane,
            reach=reach,
            shows_obstacles=i == farthest,
        )
        for i, ((label, _), scene, rollout, lane, reach) in enumerate(
            zip(genomes, scenes, rollouts, lanes, reaches, strict=True)
        )
    )


def _labelled_genomes(walkers: Any) -> Iterable[tuple[str, Genome]]:
    """Yield each robot's label and genome; a label that occurs again gets a number."""
    if isinstance(walkers, Settings):
        raise TypeError("the first argument is the settings; the robots come first: wl.replay(genome, settings)")
    walkers = getattr(walkers, "champion", walkers)  # the champion, if it is a run
    if hasattr(walkers, "columns"):
        Genome.of(walkers)  # raises an error that explains how to select an individual from a table
    if isinstance(walkers, Mapping):
        pairs = [(printable(label), walker) for label, walker in walkers.items()]
    elif isinstance(walkers, str | Genome) or hasattr(walkers, "genome") or getattr(walkers, "ndim", 0) == 1:
        pairs = [(_default_label(walkers, ""), walkers)]
    elif not isinstance(walkers, Iterable):
        raise TypeError(f"replay takes a genome, an individual or a run, or a list of them; got {short_repr(walkers)}")
    else:
        walkers = list(cast(Iterable[Any], walkers))
        if numbers := [walker for walker in walkers if isinstance(walker, int | np.integer)]:
            raise TypeError(
                f"replay takes genomes, individuals or runs; got the number {numbers[0]}. To replay the champions of "
                f"generations, call run.replay({', '.join(map(str, numbers[:MAX_NAMED_NUMBERS]))})"
            )
        pairs = [(_default_label(walker, f" {number}"), walker) for number, walker in enumerate(walkers, start=1)]
    n_uses: dict[str, int] = {}
    for label, walker in pairs:
        n_uses[label] = n_uses.get(label, 0) + 1
        unique_label = f"{label} ({n_uses[label]})" if n_uses[label] > 1 else label
        yield unique_label, Genome.of(getattr(walker, "genome", walker))


def _default_label(walker: Any, suffix: str) -> str:
    return f"robot {walker.individual}" if hasattr(walker, "individual") else f"robot{suffix}"


def _lanes(reaches: Sequence[float], terrain: Terrain) -> list[float]:
    """Return the distance to the left [m] by which each walk is moved; the first walk is the leftmost.

    The lanes are side by side if the ground is the same everywhere along y, and all in the middle otherwise. Lanes
    that are wider together than the ground are moved closer to each other.

    Args:
        reaches: Greatest distance of each robot's surface to either side at the start [m].
        terrain: Terrain that all robots walk on.
    """
    if terrain.structure == Structure.rough or terrain.n_pieces or terrain.obstacle:
        return [0.0] * len(reaches)
    widths = 2 * np.array(reaches) + LANE_GAP
    middles = np.cumsum(widths) - widths / 2
    (_, right), (_, left) = arena_bounds(terrain)
    scale = min(1.0, (left - right) / float(widths.sum()))
    return (scale * (middles[::-1] - widths.sum() / 2)).tolist()


def _racer_colour(number: int) -> RGB:
    """Return the colour of a racer: the colours of runs in turn, then darker, then lighter, then with other hues."""
    n_rounds, index = divmod(number, len(RUN_COLOURS))
    n_turns, n_lightness = divmod(n_rounds, len(LIGHTNESS_FACTORS))
    hue, lightness, saturation = colorsys.rgb_to_hls(*to_rgb(RUN_COLOURS[index]))
    lightness = min(MAX_LIGHTNESS, lightness * LIGHTNESS_FACTORS[n_lightness])
    return colorsys.hls_to_rgb((hue + n_turns * HUE_STEP) % 1, lightness, saturation)
