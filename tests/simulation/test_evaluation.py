"""Many walks on any executor: the same answers, in the order of the questions."""

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
from walkerlab.breeding import generate_robot_population
from walkerlab.genome.phenotype import express
from walkerlab.simulation import evaluation
from walkerlab.simulation.rollout import walk, walk_from_every_start
from walkerlab.simulation.starts import draw_nudge
from walkerlab.world.scene import compile_scene, reusable_scene_of

SETTINGS = wl.Settings().with_(duration=1.0)
GENOMES = generate_robot_population(SETTINGS.robot, 9, seed=3)


class Backwards(Executor):
    """Does nothing until somebody waits, and then the last task first."""

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
def test_any_executor_gives_the_same(executor):
    with executor() as pool:
        assert table(wl.evaluate(GENOMES, SETTINGS, executor=pool)) == EXPECTED


def test_loky_gives_the_same_with_a_fitness_that_only_this_process_knows():
    reach = {"seen": 0}

    def in_a_cell(rollout):
        reach["seen"] += 1
        return float(rollout.com[:, 0].max())

    plain = wl.evaluate(GENOMES, SETTINGS)
    own = wl.evaluate(GENOMES, SETTINGS.with_(fitness=in_a_cell))
    assert table(plain) == EXPECTED
    assert [e.distance for e in own] == [e.distance for e in plain]
    assert reach["seen"] == sum(e.verdict == "ok" for e in plain) > 0


def test_genomes_texts_and_arrays_are_the_same_question():
    genomes = [wl.Genome(values) for values in GENOMES[:3]]
    with ThreadPoolExecutor(1) as pool:
        answers = [
            table(wl.evaluate(given, SETTINGS, pool)) for given in (genomes, list(map(str, genomes)), GENOMES[:3])
        ]
    assert answers[0] == answers[1] == answers[2] == EXPECTED[:3]


def test_one_genome_text_or_array_is_the_same_scene_and_walk():
    genome = wl.Genome(GENOMES[0])
    for given in (genome, str(genome), GENOMES[0], GENOMES[0].tolist()):
        assert wl.compile_scene(given, SETTINGS).genome == genome
        assert wl.fitness.distance(wl.simulate(given, SETTINGS, poses=False)) == EXPECTED[0][3]


def test_a_single_genome_is_not_taken_for_a_population():
    genome = wl.Genome(GENOMES[0])
    for single in (genome, str(genome), GENOMES[0]):
        with pytest.raises(ValueError, match="put it in a list"):
            wl.evaluate(single, SETTINGS, Backwards())


def test_a_genome_from_elsewhere_is_brought_within_the_limits():
    strong = wl.Robot(weight=(50, 60), body_length=(2, 3), segment_length=(0.5, 1), segments=(3, 6))
    foreign = wl.Genome.random(strong, rng=np.random.default_rng(0))
    (found,) = wl.evaluate([foreign], SETTINGS, Backwards())
    assert found.weight <= 12 * (1 + 1e-9)
    assert found.body_length <= 1.2 * (1 + 1e-9)
    assert found.genome != foreign


def test_progress_is_told_and_adds_up():
    told = []
    wl.evaluate(GENOMES, SETTINGS, Backwards(), on_done=told.append)
    assert sum(told) == len(GENOMES)
    assert len(told) > 1


