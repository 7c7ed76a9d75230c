"""Ask and tell: the same table as wl.evolve, whatever rates the genomes."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.system.randomness import random_stream

QUICK = wl.Settings().with_(duration=1.0, population_size=6, generations=3, n_elites=2)
EXECUTOR = ThreadPoolExecutor(1)
WALKER = wl.Genome.random(wl.Robot(), rng=random_stream(4, "check"))


def ask_and_tell(settings, **options):
    algorithm = wl.GeneticAlgorithm(settings, executor=EXECUTOR, **options)
    while not algorithm.is_finished:
        algorithm.tell(wl.evaluate(algorithm.ask(), settings, EXECUTOR))
    return algorithm


@pytest.mark.parametrize(
    ("changes", "population"),
    [
        ({}, None),
        ({"seed": 5, "n_elites": 0, "selection": "gradient", "crossover": ["paired", "uniform"]}, None),
        ({"frozen": "body", "mutation_rate": 0.0, "crossover": "none"}, [WALKER]),  # many children equal their parents
    ],
    ids=["defaults", "other operators", "frozen"],
)
def test_the_table_equals_that_of_evolve(changes, population, tmp_path):
    settings = QUICK.with_(**changes)
    evolved = wl.evolve(settings, executor=EXECUTOR, progress=False, population=population)
    algorithm = ask_and_tell(settings, population=population)
    assert algorithm.run.records.equals(evolved.records)
    saved = algorithm.save(tmp_path / "run.walk")
    assert wl.load(tmp_path / "run.walk").records.equals(saved.records)
    assert wl.load(tmp_path / "run.walk").founders == evolved.founders


def test_anything_can_rate_the_genomes():
    algorithm = wl.GeneticAlgorithm(QUICK.with_(generations=8))
    while not algorithm.is_finished:
        genomes = algorithm.ask()
        assert np.array_equal(genomes, algorithm.ask())
        algorithm.tell(-genomes[:, 1])  # a low frequency
    best = algorithm.run.records.groupby("generation").fitness.max()
    assert best.is_monotonic_increasing
    assert best.iloc[-1] > best.iloc[0]


def test_ratings_without_a_walk_can_be_stored(tmp_path):
    algorithm = wl.GeneticAlgorithm(QUICK)
    algorithm.ask()
    algorithm.tell([1.0, 2.0, -np.inf, 0.0, 3.0, 1.5])
    algorithm.save(tmp_path / "run.walk")
    run = wl.load(tmp_path / "run.walk")
    assert run.champion.fitness == 3.0
    assert run.records.verdict.tolist().count("rejected") == 1
    assert run.records.distance.isna().all()


def test_mistakes_are_explained(tmp_path):
    algorithm = wl.GeneticAlgorithm(QUICK)
    with pytest.raises(RuntimeError, match="call ask"):
        algorithm.tell([1.0])
    with pytest.raises(ValueError, match="no generation"):
        algorithm.save(tmp_path / "run.walk")
    algorithm.ask()
    with pytest.raises(ValueError, match=r"shape \(5,\) for 6 genomes"):
        algorithm.tell([1.0] * 5)
    with pytest.raises(TypeError, match="must be an Evaluation or a number; got 'a'"):
        algorithm.tell(["a"] * 6)
    with pytest.raises(ValueError, match="fitness nan"):
        algorithm.tell([np.nan] * 6)
