"""Each kind of bad operator gets a message that names it, what is expected, what it did, and the mend."""

import asyncio
import random
import re
import signal
import threading
from functools import partial

import numpy as np
import pytest

from walkerlab.ga import OperatorError, check_cross, check_mutate, check_select, mutation, selection, user_functions
from walkerlab.ga.slots import run_select

from .tables import body, rng

GENES = body()


def pick(fitness, n_parents, *, rng):
    return rng.integers(len(fitness), size=n_parents)


def named(function):
    """Call a bad operator ``mine``."""
    function.__name__ = "mine"
    return function


@named
def no_rng(fitness, n_parents):
    return np.zeros(n_parents, int)


@named
def one_too_many(fitness, n_parents, pressure, *, rng):
    return np.zeros(n_parents, int)


@named
def shrinks(fitness, n_parents, *, rng):
    return np.argsort(-fitness)[:n_parents]


@named
def forgets(fitness, n_parents, *, rng):
    pass


@named
def masks(fitness, n_parents, *, rng):
    return np.ones(n_parents, bool)


@named
def outside(fitness, n_parents, *, rng):
    return pick(fitness, n_parents, rng=rng) + 1


@named
def halves_of_indices(fitness, n_parents, *, rng):
    return pick(fitness, n_parents, rng=rng) / 2


@named
def from_behind(fitness, n_parents, *, rng):
    return -pick(fitness, n_parents, rng=rng)


@named
def sorts_in_place(fitness, n_parents, *, rng):
    fitness.sort()
    return pick(fitness, n_parents, rng=rng)


@named
def own_generator(fitness, n_parents, *, rng):
    return np.random.default_rng().integers(len(fitness), size=n_parents)


@named
def not_below_zero(fitness, n_parents, *, rng):
    return rng.choice(len(fitness), size=n_parents, p=fitness / fitness.sum())


@named
def not_among_equals(fitness, n_parents, *, rng):
    weights = fitness - fitness.min()
    if not weights.any():
        raise ZeroDivisionError("all weights are zero")
    return rng.choice(len(fitness), size=n_parents, p=weights / weights.sum())


@pytest.mark.parametrize(
    ("bad", "expected", "got", "mend"),
    [
        (no_rng, "a function select(fitness, n_parents, *, rng)", "mine(fitness, n_parents)", "functools.partial"),
        (one_too_many, "a function select(", "missing a required argument: 'pressure'", "functools.partial"),
        (shrinks, "n_parents = 200 parents, an array of shape (200,)", "shape (20,)", "np.resize(chosen, n_parents)"),
        (forgets, "n_parents = 18 parents", "nothing (None)", "np.resize"),
        (masks, "whole numbers, 0 to 19", "shape (18,), bool", "np.flatnonzero(mask)"),
        (outside, "whole numbers, 0 to 19", "it returned 20", "rng.integers(len(fitness)"),
        (outside, "0 to 19", "when tried on a trial population of 20 individuals", "rng.integers(len(fitness)"),
        (halves_of_indices, "whole numbers, 0 to 19", "float64", "np.argsort gives places"),
        (from_behind, "whole numbers, 0 to 19", "it returned -", "rng.integers(len(fitness)"),
        (sorts_in_place, "leave what it is given", "wrote into what is read-only (line ", "fitness.copy()"),
        (own_generator, "the same answer for the same rng", "it gave two", "rng.random()"),
    ],
)
def test_bad_selections(bad, expected, got, mend):
    with pytest.raises(OperatorError) as caught:
        check_select(bad)
    for words in ("selection 'mine' must", expected, got, mend):
        assert words in str(caught.value)


@pytest.mark.parametrize(
    ("bad", "raised", "n_lines_down"),
    [
        (not_below_zero, "ValueError: ", 2),
        (not_among_equals, "ZeroDivisionError: all weights are zero", 4),
        (partial(not_among_equals), "ZeroDivisionError: all weights are zero", 4),
    ],
)
def test_what_a_selection_raises_comes_first_with_its_line_and_what_it_was_tried_on(bad, raised, n_lines_down):
    code = getattr(bad, "func", bad).__code__
    with pytest.raises(OperatorError) as caught:
        check_select(bad)
    told = str(caught.value)
    assert told.startswith(f"selection 'mine' raised {raised}")
    assert f" (line {code.co_firstlineno + n_lines_down}), when tried on" in told
    assert "negative and equal fitness. It must work on every population." in told


def halves(parents, n_children):
    children = np.resize(parents, (n_children, parents.shape[1]))
    return children, np.arange(n_children)[:, None] % len(parents)


