"""The displayed origin and change of each gene are those of the operator, built-in or written by a user."""

from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.analysis.comparison import compare_with_parents
from walkerlab.analysis.inheritance import ROUNDING_TOLERANCE, gene_widths, shortest_change
from walkerlab.analysis.mating import mate, mutate, trace_birth
from walkerlab.analysis.tracing import NO_SOURCE
from walkerlab.ga.operators import cross_in_turn
from walkerlab.ga.slots import run_cross
from walkerlab.genome.breeding import crossover_population, mutate_population, resolve_operators
from walkerlab.genome.features import build_genes
from walkerlab.genome.repair import repair
from walkerlab.settings.choices import Crossover, Mutation
from walkerlab.system.randomness import random_stream

SETTINGS = wl.Settings()
GENES = build_genes(SETTINGS.robot)
WIDTHS = gene_widths(GENES)
POOL = wl.generate_robot_population(SETTINGS.robot, 8, seed=3)
FITNESS = np.array([5.0, 1.0, 4.0, 2.0, 0.0, 3.0, 6.0, 2.5])
NAMES = [f"robot {i}" for i in range(8)]


# ------------------------------------------------------------------------------------ operators written by a user


def mean_of_couple(parents, fitness, n_children, *, rng):
    couples = np.arange(2 * n_children).reshape(-1, 2) % len(parents)
    return parents[couples].mean(axis=1), couples


def blend_beyond(parents, fitness, n_children, *, rng):
    couples = np.arange(2 * n_children).reshape(-1, 2) % len(parents)
    share = rng.uniform(-0.2, 1.2, (n_children, parents.shape[1]))
    return parents[couples[:, 0]] + share * (parents[couples[:, 1]] - parents[couples[:, 0]]), couples


def exchange_segments(parents, fitness, n_children, *, rng, genes):
    couples = np.arange(2 * n_children).reshape(-1, 2) % len(parents)
    children = parents[couples[:, 0]].copy()
    genes.parts(children)[:, 0] = genes.parts(parents[couples[:, 1]])[:, 2]
    return children, couples


def larger_gene(parents, fitness, n_children, *, rng):
    couples = np.arange(2 * n_children).reshape(-1, 2) % len(parents)
    return parents[couples].max(axis=1), couples


def copy_with_noise(parents, fitness, n_children, *, rng):
    copied = np.arange(n_children) % len(parents)
    return parents[copied] + 0.01 * rng.standard_normal((n_children, parents.shape[1])), copied[:, None]


def only_if_legs(parents, fitness, n_children, *, rng):
    couples = np.arange(2 * n_children).reshape(-1, 2) % len(parents)
    first, second = parents[couples[:, 0]], parents[couples[:, 1]]
    return np.where(first[:, 6:7] > 0, first, second), couples


def reverse_segments(genomes, genes, *, rng):
    changed = genomes.copy()
    genes.parts(changed)[:] = genes.parts(genomes)[:, ::-1]
    return changed


def nudge(genomes, genes, *, rng):
    return genomes + 0.01 * (genes.high - genes.low) * rng.uniform(-1, 1, genomes.shape)


def reset_some(genomes, genes, *, rng):
    return np.where(rng.random(genomes.shape) < 0.2, rng.uniform(genes.low, genes.high, genomes.shape), genomes)


CROSSOVERS = [*Crossover, mean_of_couple, blend_beyond, exchange_segments, larger_gene, copy_with_noise, only_if_legs,
              (Crossover.uniform, Crossover.paired)]  # fmt: skip
MUTATIONS = [*Mutation, reverse_segments, nudge, reset_some, (Mutation.macro, Mutation.gaussian)]


def name_of(operator):
    return (
        "+".join(map(name_of, operator))
        if isinstance(operator, tuple)
        else getattr(operator, "name", operator.__name__ if callable(operator) else "")
    )


