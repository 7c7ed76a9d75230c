"""A problem: coordinates and genomes correspond, evaluation equals that of evolution, and results are a run."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

import walkerlab as wl
from walkerlab.simulation.descriptors import DESCRIPTORS
from walkerlab.system.randomness import random_stream

QUICK = wl.Settings().with_(duration=1.0, population_size=4, generations=2)
EXECUTOR = ThreadPoolExecutor(1)
WALKER = wl.Genome.random(wl.Robot(), rng=random_stream(4, "check"))


def problem_of(settings=QUICK, **options):
    return wl.Problem(settings, executor=EXECUTOR, **options)


def random_genomes(n, robot=QUICK.robot, seed=0):
    rng = random_stream(seed, "check")
    return [wl.Genome.random(robot, rng=rng) for _ in range(n)]


@hypothesis_settings(max_examples=30)
@given(st.integers(0, 2**20))
def test_decoding_a_code_gives_the_same_genome(seed):
    problem = problem_of()
    genomes = random_genomes(5, seed=seed)
    assert np.array_equal(problem.decode(problem.encode(genomes)), [genome.values for genome in genomes])


def test_every_point_is_a_robot_within_the_limits_even_beyond_the_box():
    problem = problem_of(QUICK.with_(segments=(2, 3), weight=(4, 6)))
    points = np.random.default_rng(0).normal(0.5, 2, (50, problem.n_genes))
    genomes = problem.decode(points)
    assert np.array_equal(genomes, [wl.Genome(values).within(problem.settings.robot).values for values in genomes])
    assert (problem.encode(genomes) >= 0).all()
    assert (problem.encode(genomes) <= 1).all()


def test_whole_numbers_have_intervals_of_the_same_width_and_angles_are_cyclic():
    problem = problem_of(QUICK.with_(segments=(1, 4)))
    names = list(problem.genes.gene)
    points = np.full((400, problem.n_genes), 0.5)
    points[:, names.index("segments")] = np.linspace(0, 1, 400)
    counts = np.bincount(problem.decode(points)[:, 0].astype(int))[int(problem.low[0]) :]
    assert len(counts) > 1
    assert np.ptp(counts) <= 1
    lag = names.index("lag")
    turned = points + np.eye(problem.n_genes)[lag]
    assert np.allclose(problem.decode(points)[:, lag], problem.decode(turned)[:, lag], atol=2e-3)


def test_the_genes_are_named_with_unit_and_range():
    problem = problem_of()
    assert list(problem.genes.columns) == ["gene", "unit", "low", "high", "kind", "meaning"]
    assert len(problem.genes) == problem.n_genes == len(problem.low) == len(problem.high)
    middle = problem.decode([problem.encode([WALKER])[0]])[0]
    assert np.array_equal(middle, WALKER.within(QUICK.robot).values)


def test_with_a_frozen_body_only_genes_of_the_gait_that_have_an_effect_are_free():
    settings = QUICK.with_(frozen="body")
    problem = problem_of(settings, genome=WALKER)
    genomes = problem.decode(np.random.default_rng(0).random((20, problem.n_genes)))
    bodies = {(len(robot.segments), robot.plan, robot.weight, robot.body_length) for robot in map(wl.express, genomes)}
    assert len(bodies) == 1
    assert problem.n_genes < problem_of().n_genes / 2
    before = wl.compile_scene(WALKER, QUICK).controls(200)
    for column in range(problem.n_genes):
        point = problem.encode([WALKER])
        point[0, column] = (point[0, column] + 0.3) % 1
        after = wl.compile_scene(problem.decode(point)[0], QUICK).controls(200)
        assert not np.array_equal(before, after), problem.genes.gene[column]
    with pytest.raises(wl.SettingsError, match="frozen"):
        problem_of(settings)


def test_evaluation_equals_that_of_evolution_and_describes_each_walk():
    problem = problem_of(descriptors=("n_legs", "height", "work"))
    genomes = random_genomes(4)
    batch = problem.evaluate(problem.encode(genomes))
    expected = wl.evaluate(genomes, QUICK, EXECUTOR)
    assert [one.fitness for one in batch.evaluations] == [one.fitness for one in expected]
    assert np.array_equal(batch.fitness, problem(problem.encode(genomes)))
    assert batch.counts.any()
    assert batch.descriptors.shape == (4, 3)
    for one, described in zip(expected, batch.descriptors, strict=True):
        walk = wl.simulate(one.genome, QUICK)
        numbers = [DESCRIPTORS[name].function(walk) for name in problem.descriptor_names]
        assert described.tolist() == (numbers if one.verdict == "ok" else [pytest.approx(np.nan, nan_ok=True)] * 3)


def test_walks_that_do_not_count_have_the_chosen_fitness_and_are_recorded_as_minus_infinity():
    settings = QUICK.with_(fitness=lambda rollout: -np.inf if rollout.phenotype.n_legs > 4 else 1.0)
    problem = problem_of(settings, uncounted=-10, descriptors={"legs": lambda rollout: rollout.phenotype.n_legs})
    batch = problem.evaluate(problem.encode(random_genomes(8)))
    assert {*batch.fitness.tolist()} == {1.0, -10.0}
    assert np.array_equal(np.isnan(batch.descriptors[:, 0]), ~batch.counts)
    assert {*problem.records.fitness} == {1.0, -np.inf}
    assert np.array_equal(problem.records.legs, batch.descriptors[:, 0], equal_nan=True)
    assert problem_of(settings).evaluate(problem.encode(random_genomes(8))).fitness.min() == -np.inf


def test_a_genome_is_simulated_once_and_recorded_each_time():
    walks = []
    settings = QUICK.with_(fitness=lambda rollout: walks.append(1) or rollout.distance)
    problem = problem_of(settings)
    walks.clear()  # those on which the function was tried
    points = problem.encode(random_genomes(1))
    first, again = problem(points[0]), problem(points)
    assert again.tolist() == [first]
    assert len(walks) <= 1
    assert len(problem.records) == problem.n_evaluations == 2


@pytest.mark.parametrize("frozen", ["none", "body"])
def test_results_of_any_optimiser_are_a_run_file(frozen, tmp_path):
    problem = problem_of(QUICK.with_(frozen=frozen), genome=WALKER)
    rng = np.random.default_rng(1)
    for n in (5, 5, 3):
        problem.evaluate(rng.random((n, problem.n_genes)))
    saved = problem.save(tmp_path / "search.walk", "random points")
    run = wl.load(tmp_path / "search.walk")
    assert run.records.equals(saved.records)
    assert run.records.groupby("generation").size().tolist() == [5, 5, 5]
    assert run.champion.fitness == max(problem.records.fitness)
    assert {*run.records.operators} == {"random points"}
    elites = run.records[run.records.born < run.records.generation]
    best = sorted(problem.records.fitness[:10], reverse=True)[:2]
    assert elites.fitness.tolist() == best
    wl.plots.fitness_curve(run.records)
    continued = wl.resume(tmp_path / "search.walk", 4, EXECUTOR, progress=False)
    assert continued.n_generations == 4


def test_mistakes_are_explained():
    problem = problem_of()
    with pytest.raises(ValueError, match=rf"shape \(n, {problem.n_genes}\)"):
        problem.evaluate(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="coordinate 1 is nan"):
        problem.decode(np.where(np.arange(problem.n_genes) == 1, np.nan, 0.5)[np.newaxis])
    with pytest.raises(ValueError, match="Did you mean 'height'"):
        problem_of(descriptors=["hight"])
    with pytest.raises(TypeError, match="must be a function"):
        problem_of(descriptors={"legs": 3})
    with pytest.raises(ValueError, match="finite number or -inf"):
        problem_of(uncounted=np.inf)
    with pytest.raises(ValueError, match="at least 4"):
        problem.save()
    with pytest.raises(wl.SettingsError, match="genome=robot"):
        problem_of(QUICK.with_(frozen="body"))
    with pytest.raises(TypeError, match="must be names"):
        problem_of(descriptors=len)
    with pytest.raises(wl.OperatorError, match="must return one number"):
        problem_of(descriptors={"com": lambda rollout: rollout.com}).evaluate(problem.encode(random_genomes(4)))
