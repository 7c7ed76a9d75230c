"""A fitness depends only on the recorded walk, and a user function is checked."""

import pickle
import random
import signal
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.ga import OperatorError
from walkerlab.settings.choices import Fitness
from walkerlab.simulation import fitness
from walkerlab.simulation.rollout import walk_from_every_start
from walkerlab.simulation.validity import REJECTED
from walkerlab.system.randomness import random_stream
from walkerlab.world.scene import compile_scene

ROLLOUT_GENOME = wl.Genome.random(wl.Robot(), rng=random_stream(0, "check"))
ROLLOUT = wl.simulate(ROLLOUT_GENOME, wl.Settings().with_(duration=1.5))
CONNECTION_OF_MAIN_THREAD = sqlite3.connect(":memory:")
TIME = np.linspace(0, 9, 451)


def walked(x):
    """Return a rollout with these x coordinates of the centre of mass [m], one for each time of ``TIME``."""
    com = np.stack([x, np.zeros_like(x), np.full_like(x, 0.2)], axis=1)
    return replace(ROLLOUT, time=TIME, com=com, verdict="ok")


def test_distance_is_the_net_forward_travel():
    assert fitness.distance(walked(2 * TIME)) == pytest.approx(18)
    assert fitness.distance(walked(5 + 2 * TIME)) == pytest.approx(18), "it does not depend on the start"
    assert fitness.distance(walked(np.minimum(TIME, 9 - TIME))) == pytest.approx(0)
    assert fitness.distance(walked(-TIME)) == pytest.approx(-9), "backward travel is negative"


def test_velocity_excludes_the_first_third():
    assert fitness.velocity(walked(2 * TIME)) == pytest.approx(2)
    late_start = np.maximum(TIME - 3, 0)
    assert fitness.velocity(walked(late_start)) == pytest.approx(1)
    early_sprint = np.minimum(TIME, 3)
    assert fitness.velocity(walked(early_sprint)) == pytest.approx(0, abs=1e-9)


def test_efficiency_is_distance_per_work():
    low_work, high_work = (replace(walked(2 * TIME), work=work * TIME) for work in (10.0, 40.0))
    assert fitness.efficiency(low_work) == pytest.approx(18 / 100)
    assert fitness.efficiency(low_work) > 3.5 * fitness.efficiency(high_work)
    assert abs(fitness.efficiency(replace(walked(1e-3 * TIME), work=0 * TIME))) < 0.01, (
        "standing still is not efficient"
    )


def test_straightness_subtracts_the_distance_to_either_side():
    for side in (1, -1):
        com = np.stack([2 * TIME, side * TIME, np.full_like(TIME, 0.2)], axis=1)
        assert fitness.straightness(replace(ROLLOUT, time=TIME, com=com, verdict="ok")) == pytest.approx(18 - 9)
    assert fitness.straightness(walked(2 * TIME)) == pytest.approx(18)


def test_every_choice_has_a_function_and_a_unit():
    assert set(fitness.FITNESS_FUNCTIONS) == set(Fitness)
    assert set(fitness.FITNESS_UNITS) == set(Fitness)


def test_a_walk_that_does_not_count_has_a_lower_fitness_than_any_other():
    invalid = replace(walked(100 * TIME), verdict="airborne")
    assert fitness.score(invalid, Fitness.distance) < fitness.score(walked(-100 * TIME), Fitness.distance)
    assert not np.isnan(fitness.score(invalid, Fitness.distance))


def test_a_user_function_is_not_called_for_a_walk_that_does_not_count():
    def fail(rollout):
        raise AssertionError

    assert fitness.score(replace(ROLLOUT, verdict="too fast"), fail) == -np.inf


def check(function):
    fitness.check_user_function(wl.Settings().with_(fitness=function))


