"""The genetic algorithm: who breeds, how parents are mixed, how children vary, and the loop around it.

It works on tables of numbers and knows no robot: a gene table says what the numbers are, and an ``evaluate``
that it is handed says how good they are. Operators are plain functions without state, in three slots:

    select(fitness, n_parents, *, rng) -> (n_parents,) indices              selection.py
    cross(parents, fitness, n_children, *, rng) -> children, their parents  crossover.py
    mutate(genomes, genes, *, rng) -> (n, n_genes)                          mutation.py
"""

from walkerlab.ga import crossover, mutation, selection
from walkerlab.ga.checks import check_cross, check_mutate, check_select
from walkerlab.ga.crossover import Children
from walkerlab.ga.loop import NOT_COUNTED, Operators, Population, first_population, next_population
from walkerlab.ga.user_functions import OperatorError, name_of

__all__ = [
    "NOT_COUNTED",
    "Children",
    "OperatorError",
    "Operators",
    "Population",
    "check_cross",
    "check_mutate",
    "check_select",
    "crossover",
    "first_population",
    "mutation",
    "name_of",
    "next_population",
    "selection",
]