@named
def only_children(parents, fitness, n_children, *, rng):
    return halves(parents, n_children)[0]


@named
def flat_parents(parents, fitness, n_children, *, rng):
    children, origins = halves(parents, n_children)
    return children, origins[:, 0]


@named
def too_few(parents, fitness, n_children, *, rng):
    return halves(parents, n_children // 2)


@named
def strangers(parents, fitness, n_children, *, rng):
    children, origins = halves(parents, n_children)
    return children, origins + 1


@named
def divides(parents, fitness, n_children, *, rng):
    children, origins = halves(parents, n_children)
    return children * np.nan, origins


@named
def ragged(parents, fitness, n_children, *, rng):
    return [[1.0, 2.0], [3.0]] * 10, halves(parents, n_children)[1]


@named
def mixes_in_place(parents, fitness, n_children, *, rng):
    parents[0] = parents[1]
    return halves(parents, n_children)


@pytest.mark.parametrize(
    ("bad", "expected", "got", "mend"),
    [
        (only_children, "two arrays", "an array of shape (20, 18)", "return children, parents_of_each"),
        (flat_parents, "(n_children, k) = (20, k)", "shape (20,)", "mothers[:, None]"),
        (too_few, "(n_children, n_genes) = (20, 18)", "shape (10, 18)", "axis=0"),
        (strangers, "the parents given by whole numbers, 0 to 19", "it returned 20", "Draw from"),
        (divides, "finite numbers", "it returned nan", "division by zero"),
        (mixes_in_place, "leave what it is given", "wrote into what is read-only (line ", "parents.copy()"),
        (ragged, "(n_children, n_genes) = (20, 18)", "a list: [[1.0, 2.0], [3.0]", "axis=0"),
    ],
)
def test_bad_crossovers(bad, expected, got, mend):
    with pytest.raises(OperatorError) as caught:
        check_cross(bad, GENES)
    for words in ("crossover 'mine' must", expected, got, mend):
        assert words in str(caught.value)


@named
def shakes_in_place(genomes, genes, *, rng):
    genomes += rng.normal(size=genomes.shape)
    return genomes


@named
def returns_nothing(genomes, genes, *, rng):
    genomes + rng.normal(size=genomes.shape)


@named
def turns(genomes, genes, *, rng):
    return genomes.T


@named
def complex_roots(genomes, genes, *, rng):
    return np.emath.sqrt(-genomes)


@pytest.mark.parametrize(
    ("bad", "expected", "got", "mend"),
    [
        (shakes_in_place, "leave what it is given", "wrote into", "genomes.copy(); +="),
        (returns_nothing, "(n, n_genes) = (20, 18)", "nothing (None)", "is a return missing"),
        (turns, "(n, n_genes) = (20, 18)", "shape (18, 20)", "Each row is one individual"),
        (complex_roots, "numbers of shape", "complex128", "Each row"),
    ],
)
def test_bad_mutations(bad, expected, got, mend):
    with pytest.raises(OperatorError) as caught:
        check_mutate(bad, GENES)
    for words in ("mutation 'mine' must", expected, got, mend):
        assert words in str(caught.value)


def test_what_a_mutation_raises_is_told_without_a_word_of_fitness_which_it_never_sees():
    cell = "def my_mutation(genomes, genes, *, rng):\n    return genome + rng.normal(size=genomes.shape)\n"
    exec(compile(cell, "<cell>", "exec"), mine := {})
    with pytest.raises(OperatorError) as caught:
        check_mutate(mine["my_mutation"], GENES)
    raised = "mutation 'my_mutation' raised NameError: name 'genome' is not defined (line 2)"
    assert str(caught.value).startswith(f"{raised}, when tried on a trial population of 20 individuals.")
    assert "fitness" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "draw"),
    [
        ("np.random", lambda: np.random.random()),  # noqa: NPY002
        ("np.random", lambda: np.random.normal()),  # noqa: NPY002  # makes two at a time, and keeps one for the next call
        ("random", lambda: random.random()),
    ],
)
@pytest.mark.parametrize(
    ("slot", "check", "shifted"),
    [
        ("selection", check_select, lambda by, fitness, n: (np.arange(n) + int(1e6 * abs(by))) % len(fitness)),
        ("crossover", partial(check_cross, genes=GENES), lambda by, parents, fitness, n: halves(parents + by, n)),
        ("mutation", partial(check_mutate, genes=GENES), lambda by, genomes, genes: genomes + by),
    ],
    ids=["selection", "crossover", "mutation"],
)
def test_who_draws_from_chance_that_all_share_is_named(slot, check, shifted, name, draw):
    with pytest.raises(OperatorError) as caught:
        check(named(lambda *given, rng: shifted(draw(), *given)))
    told = str(caught.value)
    assert told.startswith(f"{slot} 'mine' used {name}, which all of Python shares")
    assert "rng.random(), rng.integers(n), rng.normal()" in told


