"""Evaluation gives the same results in the order of the genomes on any executor."""

import os
import pickle
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.genome.breeding import generate_robot_population
from walkerlab.genome.phenotype import express
from walkerlab.simulation import evaluation
from walkerlab.simulation.rollout import simulate_walk, walk_from_every_start
from walkerlab.simulation.starts import draw_nudge
from walkerlab.world.scene import compile_scene, reusable_scene_of

SETTINGS = wl.Settings().with_(duration=1.0)
GENOMES = generate_robot_population(SETTINGS.robot, 9, seed=3)


class Backwards(Executor):
    """Computes nothing until a result is waited for, and then the last task first."""

    def __init__(self):
        self.tasks = []

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        self.tasks.append((future, function, args, kwargs))
        future.result = lambda timeout=None: self._finish(future)
        return future

    def _finish(self, wanted):
        while self.tasks:
            future, function, args, kwargs = self.tasks.pop()
            future.set_result(function(*args, **kwargs))
        return Future.result(wanted)


def table(evaluations):
    return [(str(e.genome), e.fitness, e.verdict, e.distance, e.velocity, e.weight) for e in evaluations]


EXPECTED = table(wl.evaluate(GENOMES, SETTINGS, executor=Backwards()))


@pytest.mark.parametrize("executor", [
    lambda: ThreadPoolExecutor(1), lambda: ThreadPoolExecutor(4), Backwards,
    lambda: ProcessPoolExecutor(2, mp_context=get_context("forkserver")),
], ids=["1 thread", "4 threads", "backwards", "2 processes"])  # fmt: skip
def test_any_executor_gives_the_same_results(executor):
    with executor() as pool:
        assert table(wl.evaluate(GENOMES, SETTINGS, executor=pool)) == EXPECTED


def test_loky_gives_the_same_results_with_a_fitness_that_cannot_be_sent_to_workers():
    n_calls = 0

    def in_a_cell(rollout):
        nonlocal n_calls
        n_calls += 1
        return float(rollout.contact_forces[:, :, 2].max() + rollout.joint_velocities.std())

    own = SETTINGS.with_(fitness=in_a_cell, record=["contact_forces", "joint_velocities"])
    plain = wl.evaluate(GENOMES, SETTINGS)
    with_function = wl.evaluate(GENOMES, own)
    assert table(plain) == EXPECTED
    assert [e.distance for e in with_function] == [e.distance for e in plain]
    assert n_calls == sum(e.verdict == "ok" for e in plain) > 0
    with ThreadPoolExecutor(1) as pool:
        assert table(with_function) == table(wl.evaluate(GENOMES, own, pool))


def test_genomes_texts_and_arrays_give_the_same_results():
    genomes = [wl.Genome(values) for values in GENOMES[:3]]
    with ThreadPoolExecutor(1) as pool:
        tables = [
            table(wl.evaluate(given, SETTINGS, pool)) for given in (genomes, list(map(str, genomes)), GENOMES[:3])
        ]
    assert tables[0] == tables[1] == tables[2] == EXPECTED[:3]


def test_a_genome_its_text_and_its_array_give_the_same_scene_and_walk():
    genome = wl.Genome(GENOMES[0])
    for given in (genome, str(genome), GENOMES[0], GENOMES[0].tolist()):
        assert wl.compile_scene(given, SETTINGS).genome == genome
        assert wl.fitness.distance(wl.simulate(given, SETTINGS, poses=False)) == EXPECTED[0][3]


def test_a_single_genome_is_rejected():
    genome = wl.Genome(GENOMES[0])
    for single in (genome, str(genome), GENOMES[0]):
        with pytest.raises(ValueError, match="put it in a list"):
            wl.evaluate(single, SETTINGS, Backwards())


def test_a_genome_of_another_robot_is_repaired():
    other_limits = wl.Robot(weight=(50, 60), body_length=(2, 3), segment_length=(0.5, 1), segments=(3, 6))
    genome = wl.Genome.random(other_limits, rng=np.random.default_rng(0))
    (found,) = wl.evaluate([genome], SETTINGS, Backwards())
    assert found.weight <= 12 * (1 + 1e-9)
    assert found.body_length <= 1.2 * (1 + 1e-9)
    assert found.genome != genome


def test_progress_reports_add_up_to_the_number_of_genomes():
    reports = []
    wl.evaluate(GENOMES, SETTINGS, Backwards(), on_done=reports.append)
    assert sum(reports) == len(GENOMES)
    assert len(reports) > 1


