"""The genetic algorithm: selection, crossover, mutation, and the steps from one generation to the next.

It works on tables of numbers and does not depend on the robot: the gene table describes the numbers, and a function
``evaluate`` returns the fitness of each genome. Operators are functions without state, in three slots:

    select(fitness, n_parents, *, rng) -> (n_parents,) indices              selection.py
    cross(parents, fitness, n_children, *, rng) -> children, their parents  crossover.py
    mutate(genomes, genes, *, rng) -> (n, n_genes)                          mutation.py
"""

from walkerlab.ga import crossover, mutation, selection
from walkerlab.ga.checks import check_cross, check_mutate, check_select
from walkerlab.ga.crossover import Children
from walkerlab.ga.loop import first_population, next_population
from walkerlab.ga.operators import Operators
from walkerlab.ga.population import NOT_COUNTED, Population
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