class TestCheckBeforeAnySimulation:
    def test_a_correct_function_passes(self):
        check(lambda rollout: rollout.com[:, 2].max() * rollout.phenotype.body_length)
        check(Fitness.velocity)

    @pytest.mark.parametrize(
        ("function", "message"),
        [
            (lambda rollout: 1 / 0, "ZeroDivisionError"),
            (lambda rollout: rollout.poses[-1, 2], "not recorded"),
            (lambda: 1.0, "called with one Rollout"),
            (len, "len"),
            (lambda rollout: rollout.com, "one finite number"),
            (lambda rollout: -(10**400), "one finite number"),
            (lambda rollout: "far", "one finite number"),
            (lambda rollout: CONNECTION_OF_MAIN_THREAD.execute("select 1"), "separate thread.*WALKERLAB_PATIENCE"),
            (lambda rollout: signal.signal(signal.SIGINT, signal.SIG_IGN), "separate thread"),
            (lambda rollout: np.complex128(1), "one finite number"),
            (lambda rollout: np.random.default_rng().random(), "the same walk"),
            (lambda rollout: rollout.com.sort(), r"must not modify its arguments.* \(line .*com = rollout.com.copy"),
            (lambda rollout: setattr(rollout, "com", 0), "must not modify its arguments"),
            (
                lambda rollout: float("nan"),
                r"it returned nan, when .*\. Is something divided.*To exclude a robot, return -np.inf",
            ),
            (lambda rollout: np.random.random(), "used np.random.* depend only on the walk"),  # noqa: NPY002
            (lambda rollout: random.random(), "used random.* depend only on the walk"),
        ],
    )
    def test_the_error_names_the_fault(self, function, message):
        with pytest.raises(OperatorError, match=message) as caught:
            check(function)
        assert "when tried on a made-up walk" in str(caught.value)

    def test_a_function_that_never_returns_exceeds_the_time_limit(self, monkeypatch):
        monkeypatch.setenv("WALKERLAB_PATIENCE", "0.1")

        def waits(rollout):
            while rollout:
                pass

        with pytest.raises(OperatorError, match=r"'waits' had not returned after 0\.1 s \(line \d+\), when tried"):
            check(waits)


def test_a_function_cannot_change_the_walk_even_after_pickling():
    def changes_the_walk(rollout):
        rollout.com[-1, 0] = 1e9
        return rollout.distance

    walk = pickle.loads(pickle.dumps(walked(TIME)))
    with pytest.raises(OperatorError, match="'changes_the_walk' must not modify its arguments"):
        fitness.score(walk, changes_the_walk)
    assert walk.distance == 9


@pytest.mark.parametrize("answer", [float("nan"), float("inf"), 1e100, "far", np.zeros(2), [1.0], 1j, np.ma.masked])
def test_the_error_names_a_function_that_does_not_return_a_number(answer):
    def hop_height(rollout):
        return answer

    with pytest.raises(ValueError, match=r"hop_height.*one finite number"):
        fitness.score(walked(TIME), hop_height)


class Tensor:
    """Number of another library."""

    def __float__(self):
        return 2.5


@pytest.mark.parametrize(
    ("answer", "number"),
    [
        (np.True_, 1.0),
        (False, 0.0),
        (np.float32(0.1), float(np.float32(0.1))),
        (np.float16(2), 2.0),
        (np.uint8(200), 200.0),
        (np.asarray(1.5), 1.5),
        (np.asarray([[1.5]]), 1.5),
        (np.asarray(Fraction(1, 4)), 0.25),
        (pd.Series([1.5]), 1.5),
        (Decimal("1.5"), 1.5),
        (Fraction(-1, 4), -0.25),
        (10**50, 1e50),
        (Tensor(), 2.5),
    ],
)
def test_any_single_real_number_is_a_fitness(answer, number):
    assert fitness.score(walked(TIME), lambda rollout: answer) == number
    check(lambda rollout: answer)


@pytest.mark.parametrize("answer", [None, -np.inf, np.float32("-inf"), Decimal("-Infinity")])
def test_minus_infinity_and_none_reject_a_robot(answer):
    check(lambda rollout: answer)
    rated, walk = fitness.rate_walk(walked(TIME), lambda rollout: answer)
    assert (rated, walk.verdict, walk.counts) == (-np.inf, REJECTED, False)
    assert walk.reason == f"the fitness function returned {'None' if answer is None else '-inf'}"


def test_one_rejected_start_rejects_the_robot():
    settings = wl.Settings().with_(duration=1, n_starts=3)
    walks = walk_from_every_start(compile_scene(ROLLOUT_GENOME, settings), poses=False)
    assert all(walk.counts for walk in walks)
    second = walks[1].distance
    selective = settings.with_(fitness=lambda rollout: None if rollout.distance == second else 1.0)
    with ThreadPoolExecutor(1) as thread:
        (found,) = wl.evaluate([ROLLOUT_GENOME], selective, thread)
    assert (found.fitness, found.verdict, found.distance) == (-np.inf, REJECTED, second)
    assert fitness.poorest_walk(ROLLOUT_GENOME, selective).verdict == REJECTED
