"""Plausible mistakes get a hint that names the mistake."""

import numpy as np
import pytest

import walkerlab as wl

RANGE_SHARE = 0.01


def three_parents(fitness, n_parents, *, rng):
    return np.argsort(fitness)[-3:]


def unrepeatable_nudge(genomes, genes, *, rng):
    steps = np.random.default_rng().uniform(-1, 1, genomes.shape)
    return genomes + RANGE_SHARE * (genes.high - genes.low) * steps


def negative_scale(genomes, genes, *, generation, generations, rng):
    return wl.ga.mutation.gaussian(genomes, genes, scale=-0.3 * generation, rng=rng)


@pytest.mark.parametrize(
    ("number", "answer", "hint"),
    [
        ("08.3", three_parents, "parents are needed"),
        ("08.4", unrepeatable_nudge, "from rng"),
        ("08.7", negative_scale, "-0.3"),
        ("09.2", [3, 1, 2], "braces"),
        ("09.4", 6, "braces"),
        ("09.6", {"b": "4", "e": 5}, "operator_b is '4'"),
        ("10.6", [1, 2, 3, 4], "braces"),
        ("10.6", {"far": 1}, '"steps"'),
        ("10.6", {"far": "1", "steps": "2", "calm": "3", "sprint": "4"}, "without quotes"),
        ("12.5", 78, "from 0 to 1"),
        ("12.5", "0.78", "without quotes"),
        ("12.5", 3.1, "rounds"),
        ("12.6", 1.86, "gibibytes"),
        ("12.6", 30 / 16, "gibibytes"),
    ],
)
def test_a_plausible_mistake_gets_its_own_hint(number, answer, hint):
    feedback = wl.lessons.check(number, answer)
    assert feedback.state == "not yet"
    assert hint in feedback.text


@pytest.mark.parametrize("answer", [500 / 4 / 160, 0.78, 0.8])
def test_a_share_may_be_rounded(answer):
    assert wl.lessons.check("12.5", answer).state == "right"