@pytest.mark.parametrize("busy", [False, True], ids=["once", "all the time"])
def test_nobody_is_blamed_for_what_others_draw_meanwhile(busy):
    door, others = threading.Event(), []

    def draws():
        while not door.is_set():
            np.random.random()  # noqa: NPY002

    def mine(genomes, genes, *, rng):
        if not others:
            others.append(threading.Thread(target=draws) if busy else np.random.random())  # noqa: NPY002
            if busy:
                others[0].start()
        door.wait(0.005)  # it takes its time, in which the others go on
        return genomes + rng.normal(size=genomes.shape)

    try:
        check_mutate(mine, GENES)
    finally:
        door.set()
    assert others


def test_who_never_returns_is_told_where_it_was_and_how_to_give_it_longer(monkeypatch):
    monkeypatch.setenv("WALKERLAB_PATIENCE", "0.1")
    cell = (
        "def my_mutation(genomes, genes, *, rng):\n    n = 0\n    while n < 5:\n        m = n + 1\n    return genomes\n"
    )
    exec(compile(cell, "<cell>", "exec"), mine := {})
    with pytest.raises(OperatorError) as caught:
        check_mutate(mine["my_mutation"], GENES)
    told = str(caught.value)
    assert re.match(r"mutation 'my_mutation' had not returned after 0\.1 s \(line [34]\), when tried on a trial", told)
    assert "a loop that never ends? If it needs longer: os.environ['WALKERLAB_PATIENCE'] = '600' before" in told


def test_ours_are_called_on_the_callers_thread(monkeypatch):
    monkeypatch.setattr(user_functions, "call_with_limit", lambda call, seconds: 1 / 0)
    check_select(partial(selection.tournament, size=2))
    check_mutate(partial(mutation.favored, favored="length"), GENES)
    with pytest.raises(OperatorError, match="'pick' raised ZeroDivisionError"):
        check_select(pick)


def test_what_is_no_function_is_named():
    with pytest.raises(OperatorError, match=r"selection 'gradient' must be a function, .* it is a str"):
        check_select("gradient")


def test_what_a_student_would_write_is_accepted():
    def best_three(f, n, *, rng):
        return rng.choice(np.argsort(f)[-3:], size=n)

    def average(parents, fitness, n_children, rng):
        couples = rng.integers(len(parents), size=(n_children, 2))
        return [parents[couples].mean(axis=1), couples]

    def nudge(genomes, genes, rng):
        return genomes + 0.01 * (genes.high - genes.low) * rng.normal(size=genomes.shape)

    def best_two(fitness, n_parents, rng):
        return list(np.resize(np.argsort(-fitness)[:2], n_parents).astype(np.float32))

    def swap(parents, fitness, n_children, rng):
        mothers = np.arange(n_children) % len(parents)
        return parents[mothers].astype(object), mothers[:, None].astype(float)

    check_select(best_three)
    check_select(best_two)
    check_cross(swap, GENES)
    check_select(partial(selection.tournament, size=2))
    check_cross(average, GENES)
    check_mutate(nudge, GENES)
    check_mutate(partial(mutation.favored, favored="length"), GENES)
    check_mutate(lambda genomes, genes, *, rng: genomes, GENES)


def test_checking_spends_no_chance_of_the_run():
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    check_select(pick)
    assert np.array_equal(before, np.random.get_state()[1])  # noqa: NPY002
    assert rng().random() == rng().random()


@pytest.mark.parametrize(
    "raised", [KeyboardInterrupt, SystemExit, GeneratorExit, asyncio.CancelledError, BaseException]
)
def test_an_operator_that_raises_what_ends_programs_is_named_and_ends_none(raised):
    def mine(fitness, n_parents, *, rng):
        raise raised("stop")

    with pytest.raises(OperatorError, match=rf"selection 'mine' raised {raised.__name__}: stop \(line \d+\)"):
        selection_of(mine)


def test_ctrl_c_in_an_operator_stops_the_run():
    def mine(fitness, n_parents, *, rng):
        signal.raise_signal(signal.SIGINT)
        while True:
            pass

    with pytest.raises(KeyboardInterrupt):
        selection_of(mine)


def selection_of(select):
    return run_select(select, np.arange(9.0), 4, rng=rng())