@pytest.mark.parametrize("n_workers", [1, 2, 8, 100])
@pytest.mark.parametrize("n", [1, 9, 60, 1000])
def test_tasks_hold_every_robot_once_the_costly_first_and_the_last_alone(n, n_workers):
    robots = [wl.Genome(values) for values in generate_robot_population(SETTINGS.robot, n, seed=1)]
    tasks = evaluation._tasks(robots, n_workers)
    dealt = [i for task in tasks for i in task]
    assert sorted(dealt) == list(range(n))
    costs = [evaluation._cost(robots[i]) for i in dealt]
    assert costs == sorted(costs, reverse=True)
    sizes = [len(task) for task in tasks]
    assert sizes == sorted(sizes, reverse=True)
    assert max(sizes, default=1) <= max(1, min(evaluation.LARGEST, n // (2 * n_workers)))
    assert sizes[-n_workers:] == [1] * min(n, n_workers, len(sizes))


def test_a_task_is_no_longer_than_a_pause_may_last():
    robots = [wl.Genome(values) for values in generate_robot_population(SETTINGS.robot, 100, seed=1)]
    assert max(map(len, evaluation._tasks(robots, 1))) == 16


class Asked(Executor):
    """Works at once, and remembers what it was asked."""

    def __init__(self):
        self.asked = []

    def submit(self, function, /, *args):
        self.asked.append(args)
        future = Future()
        if len(self.asked) == 1:
            future.set_result(function(*args))
        return future


def test_equal_questions_are_told_apart_and_what_is_no_longer_wanted_is_given_up():
    """By an executor that answers equal questions together, as Dask's does."""

    class Wrong(Exception):
        pass

    def wrong(rollout):
        raise Wrong

    executors = Asked(), Asked()
    for executor in executors:
        given, submit = [], executor.submit
        executor.submit = lambda *args, given=given, submit=submit: given.append(submit(*args)) or given[-1]
        with pytest.raises(wl.OperatorError, match="Wrong"):
            wl.evaluate(GENOMES, SETTINGS.with_(fitness=wrong), executor)
        assert all(future.cancelled() for future in given[1:])
    first, second = (executor.asked[0] for executor in executors)
    assert first[0] == second[0]
    assert first[2:] != second[2:]


def test_limbs_tell_how_long_a_walk_takes_to_compute():
    """Or the costly ones first would be anyone first."""
    robots = [wl.Genome(values) for values in generate_robot_population(SETTINGS.robot, 200, seed=1)]
    sizes = [compile_scene(robot, SETTINGS).model.nv for robot in robots]
    assert np.corrcoef([evaluation._cost(robot) for robot in robots], sizes)[0, 1] > 0.99


def test_nobody_to_evaluate_is_no_fault():
    assert wl.evaluate([], SETTINGS, Backwards()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_caller_leaves_no_workers_behind():
    """As when a notebook's kernel is restarted while robots walk."""
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
    while (left := [worker for worker in workers if alive(worker)]) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not left


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


class TestSeveralStarts:
    """A robot that walks from several starts is worth its poorest walk."""

    settings = SETTINGS.with_(n_starts=3, duration=2.0)

    def test_the_poorest_walk_counts_and_the_first_start_is_the_plain_one(self):
        for genome, found in zip(GENOMES[:4], wl.evaluate(GENOMES[:4], self.settings), strict=True):
            scene = wl.compile_scene(genome, self.settings)
            rollouts = [walk(scene, nudge=draw_nudge(scene, start), poses=False) for start in range(3)]
            scores = [wl.fitness.score(rollout, self.settings.algorithm.fitness) for rollout in rollouts]
            assert found.fitness == min(scores)
            assert found.verdict == rollouts[scores.index(min(scores))].verdict
            plain = wl.simulate(genome, self.settings, poses=False)
            assert wl.fitness.distance(rollouts[0]) == wl.fitness.distance(plain)
            assert len({wl.fitness.distance(rollout) for rollout in rollouts}) == 3

    def test_more_starts_never_make_a_robot_better(self):
        one, three = (wl.evaluate(GENOMES, self.settings.with_(n_starts=n)) for n in (1, 3))
        assert all(many.fitness <= single.fitness for many, single in zip(three, one, strict=True))
        assert any(many.fitness < single.fitness for many, single in zip(three, one, strict=True))


GROUNDS = {
    "flat": {},
    "gravel, rocks, a pack and a sledge": {
        "texture": "gravel", "texture_density": 0.05, "obstacle": "rock", "carry_weight": 2, "drag_weight": 2,
    },
    "balls, two starts": {"obstacle": "ball", "obstacle_density": 0.3, "n_starts": 2},
}  # fmt: skip


@pytest.mark.parametrize("ground", GROUNDS)
def test_whoever_walked_before_changes_nothing_about_a_walk(ground):
    """Robots of one body plan walk on one stage, one after the other: each as if it were the first, bit for bit."""
    settings = SETTINGS.with_(**GROUNDS[ground])
    robots = [wl.Genome(values).within(settings.robot) for values in GENOMES]
    plans = {express(robot).plan for robot in robots}
    assert len(plans) < len(robots), "or nobody follows anybody"
    with ThreadPoolExecutor(1) as stages:
        in_turn = stages.submit(evaluation._walk_all, [*robots, *robots[::-1]], settings).result()
    for robot, *walks in zip(robots, in_turn[: len(robots)], in_turn[: len(robots) - 1 : -1], strict=True):
        first = walk_from_every_start(compile_scene(robot, settings), poses=False)
        assert [exact(each) for each in walks] == 2 * [exact(first)]


def exact(rollouts):
    """All that a fitness could see of them, as bytes."""
    return [pickle.dumps(tuple(vars(rollout).items())) for rollout in rollouts]


def test_a_walk_that_broke_down_leaves_nothing_behind():
    scene, data = reusable_scene_of(wl.Genome(GENOMES[0]), SETTINGS)
    expected = walk(scene, poses=False)
    for state in (data.qpos, data.qvel, data.ctrl, data.qacc_warmstart, data.xfrc_applied, data.warning.number):
        state[:] = np.nan if state.dtype.kind == "f" else 3
    data.time = np.nan
    assert exact([walk(scene, data, poses=False)]) == exact([expected])
