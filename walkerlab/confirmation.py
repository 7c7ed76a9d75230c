"""How much of a champion's fitness is its own, and how much luck: it walks again, a little differently.

Evolution looks for whatever scores, so a champion may rest on one lucky bounce, or on an error of the physics. What
stands at a quarter of the timestep, and from starts that are a little different, it can do.
"""

from dataclasses import dataclass
from statistics import median

import numpy as np

from walkerlab.fitness import label, score
from walkerlab.genome import Genome
from walkerlab.markup import Html, shown, table
from walkerlab.rollout import draw_nudge, walk, walk_from_every_start
from walkerlab.scene import compile_scene
from walkerlab.settings import Settings

FINER = 4  # times more steps
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
        """Part of the fitness that is left at a quarter of the timestep; 0 if that walk did not count."""
        return self._part(self.finer)

    @property
    def kept_nudged(self) -> float:
        """Part of the fitness that is left from other starts: the median of them."""
        return median(map(self._part, self.nudged))

    def _part(self, fitness: float) -> float:
        return max(0.0, fitness / self.fitness) if self.fitness > 0 and np.isfinite(fitness) else 0.0

    def __str__(self) -> str:
        """Tell it in words."""
        name, _, unit = self.measure.partition(" ")
        said = (
            f"Its {name} of {self.fitness:.2f} {unit}".rstrip() + ", when it walks again:\n"
            f"  {self.kept_finer:4.0%} of it at a quarter of the timestep\n"
            f"  {self.kept_nudged:4.0%} of it from starts that are a little different (the median of "
            f"{len(self.nudged)}; {self._part(self.nudged[0]):.0%} from the poorest)"
        )
        void = [verdict for verdict in self.verdicts if verdict != "ok"]
        return said + (f"\n  {len(void)} of these walks did not count: {', '.join(void)}" if void else "")

    def _repr_html_(self) -> str:
        return shown(self.table())

    def table(self) -> Html:
        """Tell it as a table."""
        rows = [
            ["at a quarter of the timestep", f"{self.kept_finer:.0%}", "does it live on an error of the physics?"],
            ["from other starts (the median)", f"{self.kept_nudged:.0%}", "does it live on one lucky start?"],
            ["from the poorest of these", f"{self._part(self.nudged[0]):.0%}", ""],
        ]
        name, _, unit = self.measure.partition(" ")
        caption = f"What is made of its {name} of {self.fitness:.2f} {unit}".rstrip() + " when it walks again"
        return table(caption, ["walk", "of it", "asks"], rows, numbers=(1,))


def confirm(genome: Genome | str, settings: Settings, n_nudges: int = N_NUDGES) -> Confirmation:
    """Let a robot walk again at a quarter of the timestep, and from a few starts that are a little different.

    Args:
        genome: a genome or its text.
        settings: of all four domains; the terrain's seed is that of the other starts too.
        n_nudges: how many of these.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if there is no other start to walk from.
    """
    if n_nudges < 1:
        raise ValueError(f"n_nudges is {n_nudges}; it must be 1 or more: how many other starts the robot walks from")
    fitness, (name, unit) = settings.algorithm.fitness, label(settings.algorithm.fitness)
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
    finer, *nudged = (score(rollout, fitness) for rollout in rollouts)
    return Confirmation(
        fitness=min(score(rollout, fitness) for rollout in seen),
        finer=finer,
        nudged=tuple(sorted(nudged)),
        verdicts=tuple(rollout.verdict for rollout in rollouts),
        measure=f"{name} {unit}".strip(),
    )
