"""The settings of the genetic algorithm."""

from collections.abc import Callable
from typing import Any, Self

from pydantic import model_validator

from walkerlab.settings.choices import Crossover, Feature, Fitness, Mutation, Selection
from walkerlab.settings.fields import one_of, quantity
from walkerlab.settings.glossary import ShownDomain


class Algorithm(ShownDomain, frozen=True):
    """The genetic algorithm: what is better, who breeds, how, and for how long."""

    fitness: Fitness | Callable[..., float] = one_of(
        Fitness.distance, functions=True, about="what makes one robot better than another"
    )
    selection: Any = one_of(Selection.gradient, functions=True, several=True, about="how parents are chosen")
    crossover: Any = one_of(Crossover.paired, functions=True, several=True, about="how parents make children")
    mutation: Any = one_of(Mutation.randomized, functions=True, several=True, about="how children are varied")
    population_size: int = quantity(60, low=4, high=10_000, about="how many robots each generation has")
    generations: int = quantity(
        25, low=1, high=10_000, about="how many generations are walked, counting the random first one"
    )
    n_elites: int = quantity(2, low=0, high=1_000, about="how many of the best live on unchanged")
    mutation_rate: float = quantity(0.08, low=0.0, high=1.0, about="the chance of each gene to change")
    mutation_scale: float = quantity(0.2, low=0.0, high=2.0, about="the size of a change, as a share of the value")
    favored_gene: Feature = one_of(Feature.leg_length, about="the feature that favored mutation changes most often")
    seed: int = quantity(0, low=0, high=2**31 - 1, about="the seed of all chance in the algorithm")

    @model_validator(mode="after")
    def _room_for_children(self) -> Self:
        if self.n_elites >= self.population_size:
            raise ValueError(
                f"Algorithm.n_elites is {self.n_elites}; it must be under Algorithm.population_size, "
                f"{self.population_size}, or no child would ever be born."
            )
        return self
