"""A league: the entries of a class, ranked on the same grounds under one judge."""

from collections.abc import Sequence
from concurrent.futures import Executor
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
from tqdm.auto import tqdm

from walkerlab.settings.arguments import require_count, require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.system.errors import WalkerlabError
from walkerlab.tournament.entries import SkippedEntry, read_entries
from walkerlab.tournament.scores import N_WALKS_PER_ROUND, Standing, rank_entries, walk_rounds
from walkerlab.tournament.seals import Seal
from walkerlab.tournament.wording import describe_verdict
from walkerlab.view.replay import Replay, replay

if TYPE_CHECKING:
    from walkerlab.text.templates import Markup

N_FINALISTS = 8  # robots in the final
MAX_ROUNDS = 20
MAX_TERRAIN_SEED = 2**32 - 1


class LeagueError(WalkerlabError, ValueError):
    """A league cannot be held; the message says why."""


class League:
    """Result of a league; displayed as a leaderboard in a notebook.

    Attributes:
        standings: The entries, the best first.
        skipped: Files that take no part, with the reason.
        grounds: Settings of each round.
        seal: Seal of the settings; None if they were not sealed.
    """

    def __init__(
        self,
        standings: Sequence[Standing],
        skipped: Sequence[SkippedEntry],
        grounds: Sequence[Settings],
        seal: Seal | None = None,
    ) -> None:
        """Combine the result of a league; call ``wl.league`` to hold one."""
        self.standings = tuple(standings)
        self.skipped = tuple(skipped)
        self.grounds = tuple(grounds)
        self.seal = seal

    @property
    def table(self) -> pd.DataFrame:
        """One row for each entry, the best first.

        Columns: rank, name, score (mean over the rounds of the median over the other starts), distance [m] (exact start
        of the first round), verdict in words, score_1, score_2, … (of each round), genome.
        """
        rows = [
            {
                "rank": standing.rank,
                "name": standing.entry.name,
                "score": float(standing.score_text),
                "distance": standing.rounds[0].evaluation.distance,
                "verdict": describe_verdict(standing),
                **{f"score_{number}": result.score for number, result in enumerate(standing.rounds, start=1)},
                "genome": str(standing.entry.genome),
            }
            for standing in self.standings
        ]
        table = pd.DataFrame(rows)
        name, unit = self.measure
        table.attrs = {"units": {"score": unit, "distance": "m"}, "fitness": name}
        return table

    @property
    def measure(self) -> tuple[str, str]:
        """Name and unit of the fitness by which the entries are ranked."""
        return name_and_unit(self.grounds[0].algorithm.fitness)

    def replay(self, n_racers: int = N_FINALISTS) -> Replay:
        """Return the final: the best entries walk as a race on the ground of the last round, from the exact start.

        Args:
            n_racers: Maximum number of robots in the race.
        """
        best = self.standings[: require_count(n_racers, "n_racers", "the number of robots in the race")]
        racers = {standing.entry.name: standing.entry.genome for standing in best}
        return replay(racers, self.grounds[-1])

    def save(self, path: str | Path) -> Path:
        """Save the league as one page that needs no other file: leaderboard, drawings, final, rules and settings.

        Args:
            path: File to write, whose name ends in ``.html``; an existing file is replaced.

        Returns:
            The path of the file.

        Raises:
            ValueError: If the name does not end in ``.html``.
            OSError: If the file cannot be written.
        """
        from walkerlab.tournament.page import page_html  # here because it is slow to import
        from walkerlab.view.pages import write_page

        def render_page() -> str:
            return page_html(self.standings, self.skipped, self.grounds, self.seal, self.replay())

        return write_page(render_page, path)

    def __repr__(self) -> str:
        """Summarise the league in a line."""
        best = self.standings[0]
        winners = ", ".join(standing.entry.name for standing in self.standings if standing.rank == 1)
        result = f"{best.score_text} {self.measure[1]}".rstrip()
        return (
            f"League({pluralize(len(self.standings), 'robot')}, {pluralize(len(self.grounds), 'round')}, "
            f"{len(self.skipped)} skipped; first: {winners}, {result})"
        )

    def _repr_html_(self) -> "Markup":
        from walkerlab.tournament.page import league_html

        return league_html(self.standings, self.skipped, self.grounds)


def league(
    folder_or_genomes: Any,
    settings: Settings | Seal | None = None,
    *,
    rounds: int = 1,
    executor: Executor | None = None,
    progress: bool = True,
) -> League:
    """Rank the robots of a class: all walk on the same grounds, under the same judge.

    On each ground, every robot walks from the exact start, once more at a quarter of the timestep, and from five
    slightly different starts. Its score is the median of the last five walks; a walk that does not count or goes
    backward scores 0. The total is the mean over the rounds. Robots whose totals are equal as printed share a rank. The
    result does not depend on the order of the files, the executor or its number of workers.

    Args:
        folder_or_genomes: Folder in which each file is an entry: a text file with one genome, or a run file
            (``.walk``), whose champion takes part; the name of the file is the name of the entry. Or genomes by name,
            or a list of genomes. Entries that are not valid are listed with the reason and take no part.
        settings: Settings of the ground, the limits of the robots, and the fitness; the defaults if None. Or a seal,
            whose settings the page reveals.
        rounds: Number of rounds, 1 to 20. Each has another terrain seed, from that of the settings on: other
            obstacles and hills, where the ground has any, and other starts.
        executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
        progress: Whether to show a progress bar.

    Raises:
        LeagueError: If there is no valid entry.
        TypeError: If an argument has another type.
        ValueError: If the folder does not exist, or the number of rounds is out of range.
    """
    sealed = settings if isinstance(settings, Seal) else None
    base = sealed.settings if sealed else Settings() if settings is None else require_settings(settings)
    n_rounds = require_count(rounds, "rounds", "the number of grounds")
    if n_rounds > MAX_ROUNDS:
        raise ValueError(f"rounds is {n_rounds}; it must be between 1 and {MAX_ROUNDS}")
    entries, skipped = read_entries(folder_or_genomes, base.robot)
    if not entries:
        reasons = "".join(f"\n  {one.file}: {one.reason}" for one in skipped)
        source = folder_or_genomes if isinstance(folder_or_genomes, str | PathLike) else "the list"
        raise LeagueError(f"there is no valid entry in {source}.{reasons}")
    seed = base.terrain.seed
    grounds = [base.with_(terrain_seed=(seed + number) % MAX_TERRAIN_SEED) for number in range(n_rounds)]
    n_walks = len(entries) * len(grounds) * N_WALKS_PER_ROUND
    with tqdm(total=n_walks, unit="walk", disable=not progress, desc="league") as bar:

        def count(n_done: int) -> None:
            bar.update(n_done)

        results = walk_rounds(entries, grounds, executor, count)
    return League(rank_entries(entries, results), skipped, grounds, sealed)
