"""Exercises and quiz of lesson 08, your own operator."""

from typing import Any

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.lessons.exercises import Exercise, Question
from walkerlab.settings.robot import Robot
from walkerlab.system.randomness import random_stream

N_DRAWS = 300
MAX_NUDGE = 0.01  # of the range of a gene
N_TRIAL_GENERATIONS = 10
STEP_RATIO = 0.5  # maximum size of a late step, as a share of an early one


def _check_best_three(select: Any) -> bool | str:
    fitness = np.array([0.4, -1.2, 2.5, 0.9, 3.1, -0.3, 1.7, 0.2])
    selected = np.asarray(select(fitness, N_DRAWS, rng=random_stream(0, "check")))
    if selected.dtype.kind != "i":
        return "Your function returns fitness values. It must return indices: the positions of robots in the list."
    if selected.shape != (N_DRAWS,):
        return f"{N_DRAWS} parents are needed (n_parents); your function returned an array of shape {selected.shape}."
    others = sorted({*selected.tolist()} - {2, 4, 6})
    if others:
        return (
            f"For the fitness {fitness.tolist()}, your function also selects robot {others[0]}, whose fitness is "
            f"{fitness[others[0]]} m. Is it among the three best?"
        )
    counts = [int((selected == robot).sum()) for robot in (2, 4, 6)]
    if min(counts) < N_DRAWS / 6:
        return f"The three best robots are selected {counts[0]}, {counts[1]} and {counts[2]} times: not equally often."
    return True


def _trial_population() -> Floats:
    rng = random_stream(0, "check")
    return np.array([Genome.random(Robot(), rng=rng).values for _ in range(20)])


def _check_nudge(mutate: Any) -> bool | str:
    genes = build_genes(Robot())
    before = _trial_population()
    after = np.asarray(mutate(before.copy(), genes, rng=random_stream(0, "check")), dtype=np.float64)
    if after.shape != before.shape:
        return f"The result has the shape {after.shape}; it must have the shape of the genomes, {before.shape}."
    moved = np.abs(after - before) / (genes.high - genes.low)
    if not moved.any():
        return "No gene changes yet. Replace the zeros by random numbers, one for each gene of each genome."
    again = np.asarray(mutate(before.copy(), genes, rng=random_stream(0, "check")), dtype=np.float64)
    if not np.array_equal(after, again):
        return "With the same rng, the steps are different each time. Draw them from rng, not from np.random or random."
    if moved.max() > MAX_NUDGE + 1e-9:
        return f"One gene moves by {moved.max():.1%} of its range; at most 1 % is allowed. What is the range of a gene?"
    if (moved > 0).mean() < 0.9:
        return f"Only {(moved > 0).mean():.0%} of the genes change; every gene must move a little."
    if np.allclose(after[0] - before[0], after[1] - before[1]):
        return "All genomes move by the same steps. Draw one random number for each gene of each genome."
    if (after >= before).all() or (after <= before).all():
        return "All genes move in the same direction. A step must be able to go up or down."
    return (
        moved.max() > MAX_NUDGE / 2 or "The steps are smaller than they need to be: up to 1 % of the range is allowed."
    )


def _check_cooling(mutate: Any) -> bool | str:
    genes = build_genes(Robot())
    genomes = np.broadcast_to((genes.low + genes.high) / 2, (40, len(genes))).copy()
    sizes: list[float] = []
    for generation in range(1, N_TRIAL_GENERATIONS):
        time: dict[str, int] = {"generation": generation, "generations": N_TRIAL_GENERATIONS}
        after = np.asarray(mutate(genomes.copy(), genes, rng=random_stream(0, "check"), **time), dtype=np.float64)
        sizes.append(float((np.abs(after - genomes) / (genes.high - genes.low))[:, ~genes.is_count].mean()))
    if np.allclose(sizes, sizes[0]):
        return "The steps in the first and in the last generation are equally large."
    if sizes[-1] > sizes[0]:
        return "The steps grow during the run; they must shrink. (A scale of -0.3 gives steps as large as one of 0.3.)"
    if not 0 < sizes[-1] <= STEP_RATIO * sizes[0]:
        return (
            f"In the last of {N_TRIAL_GENERATIONS} generations the steps are {sizes[-1] / sizes[0]:.0%} as large as in "
            "the first; they must be at most half as large, but not zero."
        )
    return all(np.diff(sizes) <= 0) or "The steps must become smaller from each generation to the next."


EXERCISES: dict[str, Exercise] = {
    "08.3": Exercise(
        check=_check_best_three,
        hints=(
            "np.argsort(fitness) returns the indices of all robots, the least fit first.",
            "The last elements of an array are array[-1:], array[-2:], and so on.",
        ),
        right="argsort returns indices, the best last; the slice keeps three of them, and rng.choice draws from these.",
    ),
    "08.4": Exercise(
        check=_check_nudge,
        hints=(
            "rng.uniform(-1, 1, genomes.shape) draws one number between -1 and 1 for each gene of each genome.",
            "The range of every gene is genes.high - genes.low, an array with one value for each gene.",
        ),
        right="Every gene of every genome gets its own small step, measured by the range of that gene.",
    ),
    "08.7": Exercise(
        check=_check_cooling,
        hints=(
            "At the start generation is small; at the end it is nearly as large as generations.",
            "generation / generations grows from about 0 to about 1. You need a number that falls from about 1 to 0.",
        ),
        right="The steps are large while the robots are still random, and small when they only need to be tuned.",
    ),
}

QUIZ: tuple[Question, ...] = (
    Question(
        text="What does a selection operator return?",
        choices={
            "the fitness of the selected robots": "Several robots can have the same fitness: a value names no robot.",
            "the indices of the selected robots": "Right: positions in the list of robots, counted from 0.",
            "the genomes of the selected robots": "It does not receive the genomes, unless it asks for them.",
        },
        right="the indices of the selected robots",
    ),
    Question(
        text="Why must all random numbers come from rng?",
        choices={
            "because np.random is slow": "Speed is not the reason.",
            "because the same seed must give the same run": "Right: a result that nobody can repeat proves nothing.",
            "because rng gives better robots": "All good generators are equally random.",
        },
        right="because the same seed must give the same run",
    ),
    Question(
        text="Your operator gives a better champion than tournament selection, with one seed. What do you know?",
        choices={
            "It is better.": "With another seed, the order may be reversed: try several seeds.",
            "It works, but whether it is better needs more seeds.": "Right: lesson 07 shows how to find out.",
            "The comparison has an error.": "It can be correct. One run just says little.",
        },
        right="It works, but whether it is better needs more seeds.",
    ),
)
