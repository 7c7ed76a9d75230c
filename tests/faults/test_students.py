"""Faults of user functions, before or during a run, are reported, and the run can be resumed."""

import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from itertools import islice

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from tests.faults import number
from walkerlab.evolution.live import LiveRun, State
from walkerlab.genome.phenotype import express
from walkerlab.simulation import evaluation, fitness

SETTINGS = wl.Settings().with_(duration=1, population_size=12, generations=5, n_elites=2, seed=3)
SLOTS = ("selection", "crossover", "mutation", "fitness")
NAMES = {"fitness": "the fitness function 'mine'"} | {slot: f"{slot} 'mine'" for slot in SLOTS[:3]}


def select(fitness, n_parents, *, rng):
    return rng.integers(len(fitness), size=n_parents)


def cross(parents, fitness, n_children, *, rng):
    mothers = rng.integers(len(parents), size=n_children)
    return parents[mothers], mothers[:, None]


def mutate(genomes, genes, *, rng):
    """Change about half of the genomes, so that the others need not be simulated again."""
    changed = genomes.copy()
    changed[:, 1] += np.where(rng.random(len(genomes)) < 0.5, 0.0, 0.001)
    return changed


CORRECT_FUNCTIONS = dict(zip(SLOTS, (select, cross, mutate, lambda rollout: rollout.distance), strict=True))


def raises(answer, given):
    raise IndexError("none left")


def misshapes(answer, given):
    match answer:
        case float():
            return np.array([answer, answer])
        case children, parents:
            return children[:-1], parents
        case _:
            return answer[:-1]


def knows_nothing(answer, given):
    return (answer[0] * np.nan, answer[1]) if isinstance(answer, tuple) else answer * np.nan


def writes(answer, given):
    getattr(given[0], "com", given[0])[...] = 0
    return answer


def gambles(answer, given):
    drawn = np.random.random()  # noqa: NPY002
    match answer:
        case (genomes, parents):
            return genomes + drawn, parents
        case np.ndarray() if answer.ndim == 1:  # chosen parents
            return np.random.default_rng(int(1e9 * drawn)).permutation(answer)
        case _:
            return answer + drawn


def hangs(answer, given):
    while given:
        pass


MESSAGES = {
    raises: r" raised IndexError: none left \(line \d+\)",
    misshapes: r" must .*; it returned an array",
    knows_nothing: r" must .*; (one of the values it returned is nan|it returned (nan|an array of shape .*, float64))",
    writes: r" must not modify its arguments, which are read-only; it tried to \(line \d+\)",
    gambles: " used np.random, shared with all other Python code",
    hangs: r" had not returned after 0\.\d s \(line \d+\)",
}


def create_function(slot, fault=None, is_due=lambda walk: True):
    """Return a function for a slot that is correct, apart from a fault when it is due."""

    def mine(*given, **named):
        answer = CORRECT_FUNCTIONS[slot](*given, **named)
        return fault(answer, given) if fault and is_due(given[0]) else answer

    return mine


def walks(genomes, settings, starts, asked=""):
    """Replacement for the walks of a task: different for each genome, and repeatable."""
    even = fitness._create_made_up_walk()
    return [
        [replace(even, com=even.com * (1 + values.sum() % 7), phenotype=express(genome))]
        for genome, values in ((genome, genome.values) for genome in genomes)
    ]


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Change to a temporary folder, where a run without a path may be saved."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def pool(monkeypatch):
    monkeypatch.setattr(evaluation, "_simulate_task", walks)
    with ThreadPoolExecutor(1) as pool:
        yield pool


@cache
def whole(slot):
    """Return the table of a run without faults."""
    with ThreadPoolExecutor(1) as pool:
        return wl.evolve(SETTINGS.with_(**{slot: create_function(slot)}), executor=pool, progress=False).records


def same(left, right):
    pd.testing.assert_frame_equal(left.reset_index(drop=True), right.reset_index(drop=True), check_exact=True)


def no_function_runs():
    threads = [thread for thread in threading.enumerate() if thread.name == "walkerlab user function"]
    for thread in threads:
        thread.join(0.5)
    return not any(thread.is_alive() for thread in threads)


@pytest.mark.parametrize("slot", SLOTS)
@pytest.mark.parametrize("fault", MESSAGES, ids=lambda fault: fault.__name__)
def test_a_fault_is_reported_before_any_simulation(fault, slot, tmp_path, monkeypatch):
    class NoPhysics(ThreadPoolExecutor):
        def submit(self, *args, **kwargs):
            raise AssertionError("physics ran")

    monkeypatch.setenv("WALKERLAB_PATIENCE", "0.2")
    settings = SETTINGS.with_(**{slot: create_function(slot, fault)})
    with pytest.raises(wl.OperatorError, match=rf"^{NAMES[slot]}{MESSAGES[fault]}.*, when tried on a .*\. \w"):
        wl.evolve(settings, tmp_path / "run.walk", executor=NoPhysics(), progress=False)
    assert not list(tmp_path.iterdir())
    assert no_function_runs()


