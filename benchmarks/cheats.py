"""Attack the verdicts: look for robots that get far without walking.

    python -m benchmarks.cheats [--evaluations 400] [--seeds 1] [--world NAME] [--cheat NAME] [--folder F] [--jobs 2]

Four parts with several trials each. The result of a trial is a line of ``results.jsonl`` in the folder. Trials that are
there already are not computed again, so the benchmark can be stopped at any time and resumed by the same command.

known    robots that got far on their back, rolling or trembling, in worlds where that must not count
weak     50 tall, weak robots on slopes: how many stay down for over 0.5 s, and how many of these count all the same
search   the greatest distance that counts in an evolution of cheats: robots on their back, robots whose drive is cut
         after settling, robots that touch the ground with anything but feet, and robots that are slower without push
walker   a robot that walks on its feet, on every ground: its walk must count, except on ice at -5°, where robots slide
         while they stand
"""

import argparse
import json
import math
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import walkerlab as wl
from walkerlab.ga.genes import Floats
from walkerlab.genome.features import build_genes
from walkerlab.genome.repair import repair
from walkerlab.simulation.footfalls import foot_share
from walkerlab.simulation.rollout import Rollout, simulate_walk
from walkerlab.world.scene import Scene, compile_scene

LIMITS = wl.Robot(segments=(1, 4), legs=(2, 8))
"""Limits of all robots here; bodies of one segment are easier to cheat with."""

ON_ITS_BACK = (
    "wl1 segments=1 | seg length=0.4 mass=10.589 legs length=0.6 force=18.393 | gait frequency=1.532 "
    "| step hip amplitude=0.659 phase=3.987 offset=-0.264 knee amplitude=0.999 phase=6.02 offset=-1.163 stride=2.939"
)
FLAILING = (
    "wl1 segments=2 | seg length=0.3 mass=2.5 legs length=0.1 force=15 | seg length=0.3 mass=2.5 legs length=0.1 "
    "force=15 | gait frequency=2.2 "
    "| step hip amplitude=1 phase=0 offset=0 knee amplitude=1 phase=0 offset=0 stride=3.14 "
    "| step hip amplitude=1 phase=0 offset=0 knee amplitude=1 phase=0 offset=0 stride=3.14"
)
WALKER = (  # found by evolution on flat ground; all but 2 % of its contacts are by feet
    "wl1 segments=4 | seg length=0.233 mass=2.368 legs length=0.277 force=13.136 "
    "| seg length=0.326 mass=1.105 legs length=0.345 force=4.177 "
    "| seg length=0.276 mass=1.965 nolegs length=0.297 force=11.404 "
    "| seg length=0.34 mass=3.33 legs length=0.295 force=18.937 | gait frequency=2.097 "
    "| step hip amplitude=0.752 phase=5.244 offset=0.51 knee amplitude=0.686 phase=3.279 offset=-0.993 stride=4.871 "
    "| step hip amplitude=0.806 phase=2.066 offset=-0.524 knee amplitude=0.893 phase=3.338 offset=0.029 stride=2.61 "
    "| step hip amplitude=0.103 phase=3.552 offset=0.458 knee amplitude=0.81 phase=2.375 offset=0.997 stride=2.792 "
    "| step hip amplitude=0.68 phase=2.08 offset=0.605 knee amplitude=0.489 phase=1.227 offset=-0.058 stride=5.596"
)


def slope(incline: float, **changes: Any) -> dict[str, Any]:
    """Return the changes of a terrain that make it a slope."""
    return {"structure": "incline", "incline": incline, **changes}