def births(settings, n=4, *, mutates=False):
    return [
        trace_birth(
            POOL, FITNESS, settings, names=NAMES, seed=settings.algorithm.seed, generation=1, n_children=8, child=child,
            mutates=mutates,
        )
        for child in range(n)
    ]  # fmt: skip


def assert_consistent(birth):
    """Assert that the values before mutation follow from the parents and the shown origins."""
    for j, origin in enumerate(birth.origins):
        parent, gene = birth.sources.parent[j], birth.sources.gene[j]
        shares = birth.sources.shares[:, j]
        if origin in ("parent", "same"):
            assert shares.sum() == shares[parent] == 1
            assert birth.inherited[j] == pytest.approx(birth.parents[parent, gene] + birth.crossover[j], abs=1e-6)
        if origin == "same":
            assert (birth.parents[:, j] == birth.parents[0, j]).all()
        if origin == "blend":
            blend = shares @ birth.parents[:, j]
            around = birth.parents[0, j] + shares @ shortest_change(birth.parents[0], birth.parents, GENES)[:, j]
            error = min(
                abs(shortest_change(np.full(len(GENES), one), birth.inherited, GENES)[j]) for one in (blend, around)
            )
            assert error <= (0.5 if GENES.is_count[j] else 1e-5 * WIDTHS[j])


# ------------------------------------------------------------------------------------------------------ crossover


@pytest.mark.parametrize("crossover", CROSSOVERS, ids=name_of)
def test_the_shown_origins_are_those_of_the_crossover(crossover):
    settings = SETTINGS.with_(crossover=crossover, seed=5)
    children, parents = crossover_population(POOL, FITNESS, 8, SETTINGS.robot, settings.algorithm, generation=1)
    for child, birth in enumerate(births(settings)):
        assert np.array_equal(birth.inherited, children[child])
        assert {*birth.names} <= {NAMES[parent] for parent in parents[child]}
        assert np.array_equal(birth.child, repair(children[child : child + 1], SETTINGS.robot)[0])
        assert not birth.mutation.any()
        assert_consistent(birth)


def test_randomized_crossover_shows_the_donor_of_each_gene():
    settings = SETTINGS.with_(crossover="randomized")
    _, donors = crossover_population(POOL, FITNESS, 8, SETTINGS.robot, settings.algorithm, generation=1)
    for child, birth in enumerate(births(settings)):
        shown = [birth.names[parent] for parent in birth.sources.parent]
        for j, donor in enumerate(donors[child]):
            assert shown[j] == NAMES[donor] or POOL[donor, j] in POOL[[NAMES.index(shown[j])], j]
        is_real = ~GENES.is_count
        assert [name for name, real in zip(shown, is_real, strict=True) if real] == [
            NAMES[i] for i in donors[child][is_real]
        ]


def test_weighted_crossover_shows_the_share_of_the_fitter_parent():
    for child, birth in enumerate(births(SETTINGS.with_(crossover="weighted"))):
        first, second = FITNESS[child], FITNESS[child + 1]
        share = abs(first - second) / np.ptp(FITNESS)
        fitter = birth.names.index(NAMES[child if first >= second else child + 1])
        is_blend = np.array(birth.origins) == "blend"
        assert is_blend[~GENES.is_count].all()
        assert birth.sources.shares[fitter, is_blend] == pytest.approx(share, abs=1e-5)


def test_segments_that_a_crossover_moves_show_their_position_in_the_parent():
    genes = GENES
    long, short = POOL[0].copy(), POOL[1].copy()
    long[genes.count], short[genes.count] = 4, 1
    settings = SETTINGS.with_(crossover="paired")
    birth = mate(wl.Genome(short), wl.Genome(long), settings, rng=np.random.default_rng(0))
    rear = genes.find("mass")
    assert [genes.names[gene] for gene in birth.sources.gene[rear[:3]]] == ["seg1.mass", "seg3.mass", "seg4.mass"]
    assert birth.sources.parent[rear[:3]].tolist() == [0, 1, 1]
    assert birth.is_moved[rear[1:3]].all()


