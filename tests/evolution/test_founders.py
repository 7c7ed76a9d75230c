"""Generation 0 from given genomes: their places, their origin in the table, and frozen genes."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults.standins import evaluate
from walkerlab.evolution import evolution as evolving
from walkerlab.genome.features import build_genes
from walkerlab.genome.frozen import BODY, frozen_features
from walkerlab.settings.choices import Feature

SETTINGS = wl.Settings().with_(duration=1, population_size=6, generations=3, n_elites=2, seed=1, mutation_rate=0.3)
ROBOT = SETTINGS.robot
GENOMES = [wl.Genome(values) for values in wl.generate_robot_population(ROBOT, 3, seed=99)]
same = partial(pd.testing.assert_frame_equal, check_exact=True)


@pytest.fixture(autouse=True)
def fast_walks(monkeypatch):
    monkeypatch.setattr(evolving, "evaluate", evaluate)


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(1) as pool:
        yield pool


def evolve(settings=SETTINGS, path=None, **options):
    return wl.evolve(settings, path, progress=False, **options)


def first(run):
    return run.records[run.records.generation == 0]


@pytest.mark.parametrize("given", [
    GENOMES, [str(genome) for genome in GENOMES], [genome.values for genome in GENOMES],
    np.array([genome.values for genome in GENOMES]), tuple(GENOMES),
], ids=["genomes", "texts", "arrays", "table", "tuple"])  # fmt: skip
def test_given_genomes_are_the_first_individuals_and_the_others_are_random(given):
    run = evolve(population=given)
    start = first(run)
    assert start.genome.tolist()[:3] == [str(genome) for genome in GENOMES]
    assert start.genome.tolist()[3:] == first(evolve()).genome.tolist()[3:]
    assert start.operators.tolist() == ["given"] * 3 + ["random"] * 3
    assert start.parents.tolist() == [""] * 6
    elites = run.records[(run.records.generation > 0) & (run.records.born == 0)]
    assert set(elites.operators[elites.individual < 3]) <= {"given"}
    assert set(elites.operators[elites.individual >= 3]) <= {"random"}


def test_a_run_or_its_table_gives_its_last_generation_best_first(tmp_path):
    before = evolve(path=tmp_path / "flat.walk")
    last = before.records[before.records.generation == 2].sort_values("fitness", ascending=False, kind="stable")
    small = SETTINGS.with_(population_size=4)
    for given, of in ((before, " of flat.walk"), (before.records, "")):
        start = first(evolve(small, population=given))
        assert start.genome.tolist() == last.genome.tolist()[:4]
        assert start.operators.tolist() == [f"given: robot {number}{of}" for number in last.individual[:4]]
    champion = first(evolve(population=[before.champion]))
    assert champion.operators[0] == f"given: robot {before.champion.individual}"


def test_given_genomes_are_brought_within_the_limits():
    small = SETTINGS.with_(weight=(3, 5))
    start = first(evolve(small, population=GENOMES))
    assert start.genome.tolist()[:3] == [str(genome.within(small.robot)) for genome in GENOMES]


def test_a_resumed_run_has_the_same_table_even_before_generation_0(tmp_path):
    path = tmp_path / "a.walk"
    whole = evolve(population=GENOMES)
    wl.Evolution(SETTINGS, path, population=GENOMES)  # as if its process were killed
    assert wl.load(path).n_generations == 0
    assert [founder.genome for founder in wl.load(path).founders] == [str(genome) for genome in GENOMES]
    wl.resume(path, progress=False, stop=wl.Stop(target=-1e9))
    same(wl.resume(path, progress=False).records, whole.records)


@pytest.mark.parametrize(("given", "error", "message"), [
    ([], ValueError, "population is empty"), (GENOMES * 3, ValueError, "population has 9 genomes; Algorithm.popul"),
    (["wl2"], wl.GenomeError, None), ([[1, 2]], ValueError, "a genome is a row of"),
    (GENOMES[0], ValueError, "put it in a list"), (7, TypeError, "several genomes are expected"),
    (pd.DataFrame({"a": [1]}), ValueError, "without the column fitness"),
])  # fmt: skip
def test_a_wrong_population_is_explained_before_a_file_is_made(given, error, message, tmp_path):
    with pytest.raises(error, match=message):
        evolve(path=tmp_path / "a.walk", population=given)
    assert not list(tmp_path.iterdir())


def frozen_values(run, frozen):
    """Return the values of the frozen genes of each robot in a run, shape (n, n_frozen)."""
    genes = build_genes(run.settings.robot)
    columns = [i for i, name in enumerate(genes.names) if name.rpartition(".")[2] in frozen]
    return np.array([wl.Genome.parse(text).values for text in run.records.genome])[:, columns]


def draw_anew(genomes, genes, *, rng):
    return rng.uniform(genes.low, genes.high, genomes.shape)


@pytest.mark.parametrize("frozen", [["length", "mass"], ["segments"], ["legs", "frequency"], ["body"], ["gait"]])
@pytest.mark.parametrize("operators", [
    {"crossover": "paired", "mutation": "macro"}, {"crossover": "randomized", "mutation": ["favored", "micro"]},
    {"crossover": "weighted", "mutation": "randomized"}, {"crossover": "one_point", "mutation": "gaussian"},
    {"crossover": "uniform", "mutation": draw_anew},
], ids=["paired", "randomized", "weighted", "one_point", "user"])  # fmt: skip
def test_frozen_genes_never_change_and_every_robot_obeys_its_limits(frozen, operators):
    settings = SETTINGS.with_(frozen=frozen, mutation_rate=0.8, **operators)
    run = evolve(settings, population=[GENOMES[0]])
    names = {feature.name for feature in frozen_features(settings.algorithm.frozen)}
    values = frozen_values(run, names)
    assert values.size
    assert (values == values[0]).all()
    genomes = [wl.Genome.parse(text) for text in run.records.genome]
    assert all(genome.within(ROBOT) == genome for genome in genomes)
    assert run.records.genome.nunique() > 6


def test_genes_that_are_not_frozen_evolve():
    run = evolve(SETTINGS.with_(frozen="body", mutation_rate=0.5), population=GENOMES)
    gait = {feature.name for feature in set(Feature) - BODY}
    assert len(np.unique(frozen_values(run, gait), axis=0)) > 6


def test_an_inserted_genome_gets_the_frozen_genes():
    evolution = wl.Evolution(SETTINGS.with_(frozen="body"), population=GENOMES[:1])
    for generation in evolution:
        if generation.number == 0:
            evolution.insert(GENOMES[1])
    values = frozen_values(evolution.run, {feature.name for feature in BODY})
    assert (values == values[0]).all()
    assert "by hand" in set(evolution.run.records.operators)


def test_frozen_genes_require_a_population(tmp_path):
    with pytest.raises(wl.SettingsError, match=r"Algorithm.frozen is .*'mass'.* population=\[genome\]"):
        evolve(SETTINGS.with_(frozen=["mass"]), tmp_path / "a.walk")
    assert not list(tmp_path.iterdir())


def test_a_run_with_frozen_genes_resumes_to_the_same_table(tmp_path):
    settings = SETTINGS.with_(frozen=["body", "frequency"])
    path = tmp_path / "a.walk"
    whole = evolve(settings, population=GENOMES)
    evolve(settings.with_(generations=1), path, population=GENOMES)
    same(wl.resume(path, 3, progress=False).records, whole.records)
    assert wl.load(path).settings == settings


def test_every_feature_can_be_frozen_by_its_name():
    assert {choice.name for choice in wl.Frozen} == {"none", "body", "gait"} | {feature.name for feature in Feature}
    for feature in Feature:
        assert frozen_features(wl.Algorithm(frozen=[feature.name]).frozen) == {feature}
    assert frozen_features(wl.Algorithm(frozen=["body", "gait"]).frozen) == set(Feature)
    assert frozen_features(wl.Algorithm().frozen) == set()


def test_real_robots_of_a_given_population_walk_in_generation_0(threads, monkeypatch):
    monkeypatch.undo()
    settings = SETTINGS.with_(population_size=4, generations=1)
    run = evolve(settings, executor=threads, population=GENOMES)
    walked = wl.evaluate(GENOMES, settings, threads)
    assert first(run).fitness.tolist()[:3] == [one.fitness for one in walked]