@pytest.mark.parametrize("slot", SLOTS)
@pytest.mark.parametrize("fault", MESSAGES, ids=lambda fault: fault.__name__)
@pytest.mark.parametrize("late", number([3], [1, 2, 3, 4]))
def test_a_late_fault_is_reported_with_its_generation_and_the_run_can_be_resumed(
    late, fault, slot, pool, tmp_path, monkeypatch
):
    path = tmp_path / "run.walk"
    done = []
    walked = []

    def is_due(walk):
        """Return whether the fault is due: in one generation, and for a fitness only in its third walk."""
        if len(done) != late:
            return False
        if slot == "fitness" and walk.distance not in walked:
            walked.append(walk.distance)
        return slot != "fitness" or walk.distance in walked[2:]

    evolution = wl.Evolution(SETTINGS.with_(**{slot: create_function(slot, fault, is_due)}), path, pool)
    done.extend(generation.number for generation in islice(evolution, late))
    if fault is hangs:
        monkeypatch.setenv("WALKERLAB_PATIENCE", "0.5")
    with pytest.raises(wl.OperatorError, match=rf"^{NAMES[slot]}{MESSAGES[fault]}") as caught:
        next(iter(evolution))
    monkeypatch.delenv("WALKERLAB_PATIENCE", raising=False)
    assert no_function_runs()

    truth = whole(slot)
    same(wl.load(path).records, truth[truth.generation < late])
    fixed_source = (
        nullcontext() if slot == "fitness" else pytest.warns(UserWarning, match=f"different code for its {slot}")
    )
    with fixed_source:
        same(wl.resume(path, executor=pool, progress=False, **{slot: create_function(slot)}).records, truth)
    if slot == "fitness":
        [individual] = truth.individual[(truth.born == late) & (truth.distance == walked[2])].drop_duplicates()
        assert f", for individual {individual} of generation {late}. " in str(caught.value)
    else:
        assert f", while making generation {late}. " in str(caught.value)


def test_the_individual_is_named_if_earlier_ones_are_not_simulated_again(pool, tmp_path):
    path = tmp_path / "run.walk"
    walked = []

    def later_half(genomes, genes, *, rng):
        changed = genomes.copy()
        changed[len(genomes) // 2 :, 1] += 0.001
        return changed

    settings = SETTINGS.with_(crossover="none", mutation=later_half, generations=2)
    faulty = create_function(
        "fitness",
        raises,
        lambda walk: path.exists() and wl.load(path).n_generations and not walked.append(walk.distance),
    )
    with pytest.raises(wl.OperatorError) as caught:
        wl.evolve(settings.with_(fitness=faulty), path, executor=pool, progress=False)
    truth = wl.evolve(settings, executor=pool, progress=False).records
    [individual] = truth.individual[(truth.generation == 1) & (truth.distance == walked[0])]
    assert f", for individual {individual} of generation 1. " in str(caught.value)


def test_ctrl_c_while_a_function_hangs_saves_complete_generations(pool, tmp_path):
    path = tmp_path / "run.walk"

    def presses_and_hangs(answer, given):
        signal.raise_signal(signal.SIGINT)
        hangs(answer, given)

    faulty = create_function("fitness", presses_and_hangs, lambda walk: path.exists() and wl.load(path).n_generations)
    kept = wl.evolve(SETTINGS.with_(fitness=faulty), path, executor=pool, progress=False)
    assert kept.n_generations == 1
    assert no_function_runs()
    same(wl.resume(path, executor=pool, progress=False, fitness=create_function("fitness")).records, whole("fitness"))


def test_evaluate_reports_the_index_and_genome_of_a_robot(pool):
    genomes = [wl.Genome.random(SETTINGS.robot, rng=np.random.default_rng(i)) for i in range(5)]
    faulty = walks([genomes[3].within(SETTINGS.robot)], SETTINGS, [0])[0][0].distance
    settings = SETTINGS.with_(fitness=create_function("fitness", knows_nothing, lambda walk: walk.distance == faulty))
    with pytest.raises(wl.OperatorError, match=r"'mine' must .*; it returned nan, for the robot at index 3") as caught:
        wl.evaluate(genomes, settings, pool)
    assert caught.value.genome == genomes[3].within(SETTINGS.robot)


REAL = SETTINGS.with_(population_size=4, generations=3, n_elites=0)


def test_walks_from_other_processes_are_read_only(tmp_path):
    path = tmp_path / "run.walk"
    faulty = create_function("fitness", writes, lambda walk: evolution.n_generations == 2 if path.exists() else False)
    evolution = wl.Evolution(REAL.with_(fitness=faulty), path)
    with pytest.raises(wl.OperatorError, match=r"must not modify its arguments.* of generation 2"):
        list(evolution)
    resumed = wl.resume(path, progress=False, fitness=create_function("fitness")).records
    same(resumed, wl.evolve(REAL.with_(fitness=create_function("fitness")), progress=False).records)


def test_a_live_run_reports_a_fault_and_keeps_complete_generations(monkeypatch):
    over = threading.Event()
    lives = []

    def hear(run):
        if run.n_generations:
            monkeypatch.setenv("WALKERLAB_PATIENCE", "0.5")
        if run.is_over:
            over.set()

    faulty = create_function("fitness", hangs, lambda walk: any(live.n_generations for live in lives))
    with ThreadPoolExecutor(1) as pool:
        lives.append(LiveRun(REAL.with_(fitness=faulty), executor=pool, on_change=hear))
        lives[0].resume()
        assert over.wait(60)
    assert lives[0].state == State.failed
    assert "'mine' had not returned after 0.5 s" in str(lives[0].error)
    assert lives[0].n_generations == 1
    assert no_function_runs()
