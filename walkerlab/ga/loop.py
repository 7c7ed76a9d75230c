"""The loop over generations: selection, crossover, mutation, repair and evaluation; the caller iterates."""

from collections.abc import Callable, Sequence

import numpy as np

from walkerlab.ga.genes import Floats, Genes
from walkerlab.ga.operators import Operators, cross_in_turn, mutate_in_turn, select_in_turn
from walkerlab.ga.population import NOT_COUNTED, EvaluationT, Population, fitness_for_comparison


def first_population(genomes: Floats, evaluate: Callable[[Floats], Sequence[EvaluationT]]) -> Population[EvaluationT]:
    """Evaluate generation 0.

    Args:
        genomes: Genomes, shape (n, n_genes).
        evaluate: Function from (n, n_genes) genomes to n results, each with a ``fitness``.

    Returns:
        Population in which no individual has parents.

    Raises:
        ValueError: If the number of results is wrong, or a fitness is NaN or +inf.
    """
    n = len(genomes)
    return Population(
        generation=0,
        genomes=genomes.copy(),
        individuals=np.arange(n),
        born=np.zeros(n, dtype=np.intp),
        parents=((),) * n,
        evaluations=_evaluate_all(evaluate, genomes),
        n_born=n,
    )


def next_population(
    population: Population[EvaluationT],
    operators: Operators,
    genes: Genes,
    evaluate: Callable[[Floats], Sequence[EvaluationT]],
    *,
    repair: Callable[[Floats], Floats],
    n_elites: int,
    seed: int,
    generations: int | None = None,
    inserted: Floats | None = None,
) -> Population[EvaluationT]:
    """Breed and evaluate the next generation, of the same size.

    Args:
        population: Previous generation.
        operators: Operators in each slot.
        genes: Gene table.
        evaluate: Function from (n_children, n_genes) genomes to one result each; elites are not evaluated again.
        repair: Function that brings (n_children, n_genes) mutated genomes within all limits.
        n_elites: Number of the best individuals that are carried over unchanged, with their evaluations; fewer if fewer
            individuals count.
        seed: Seed of the run; each operator draws from its own stream.
        generations: Number of generations of the run, for operators with a keyword ``generations``.
        inserted: Genomes inserted from outside, shape (n_inserted, n_genes), which replace the last children.

    Returns:
        Population of the elites, best first, then the children, then the inserted genomes, which have no parents.

    Raises:
        OperatorError: If an operator fails.
        ValueError: If ``n_elites`` does not leave room for a child, there are more inserted genomes than children, the
            number of results is wrong, or a fitness is NaN or +inf.
    """
    n = len(population.genomes)
    if not 0 <= n_elites < n:
        raise ValueError(
            f"n_elites is {n_elites}; it must be between 0 and {n - 1}, so that at least one of the {n} is a child. "
            "It is the number of the best individuals that are carried over unchanged."
        )
    generation = population.generation + 1
    elites = find_elites(population.fitness, n_elites)
    n_children = n - len(elites)

    n_parents = n_children + n_children % 2  # whole couples
    selected = select_in_turn(
        operators.select,
        population.fitness,
        n_parents,
        seed=seed,
        generation=generation,
        generations=generations,
        genomes=population.genomes,
    )
    crossed = cross_in_turn(
        operators.cross,
        population.genomes[selected],
        fitness_for_comparison(population.fitness)[selected],
        n_children,
        genes=genes,
        seed=seed,
        generation=generation,
        generations=generations,
    )
    mutated = mutate_in_turn(
        operators.mutate, crossed.genomes, genes, seed=seed, generation=generation, generations=generations
    )
    inserted = np.empty((0, len(genes))) if inserted is None else inserted
    n_bred = n_children - len(inserted)
    if n_bred < 0:
        raise ValueError(
            f"{len(inserted)} genomes cannot be inserted into a generation of {n_children} children; insert at most "
            f"{n_children}"
        )
    children = np.concatenate([repair(mutated)[:n_bred], inserted])

    parents_of_bred: list[list[int]] = population.individuals[selected][crossed.parents[:n_bred]].tolist()
    parents = [tuple(sorted(set(row))) for row in parents_of_bred] + [()] * len(inserted)
    return Population(
        generation=generation,
        genomes=np.concatenate([population.genomes[elites], children]),
        individuals=np.concatenate([population.individuals[elites], population.n_born + np.arange(n_children)]),
        born=np.concatenate([population.born[elites], np.full(n_children, generation)]),
        parents=(*(population.parents[i] for i in elites), *parents),
        evaluations=[*(population.evaluations[i] for i in elites), *_evaluate_all(evaluate, children)],
        n_born=population.n_born + n_children,
    )


def find_elites(fitness: Floats, n_elites: int) -> list[int]:
    """Return the indices of the best individuals that count, best first; fewer than ``n_elites`` if fewer count."""
    best = np.argsort(-fitness, kind="stable")[:n_elites]
    return best[fitness[best] != NOT_COUNTED].tolist()


def _evaluate_all(evaluate: Callable[[Floats], Sequence[EvaluationT]], genomes: Floats) -> Sequence[EvaluationT]:
    """Evaluate a copy of the genomes, which ``evaluate`` may modify.

    Raises:
        ValueError: If the number of results is not the number of genomes.
    """
    evaluations = evaluate(genomes.copy())
    if len(evaluations) != len(genomes):
        raise ValueError(
            f"evaluate returned {len(evaluations)} results for {len(genomes)} genomes; it must return one for each "
            "genome, in their order."
        )
    return evaluations
