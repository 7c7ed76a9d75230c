"""The settings of the genetic algorithm."""

from collections.abc import Callable
from typing import Annotated, Any, Self

from pydantic import model_validator

from walkerlab.settings.choices import Crossover, Feature, Fitness, Frozen, Mutation, Selection
from walkerlab.settings.fields import OneOf, Quantity
from walkerlab.settings.glossary import DisplayedDomain


class Algorithm(DisplayedDomain, frozen=True):
    """The genetic algorithm: fitness, operators, population size and number of generations."""

    fitness: Annotated[
        Fitness | Callable[..., float], OneOf(Fitness, about="the quantity that evolution increases", functions=True)
    ] = Fitness.distance
    selection: Annotated[
        Any, OneOf(Selection, about="the method by which parents are chosen", functions=True, several=True)
    ] = Selection.tournament
    crossover: Annotated[
        Any, OneOf(Crossover, about="the method by which parents make children", functions=True, several=True)
    ] = Crossover.uniform
    mutation: Annotated[
        Any, OneOf(Mutation, about="the method by which children are varied", functions=True, several=True)
    ] = Mutation.gaussian
    population_size: Annotated[
        int, Quantity(low=4, high=10_000, about="the number of robots in each generation", whole=True)
    ] = 60
    generations: Annotated[
        int,
        Quantity(low=1, high=10_000, about="the number of generations, including the random first one", whole=True),
    ] = 25
    n_elites: Annotated[
        int, Quantity(low=0, high=1_000, about="the number of best robots that survive unchanged", whole=True)
    ] = 2
    mutation_rate: Annotated[float, Quantity(low=0.0, high=1.0, about="the probability that a gene changes")] = 0.04
    mutation_scale: Annotated[
        float,
        Quantity(
            low=0.0, high=2.0, about="the size of a change, as a share of the gene's range (gaussian) or value (others)"
        ),
    ] = 0.1
    favored_gene: Annotated[Feature, OneOf(Feature, about="the feature that favored mutation changes most often")] = (
        Feature.leg_length
    )
    frozen: Annotated[
        Any,
        OneOf(
            Frozen,
            about="the list of genes that do not evolve: they keep the values of the first robot given as population",
            several=True,
        ),
    ] = Frozen.none
    seed: Annotated[
        int, Quantity(low=0, high=2**31 - 1, about="the seed of all random numbers of the algorithm", whole=True)
    ] = 0

    @model_validator(mode="after")
    def _validate_elites(self) -> Self:
        if self.n_elites >= self.population_size:
            raise ValueError(
                f"Algorithm.n_elites is {self.n_elites}; it must be less than Algorithm.population_size, "
                f"{self.population_size}, or there would be no children."
            )
        return self
