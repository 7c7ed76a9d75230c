"""Bound arguments return unchanged from a run file, or are rejected before any walk, with the reason."""

import enum
import json
import os
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import walkerlab as wl
from walkerlab.settings import binding, choices
from walkerlab.settings.binding import BoundFunction
from walkerlab.settings.choices import Choice

SETTINGS = wl.Settings().with_(duration=1, population_size=4, generations=1, n_elites=1)
KINDS = {kind.__name__: kind for kind in Choice.__subclasses__() if kind.__module__ == choices.__name__}
plain = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9) | st.sampled_from(wl.Feature)
arrays = st.sampled_from(["bool", "int8", "uint64", "float32", "float64"]).flatmap(
    lambda dtype: st.sampled_from([np.zeros((0, 3), dtype), np.ones((2, 1, 2), dtype), np.arange(3).astype(dtype)])
)
values = st.recursive(
    plain | arrays,
    lambda inner: st.lists(inner, max_size=3) | st.tuples(inner, inner) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=6,
)


def scaled(walk, *_, k=(1.0,), **__):
    return walk.distance


class Colour(enum.IntEnum):
    red = 1


def text(value):
    return binding.arguments_key(BoundFunction(scaled, value))


@given(values)
def test_a_value_returns_unchanged_from_json_and_from_python_code(value):
    copy = binding.plain_copy(value)
    written = json.dumps(binding.to_json_data(copy), allow_nan=False)
    for again in (
        binding.from_json_data(json.loads(written), KINDS),
        eval(binding.as_python(copy), {"np": np, "wl": wl}),
    ):
        assert type(again) is type(copy)
        assert text(again) == text(copy) == text(value)
        np.testing.assert_equal(again, copy)


@given(values, values)
def test_bound_functions_are_equal_exactly_if_their_values_are(one, other):
    first, second = (BoundFunction(scaled, k=value) for value in (one, other))
    assert first == BoundFunction(scaled, k=one) == partial(scaled, k=one)
    assert hash(first) == hash(BoundFunction(scaled, k=one))
    assert (first == second) == (text(one) == text(other))
    assert first != BoundFunction(wl.fitness.distance, k=one)


@pytest.mark.parametrize(
    ("one", "other"), [(1, 1.0), (1, True), ((1,), [1]), (0.0, -0.0), ("1", 1), ([1], np.array([1]))]
)
def test_values_that_are_equal_in_python_but_of_different_types_differ(one, other):
    assert text(one) != text(other)


@pytest.mark.parametrize(("bad", "description"), [
    (scaled, "a function"), (object(), "an object"), (b"x", "a bytes"), ({1}, "a set"), (1j, "a complex"),
    (range(3), "a range"), (Colour.red, "a Colour"), (Colour, "an EnumType"), (os, "a module"), (open, "a builtin"),
    ({1: 2}, "a dict with an int as key"), ([[scaled]], "a function"), (np.array(["a"]), "an array of dtype"),
    (np.array([scaled]), "an array of dtype object"), (10**400, "an int of 1329 bits"),
    ([0] * 2000, "a list of 2000 items"), (np.zeros(2000), "2000 items"), ("x" * 20_000, "a str of 20000"),
    ([[[[[[[[[[1]]]]]]]]]], "nested"), (chr(0xD800), "surrogate"), (np.longdouble(1), "a longdouble"),
], ids=lambda value: value if isinstance(value, str) and len(value) < 99 and value.isascii() else "")  # fmt: skip
def test_a_value_that_a_run_file_cannot_hold_is_rejected_with_a_fix(bad, description):
    for slot, bound, name in (
        ("fitness", partial(scaled, k=bad), "'k'"),
        ("mutation", partial(scaled, 1, bad), "number 2"),
        ("selection", ["rank", partial(scaled, k=bad)], "'k'"),
    ):
        with pytest.raises(wl.SettingsError, match=rf"^Algorithm\.{slot} binds the argument {name} to .*def") as caught:
            SETTINGS.with_(**{slot: bound})
        assert description in str(caught.value)


