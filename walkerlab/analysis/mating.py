"""Cross and mutate with the operators of the settings, and trace each gene of one child."""

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.random import Generator

from walkerlab.analysis.inheritance import Birth, parent_letter
from walkerlab.analysis.tracing import NO_SOURCE, Sources, trace_sources
from walkerlab.breeding import resolve_operators
from walkerlab.ga.genes import Floats, Genes, Indices
from walkerlab.ga.operators import cross_in_turn, mutate_in_turn
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome, HasGenome
from walkerlab.genome.repair import repair
from walkerlab.settings.arguments import require_generator, require_settings
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings

AnyGenome: TypeAlias = Genome | str | Floats | HasGenome

GENERATION = 1  # generation passed to operators that ask for it


def mate(
    first: AnyGenome, second: AnyGenome, settings: Settings | None = None, *, rng: Generator,
    others: Sequence[AnyGenome] = (), fitness: Sequence[float] | None = None, mutates: bool = False, child: int = 0,
) -> Birth:  # fmt: skip
    """Cross two parents with the crossover operators of the settings, and trace each gene of one child.

    Args:
        first: First parent: a genome, its text, its values, or an individual.
        second: Second parent.
        settings: Settings with the operators and the limits of the robots; the defaults if None.
        rng: Random generator.
        others: Further selected parents, which some operators also use, such as ``randomized``.
        fitness: Fitness of all parents in this order; if None, that of individuals, and 0 for genomes.
        mutates: Whether the mutation operators of the settings change the child too.
        child: Index of the child, from 0; the couple's children are 0 and 1.

    Returns:
        The birth, with the parents that contributed, or the couple if it was not possible to trace any.

    Raises:
        OperatorError: If an operator does not work.
        ValueError: If the number of fitness values differs from the number of parents, or there is no such child.
    """
    settings = Settings() if settings is None else require_settings(settings)
    given = [first, second, *others]
    pool = np.array([Genome.of(one).within(settings.robot).values for one in given])
    if not 0 <= child < len(pool):
        raise ValueError(f"child is {child}; it must be between 0 and {len(pool) - 1}")
    ratings = [getattr(one, "fitness", 0.0) for one in given] if fitness is None else list(fitness)
    if len(ratings) != len(pool):
        raise ValueError(f"fitness must have a value for each of the {len(pool)} parents; it has {len(ratings)}")
    rated = np.array(ratings, dtype=np.float64)
    rated = np.where(np.isfinite(rated), rated, 0.0)
    names = tuple(_parent_name(one, position) for position, one in enumerate(given))
    seed = int(require_generator(rng).integers(2**31))
    return trace_birth(
        pool, rated, settings, names=names, seed=seed, generation=GENERATION, n_children=len(pool), child=child,
        mutates=mutates,
    )  # fmt: skip


def mutate(genome: AnyGenome, settings: Settings | None = None, *, rng: Generator) -> Birth:
    """Mutate a genome with the mutation operators of the settings, and trace each gene.

    Args:
        genome: Genome, its text, its values, or an individual.
        settings: Settings with the operators and the limits of the robots; the defaults if None.
        rng: Random generator.

    Returns:
        The birth, whose only parent is the genome.

    Raises:
        OperatorError: If an operator does not work.
    """
    settings = Settings() if settings is None else require_settings(settings)
    parent = Genome.of(genome).within(settings.robot).values[np.newaxis]
    seed = int(require_generator(rng).integers(2**31))
    genes = build_genes(settings.robot)
    copied = Sources(np.zeros(len(genes), dtype=np.intp), np.arange(len(genes)), np.ones((1, len(genes))))
    mutate_rows = _mutation(settings, seed, GENERATION)
    return _add_mutation(
        genes, parent, (_parent_name(genome, 0),), copied, parent, 0, mutate_rows, settings.robot, seed
    )