WORLDS: dict[str, dict[str, Any]] = {
    "flat": {},
    "descent of 5°": slope(-5),
    "descent of 20°": slope(-20),
    "ascent of 10°": slope(10),
    "icy descent of 3°": slope(-3, texture="ice"),
    "icy descent of 5°": slope(-5, texture="ice"),
    "tilted gravity": {"gravity": (2, 0, -9.81)},
    "tail wind": {"wind": (20, 0, 0)},
    "tail wind on ice": {"texture": "ice", "wind": (10, 0, 0)},
    "stairs": {"structure": "stairs", "step_height": 0.05},
    "rough": {"structure": "rough"},
    "gaps": {"structure": "gaps"},
}
KNOWN: list[tuple[str, dict[str, Any]]] = [
    (ON_ITS_BACK, slope(-20)),
    (FLAILING, slope(-5, texture="ice")),
    (FLAILING, slope(-10)),
    (FLAILING, {"gravity": (5, 0, -9.81)}),
    (FLAILING, {"texture": "ice", "wind": (15, 0, 0)}),
]
WEAK_LEG = "| seg length=0.5 mass={mass:.3f} legs length=0.75 force={force:.3f} "
WEAK_STEP = (
    "| step hip amplitude={:.3f} phase={:.3f} offset={:.3f} "
    "knee amplitude={:.3f} phase={:.3f} offset={:.3f} stride=3.1 "
)
SLOPES = (-20, -10, -5, 0, 5, 10, 20)
N_WEAK = 50
POPULATION = 20
MUTATION_RATE = 0.15
MUTATION_SCALE = 0.2  # of the range of a gene


class HeldScene(Scene):
    """Scene in which the robot holds its rest pose instead of walking."""

    def controls(self, n_steps: int) -> Floats:
        """Return the servo targets of the rest pose."""
        return np.tile(self.rest, (n_steps, 1))


def walk_on_back(genome: wl.Genome, settings: wl.Settings) -> tuple[Rollout, float]:
    """Return a walk and the share of it that is spent on the back."""
    rollout = wl.simulate(genome, settings, poses=False)
    return rollout, float((rollout.up[:, 2] < 0).mean())


def stand_still(genome: wl.Genome, settings: wl.Settings) -> tuple[Rollout, float]:
    """Return the walk of a robot that is not driven, and 1."""
    return simulate_walk(HeldScene(**vars(compile_scene(genome, settings))), poses=False), 1.0


def scrape(genome: wl.Genome, settings: wl.Settings) -> tuple[Rollout, float]:
    """Return a walk and the share of the contacts with the ground that are not by feet."""
    scene = compile_scene(genome, settings)
    rollout = simulate_walk(scene)
    share = foot_share(scene, rollout.poses[::8]) if rollout.counts else 1.0
    return rollout, 0.0 if math.isnan(share) else 1 - share


def be_carried(genome: wl.Genome, settings: wl.Settings) -> tuple[Rollout, float]:
    """Return a walk and the share of its speed that is due to a push."""
    rollout = wl.simulate(genome, settings, poses=False)
    speed = rollout.distance / rollout.time[-1]
    is_pushed = speed > 0 and math.isfinite(rollout.level_speed)
    return rollout, max(0.0, 1 - rollout.level_speed / speed) if is_pushed else 0.0


CHEATS = {"on its back": walk_on_back, "not driven": stand_still, "not on feet": scrape, "carried": be_carried}


def search(cheat: str, world: str, seed: int, n_evaluations: int) -> dict[str, Any]:
    """Evolve cheats and return the best: counted distance times the share of it that is cheated."""
    settings = wl.Settings(robot=LIMITS).with_(**WORLDS[world])
    genes = build_genes(settings.robot)
    rng = np.random.default_rng([seed, *map(ord, cheat + world)])
    found: list[tuple[float, int, wl.Genome, float, float]] = []
    for number in range(n_evaluations):
        if number < 2 * POPULATION:
            genome = wl.Genome.random(settings.robot, rng=rng)
        else:
            first, second = (found[rng.integers(POPULATION)][2] for _ in range(2))
            values = np.where(rng.random(len(genes.names)) < 0.5, first.values, second.values)
            steps = rng.normal(0, MUTATION_SCALE, len(genes.names)) * (genes.high - genes.low)
            values = values + steps * (rng.random(len(genes.names)) < MUTATION_RATE)
            genome = wl.Genome(repair(values[np.newaxis], settings.robot)[0])
        rollout, share = CHEATS[cheat](genome, settings)
        gain = rollout.distance * share if rollout.counts else -math.inf
        found.append((gain, -number, genome, rollout.distance, share))
        found.sort(reverse=True)
        del found[max(POPULATION, 2 * POPULATION - number) + POPULATION :]
    gain, _, genome, distance, share = found[0]
    return {"gain": gain, "distance": distance, "share": share, "genome": str(genome)}