def test_a_list_that_contains_itself_is_rejected():
    endless = []
    endless.append(endless)
    with pytest.raises(wl.SettingsError, match="nested"):
        SETTINGS.with_(fitness=partial(scaled, k=endless))


def test_bound_values_do_not_change_with_the_objects_they_were_copied_from():
    numbers = [1.0]
    table = np.ones(2)
    bound = partial(scaled, k=numbers, table=table)
    fitness = SETTINGS.with_(fitness=bound).algorithm.fitness
    before = binding.arguments_key(fitness)
    numbers.append(2.0)
    table[:] = 7
    bound.keywords["k"] = fitness.keywords["k2"] = 5
    assert binding.arguments_key(fitness) == before
    with pytest.raises(ValueError, match="read-only"):
        fitness.keywords["table"][0] = 7


@pytest.mark.parametrize(
    "value",
    [(2.0,), np.array([2.0]), [1, "a"], {"k": (1,)}, float("inf"), float("nan"), None, wl.Feature.length, "(2.0,)"],
    ids=repr,
)  # fmt: skip
def test_a_run_with_bound_values_resumes_with_the_code_in_its_error_message(value, tmp_path):
    path = tmp_path / "run.walk"
    settings = SETTINGS.with_(fitness=partial(scaled, k=value))
    with ThreadPoolExecutor(1) as threads:
        wl.evolve(settings, path, threads, progress=False)
        with pytest.raises(wl.RunFileError, match="pass the functions under the same names") as caught:
            wl.resume(path, 2, threads, progress=False)
        recipe = str(caught.value).partition(", fitness=")[2].partition("). To view")[0]
        given_back = eval(recipe, {"np": np, "wl": wl, "partial": partial, "scaled": scaled})
        other = partial(scaled, k=[*"another"])
        with pytest.raises(wl.RunFileError, match="pass the functions under the same names"):
            wl.resume(path, 2, threads, progress=False, fitness=other)
        run = wl.resume(path, 2, threads, progress=False, fitness=given_back)
    assert run.n_generations == 2
    assert run.settings == settings.with_(generations=2)
    assert b" at 0x" not in path.read_bytes()


def renamed(name):
    def fitness(walk, **_):
        return walk.distance

    fitness.__name__ = name
    return fitness


@pytest.mark.parametrize(
    "fitness", [renamed("max"), renamed("two words"), renamed("\x1b[2J"), partial(scaled, **{"two words": 1})]
)
def test_a_function_name_that_cannot_be_stored_is_rejected_before_any_walk(fitness, tmp_path):
    with (
        ThreadPoolExecutor(1) as threads,
        pytest.raises(wl.SettingsError, match=r"fitness cannot be stored .* Rename it"),
    ):
        wl.evolve(SETTINGS.with_(fitness=fitness), tmp_path / "run.walk", threads, progress=False)


def test_too_many_characters_are_rejected_before_any_walk():
    def mutate(genomes, genes, *, rng, k=()):
        return genomes

    many = [partial(mutate, k=[place] * 1000) for place in range(50)]
    with ThreadPoolExecutor(1) as threads, pytest.raises(wl.SettingsError, match="characters to store"):
        wl.Evolution(SETTINGS.with_(mutation=many), executor=threads)


@pytest.mark.parametrize("hostile", [
    {"tuple": 1}, {"tuple": [], "more": 1}, {"nonsense": []}, {"choice": "Feature.__class__"}, {"choice": "os.system"},
    {"float": "1e9"}, {"array": [1], "shape": [-1], "dtype": "float64"}, {"array": [1], "shape": [2], "dtype": "int8"},
    {"array": [10**30], "shape": [1], "dtype": "int8"}, {"array": [[1], 2], "shape": [2], "dtype": "int8"},
    {"array": ["os"], "shape": [1], "dtype": "object"}, {"array": [], "shape": [0] * 99, "dtype": "int8"},
    {"dict": {"k": {"float": 1}}},
])  # fmt: skip
def test_invalid_stored_data_are_rejected(hostile):
    with pytest.raises(ValueError):  # noqa: PT011
        binding.from_json_data(hostile, KINDS)
