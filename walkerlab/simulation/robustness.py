"""How much of a champion's fitness is its own, and how much luck: it walks again, a little differently.

Evolution looks for whatever scores, so a champion may rest on one lucky bounce, or on an error of the physics. What
stands at a quarter of the timestep, and from starts that are a little different, it can do.

Outcomes are shares of a fitness above zero. A fitness of zero or below, or close above it, has no telling share, so
the new fitness is written with its difference.
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
from walkerlab.simulation.fitness import UNITS, label, poorest, rate
from walkerlab.simulation.rollout import walk, walk_from_every_start
from walkerlab.simulation.starts import draw_nudge
from walkerlab.text.html import Html, shown, table
from walkerlab.text.numbers import significant, with_unit
from walkerlab.world.scene import compile_scene

FINER = 4  # times more steps
MAX_SHARE = 10  # times the fitness, from which on differences are written in place of shares
N_NUDGES = 5  # starts that are a little different
UNSEEN = 1000  # the number of the first of these starts: evolution walks from the first ones, if from any


@dataclass(frozen=True)
class Confirmation:
    """What a champion keeps of its fitness.

    Attributes:
        fitness: as evolution measured it.
        finer: the same walk at a quarter of the timestep; -inf if it did not count.
        nudged: from starts that are a little different, the poorest first.
        verdicts: of the finer walk and of each from another start, in the order in which they were walked.
        measure: what the fitness is, with its unit.
    """

    fitness: float
    finer: float
    nudged: tuple[float, ...]
    verdicts: tuple[str, ...]
    measure: str

    @property
    def kept_finer(self) -> float:
        """Share of the fitness that is kept at a quarter of the timestep, at least 0; 0 if that walk did not count.

        1 means the same fitness. A loss is a share of the absolute value: of -2, -2.5 keeps 0.75, as 1.5 does of 2.
        Of a fitness of 0, any loss keeps 0, and anything else 1.
        """
        return self._share(self.finer)

    @property
    def kept_nudged(self) -> float:
        """Share of the fitness that is kept from other starts, by their median; defined as ``kept_finer``."""
        return self._share(median(self.nudged))

    def _share(self, again: float) -> float:
        if not (math.isfinite(self.fitness) and math.isfinite(again)):
            return 0.0
        if self.fitness > 0:
            return max(0.0, again / self.fitness)
        if self.fitness == 0:
            return float(again >= 0)
        return max(0.0, 2 - again / self.fitness)

    @property
    def _in_shares(self) -> bool:
        """Whether the outcomes are written as shares: of a fitness near zero or below, these say little."""
        return self.fitness > 0 and max(self.finer, *self.nudged) < MAX_SHARE * self.fitness

    def _outcomes(self) -> list[str]:
        """Write what is left at the finer timestep, from the median of the other starts, and from the poorest."""
        return [self._outcome(again) for again in (self.finer, median(self.nudged), min(self.nudged))]

    def _outcome(self, again: float) -> str:
        if self._in_shares:
            return f"{self._share(again):.0%}"
        if not math.isfinite(again):
            return "does not count"
        text, change = with_unit(again, self._name_and_unit[1]), again - self.fitness
        if not math.isfinite(change):
            return text
        if change == 0:
            return f"{text} (equal)"
        return f"{text} ({significant(abs(change))} {'less' if change < 0 else 'more'})"

    @property
    def _name_and_unit(self) -> tuple[str, str]:
        name, _, unit = self.measure.rpartition(" ")
        return (name, unit) if unit in UNITS.values() else (self.measure, "")

    @property
    def _first(self) -> str:
        """The fitness as evolution measured it, in words."""
        name, unit = self._name_and_unit
        if not math.isfinite(self.fitness):
            return "walk that does not count"
        return f"{name} of {with_unit(self.fitness, unit)}"

    def __str__(self) -> str:
        """Describe it in a few lines."""
        finer, other, poorest = self._outcomes()
        of_it = " of it" if self._in_shares else ""
        width = max(4, len(finer), len(other))
        lines = [
            f"Its {self._first}, when it walks again:",
            f"  {finer:>{width}}{of_it} at a quarter of the timestep",
            f"  {other:>{width}}{of_it} from starts that are a little different (the median of "
            f"{len(self.nudged)}; {poorest} from the poorest)",
        ]
        if void := [verdict for verdict in self.verdicts if verdict != "ok"]:
            lines.append(f"  {len(void)} of these walks did not count: {', '.join(void)}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return shown(self.table())

    def table(self) -> Html:
        """Describe it as a table."""
        finer, other, poorest = self._outcomes()
        rows = [
            ["at a quarter of the timestep", finer, "does it live on an error of the physics?"],
            ["from other starts (the median)", other, "does it live on one lucky start?"],
            ["from the poorest of these", poorest, ""],
        ]
        caption = f"What is left of its {self._first} when it walks again"
        return table(caption, ["walk", "of it" if self._in_shares else "fitness", "asks"], rows, numbers=(1,))


def confirm(
    genome: Genome | str,
    settings: Settings,
    n_nudges: int = N_NUDGES,
    fitness: Fitness | str | Callable[..., Any] | None = None,
) -> Confirmation:
    """Let a robot walk again at a quarter of the timestep, and from a few starts that are a little different.

    Args:
        genome: a genome or its text.
        settings: of all four domains; the terrain's seed is that of the other starts too.
        n_nudges: how many of these.
        fitness: by which the walks are rated; that of the settings if None. A loaded run has lost its own function.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if there is no other start to walk from.
        RunFileError: if the settings are of a loaded run, which has lost its own fitness function.
    """
    genome, settings = Genome.of(genome), require_settings(settings)
    if fitness is not None:
        settings = settings.with_(fitness=fitness)
    require_count(n_nudges, "n_nudges", "how many other starts the robot walks from")
    measure, (name, unit) = settings.algorithm.fitness, label(settings.algorithm.fitness)
    simulation = settings.simulation
    finer_steps = settings.model_copy(  # which may be under the range of the setting
        update={"simulation": simulation.model_copy(update={"timestep": simulation.timestep / FINER})}
    )
    scene = compile_scene(genome, settings)
    seen = walk_from_every_start(scene, poses=False)
    rollouts = [
        walk(compile_scene(genome, finer_steps), poses=False),
        *(walk(scene, nudge=draw_nudge(scene, UNSEEN + number), poses=False) for number in range(n_nudges)),
    ]
    rated = [rate(rollout, measure) for rollout in rollouts]
    (finer, _), *nudged = rated
    return Confirmation(
        fitness=poorest([rate(rollout, measure) for rollout in seen])[0],
        finer=finer,
        nudged=tuple(sorted(score for score, _ in nudged)),
        verdicts=tuple(rollout.verdict for _, rollout in rated),
        measure=f"{name} {unit}".strip(),
    )
