"""Each kind of bad operator gets a message that names it, what is expected, what it did, and how to fix it."""

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


def random_parents(fitness, n_parents, *, rng):
    return rng.integers(len(fitness), size=n_parents)


def named(function):
    """Set the name of a bad operator to ``mine``, as messages give it."""
    function.__name__ = "mine"
    return function


@named
def without_rng(fitness, n_parents):
    return np.zeros(n_parents, int)


@named
def with_extra_parameter(fitness, n_parents, pressure, *, rng):
    return np.zeros(n_parents, int)


@named
def returns_too_few(fitness, n_parents, *, rng):
    return np.argsort(-fitness)[:n_parents]


@named
def returns_none(fitness, n_parents, *, rng):
    pass


@named
def returns_mask(fitness, n_parents, *, rng):
    return np.ones(n_parents, bool)


@named
def returns_index_out_of_range(fitness, n_parents, *, rng):
    return random_parents(fitness, n_parents, rng=rng) + 1


@named
def returns_fractional_indices(fitness, n_parents, *, rng):
    return random_parents(fitness, n_parents, rng=rng) / 2


@named
def returns_negative_indices(fitness, n_parents, *, rng):
    return -random_parents(fitness, n_parents, rng=rng)


@named
def sorts_in_place(fitness, n_parents, *, rng):
    fitness.sort()
    return random_parents(fitness, n_parents, rng=rng)


@named
def uses_own_generator(fitness, n_parents, *, rng):
    return np.random.default_rng().integers(len(fitness), size=n_parents)


@named
def fails_for_negative_fitness(fitness, n_parents, *, rng):
    return rng.choice(len(fitness), size=n_parents, p=fitness / fitness.sum())


@named
def fails_for_equal_fitness(fitness, n_parents, *, rng):
    weights = fitness - fitness.min()
    if not weights.any():
        raise ZeroDivisionError("all weights are zero")
    return rng.choice(len(fitness), size=n_parents, p=weights / weights.sum())


@pytest.mark.parametrize(
    ("bad", "expected", "got", "fix"),
    [
        (without_rng, "a function select(fitness, n_parents, *, rng)", "mine(fitness, n_parents)", "functools.partial"),
        (with_extra_parameter, "a function select(", "missing a required argument: 'pressure'", "functools.partial"),
        (
            returns_too_few,
            "n_parents = 200 parents, an array of shape (200,)",
            "shape (20,)",
            "np.resize(selected, n_parents)",
        ),
        (returns_none, "n_parents = 18 parents", "nothing (None)", "np.resize"),
        (returns_mask, "whole numbers from 0 to 19", "shape (18,), bool", "np.flatnonzero(mask)"),
        (
            returns_index_out_of_range,
            "whole numbers from 0 to 19",
            "one of the values it returned is 20",
            "rng.integers(len(fitness)",
        ),
        (
            returns_index_out_of_range,
            "0 to 19",
            "when tried on a trial population of 20 individuals",
            "rng.integers(len(fitness)",
        ),
        (returns_fractional_indices, "whole numbers from 0 to 19", "float64", "np.argsort returns indices"),
        (
            returns_negative_indices,
            "whole numbers from 0 to 19",
            "one of the values it returned is -",
            "rng.integers(len(fitness)",
        ),
        (sorts_in_place, "not modify its arguments", "it tried to (line ", "fitness.copy()"),
        (uses_own_generator, "the same result for the same rng", "it returned two different", "rng.random()"),
    ],
)
def test_a_bad_selection_is_explained(bad, expected, got, fix):
    with pytest.raises(OperatorError) as caught:
        check_select(bad)
    for words in ("selection 'mine' must", expected, got, fix):
        assert words in str(caught.value)


@pytest.mark.parametrize(
    ("bad", "raised", "n_lines_down"),
    [
        (fails_for_negative_fitness, "ValueError: ", 2),
        (fails_for_equal_fitness, "ZeroDivisionError: all weights are zero", 4),
        (partial(fails_for_equal_fitness), "ZeroDivisionError: all weights are zero", 4),
    ],
)
def test_an_exception_in_a_selection_is_reported_with_its_line_and_the_trial_population(bad, raised, n_lines_down):
    code = getattr(bad, "func", bad).__code__
    with pytest.raises(OperatorError) as caught:
        check_select(bad)
    message = str(caught.value)
    assert message.startswith(f"selection 'mine' raised {raised}")
    assert f" (line {code.co_firstlineno + n_lines_down}), when tried on" in message
    assert "negative and equal fitness. It must work on every population." in message


