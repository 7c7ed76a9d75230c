"""The search for a good walker as a problem for any optimiser: a box of real numbers and a fitness to maximise."""

import math
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

import numpy as np
import pandas as pd
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from walkerlab.evolution.founders import fit_genomes, read_founders
from walkerlab.evolution.run import Run
from walkerlab.ga.genes import Floats
from walkerlab.genome.features import build_genes, gene_table
from walkerlab.genome.genome import Genome, HasGenome, read_genomes
from walkerlab.interfaces.coordinates import Coordinates, find_free_genes
from walkerlab.interfaces.saving import MIN_GENERATION, save_evaluations
from walkerlab.runfile.records import EvaluationRow
from walkerlab.settings.arguments import require_count, require_generator, require_settings
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.simulation.descriptors import Descriptor, read_descriptors
from walkerlab.simulation.evaluation import Evaluation, evaluate
from walkerlab.simulation.fitness import check_user_function
from walkerlab.system.readonly import ReadOnlyArrays


@dataclass(frozen=True, eq=False)
class Batch(ReadOnlyArrays):
    """Evaluations of a batch of points.

    Attributes:
        fitness: Fitness, higher is better, shape (n,); ``Problem.uncounted`` where a walk does not count.
        descriptors: Behaviour descriptors, shape (n, n_descriptors); NaN where a walk does not count.
        counts: Whether each walk counts, shape (n,).
        evaluations: Evaluation of each robot, with its genome, verdict and measurements.
    """

    fitness: Floats
    descriptors: Floats
    counts: NDArray[np.bool_]
    evaluations: tuple[Evaluation, ...]