def trace_birth(
    pool: Floats, fitness: Floats, settings: Settings, *, names: Sequence[str], seed: int, generation: int,
    n_children: int, child: int, mutates: bool = True, repair_rows: Callable[[Floats], Floats] | None = None,
) -> Birth:  # fmt: skip
    """Breed children from selected parents, and trace one of them.

    Args:
        pool: Genomes of the selected parents, shape (n_parents, n_genes).
        fitness: Fitness of each, shape (n_parents,); finite.
        settings: Settings with the operators and the limits of the robots.
        names: Name of each parent.
        seed: Seed of the operators' random generators.
        generation: Number of the generation that is created.
        n_children: Number of children to breed.
        child: Index of the child to trace.
        mutates: Whether the children are mutated.
        repair_rows: Repair of (n, n_genes) genomes; that of the settings' limits if None.

    Raises:
        OperatorError: If an operator does not work.
    """
    genes = build_genes(settings.robot)
    operators = resolve_operators(settings.algorithm)

    def cross(parents: Floats) -> tuple[Floats, Indices]:
        return cross_in_turn(
            operators.cross, parents, fitness, n_children,
            genes=genes, seed=seed, generation=generation, generations=settings.algorithm.generations,
        )  # fmt: skip

    crossed, indices = cross(pool)
    rng = np.random.default_rng(seed)
    sources = trace_sources(lambda parents: cross(parents)[0][child], pool, genes, rng=rng, involved=indices[child])
    sources, kept = _merge_parents(sources, indices[child], names)
    return _add_mutation(
        genes, pool[kept], tuple(names[i] for i in kept), sources, crossed, child,
        _mutation(settings, seed, generation) if mutates else None, settings.robot, seed, repair_rows,
    )  # fmt: skip


def _mutation(settings: Settings, seed: int, generation: int) -> Callable[[Floats], Floats]:
    """Return the function that mutates (n, n_genes) genomes as a run with this seed does in this generation."""
    operators = resolve_operators(settings.algorithm)
    genes = build_genes(settings.robot)
    generations = settings.algorithm.generations
    return lambda genomes: mutate_in_turn(
        operators.mutate, genomes, genes, seed=seed, generation=generation, generations=generations
    )


def _add_mutation(
    genes: Genes, parents: Floats, names: tuple[str, ...], sources: Sources, crossed: Floats, row: int,
    mutate_rows: Callable[[Floats], Floats] | None, robot: Robot, seed: int,
    repair_rows: Callable[[Floats], Floats] | None = None,
) -> Birth:  # fmt: skip
    """Return the birth of one of the crossed children after mutation, if there is any, and repair.

    Args:
        genes: Gene table.
        parents: Genomes of the contributing parents.
        names: Their names.
        sources: Sources of the child's genes before mutation.
        crossed: All children before mutation, shape (n, n_genes).
        row: Index of the child.
        mutate_rows: Mutation of all children.
        robot: Limits of the robots.
        seed: Seed for tags.
        repair_rows: Repair of (n, n_genes) genomes; that of the limits if None.
    """
    inherited = crossed[row]
    mutated = inherited
    if mutate_rows is not None:

        def mutate_one(genome: Floats) -> Floats:
            whole = crossed.copy()
            whole[row] = genome[0]
            return mutate_rows(whole)[row]

        mutated = mutate_one(inherited[np.newaxis])
        moved = trace_sources(mutate_one, inherited[np.newaxis], genes, rng=np.random.default_rng(seed)).gene
        before = np.where(moved == NO_SOURCE, np.arange(len(genes)), moved)
        sources = Sources(sources.parent[before], sources.gene[before], sources.shares[:, before])
        inherited = inherited[before]
    repaired = (repair_rows or (lambda genomes: repair(genomes, robot)))(mutated[np.newaxis])[0]
    return Birth(genes, parents, names, sources, inherited, mutated, repaired)


def _merge_parents(sources: Sources, indices: Indices, names: Sequence[str]) -> tuple[Sources, list[int]]:
    """Merge parents with the same name, and keep those that contributed genes, or both parents of a couple.

    Returns:
        Sources with indices into the kept parents, and the kept parents, by number of genes if they are not a couple.
    """
    first = {name: index for index, name in reversed(list(enumerate(names)))}
    same = np.array([first[name] for name in names])
    shares = np.zeros_like(sources.shares)
    np.add.at(shares, same, sources.shares)
    kept: list[int] = list(dict.fromkeys(same[indices].tolist()))
    if len(kept) > 2:
        n_genes = np.abs(shares).sum(axis=1)
        kept = sorted([parent for parent in kept if n_genes[parent] > 0] or kept[:2], key=lambda one: -n_genes[one])
    positions = {parent: position for position, parent in enumerate(kept)}
    parent = [NO_SOURCE if one == NO_SOURCE else positions[int(same[one])] for one in sources.parent.tolist()]
    return Sources(np.array(parent, dtype=np.intp), sources.gene, shares[kept]), kept


def _parent_name(parent: AnyGenome, position: int) -> str:
    number = getattr(parent, "individual", None)
    return f"parent {parent_letter(position)}" if number is None else f"robot {number}"
