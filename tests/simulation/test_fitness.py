"""A fitness rates the walk that was made, and nothing else."""

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
from walkerlab.randomness import stream
from walkerlab.settings.choices import Fitness
from walkerlab.simulation import fitness
from walkerlab.simulation.rollout import walk_from_every_start
from walkerlab.simulation.validity import REJECTED
from walkerlab.world.scene import compile_scene

ROLLOUT_GENOME = wl.Genome.random(wl.Robot(), rng=stream(0, "check"))
ROLLOUT = wl.simulate(ROLLOUT_GENOME, wl.Settings().with_(duration=1.5))
OPENED_ELSEWHERE = sqlite3.connect(":memory:")
TIME = np.linspace(0, 9, 451)


def walked(x):
    """Return a rollout whose centre of mass was at these x."""
    com = np.stack([x, np.zeros_like(x), np.full_like(x, 0.2)], axis=1)
    return replace(ROLLOUT, time=TIME, com=com, verdict="ok")


def test_distance_is_net_so_going_back_costs_what_going_forth_gained():
    assert fitness.distance(walked(2 * TIME)) == pytest.approx(18)
    assert fitness.distance(walked(5 + 2 * TIME)) == pytest.approx(18), "wherever it starts"
    assert fitness.distance(walked(np.minimum(TIME, 9 - TIME))) == pytest.approx(0)
    assert fitness.distance(walked(-TIME)) == pytest.approx(-9), "backward is less than nothing, not as good"


def test_velocity_forgets_the_first_third():
    assert fitness.velocity(walked(2 * TIME)) == pytest.approx(2)
    late_start = np.maximum(TIME - 3, 0)
    assert fitness.velocity(walked(late_start)) == pytest.approx(1)
    early_sprint = np.minimum(TIME, 3)
    assert fitness.velocity(walked(early_sprint)) == pytest.approx(0, abs=1e-9)


def test_efficiency_is_travel_for_work():
    thrifty, spendthrift = (replace(walked(2 * TIME), work=work * TIME) for work in (10.0, 40.0))
    assert fitness.efficiency(thrifty) == pytest.approx(18 / 100)
    assert fitness.efficiency(thrifty) > 3.5 * fitness.efficiency(spendthrift)
    assert abs(fitness.efficiency(replace(walked(1e-3 * TIME), work=0 * TIME))) < 0.01, "lying still is not efficient"


def test_straightness_takes_off_what_went_to_either_side():
    for side in (1, -1):
        com = np.stack([2 * TIME, side * TIME, np.full_like(TIME, 0.2)], axis=1)
        assert fitness.straightness(replace(ROLLOUT, time=TIME, com=com, verdict="ok")) == pytest.approx(18 - 9)
    assert fitness.straightness(walked(2 * TIME)) == pytest.approx(18)


def test_every_choice_has_its_function_and_unit():
    assert set(fitness.FUNCTIONS) == set(Fitness)
    assert set(fitness.UNITS) == set(Fitness)


def test_a_walk_that_does_not_count_is_worse_than_any_that_does():
    void = replace(walked(100 * TIME), verdict="airborne")
    assert fitness.score(void, Fitness.distance) < fitness.score(walked(-100 * TIME), Fitness.distance)
    assert not np.isnan(fitness.score(void, Fitness.distance))


def test_a_function_of_the_users_own_is_not_asked_about_a_void_walk():
    def unasked(rollout):
        raise AssertionError

    assert fitness.score(replace(ROLLOUT, verdict="too fast"), unasked) == -np.inf