class Problem:
    """The search for a good walker as an optimisation problem; the fitness is maximised.

    A point has one coordinate from 0 to 1 for each free gene: each that is not frozen, can have more than one value
    and, if the body plan is frozen, has an effect on the robot.

        problem = wl.Problem(settings)
        fitness = problem(rng.random((20, problem.n_genes)))     # (20,)
        run = problem.save("random.walk", "random points")       # plots, replays and reports

    For the gait of a fixed body, freeze the body and give the robot:

        problem = wl.Problem(settings.with_(frozen="body"), genome=champion, uncounted=-10)

    Walks that do not count have the fitness ``-inf``. Optimisers that compute with fitness values, such as CMA-ES and
    Gaussian processes, require finite numbers: choose one below every fitness that counts, such as -10 for the distance
    in m. Records and run files contain ``-inf`` all the same.
    """

    def __init__(
        self,
        settings: Settings,
        *,
        genome: Genome | str | HasGenome | None = None,
        executor: Executor | None = None,
        descriptors: Iterable[str] | Mapping[str, Descriptor] = (),
        uncounted: float = -math.inf,
    ) -> None:
        """Check the arguments, without any simulation.

        Args:
            settings: Complete settings; ``frozen`` names genes that keep the values of ``genome``.
            genome: Robot whose genes are kept where they are frozen or have no effect; required if genes are frozen.
            executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
            descriptors: Names of built-in behaviour descriptors, such as ``("n_legs", "height")``, or a dict from names
                to functions of a ``Rollout``; ``walkerlab.simulation.descriptors`` lists them.
            uncounted: Fitness of walks that do not count: ``-inf``, or a finite number.

        Raises:
            GenomeError: If the text is not a valid genome.
            OperatorError: If a user function as fitness does not work.
            SettingsError: If the settings freeze genes, and there is no genome.
            TypeError: If an argument is of the wrong type.
            ValueError: If there is no such descriptor, no gene is free, or ``uncounted`` is NaN or +inf.
        """
        self.settings = require_settings(settings)
        check_user_function(settings)
        self.uncounted = float(uncounted)
        if not self.uncounted < math.inf:
            raise ValueError(f"uncounted is {uncounted}; it must be a finite number or -inf")
        self._descriptors = read_descriptors(descriptors)
        self._executor = executor
        self._founders = read_founders(None if genome is None else [genome], settings, "genome=robot")
        genes = build_genes(settings.robot)
        middle = fit_genomes(((genes.low + genes.high) / 2)[np.newaxis], settings, self._founders)[0]
        reference = Genome.parse(self._founders[0].genome).values if self._founders else middle
        self._coordinates = Coordinates(genes, find_free_genes(settings, genes, reference), reference)
        self._evaluated: list[EvaluationRow] = []
        self._described: list[Mapping[str, float]] = []
        self._known: dict[str, Evaluation] = {}
        self._first_batch = 0
        if not self.n_genes:
            raise ValueError("no gene is free: Algorithm.frozen and the limits of the robot fix all of them")

    @property
    def n_genes(self) -> int:
        """Number of free genes, the dimension of the problem."""
        return int(self._coordinates.is_free.sum())

    @property
    def genes(self) -> pd.DataFrame:
        """Table of the free genes, in the order of the coordinates: gene, unit, low, high, kind, meaning."""
        return gene_table(self.settings.robot).loc[self._coordinates.is_free].reset_index(drop=True)

    @property
    def low(self) -> Floats:
        """Minimum of each free gene in its unit, shape (n_genes,)."""
        return self._coordinates.low

    @property
    def high(self) -> Floats:
        """Maximum of each free gene in its unit, shape (n_genes,)."""
        return self._coordinates.high

    @property
    def descriptor_names(self) -> tuple[str, ...]:
        """Names of the descriptors, in the order of the columns of ``Batch.descriptors``."""
        return tuple(self._descriptors)

    def encode(self, genomes: Iterable[Genome | str | ArrayLike | HasGenome]) -> Floats:
        """Return the coordinates of genomes.

        Args:
            genomes: Genomes, their texts, robots or an array of shape (n, n_all_genes).

        Returns:
            Points, shape (n, n_genes), from 0 to 1; ``decode`` returns the same genomes if their other genes are those
            of this problem.

        Raises:
            GenomeError: If a text is not a valid genome.
            ValueError: If an array has another shape.
        """
        robots = [genome.within(self.settings.robot).values for genome in read_genomes(genomes)]
        return self._coordinates.encode(np.array(robots).reshape(-1, len(self._coordinates.genes)))

    def decode(self, points: ArrayLike) -> Floats:
        """Return the genomes at points.

        A whole number, such as the number of segments, has an interval of the same width for each of its values. Angles
        are cyclic: 1.25 is the same as 0.25. Other coordinates are clipped to 0 and 1. Then genomes are repaired, so
        several points can have the same genome, such as those of bodies that are too long.

        Args:
            points: Coordinates, shape (n, n_genes).

        Returns:
            Genomes in physical units, within all limits, shape (n, n_all_genes).

        Raises:
            ValueError: If the shape is wrong, or a coordinate is not finite.
        """
        return fit_genomes(self._coordinates.decode(points), self.settings, self._founders)

    def sample(self, n: int, *, rng: Generator) -> Floats:
        """Return random points drawn like generation 0, most of which stand on their feet.

        Uniform points, by contrast, mostly lie on their belly.

        Args:
            n: Number of points.
            rng: Random generator.

        Returns:
            Points, shape (n, n_genes).

        Raises:
            TypeError: If ``n`` is not a whole number, or ``rng`` is not a generator.
            ValueError: If ``n`` is negative.
        """
        n = require_count(n, "n", "the number of points", low=0)
        rng = require_generator(rng)
        drawn = np.array([Genome.random(self.settings.robot, rng=rng).values for _ in range(n)])
        return self.encode(list(fit_genomes(drawn.reshape(n, -1), self.settings, self._founders)))

    @overload
    def __call__(self, points: list[float]) -> float: ...
    @overload
    def __call__(self, points: ArrayLike) -> Floats: ...
    def __call__(self, points: ArrayLike) -> Any:
        """Return the fitness of points: shape (n,) for shape (n, n_genes), one number for shape (n_genes,).

        Minimisers require the negative: ``lambda point: -problem(point)``.
        """
        array = np.asarray(points, dtype=np.float64)
        return float(self.evaluate(array[np.newaxis]).fitness[0]) if array.ndim == 1 else self.evaluate(array).fitness

    def evaluate(self, points: ArrayLike) -> Batch:
        """Simulate and rate the robots at points, and record them.

        A genome that was evaluated before is recorded again, but not simulated.

        Args:
            points: Coordinates, shape (n, n_genes).

        Raises:
            OperatorError: If the fitness function or a descriptor fails.
            ValueError: If the shape is wrong, or a coordinate is not finite.
            WorkersLostError: If the workers do not answer or run out of memory.
        """
        robots = [Genome(values) for values in self.decode(points)]
        texts = list(map(str, robots))
        new = {text: robot for text, robot in zip(texts, robots, strict=True) if text not in self._known}
        rated = evaluate(list(new.values()), self.settings, self._executor, descriptors=self._descriptors)
        self._known |= zip(new, rated, strict=True)
        evaluations = tuple(self._known[text] for text in texts)
        self._evaluated += [EvaluationRow.of(one, text) for one, text in zip(evaluations, texts, strict=True)]
        self._described += [one.descriptors for one in evaluations]
        self._first_batch = self._first_batch or len(texts)
        counts = np.array([one.fitness != -math.inf for one in evaluations], dtype=np.bool_)
        fitness = np.array([one.fitness for one in evaluations])
        described = [[one.descriptors.get(name, math.nan) for name in self._descriptors] for one in evaluations]
        return Batch(
            fitness=np.where(counts, fitness, self.uncounted),
            descriptors=np.array(described).reshape(len(texts), len(self._descriptors)),
            counts=counts,
            evaluations=evaluations,
        )

    @property
    def n_evaluations(self) -> int:
        """Number of evaluated points."""
        return len(self._evaluated)

    @property
    def records(self) -> pd.DataFrame:
        """Table of all evaluated robots in their order, with the columns of ``run.records`` and of the descriptors."""
        table = pd.DataFrame(self._evaluated, columns=list(EvaluationRow._fields))
        for name in self._descriptors:
            if name not in table:
                table[name] = [described.get(name, math.nan) for described in self._described]
        return table

    def save(self, path: str | Path | None = None, optimiser: str = "optimiser", generation: int | None = None) -> Run:
        """Save all evaluations as a run, on which plots, replays and reports work.

        Every ``generation`` evaluations form a generation. The best earlier robots complete the last one. ``wl.resume``
        continues the file with the genetic algorithm.

        Args:
            path: Run file to create; if None, the run is only in memory.
            optimiser: Name of the optimiser, for the column ``operators``.
            generation: Number of robots of a generation, at least 4; if None, the size of the first batch.

        Returns:
            The run.

        Raises:
            RunFileError: If ``path`` exists already or cannot be created.
            SettingsError: If the settings cannot be stored in a run file.
            ValueError: If there are fewer than 4 evaluations, or ``generation`` is below 4.
        """
        default = self._first_batch if self._first_batch >= MIN_GENERATION else self.settings.algorithm.population_size
        size = min(default, self.n_evaluations) if generation is None else generation
        return save_evaluations(self._evaluated, self.settings, path, optimiser, size, self._founders)

    def __repr__(self) -> str:
        """Summarise the problem in a line."""
        described = f", descriptors {', '.join(self._descriptors)}" if self._descriptors else ""
        name = getattr(self.settings.algorithm.fitness, "name", short_repr(self.settings.algorithm.fitness))
        return f"Problem({self.n_genes} free genes, fitness {name}{described}; {self.n_evaluations} evaluations)"