def draw_weak(rng: np.random.Generator) -> str:
    """Draw a robot with two segments and long legs that can hardly carry it."""
    body = WEAK_LEG.format(mass=rng.uniform(3, 6), force=rng.uniform(5, 15))
    steps = "".join(WEAK_STEP.format(*rng.uniform([0.2, 0, -0.3] * 2, [1, 6, 0.3] * 2)) for _ in range(2))
    return f"wl1 segments=2 {2 * body}| gait frequency={rng.uniform(0.5, 2):.3f} {steps}"


def check_weak(incline: float) -> dict[str, Any]:
    """Count the tall, weak robots that stay down on a slope, and those of them whose walk counts."""
    settings = wl.Settings(robot=LIMITS).with_(**slope(incline))
    pitch = math.radians(incline)
    rng = np.random.default_rng(0)
    n_down = n_counted = 0
    for _ in range(N_WEAK):
        rollout = wl.simulate(draw_weak(rng), settings, poses=False)
        height = rollout.com @ [-math.sin(pitch), 0, math.cos(pitch)]
        is_down = height < 0.4 * height[0]
        longest = max(map(len, "".join("x" if down else " " for down in is_down).split(" ")))
        if longest > 26:  # samples at 50 Hz
            n_down += 1
            n_counted += rollout.counts
    return {"down": n_down, "counted": n_counted}


def trials(arguments: argparse.Namespace) -> Iterator[tuple[str, Callable[[], dict[str, Any]]]]:
    """Yield the name of each trial and the function that returns its figures."""
    for number, (genome, changes) in enumerate(KNOWN):
        yield f"known {number}", partial(judge, genome, changes)
    for incline in SLOPES:
        yield f"weak at {incline}°", partial(check_weak, incline)
    for world in arguments.world or WORLDS:
        yield f"walker on {world}", partial(judge, WALKER, WORLDS[world])
    for seed in range(arguments.seeds):
        for cheat in arguments.cheat or CHEATS:
            for world in arguments.world or WORLDS:
                name = f"search {cheat}, {world}, seed {seed}, {arguments.evaluations} evaluations"
                yield name, partial(search, cheat, world, seed, arguments.evaluations)


def judge(genome: str, changes: dict[str, Any]) -> dict[str, Any]:
    """Return distance and verdict of a walk."""
    rollout = wl.simulate(genome, wl.Settings(robot=LIMITS).with_(**changes), poses=False)
    return {"changes": changes, "distance": rollout.distance, "verdict": rollout.verdict, "reason": rollout.reason}


def main() -> None:
    """Parse the arguments, run the trials that have no result yet, and print all results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--evaluations", type=int, default=400, help="number of walks of each search")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--world", action="append", choices=list(WORLDS), help="only this world; may be repeated")
    parser.add_argument("--cheat", action="append", choices=list(CHEATS), help="only this cheat; may be repeated")
    parser.add_argument("--folder", type=Path, default=Path("cheats"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="number of processes")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    path = arguments.folder / "results.jsonl"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    done = {record.pop("name"): record for record in map(json.loads, lines)}
    with ProcessPoolExecutor(arguments.jobs) as executor, path.open("a", encoding="utf-8") as file:
        names = {executor.submit(compute): name for name, compute in trials(arguments) if name not in done}
        for future in as_completed(names):
            done[names[future]] = future.result()
            file.write(json.dumps({"name": names[future], **future.result()}, ensure_ascii=False, default=str) + "\n")
            file.flush()
    for name, _ in trials(arguments):
        print(f"{name}: " + ", ".join(f"{key} {shorten(value)}" for key, value in done[name].items()))


def shorten(value: object) -> str:
    """Write a number with two decimals, and the first words of a genome."""
    return f"{value:.2f}" if isinstance(value, float) else str(value)[:60]


if __name__ == "__main__":
    main()
