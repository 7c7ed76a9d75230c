"""Cross and mutate with the operators of the settings, and trace each gene of one child."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, TypeAlias

import numpy as np
from numpy.random import Generator

from walkerlab.analysis.inheritance import Birth
from walkerlab.analysis.tracing import NO_SOURCE, Sources, trace_sources
from walkerlab.ga.genes import Floats, Indices
from walkerlab.ga.operators import cross_in_turn, mutate_in_turn
from walkerlab.genome.breeding import describe_operators, resolve_operators
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome, HasGenome
from walkerlab.genome.repair import repair
from walkerlab.settings.arguments import require_generator, require_settings
from walkerlab.settings.settings import Settings
from walkerlab.system.randomness import random_stream

AnyGenome: TypeAlias = Genome | str | Floats | HasGenome

ASSUMED_GENERATION = 1  # generation number for operators that take one


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
        others: Additional selected parents, for operators that use them, such as ``randomized``.
        fitness: Fitness of all parents, in the order of the arguments; if None, each individual has its own fitness,
            and each genome has 0.
        mutates: Whether to mutate the child, too, with the mutation operators of the settings.
        child: Index of the child, from 0; the children of the first two parents are 0 and 1.

    Returns:
        Birth with both parents of the child; if the operators use more than two, with those that contributed genes.

    Raises:
        OperatorError: If an operator fails.
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
        pool, rated, settings, names=names, seed=seed, generation=ASSUMED_GENERATION, n_children=len(pool), child=child,
        mutates=mutates,
    )  # fmt: skip


def mutate(genome: AnyGenome, settings: Settings | None = None, *, rng: Generator) -> Birth:
    """Mutate a genome with the mutation operators of the settings, and trace each gene.

    Args:
        genome: Genome, its text, its values, or an individual.
        settings: Settings with the operators and the limits of the robots; the defaults if None.
        rng: Random generator.

    Returns:
        Birth with the genome as the only parent.

    Raises:
        OperatorError: If an operator fails.
    """
    settings = Settings() if settings is None else require_settings(settings)
    parent = Genome.of(genome).within(settings.robot).values[np.newaxis]
    seed = int(require_generator(rng).integers(2**31))
    genes = build_genes(settings.robot)
    copied = Sources(np.zeros(len(genes), dtype=np.intp), np.arange(len(genes)), np.ones((1, len(genes))))
    name = "parent" if getattr(genome, "individual", None) is None else _parent_name(genome, 0)
    birth = Birth(genes, parent, (name,), copied, parent[0], parent[0], parent[0], "mutant")
    return _complete_birth(birth, parent, 0, settings, seed, ASSUMED_GENERATION)


def trace_birth(
    pool: Floats, fitness: Floats, settings: Settings, *, names: Sequence[str], seed: int, generation: int,
    n_children: int, child: int, name: str = "child", mutates: bool = True,
    repair_rows: Callable[[Floats], Floats] | None = None,
) -> Birth:  # fmt: skip
    """Breed children from selected parents, and trace one of them.

    Args:
        pool: Genomes of the selected parents, shape (n_parents, n_genes).
        fitness: Fitness of each parent, shape (n_parents,); finite.
        settings: Settings with the operators and the limits of the robots.
        names: Name of each parent.
        seed: Seed of the operators' random generators.
        generation: Number of the generation being created.
        n_children: Number of children to breed.
        child: Index of the child to trace.
        name: Name of the child.
        mutates: Whether the children are mutated.
        repair_rows: Function that repairs genomes, shape (n, n_genes); by default, it brings them within the limits of
            the settings.

    Raises:
        OperatorError: If an operator fails.
    """
    genes = build_genes(settings.robot)
    operators = resolve_operators(settings.algorithm)

    def cross(parents: Floats) -> tuple[Floats, Indices]:
        return cross_in_turn(
            operators.cross, parents, fitness, n_children,
            genes=genes, seed=seed, generation=generation, generations=settings.algorithm.generations,
        )  # fmt: skip

    crossed, indices = cross(pool)
    rng = random_stream(seed, "analysis", child)
    sources = trace_sources(lambda parents: cross(parents)[0][child], pool, genes, rng=rng, involved=indices[child])
    sources, kept = _merge_parents(sources, indices[child], names)
    values = crossed[child]
    parent_names = tuple(names[i] for i in kept)
    birth = Birth(
        genes, pool[kept], parent_names, sources, values, values, values, name, operator_names(settings, "crossover")
    )
    if mutates:
        return _complete_birth(birth, crossed, child, settings, seed, generation, repair_rows)
    return replace(birth, child=(repair_rows or partial(repair, robot=settings.robot))(values[np.newaxis])[0])


def operator_names(settings: Settings, slot: Literal["crossover", "mutation"]) -> tuple[str, ...]:
    """Return the names of the crossover or mutation operators of settings."""
    return tuple(describe_operators(settings.algorithm).split(" > ")[1 if slot == "crossover" else 2].split("+"))


def _complete_birth(
    birth: Birth, crossed: Floats, row: int, settings: Settings, seed: int, generation: int,
    repair_rows: Callable[[Floats], Floats] | None = None,
) -> Birth:  # fmt: skip
    """Mutate and repair a child that crossover has produced, and trace its genes.

    Args:
        birth: Birth before mutation.
        crossed: All children before mutation, shape (n, n_genes).
        row: Index of the child.
        settings: Settings with the operators and the limits of the robots.
        seed: Seed of the operators' random generators.
        generation: Number of the generation being created.
        repair_rows: Function that repairs genomes, shape (n, n_genes); by default, it brings them within the limits of
            the settings.
    """
    operators = resolve_operators(settings.algorithm)
    genes = birth.genes

    def mutate_one(genome: Floats) -> Floats:
        whole = crossed.copy()
        whole[row] = genome[0]
        return mutate_in_turn(
            operators.mutate, whole, genes,
            seed=seed, generation=generation, generations=settings.algorithm.generations,
        )[row]  # fmt: skip

    inherited = crossed[row]
    mutated = mutate_one(inherited[np.newaxis])
    moved = trace_sources(mutate_one, inherited[np.newaxis], genes, rng=random_stream(seed, "analysis", row)).gene
    before = np.where(moved == NO_SOURCE, np.arange(len(genes)), moved)
    sources = birth.sources
    return replace(
        birth,
        sources=Sources(sources.parent[before], sources.gene[before], sources.shares[:, before]),
        inherited=inherited[before],
        mutated=mutated,
        child=(repair_rows or partial(repair, robot=settings.robot))(mutated[np.newaxis])[0],
        operators=(*birth.operators, *operator_names(settings, "mutation")),
    )


def _merge_parents(sources: Sources, indices: Indices, names: Sequence[str]) -> tuple[Sources, list[int]]:
    """Merge parents with the same name; keep both parents of a couple, or those of several that contributed genes.

    Returns:
        Sources with indices into the kept parents, and the indices of these parents; if there are more than two,
        sorted by the number of genes that they contributed.
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
    return f"genome {position + 1}" if number is None else f"robot {number}"
