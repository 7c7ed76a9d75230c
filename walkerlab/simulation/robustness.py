"""Robustness of a champion: the share of its fitness that it keeps in walks that differ slightly.

A high fitness may rest on a lucky bounce or on an error of the simulation. A fitness that remains at a quarter of the
timestep and from slightly different starts does not.

A share of a fitness near or below zero is hard to interpret, so the new fitness is printed with its difference instead.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

from walkerlab.genome.genome import Genome
from walkerlab.settings.arguments import require_count, require_settings
from walkerlab.settings.choices import Fitness
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import FITNESS_UNITS, find_poorest, name_and_unit, rate_walk
from walkerlab.simulation.rollout import simulate_walk, walk_from_every_start
from walkerlab.simulation.starts import draw_nudge
from walkerlab.text.numbers import format_significant, with_unit
from walkerlab.text.templates import Markup, render
from walkerlab.world.scene import compile_scene

TIMESTEP_DIVISOR = 4  # divisor of the timestep in the finer walk
MAX_SHARE = 10  # multiple of the fitness from which differences are printed instead
N_NUDGES = 5  # default number of slightly different starts
FIRST_NUDGE = 1000  # number of the first of these starts; evolution uses starts from 1 on


@dataclass(frozen=True)
class Confirmation:
    """Fitness of a champion in the run and in walks that differ slightly.

    Attributes:
        fitness: Fitness in the run.
        finer: Fitness at a quarter of the timestep; -inf if that walk did not count.
        nudged: Fitness from each slightly different start, in increasing order; -inf for walks that did not count.
        verdicts: Verdicts of the finer walk and of the walk from each start, in the order of simulation.
        measure: Name and unit of the fitness.
    """

    fitness: float
    finer: float
    nudged: tuple[float, ...]
    verdicts: tuple[str, ...]
    measure: str

    @property
    def kept_finer(self) -> float:
        """Share of the fitness that remains at a quarter of the timestep, at least 0; 0 if that walk did not count.

        1 means the same fitness. A loss is relative to the absolute value: the share is 0.75 for 1.5 after 2, and for
        -2.5 after -2. For a fitness of 0, the share is 0 after any loss and 1 otherwise.
        """
        return self._remaining_share(self.finer)

    @property
    def kept_nudged(self) -> float:
        """Share of the fitness that the median of the other starts reaches; defined as for ``kept_finer``."""
        return self._remaining_share(median(self.nudged))

    def _remaining_share(self, again: float) -> float:
        if not (math.isfinite(self.fitness) and math.isfinite(again)):
            return 0.0
        if self.fitness > 0:
            return max(0.0, again / self.fitness)
        if self.fitness == 0:
            return 1.0 if again >= 0 else 0.0
        return max(0.0, 2 - again / self.fitness)

    @property
    def _uses_shares(self) -> bool:
        """Whether results are printed as shares, which are hard to interpret for a fitness near or below zero."""
        return self.fitness > 0 and max(self.finer, *self.nudged) < MAX_SHARE * self.fitness

    def _format_results(self) -> list[str]:
        """Format the results at the finer timestep, from the median of the other starts, and from the poorest."""
        return [self._format_result(again) for again in (self.finer, median(self.nudged), min(self.nudged))]

    def _format_result(self, again: float) -> str:
        if self._uses_shares:
            return f"{self._remaining_share(again):.0%}"
        if not math.isfinite(again):
            return "does not count"
        text = with_unit(again, self._name_and_unit[1])
        change = again - self.fitness
        if not math.isfinite(change):
            return text
        if change == 0:
            return f"{text} (equal)"
        return f"{text} ({format_significant(abs(change))} {'less' if change < 0 else 'more'})"

    @property
    def _name_and_unit(self) -> tuple[str, str]:
        name, _, unit = self.measure.rpartition(" ")
        return (name, unit) if unit in FITNESS_UNITS.values() else (self.measure, "")

    @property
    def _fitness_in_run(self) -> str:
        """Description of the fitness in the run, such as "distance of 2.00 m"."""
        name, unit = self._name_and_unit
        if not math.isfinite(self.fitness):
            return "walk that does not count"
        return f"{name} of {with_unit(self.fitness, unit)}"

    def __str__(self) -> str:
        """Return a summary of a few lines."""
        finer, other, poorest = self._format_results()
        of_it = " of it" if self._uses_shares else ""
        width = max(4, len(finer), len(other))
        lines = [
            f"Its {self._fitness_in_run}, when it walks again:",
            f"  {finer:>{width}}{of_it} at a quarter of the timestep",
            f"  {other:>{width}}{of_it} from slightly different starts "
            f"(median of {len(self.nudged)}; {poorest} from the poorest)",
        ]
        if faults := [verdict for verdict in self.verdicts if verdict != "ok"]:
            lines.append(f"  {len(faults)} of these walks did not count: {', '.join(faults)}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return render("text/output.html", content=[self.table()])

    def table(self) -> Markup:
        """Return a summary as an HTML table."""
        finer, other, poorest = self._format_results()
        return render(
            "simulation/confirmation.html",
            fitness_in_run=self._fitness_in_run,
            uses_shares=self._uses_shares,
            finer=finer,
            median=other,
            poorest=poorest,
        )


def confirm(
    genome: Genome | str,
    settings: Settings,
    n_nudges: int = N_NUDGES,
    fitness: Fitness | str | Callable[..., Any] | None = None,
) -> Confirmation:
    """Simulate a robot again at a quarter of the timestep and from a few slightly different starts.

    Args:
        genome: Genome or its text.
        settings: Complete settings of the run; the seed of the terrain also determines the starts.
        n_nudges: Number of slightly different starts, at least 1.
        fitness: Fitness that rates the walks; if None, the fitness in the settings. Required for a loaded run with a
            user function, because the run file does not contain its code.

    Raises:
        GenomeError: If the text is not a valid genome.
        ValueError: If ``n_nudges`` is less than 1.
        RunFileError: If the settings come from a loaded run whose fitness is a user function.
    """
    genome = Genome.of(genome)
    settings = require_settings(settings)
    if fitness is not None:
        settings = settings.with_(fitness=fitness)
    require_count(n_nudges, "n_nudges", "number of slightly different starts")
    measure = settings.algorithm.fitness
    name, unit = name_and_unit(measure)
    simulation = settings.simulation
    finer_settings = settings.model_copy(  # the timestep may be below the range of the setting
        update={"simulation": simulation.model_copy(update={"timestep": simulation.timestep / TIMESTEP_DIVISOR})}
    )
    scene = compile_scene(genome, settings)
    rollouts_of_run = walk_from_every_start(scene, poses=False)
    new_rollouts = [
        simulate_walk(compile_scene(genome, finer_settings), poses=False),
        *(
            simulate_walk(scene, nudge=draw_nudge(scene, FIRST_NUDGE + number), poses=False)
            for number in range(n_nudges)
        ),
    ]
    rated = [rate_walk(rollout, measure) for rollout in new_rollouts]
    (finer, _), *nudged = rated
    return Confirmation(
        fitness=find_poorest([rate_walk(rollout, measure) for rollout in rollouts_of_run])[0],
        finer=finer,
        nudged=tuple(sorted(score for score, _ in nudged)),
        verdicts=tuple(rollout.verdict for _, rollout in rated),
        measure=f"{name} {unit}".strip(),
    )
