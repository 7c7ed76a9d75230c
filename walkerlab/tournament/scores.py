"""Scores of a league: every entry walks on each ground from several starts, and the entries are ranked.

The score on a ground is the median of ``N_NUDGES`` walks, each from a slightly different start. A walk that does not
count, or whose fitness is negative, scores 0. The total is the mean over the grounds. Entries with the same total, at
the precision at which it is printed, share a rank.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from statistics import fmean, median

from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import Evaluation, evaluate
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.simulation.robustness import FIRST_NUDGE, N_NUDGES, TIMESTEP_DIVISOR, Confirmation
from walkerlab.text.numbers import format_fixed_column
from walkerlab.tournament.entries import Entry

SCORE_DECIMALS = 2  # decimals of a printed score, at least; centimetres
N_WALKS_PER_ROUND = N_NUDGES + 2  # the exact start, the other starts, and the exact start at a finer timestep


@dataclass(frozen=True)
class Round:
    """Result of one entry on one ground.

    Attributes:
        evaluation: Walk from the exact start, as in evolution.
        confirmation: Fitness at a quarter of the timestep and from slightly different starts.
    """

    evaluation: Evaluation
    confirmation: Confirmation

    @property
    def score(self) -> float:
        """Median of the walks from the other starts; a walk that does not count, or went backward, scores 0."""
        return median(max(0.0, fitness) for fitness in self.confirmation.nudged)

    @property
    def n_counted(self) -> int:
        """Number of walks from the other starts that count."""
        return sum(verdict == "ok" for verdict in self.confirmation.verdicts[1:])


@dataclass(frozen=True)
class Standing:
    """Place of one entry.

    Attributes:
        rank: 1 is the best; equal printed scores share a rank.
        entry: The entry.
        rounds: Its result on each ground.
        score: Mean of its scores on the grounds.
        score_text: Score as printed, without unit.
    """

    rank: int
    entry: Entry
    rounds: tuple[Round, ...]
    score: float
    score_text: str


def walk_rounds(
    entries: Sequence[Entry],
    grounds: Sequence[Settings],
    executor: Executor | None,
    on_done: Callable[[int], None],
) -> list[tuple[Round, ...]]:
    """Simulate all walks of a league.

    Args:
        entries: Entries.
        grounds: Settings of each round.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        on_done: Called with the number of walks that were completed.

    Returns:
        For each entry, its result on each ground.
    """
    by_ground = [_walk_ground(entries, settings, executor, on_done) for settings in grounds]
    return list(zip(*by_ground, strict=True))


def _walk_ground(
    entries: Sequence[Entry], settings: Settings, executor: Executor | None, on_done: Callable[[int], None]
) -> list[Round]:
    """Return the result of each entry on one ground, as ``wl.confirm`` computes it, but on all workers."""
    genomes = [entry.genome for entry in entries]
    simulation = settings.simulation
    finer = simulation.model_copy(update={"timestep": simulation.timestep / TIMESTEP_DIVISOR})
    exact = evaluate(genomes, settings, executor, on_done=on_done)
    finest = evaluate(genomes, settings.model_copy(update={"simulation": finer}), executor, starts=[0], on_done=on_done)
    nudged = [
        evaluate(genomes, settings, executor, starts=[FIRST_NUDGE + number], on_done=on_done)
        for number in range(N_NUDGES)
    ]
    name, unit = name_and_unit(settings.algorithm.fitness)
    return [
        Round(
            evaluation,
            Confirmation(
                fitness=evaluation.fitness,
                finer=fine.fitness,
                nudged=tuple(sorted(other.fitness for other in others)),
                verdicts=(fine.verdict, *(other.verdict for other in others)),
                measure=f"{name} {unit}".strip(),
            ),
        )
        for evaluation, fine, *others in zip(exact, finest, *nudged, strict=True)
    ]


def rank_entries(entries: Sequence[Entry], results: Sequence[tuple[Round, ...]]) -> list[Standing]:
    """Rank entries by their mean score; equal printed scores share a rank, in the order of the names.

    Args:
        entries: Entries in the order of their names.
        results: For each entry, its result on each ground.
    """
    totals = [fmean(result.score for result in rounds) for rounds in results]
    texts = format_fixed_column(totals, SCORE_DECIMALS)
    printed = [float(text) for text in texts]
    standings = [
        Standing(1 + sum(other > number for other in printed), entry, rounds, total, text)
        for entry, rounds, total, text, number in zip(entries, results, totals, texts, printed, strict=True)
    ]
    return sorted(standings, key=lambda standing: standing.rank)  # stable: equal ranks stay in the order of the names