class TestTriedBeforeAnyPhysics:
    def test_a_sound_one_passes(self):
        fitness.check_own(lambda rollout: rollout.com[:, 2].max() * rollout.phenotype.body_length)
        fitness.check_own(Fitness.velocity)

    @pytest.mark.parametrize(
        ("own", "told"),
        [
            (lambda rollout: 1 / 0, "ZeroDivisionError"),
            (lambda rollout: rollout.poses[-1, 2], "not recorded"),
            (lambda: 1.0, "called with one Rollout"),
            (len, "len"),
            (lambda rollout: rollout.com, "one finite number"),
            (lambda rollout: -(10**400), "one finite number"),
            (lambda rollout: "far", "one finite number"),
            (lambda rollout: OPENED_ELSEWHERE.execute("select 1"), "thread of their own.*WALKERLAB_PATIENCE"),
            (lambda rollout: signal.signal(signal.SIGINT, signal.SIG_IGN), "thread of their own"),
            (lambda rollout: np.complex128(1), "one finite number"),
            (lambda rollout: np.random.default_rng().random(), "the same walk"),
            (lambda rollout: rollout.com.sort(), r"wrote into what is read-only \(line .*com = rollout.com.copy"),
            (lambda rollout: setattr(rollout, "com", 0), "wrote into what is read-only"),
            (
                lambda rollout: float("nan"),
                r"it returned nan, when .*\. Is something divided.*To exclude a robot, return -np.inf",
            ),
            (lambda rollout: np.random.random(), "used np.random.* nothing but the walk"),  # noqa: NPY002
            (lambda rollout: random.random(), "used random.* nothing but the walk"),
        ],
    )
    def test_an_unsound_one_is_told_what_is_wrong(self, own, told):
        with pytest.raises(OperatorError, match=told) as caught:
            fitness.check_own(own)
        assert "when tried on a made-up walk" in str(caught.value)

    def test_one_that_never_returns_is_told_so(self, monkeypatch):
        monkeypatch.setenv("WALKERLAB_PATIENCE", "0.1")

        def waits(rollout):
            while rollout:
                pass

        with pytest.raises(OperatorError, match=r"'waits' had not returned after 0\.1 s \(line \d+\), when tried"):
            fitness.check_own(waits)


def test_a_walk_that_is_rated_cannot_be_written_into_wherever_it_comes_from():
    def puts_itself_first(rollout):
        rollout.com[-1, 0] = 1e9
        return rollout.distance

    walk = pickle.loads(pickle.dumps(walked(TIME)))
    with pytest.raises(OperatorError, match="'puts_itself_first' must leave what it is given as it was"):
        fitness.score(walk, puts_itself_first)
    assert walk.distance == 9


@pytest.mark.parametrize("answer", [float("nan"), float("inf"), 1e100, "far", np.zeros(2), [1.0], 1j, np.ma.masked])
def test_a_fitness_that_gives_no_number_is_named(answer):
    def hop_height(rollout):
        return answer

    with pytest.raises(ValueError, match=r"hop_height.*one finite number"):
        fitness.score(walked(TIME), hop_height)


class Tensor:
    """A number of another library."""

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
    fitness.check_own(lambda rollout: answer)


@pytest.mark.parametrize("answer", [None, -np.inf, np.float32("-inf"), Decimal("-Infinity")])
def test_minus_infinity_and_none_exclude_a_robot_with_a_verdict_of_its_own(answer):
    fitness.check_own(lambda rollout: answer)
    rated, walk = fitness.rate(walked(TIME), lambda rollout: answer)
    assert (rated, walk.verdict, walk.counts) == (-np.inf, REJECTED, False)
    assert walk.reason == f"the fitness function returned {'None' if answer is None else '-inf'}"


def test_one_rejected_start_rejects_the_robot():
    settings = wl.Settings().with_(duration=1, n_starts=3)
    walks = walk_from_every_start(compile_scene(ROLLOUT_GENOME, settings), poses=False)
    assert all(walk.counts for walk in walks)
    second = walks[1].distance
    picky = settings.with_(fitness=lambda rollout: None if rollout.distance == second else 1.0)
    with ThreadPoolExecutor(1) as thread:
        (found,) = wl.evaluate([ROLLOUT_GENOME], picky, thread)
    assert (found.fitness, found.verdict, found.distance) == (-np.inf, REJECTED, second)
    assert fitness.poorest_walk(ROLLOUT_GENOME, picky).verdict == REJECTED