def test_a_mutation_in_a_crossover_is_shown_as_its_change():
    birth = births(SETTINGS.with_(crossover=copy_with_noise), 1)[0]
    assert birth.names == ("robot 0",)
    assert (birth.sources.parent == 0)[~GENES.is_count].all()
    assert np.allclose(birth.crossover[~GENES.is_count], (birth.inherited - POOL[0])[~GENES.is_count])


def test_traced_parents_agree_with_the_random_numbers_of_uniform_crossover():
    settings = SETTINGS.with_(crossover="uniform", seed=9)
    from_first = random_stream(9, "crossover", 1, 0).random((4, len(GENES))) < 1 / 2
    for child, birth in enumerate(births(settings, 4)):
        is_from_first = from_first[child // 2] if child % 2 == 0 else ~from_first[child // 2]
        first = birth.names.index(NAMES[2 * (child // 2)])
        for j, origin in enumerate(birth.origins):
            if origin == "parent":
                assert (birth.sources.parent[j] == first) == is_from_first[j], GENES.names[j]


# ------------------------------------------------------------------------------------------------------- mutation


@pytest.mark.parametrize("mutation", MUTATIONS, ids=name_of)
def test_the_shown_changes_are_those_of_the_mutation(mutation):
    settings = SETTINGS.with_(mutation=mutation, crossover="none", mutation_rate=0.2, seed=5)
    expected = mutate_population(POOL, SETTINGS.robot, settings.algorithm, generation=1)
    for row, birth in enumerate(births(settings, mutates=True)):
        assert np.array_equal(birth.child, expected[row])
        assert_consistent(birth)
        assert np.allclose(shortest_change(birth.inherited + birth.mutation, birth.mutated, GENES), 0, atol=1e-9)
        assert ((birth.mutation != 0) == (birth.inherited != birth.mutated)).all()
        moved = birth.is_moved
        at_same_place = ~moved & (birth.sources.gene != NO_SOURCE)
        assert (birth.inherited[at_same_place] == POOL[row][at_same_place]).all()


@pytest.mark.parametrize("n", [1, 5])
def test_segments_that_macro_duplicates_or_drops_are_shown_as_moved(n):
    rng = np.random.default_rng(n)
    settings = SETTINGS.with_(mutation=partial(wl.ga.mutation.macro, rate=0.2), mutation_rate=0)
    birth = next(one for one in (mutate(POOL[0], settings, rng=rng) for _ in range(20)) if one.is_moved.any())
    unchanged = birth.mutation == 0
    assert (birth.mutated[unchanged] == POOL[0][birth.sources.gene[unchanged]]).all()
    assert unchanged.mean() > 0.5
    assert not birth.is_moved[: GENES.n_whole].any()


def test_without_mutation_nothing_changes():
    birth = mutate(POOL[0], SETTINGS.with_(mutation_rate=0), rng=np.random.default_rng(0))
    assert np.array_equal(birth.child, POOL[0])
    assert not birth.change.any()
    assert birth.origins == ("parent",) * len(GENES)


def test_what_repair_changes_is_shown_as_repair():
    def stretch(genomes, genes, *, rng):
        changed = genomes.copy()
        changed[:, genes.find("length")] *= 100
        return changed

    birth = mutate(POOL[0], SETTINGS.with_(mutation=stretch), rng=np.random.default_rng(0))
    lengths = GENES.find("length")
    assert birth.is_repaired[lengths].all()
    assert (birth.repair[lengths] < 0).all()
    assert np.allclose(birth.mutated + birth.repair, birth.child)
    assert set(np.flatnonzero(birth.mutation)) == set(lengths)


# ------------------------------------------------------------------------------------------------- records, table


@pytest.fixture(scope="module")
def run():
    from concurrent.futures import ThreadPoolExecutor

    settings = wl.Settings().with_(population_size=6, generations=4, duration=1, mutation_rate=0.1)
    with ThreadPoolExecutor(1) as workers:
        return wl.evolve(settings, executor=workers, progress=False)


def test_every_birth_of_a_run_is_repeated_exactly(run):
    children = run.records.drop_duplicates("individual").query("parents != ''")
    assert len(children) > 10
    for row in children.itertuples():
        birth = wl.explain_birth(run, row.individual)
        assert birth.is_exact
        assert str(birth.genome) == row.genome
        assert {*birth.names} <= {f"robot {number}" for number in row.parents.split()}
        assert_consistent(birth)


def test_without_the_operators_a_birth_is_inferred_from_the_genomes(run):
    other = wl.Run(run.settings.with_(seed=99), run.records)
    for row in run.records.drop_duplicates("individual").query("parents != ''").itertuples():
        birth = wl.explain_birth(other, row.individual)
        assert not birth.is_exact
        assert str(birth.genome) == row.genome
        assert_consistent(birth)
        exact = wl.explain_birth(run, row.individual)
        is_plain = (exact.change == 0) & (np.array(exact.origins) == "parent") & ~GENES.is_count
        named = [birth.names[i] for i in birth.sources.parent]
        agrees = [named[j] == exact.names[exact.sources.parent[j]] for j in np.flatnonzero(is_plain)]
        assert np.mean(agrees) > 0.9


def test_a_robot_without_parents_is_rejected(run):
    with pytest.raises(ValueError, match="robot 0 has no parents in this table; it is random"):
        wl.explain_birth(run, 0)
    with pytest.raises(ValueError, match="individual 999 is not in this run"):
        wl.explain_birth(run, 999)


def test_a_blend_is_inferred_from_the_genomes():
    first, second = POOL[:2]
    blend = repair((first + 0.25 * shortest_change(first, second, GENES))[None], SETTINGS.robot)[0]
    birth = compare_with_parents(wl.Genome(blend), [first, second], SETTINGS.robot, ["a", "b"])
    is_blend = np.array(birth.origins) == "blend"
    assert is_blend[~GENES.is_count].mean() > 0.6
    assert birth.sources.shares[1, is_blend] == pytest.approx(0.25, abs=0.02)


def test_the_table_has_a_row_for_each_gene():
    birth = births(SETTINGS.with_(crossover="paired", mutation_rate=0.3), 1, mutates=True)[0]
    table = birth.table
    assert table.gene.tolist() == list(GENES.names)
    assert set(table.origin) <= {"A", "B", "same", "blend", "new"}
    assert table.attrs["parents"] == dict(zip("AB", birth.names, strict=True))
    from_a = table[table.origin == "A"].set_index("gene")
    assert (from_a["parent A"] == table.set_index("gene")["parent A"].loc[from_a.index]).all()
    is_changed = table.change != 0
    assert is_changed.any()
    assert (is_changed >= (table.mutation.abs() > 2 * ROUNDING_TOLERANCE)).all()


def test_wrong_arguments_are_rejected():
    rng = np.random.default_rng(0)
    with pytest.raises(ValueError, match="child is 2; it must be between 0 and 1"):
        mate(POOL[0], POOL[1], rng=rng, child=2)
    with pytest.raises(ValueError, match="fitness must have a value for each of the 2 parents; it has 1"):
        mate(POOL[0], POOL[1], rng=rng, fitness=[1.0])


def test_tracing_does_not_change_what_an_operator_draws():
    settings = SETTINGS.with_(crossover="one_point", seed=4)
    again = cross_in_turn(
        resolve_operators(settings.algorithm).cross, POOL, FITNESS, 8, genes=GENES, seed=4, generation=1
    )
    direct = run_cross(wl.ga.crossover.one_point, POOL, FITNESS, 8, rng=random_stream(4, "crossover", 1, 0))
    assert np.array_equal(again.genomes, direct.genomes)
    assert np.array_equal(births(settings, 1)[0].inherited, direct.genomes[0])
