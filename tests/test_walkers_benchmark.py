"""The benchmark of champions: its searches are resumable and fair, and its measures mean what they say."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import walkerlab as wl
from benchmarks import searches, walker_jobs, walkers
from benchmarks.champions import measure_champion
from benchmarks.walker_tables import compare_folders, describe_folder, read_folder
from walkerlab.evolution.fragility import N_TEST_STARTS
from walkerlab.genome.features import build_genes
from walkerlab.simulation.rollout import walk_from_every_start

SMALL = wl.Settings().with_(population_size=4, duration=1, segments=(1, 2), forgive="fragile")
"""Settings of a short search, without the tests from other starts, which would require most of its walks."""


class Interrupted(Exception):
    """Raised by a test in place of an interruption."""


@pytest.fixture
def one_thread():
    with ThreadPoolExecutor(1) as executor:
        yield executor


@pytest.fixture
def small_batches(monkeypatch):
    monkeypatch.setattr(searches, "BATCH_SIZE", 2)
    monkeypatch.setattr(searches, "CMA_POPULATION_SIZE", 4)


@pytest.mark.parametrize("method", ["random", "cma"])
def test_a_search_resumed_after_an_interruption_finds_the_same_champions(
    method, one_thread, small_batches, tmp_path, monkeypatch
):
    whole = searches.METHODS[method](SMALL, 1, [4, 12], tmp_path / "whole", one_thread)
    evaluate = wl.evaluate
    calls = []

    def interrupted_evaluate(*arguments):
        calls.append(arguments)
        if len(calls) == 3:
            raise Interrupted
        return evaluate(*arguments)

    monkeypatch.setattr(wl, "evaluate", interrupted_evaluate, raising=False)
    with pytest.raises(Interrupted):
        searches.METHODS[method](SMALL, 1, [4, 12], tmp_path / "parts", one_thread)
    log = tmp_path / "parts.fitness"
    log.write_text(log.read_text() + "[0.1, 0.")  # a line that was being written
    assert searches.METHODS[method](SMALL, 1, [4, 12], tmp_path / "parts", one_thread) == whole
    assert log.read_text() == (tmp_path / "whole.fitness").read_text()


def test_the_champion_within_fewer_evaluations_is_that_of_a_shorter_run(one_thread, tmp_path):
    settings = SMALL.with_(n_elites=1)
    long = searches.search_by_evolution(settings, 2, [7, 10], tmp_path / "long", one_thread)
    short = searches.search_by_evolution(settings, 2, [7], tmp_path / "short", one_thread)
    assert long[7] == short[7]
    continued = searches.search_by_evolution(settings, 2, [7, 10], tmp_path / "short", one_thread)
    assert continued == long


@pytest.mark.parametrize("n_starts", [1, 2])
def test_an_evaluation_is_one_walk(n_starts, one_thread, small_batches, tmp_path, monkeypatch):
    settings = SMALL.with_(n_starts=n_starts)
    for name, search in searches.METHODS.items():
        champion = search(settings, 0, [8], tmp_path / name, one_thread)[8]
        assert 8 - 2 * n_starts <= champion.n_evaluations <= 8


def test_cma_changes_only_the_expressed_gait_of_one_body(small_batches):
    robot = SMALL.robot
    genes = build_genes(robot)
    proposals = searches.propose_by_cma(SMALL, 0, 4)
    best = next(proposals)[0]
    batch = proposals.send(np.array([1.0, 0.0]))
    gait = searches.find_gait_genes(best, robot)
    others = np.setdiff1d(np.arange(len(genes)), gait)
    np.testing.assert_array_equal(batch[:, others], np.tile(best[others], (len(batch), 1)))
    assert (np.ptp(batch[:, gait], axis=0) > 0).all()
    is_bounded = ~genes.is_cyclic[gait]
    assert (batch[:, gait] >= genes.low[gait])[:, is_bounded].all()
    assert (batch[:, gait] <= genes.high[gait])[:, is_bounded].all()


def test_gait_genes_are_those_of_the_grown_legs():
    robot = wl.Robot(segments=(2, 2))
    genes = build_genes(robot)
    genome = wl.generate_robot_population(robot, 1, seed=0)[0]
    genome[genes.find("legs")] = [1, 0]
    names = {genes.names[i] for i in searches.find_gait_genes(genome, robot)}
    assert {"frequency", "seg1.hip_amplitude", "seg1.stride"} <= names
    assert not names & {"segments", "seg1.length", "seg1.mass", "seg1.legs", "seg1.leg_length", "seg1.leg_force"}
    assert not any(name.startswith("seg2") for name in names)


def test_the_measures_of_a_champion_are_those_of_its_walk():
    settings = SMALL.with_(structure="stairs", n_starts=2)
    genome = wl.Genome(wl.generate_robot_population(settings.robot, 1, seed=4)[0])
    measures = measure_champion(genome, settings)
    [evaluation] = wl.evaluate([genome], settings)
    assert measures["distance"] == evaluation.distance
    assert measures["body lengths/s"] == evaluation.velocity / evaluation.body_length
    assert measures["fitness"] == (evaluation.fitness if evaluation.verdict == "ok" else None)
    assert measures["stairs climbed"] == 0
    assert 0 <= measures["contact by feet"] <= 1


def test_a_stopped_job_is_resumed_and_its_results_are_reported(small_batches, tmp_path):
    changes = walkers.parse_changes(["population_size=4", "simulation.duration=1", "segments=1,2"])

    def job(folder, method, end=float("inf")):
        return walker_jobs.Job(tmp_path / folder, "flat", method, 0, (4, 6), changes, end)

    assert walker_jobs.run_job(job("one", "random", end=0.0)) == ""
    for method in searches.METHODS:
        assert not job("one", method).is_done
        assert "body lengths/s" in walker_jobs.run_job(job("one", method))
        assert job("one", method).is_done
    walker_jobs.run_job(job("other", "evolution"))
    table = read_folder(tmp_path / "one")
    assert sorted(zip(table.method, table.budget, strict=True)) == [
        (method, budget) for method in sorted(searches.METHODS) for budget in (4, 6)
    ]
    text = describe_folder(tmp_path / "one")
    assert text.count("| evolution |") == 2
    assert "evolution is better than random for" in text
    assert "0 of 1" in compare_folders([tmp_path / "one", tmp_path / "other"])  # equal runs


@pytest.mark.parametrize(
    ("word", "message"),
    [("selection", "has no value"), ("selction=rank", "Did you mean 'selection'"), ("terrain.foo=1", "no setting")],
)
def test_wrong_changes_are_explained(word, message):
    with pytest.raises(ValueError, match=message):
        walkers.parse_changes([word])


def test_operators_can_be_given_with_arguments():
    changes = walkers.parse_changes(["selection=tournament(size=7)", "mutation=micro,gaussian(rate=0.1,scale=0.3)"])
    algorithm = walker_jobs.create_settings("stairs", changes).algorithm
    assert algorithm.selection.keywords == {"size": 7}
    assert algorithm.mutation[1].keywords == {"rate": 0.1, "scale": 0.3}
    with pytest.raises(ValueError, match="no operator 'turnament'"):
        walker_jobs.create_settings("flat", walkers.parse_changes(["selection=turnament(size=7)"]))


def test_an_evolution_with_an_operator_with_arguments_is_resumed(one_thread, tmp_path):
    changes = walkers.parse_changes(["selection=tournament(size=2)", "population_size=4", "duration=1"])
    settings = walker_jobs.create_settings("flat", changes)
    searches.search_by_evolution(settings, 0, [4], tmp_path / "parts", one_thread)
    continued = searches.search_by_evolution(settings, 0, [8], tmp_path / "parts", one_thread)
    assert continued == searches.search_by_evolution(settings, 0, [8], tmp_path / "whole", one_thread)


def test_a_folder_holds_the_results_of_one_set_of_changes(tmp_path):
    walkers.prepare_folder(tmp_path, {"algorithm.selection": "rank"})
    walkers.prepare_folder(tmp_path, {"algorithm.selection": "rank"})
    with pytest.raises(ValueError, match="choose another --folder"):
        walkers.prepare_folder(tmp_path, {})


def test_the_walks_of_the_tests_from_other_starts_are_counted(one_thread, monkeypatch):
    settings = wl.Settings().with_(population_size=6, generations=3, duration=1, n_elites=1)
    n_walks: list[int] = []

    def count(*given, **named):
        rollouts = walk_from_every_start(*given, **named)
        n_walks.append(len(rollouts))
        return rollouts

    monkeypatch.setattr("walkerlab.simulation.evaluation.walk_from_every_start", count)
    run = wl.evolve(settings, executor=one_thread, progress=False)
    n_stopped = sum("did not count" in reason for reason in run.records.reason)  # at the first of the other starts
    n_copies = run.records.individual.nunique() - run.records.genome.nunique()
    total = searches.count_walks(run.records, settings)[-1]
    n_untested = N_TEST_STARTS * settings.algorithm.generations  # elites that are no better than the median
    assert total - n_stopped * (N_TEST_STARTS - 1) - n_copies - n_untested <= sum(n_walks) <= total