@pytest.mark.parametrize("n_workers", [1, 2, 8, 100])
@pytest.mark.parametrize("n", [1, 9, 60, 1000])
def test_tasks_contain_each_robot_once_with_the_slowest_first_and_single_ones_last(n, n_workers):
    robots = [wl.Genome(values) for values in generate_robot_population(SETTINGS.robot, n, seed=1)]
    tasks = evaluation._divide_into_tasks(robots, n_workers)
    order = [i for task in tasks for i in task]
    assert sorted(order) == list(range(n))
    costs = [evaluation._estimate_cost(robots[i]) for i in order]
    assert costs == sorted(costs, reverse=True)
    sizes = [len(task) for task in tasks]
    assert sizes == sorted(sizes, reverse=True)
    assert max(sizes, default=1) <= max(1, min(evaluation.MAX_TASK_SIZE, n // (2 * n_workers)))
    assert sizes[-n_workers:] == [1] * min(n, n_workers, len(sizes))


def test_tasks_are_small_so_that_a_run_can_be_paused_quickly():
    robots = [wl.Genome(values) for values in generate_robot_population(SETTINGS.robot, 100, seed=1)]
    assert max(map(len, evaluation._divide_into_tasks(robots, 1))) == 16


class Recording(Executor):
    """Records the arguments of its tasks, and computes only the first."""

    def __init__(self):
        self.arguments = []

    def submit(self, function, /, *args):
        self.arguments.append(args)
        future = Future()
        if len(self.arguments) == 1:
            future.set_result(function(*args))
        return future


def test_equal_tasks_of_two_calls_differ_and_tasks_are_cancelled_after_an_error():
    """An executor such as Dask's computes equal tasks only once."""

    class Wrong(Exception):
        pass

    def wrong(rollout):
        raise Wrong

    executors = Recording(), Recording()
    for executor in executors:
        futures = []
        submit = executor.submit
        executor.submit = lambda *args, futures=futures, submit=submit: futures.append(submit(*args)) or futures[-1]
        with pytest.raises(wl.OperatorError, match="Wrong"):
            wl.evaluate(GENOMES, SETTINGS.with_(fitness=wrong), executor)
        assert all(future.cancelled() for future in futures[1:])
    first, second = (executor.arguments[0] for executor in executors)
    assert first[0] == second[0]
    assert first[2:] != second[2:]


def test_the_number_of_limbs_predicts_the_size_of_the_model():
    robots = [wl.Genome(values) for values in generate_robot_population(SETTINGS.robot, 200, seed=1)]
    sizes = [compile_scene(robot, SETTINGS).model.nv for robot in robots]
    assert np.corrcoef([evaluation._estimate_cost(robot) for robot in robots], sizes)[0, 1] > 0.99


def test_an_empty_population_gives_no_evaluations():
    assert wl.evaluate([], SETTINGS, Backwards()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_workers_end_when_their_parent_process_is_killed():
    """For example, when the kernel of a notebook is restarted during a run."""
    script = (
        "import walkerlab as wl; from walkerlab.simulation.workers import default_executor\n"
        "workers = default_executor(); list(workers.map(abs, range(4)))\n"
        "print(*workers._pool._processes, flush=True)\n"
        "for _ in wl.Evolution(wl.Settings()): pass"
    )
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as caller:
        assert caller.stdout
        workers = list(map(int, caller.stdout.readline().split()))
        caller.kill()
    assert workers
    deadline = time.monotonic() + 20
    while (remaining := [worker for worker in workers if is_alive(worker)]) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not remaining


def is_alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


class TestSeveralStarts:
    """The fitness of a robot with several starts is that of its poorest walk."""

    settings = SETTINGS.with_(n_starts=3, duration=2.0)

    def test_the_poorest_walk_counts_and_the_first_start_is_exact(self):
        for genome, found in zip(GENOMES[:4], wl.evaluate(GENOMES[:4], self.settings), strict=True):
            scene = wl.compile_scene(genome, self.settings)
            rollouts = [simulate_walk(scene, nudge=draw_nudge(scene, start), poses=False) for start in range(3)]
            scores = [wl.fitness.score(rollout, self.settings.algorithm.fitness) for rollout in rollouts]
            assert found.fitness == min(scores)
            assert found.verdict == rollouts[scores.index(min(scores))].verdict
            exact_start = wl.simulate(genome, self.settings, poses=False)
            assert wl.fitness.distance(rollouts[0]) == wl.fitness.distance(exact_start)
            assert len({wl.fitness.distance(rollout) for rollout in rollouts}) == 3

    def test_more_starts_never_increase_the_fitness(self):
        one, three = (wl.evaluate(GENOMES, self.settings.with_(n_starts=n)) for n in (1, 3))
        assert all(many.fitness <= single.fitness for many, single in zip(three, one, strict=True))
        assert any(many.fitness < single.fitness for many, single in zip(three, one, strict=True))


WORLDS = {
    "flat": {},
    "gravel, rocks, a pack and a sledge": {
        "texture": "gravel", "texture_density": 0.05, "obstacle": "rock", "carry_weight": 2, "drag_weight": 2,
    },
    "balls, two starts": {"obstacle": "ball", "obstacle_density": 0.3, "n_starts": 2},
}  # fmt: skip


@pytest.mark.parametrize("world", WORLDS)
def test_a_walk_in_a_reused_scene_equals_a_walk_in_a_new_scene(world):
    """Robots of one body plan share a compiled model; the result of each is the same bit for bit."""
    settings = SETTINGS.with_(**WORLDS[world])
    robots = [wl.Genome(values).within(settings.robot) for values in GENOMES]
    plans = {express(robot).plan for robot in robots}
    assert len(plans) < len(robots), "some robots must share a body plan"
    with ThreadPoolExecutor(1) as thread:
        starts = range(settings.simulation.n_starts)
        in_turn = thread.submit(evaluation._simulate_task, [*robots, *robots[::-1]], settings, starts).result()
    for robot, *walks in zip(robots, in_turn[: len(robots)], in_turn[: len(robots) - 1 : -1], strict=True):
        expected = walk_from_every_start(compile_scene(robot, settings), poses=False)
        assert [as_bytes(each) for each in walks] == 2 * [as_bytes(expected)]


def as_bytes(rollouts):
    """Return all attributes of some rollouts as bytes."""
    return [pickle.dumps(tuple(vars(rollout).items())) for rollout in rollouts]


def test_a_diverged_walk_does_not_change_the_next_one():
    scene, data = reusable_scene_of(wl.Genome(GENOMES[0]), SETTINGS)
    expected = simulate_walk(scene, poses=False)
    for state in (data.qpos, data.qvel, data.ctrl, data.qacc_warmstart, data.xfrc_applied, data.warning.number):
        state[:] = np.nan if state.dtype.kind == "f" else 3
    data.time = np.nan
    assert as_bytes([simulate_walk(scene, data, poses=False)]) == as_bytes([expected])
