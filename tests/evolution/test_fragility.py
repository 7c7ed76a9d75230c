"""Robots whose walk depends on their exact start do not become elites or champions."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import walkerlab as wl
from walkerlab.evolution.fragility import (
    MIN_KEPT_SHARE,
    N_TEST_STARTS,
    SUFFICIENT_QUANTILE,
    exclude_fragile,
    further_starts,
)
from walkerlab.runfile.records import EvaluationRow
from walkerlab.simulation.evaluation import Evaluation

SETTINGS = wl.Settings().with_(n_elites=2)
GENOME = wl.Genome.random(SETTINGS.robot, rng=np.random.default_rng(0))
FITNESS = st.integers(-4, 20).map(float) | st.just(-np.inf)


def row(fitness):
    """Return the evaluation of a robot that walked as far as its fitness says."""
    verdict = "ok" if np.isfinite(fitness) else "fell"
    return EvaluationRow(fitness, verdict, "" if verdict == "ok" else "it fell", fitness, 0.0, 2, 4, 8.0, 1.0, "")


def walk_again_with(fitness_again):
    """Return a function that simulates robots again, and the list of the robots that were passed to it."""
    walked = []

    def walk_again(texts):
        walked.extend(texts)
        rows = [row(fitness_again[text]) for text in texts]
        return [Evaluation(GENOME, *one[:-1]) for one in rows]

    return walk_again, walked


@given(st.lists(st.tuples(FITNESS, FITNESS), min_size=1, max_size=12), st.integers(0, 3), st.data())
def test_the_best_are_tested_until_all_elites_have_passed(pairs, n_elites, data):
    settings = SETTINGS.with_(n_elites=n_elites)
    rows = {str(number): row(fitness) for number, (fitness, _) in enumerate(pairs)}
    again = {str(number): fitness for number, (_, fitness) in enumerate(pairs)}
    passed = data.draw(st.sets(st.sampled_from(sorted(rows))))
    walk_again, walked = walk_again_with(again)
    rated = exclude_fragile(rows, passed, settings, walk_again)
    assert len(walked) == len({*walked})
    assert not {*walked} & passed
    best = sorted(rated, key=lambda text: -rated[text].fitness)[: max(1, n_elites)]
    counted = [one.fitness for one in rows.values() if one.verdict == "ok"]
    median = np.median(counted) if counted else np.inf
    assert all(text in passed or text in walked or rated[text].fitness <= median for text in best)
    assert all(rows[text].fitness > median for text in walked), "at least half of the generation remains"
    limit = rated[best[-1]].fitness
    assert all(rows[text].fitness >= limit for text in walked), "robots below the elites are not tested"
    for text, one in rated.items():
        before = rows[text]
        if one == before:
            required = before.fitness - (1 - MIN_KEPT_SHARE) * abs(before.fitness)
            assert text not in walked or again[text] >= min(required, np.quantile(counted, SUFFICIENT_QUANTILE))
        else:
            assert text in walked
            assert (one.fitness, one.verdict) == (-np.inf, "fragile")
            assert again[text] < np.quantile(counted, SUFFICIENT_QUANTILE)
            assert again[text] < MIN_KEPT_SHARE * before.fitness or before.fitness <= 0
            assert one.distance == before.distance


def test_a_reason_names_what_was_reached_and_what_is_required():
    rows = {"a": row(10.0), "b": row(9.0), "c": row(1.0), "d": row(0.5)}
    walk_again, _ = walk_again_with({"a": 7.0, "b": -np.inf})
    rated = exclude_fragile(rows, (), SETTINGS, walk_again)
    assert (
        rated["a"].reason
        == f"from a slightly different start, its fitness was 7.00 m; {10 * MIN_KEPT_SHARE:.2f} m or more is required"
    )
    assert rated["b"].reason == "from a slightly different start, its walk did not count: it fell"
    assert rated["c"] == rows["c"]


@pytest.mark.parametrize("forgiven", ["fragile", ["fragile", "fell"]])
def test_forgive_turns_the_test_off(forgiven):
    settings = SETTINGS.with_(forgive=forgiven)
    assert not further_starts(settings)
    rows = {"a": row(10.0)}
    assert exclude_fragile(rows, (), settings, pytest.fail) == rows


@pytest.mark.parametrize("seed", range(2))
def test_the_champion_of_a_run_does_not_depend_on_its_start(seed):
    settings = wl.Settings().with_(population_size=8, generations=3, duration=2, seed=seed)
    with ThreadPoolExecutor(1) as thread:
        run = wl.evolve(settings, executor=thread, progress=False)
        champion = run.champion
        [again] = wl.evaluate([champion.genome], settings, thread, starts=range(1, 1 + N_TEST_STARTS))
    generation = run.records[run.records.generation == champion.generation].drop_duplicates("genome")
    counted = generation.distance[generation.verdict.isin(["ok", "fragile"])]
    assert again.verdict == "ok"
    assert again.fitness >= min(MIN_KEPT_SHARE * champion.fitness, counted.quantile(SUFFICIENT_QUANTILE))


def test_walks_from_given_starts_are_those_of_several_starts():
    settings = wl.Settings().with_(duration=1, forgive=[guard.name for guard in wl.Guard if guard])
    with ThreadPoolExecutor(1) as thread:
        single = [wl.evaluate([GENOME], settings, thread, starts=[start])[0] for start in range(3)]
        [poorest] = wl.evaluate([GENOME], settings.with_(n_starts=3), thread)
    assert len({one.distance for one in single}) == 3
    expected = min(single, key=lambda one: one.fitness)
    assert (poorest.fitness, poorest.velocity) == (expected.fitness, expected.velocity)


@pytest.mark.parametrize("starts", [[], [-1], [0.5], 3, [[1, 2]], "12"])
def test_invalid_starts_are_rejected(starts):
    with pytest.raises(ValueError, match="at least one whole number"):
        wl.evaluate([GENOME], SETTINGS, starts=starts)