def copied_parents(parents, n_children):
    children = np.resize(parents, (n_children, parents.shape[1]))
    return children, np.arange(n_children)[:, None] % len(parents)


@named
def returns_children_only(parents, fitness, n_children, *, rng):
    return copied_parents(parents, n_children)[0]


@named
def returns_flat_parents(parents, fitness, n_children, *, rng):
    children, origins = copied_parents(parents, n_children)
    return children, origins[:, 0]


@named
def returns_too_few_children(parents, fitness, n_children, *, rng):
    return copied_parents(parents, n_children // 2)


@named
def returns_parents_out_of_range(parents, fitness, n_children, *, rng):
    children, origins = copied_parents(parents, n_children)
    return children, origins + 1


@named
def returns_nan(parents, fitness, n_children, *, rng):
    children, origins = copied_parents(parents, n_children)
    return children * np.nan, origins


@named
def returns_ragged_rows(parents, fitness, n_children, *, rng):
    return [[1.0, 2.0], [3.0]] * 10, copied_parents(parents, n_children)[1]


@named
def crosses_in_place(parents, fitness, n_children, *, rng):
    parents[0] = parents[1]
    return copied_parents(parents, n_children)


@pytest.mark.parametrize(
    ("bad", "expected", "got", "fix"),
    [
        (returns_children_only, "two arrays", "an array of shape (20, 18)", "return children, parents_of_each"),
        (returns_flat_parents, "(n_children, k) = (20, k)", "shape (20,)", "mothers[:, None]"),
        (returns_too_few_children, "(n_children, n_genes) = (20, 18)", "shape (10, 18)", "axis=0"),
        (
            returns_parents_out_of_range,
            "indices of the given parents, whole numbers from 0 to 19",
            "one of the values it returned is 20",
            "rng.integers(len(fitness)",
        ),
        (returns_nan, "finite numbers", "one of the values it returned is nan", "division by zero"),
        (crosses_in_place, "not modify its arguments", "it tried to (line ", "parents.copy()"),
        (returns_ragged_rows, "(n_children, n_genes) = (20, 18)", "a list: [[1.0, 2.0], [3.0]", "axis=0"),
    ],
)
def test_a_bad_crossover_is_explained(bad, expected, got, fix):
    with pytest.raises(OperatorError) as caught:
        check_cross(bad, GENES)
    for words in ("crossover 'mine' must", expected, got, fix):
        assert words in str(caught.value)


@named
def mutates_in_place(genomes, genes, *, rng):
    genomes += rng.normal(size=genomes.shape)
    return genomes


@named
def without_return(genomes, genes, *, rng):
    genomes + rng.normal(size=genomes.shape)


@named
def returns_transposed(genomes, genes, *, rng):
    return genomes.T


@named
def returns_complex_numbers(genomes, genes, *, rng):
    return np.emath.sqrt(-genomes)


@pytest.mark.parametrize(
    ("bad", "expected", "got", "fix"),
    [
        (mutates_in_place, "not modify its arguments", "it tried to", "genomes.copy(); +="),
        (without_return, "(n, n_genes) = (20, 18)", "nothing (None)", "a missing return"),
        (returns_transposed, "(n, n_genes) = (20, 18)", "shape (18, 20)", "Each row is one individual"),
        (returns_complex_numbers, "numbers of shape", "complex128", "Each row"),
    ],
)
def test_a_bad_mutation_is_explained(bad, expected, got, fix):
    with pytest.raises(OperatorError) as caught:
        check_mutate(bad, GENES)
    for words in ("mutation 'mine' must", expected, got, fix):
        assert words in str(caught.value)


def test_an_exception_in_a_mutation_is_reported_without_mentioning_fitness():
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
        ("np.random", lambda: np.random.normal()),  # noqa: NPY002  # draws two numbers and stores one for the next call
        ("random", lambda: random.random()),
    ],
)
@pytest.mark.parametrize(
    ("slot", "check", "shifted_by"),
    [
        (
            "selection",
            check_select,
            lambda shift, fitness, n: np.random.default_rng(int(1e9 * abs(shift))).integers(len(fitness), size=n),
        ),
        (
            "crossover",
            partial(check_cross, genes=GENES),
            lambda shift, parents, fitness, n: copied_parents(parents + shift, n),
        ),
        ("mutation", partial(check_mutate, genes=GENES), lambda shift, genomes, genes: genomes + shift),
    ],
    ids=["selection", "crossover", "mutation"],
)
def test_an_operator_that_uses_a_shared_random_generator_is_named(slot, check, shifted_by, name, draw):
    with pytest.raises(OperatorError) as caught:
        check(named(lambda *given, rng: shifted_by(draw(), *given)))
    message = str(caught.value)
    assert message.startswith(f"{slot} 'mine' used {name}, shared with all other Python code")
    assert "rng.random(), rng.integers(n), rng.normal()" in message


@pytest.mark.parametrize("busy", [False, True], ids=["once", "all the time"])
def test_an_operator_is_accepted_if_only_other_code_uses_the_shared_generator(busy):
    stopped = threading.Event()
    others = []

    def draws():
        while not stopped.is_set():
            np.random.random()  # noqa: NPY002

    def mine(genomes, genes, *, rng):
        if not others:
            others.append(threading.Thread(target=draws) if busy else np.random.random())  # noqa: NPY002
            if busy:
                others[0].start()
        stopped.wait(0.005)  # time for the other thread to draw
        return genomes + rng.normal(size=genomes.shape)

    try:
        check_mutate(mine, GENES)
    finally:
        stopped.set()
    assert others


def test_an_operator_that_never_returns_is_reported_with_its_line_and_the_time_limit(monkeypatch):
    monkeypatch.setenv("WALKERLAB_PATIENCE", "0.1")
    cell = (
        "def my_mutation(genomes, genes, *, rng):\n    n = 0\n    while n < 5:\n        m = n + 1\n    return genomes\n"
    )
    exec(compile(cell, "<cell>", "exec"), mine := {})
    with pytest.raises(OperatorError) as caught:
        check_mutate(mine["my_mutation"], GENES)
    message = str(caught.value)
    assert re.match(
        r"mutation 'my_mutation' had not returned after 0\.1 s \(line [34]\), when tried on a trial", message
    )
    assert (
        "a loop that never ends. If it needs more time, set os.environ['WALKERLAB_PATIENCE'] = '600' before" in message
    )


def test_our_operators_are_called_in_the_thread_of_the_caller(monkeypatch):
    monkeypatch.setattr(user_functions, "call_with_limit", lambda call, seconds: 1 / 0)
    check_select(partial(selection.tournament, size=2))
    check_mutate(partial(mutation.favored, favored="length"), GENES)
    with pytest.raises(OperatorError, match="'random_parents' raised ZeroDivisionError"):
        check_select(random_parents)


def test_a_value_that_is_not_a_function_is_named():
    with pytest.raises(OperatorError, match=r"selection 'gradient' must be a function, .* it is a str"):
        check_select("gradient")


def test_simple_user_operators_are_accepted():
    def best_three(f, n, *, rng):
        return rng.choice(np.argsort(f)[-3:], size=n)

    def average(parents, fitness, n_children, rng):
        couples = rng.integers(len(parents), size=(n_children, 2))
        return [parents[couples].mean(axis=1), couples]

    def gaussian(genomes, genes, rng):
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
    check_mutate(gaussian, GENES)
    check_mutate(partial(mutation.favored, favored="length"), GENES)
    check_mutate(lambda genomes, genes, *, rng: genomes, GENES)


def test_a_check_does_not_draw_from_the_generators_of_the_run():
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    check_select(random_parents)
    assert np.array_equal(before, np.random.get_state()[1])  # noqa: NPY002
    assert rng().random() == rng().random()


@pytest.mark.parametrize(
    "raised", [KeyboardInterrupt, SystemExit, GeneratorExit, asyncio.CancelledError, BaseException]
)
def test_an_operator_that_raises_an_exit_exception_is_named_and_does_not_end_the_program(raised):
    def mine(fitness, n_parents, *, rng):
        raise raised("stop")

    with pytest.raises(OperatorError, match=rf"selection 'mine' raised {raised.__name__}: stop \(line \d+\)"):
        run_selection(mine)


def test_ctrl_c_in_an_operator_stops_the_run():
    def mine(fitness, n_parents, *, rng):
        signal.raise_signal(signal.SIGINT)
        while True:
            pass

    with pytest.raises(KeyboardInterrupt):
        run_selection(mine)


def run_selection(select):
    return run_select(select, np.arange(9.0), 4, rng=rng())
