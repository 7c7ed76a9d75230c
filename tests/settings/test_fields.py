"""Numbers and choices are accepted, converted or rejected as their declarations say."""

import re
from functools import partial
from math import inf, nan, nextafter

import numpy as np
import pytest

from tests.settings.cases import (
    DOMAINS,
    FIELDS,
    NUMBERS,
    default,
    error_message,
    every_choice,
    every_number,
    user_function,
    with_part,
)
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Camera, Choice, Structure
from walkerlab.settings.fields import MIN_MAX
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import function_name

NEEDS = {"n_elites": {"population_size": 10_000}, "texture_density": {"texture_size": 0.3}}
"""Other settings that the end of a range requires, by field."""


def test_every_field_is_declared_with_a_meaning():
    for domain, name in FIELDS:
        declared = domain.declared()[name]
        assert declared.about
        assert declared.about[0].islower()
        assert not declared.about.endswith(".")
        assert domain.model_json_schema()["properties"][name]["description"] == declared.about
    for domain in DOMAINS.values():
        assert set(domain.declared()) == set(domain.model_fields)


@every_number
def test_an_annotation_agrees_with_its_declaration(domain, name):
    declared = domain.declared()[name]
    number = int if declared.whole else float
    wanted = tuple[(number,) * len(declared.components)] if declared.components else number
    assert domain.model_fields[name].annotation == wanted
    assert type(default(domain, name)) is (tuple if declared.components else number)
    schema = domain.model_json_schema()["properties"][name]
    assert (schema["minimum"], schema["maximum"], schema["unit"]) == (declared.low, declared.high, declared.unit)


@every_choice
def test_a_default_is_a_member_of_its_choices(domain, name):
    assert default(domain, name) in domain.declared()[name].choices


@every_number
def test_a_number_out_of_range_is_reported_with_field_value_unit_range_and_meaning(domain, name):
    declared = domain.declared()[name]
    just_under = declared.low - 1 if declared.whole else nextafter(declared.low, -inf)
    just_over = declared.high + 1 if declared.whole else nextafter(declared.high, inf)
    for bad in (just_under, just_over, nan, inf, -inf, 10**40):
        for value in with_part(domain, name, bad):
            message = error_message(domain, **{name: value})
            assert message.startswith(f"{domain.__name__}.{name}")
            assert f" is {bad}{' ' * bool(declared.unit)}{declared.unit}; it must be " in message
            low, high = re.search(r"must be between (-?\d+(?:\.\d+)?) and (\d+(?:\.\d+)?)", message).groups()
            assert (float(low), float(high)) == pytest.approx((declared.low, declared.high), rel=1e-9)
            assert message.endswith(f" It is {declared.about}.")


@every_number
def test_a_range_includes_its_ends(domain, name):
    declared = domain.declared()[name]
    ends = [declared.low, declared.high]
    if declared.components:
        ends = [tuple(ends)] if declared.components == MIN_MAX else [(end,) * len(declared.components) for end in ends]
    for end in ends:
        assert getattr(domain(**NEEDS.get(name, {}), **{name: end}), name) == end


@every_number
def test_values_that_are_not_numbers_are_rejected(domain, name):
    for bad in ("3", "3.0", True, None, 1j, [1.0], {}, np.bool_(True), np.array([1.0]), b"3"):
        for value in with_part(domain, name, bad):
            message = error_message(domain, **{name: value})
            assert message.startswith(f"{domain.__name__}.{name}")
            assert f"{bad!r}; it must be a" in message or f"{bad.item()!r}; it must be a" in message


@every_number
def test_numbers_become_plain_python_numbers_and_whole_ones_must_be_whole(domain, name):
    declared = domain.declared()[name]
    plain = int if declared.whole else float
    middle = default(domain, name)
    for kind in (np.float64, np.float32) + ((np.int64,) if declared.whole else ()):
        given = tuple(map(kind, middle)) if declared.components else kind(middle)
        got = getattr(domain(**{name: given}), name)
        assert [type(one) for one in (got if declared.components else [got])] == [plain] * max(
            1, len(declared.components)
        )
        assert got == pytest.approx(middle)
    if declared.whole:
        for value in with_part(domain, name, declared.low + 0.5):
            assert "it must be a whole number" in error_message(domain, **{name: value})


@pytest.mark.parametrize(("domain", "name"), [(d, n) for d, n in NUMBERS if d.declared()[n].components])
def test_a_pair_or_vector_requires_the_right_count_of_numbers_in_order(domain, name):
    components = domain.declared()[name].components
    good = default(domain, name)
    assert getattr(domain(**{name: list(good)}), name) == good
    assert getattr(domain(**{name: np.array(good)}), name) == good
    unordered = set(good), frozenset(good), dict.fromkeys(good), dict.fromkeys(good).keys()
    letters = [kind(b"123"[: len(components)]) for kind in (bytes, bytearray)]
    for bad in (good[:-1], (*good, good[-1]), (), good[0], "123"[: len(components)], None, *unordered, *letters):
        assert f"it must be {len(components)} numbers: {', '.join(components)}" in error_message(domain, **{name: bad})


@pytest.mark.parametrize("name", [name for name in Robot.declared() if Robot.declared()[name].components == MIN_MAX])
def test_a_min_over_its_max_is_rejected(name):
    declared = Robot.declared()[name]
    message = error_message(Robot, **{name: (declared.high, declared.low)})
    assert message.startswith(f"Robot.{name} is ({declared.high:g}, {declared.low:g})")
    assert f"the minimum, {declared.high:g}, must not exceed the maximum, {declared.low:g}." in message
    assert f" {declared.unit}; " in message or not declared.unit


def test_the_message_has_value_range_and_meaning():
    assert error_message(Terrain, step_height=0.9) == (
        "Terrain.step_height is 0.9 m; it must be between 0.01 and 0.4 m. It is the rise of each stair."
    )
    assert error_message(Algorithm, seed=-1).startswith("Algorithm.seed is -1; it must be between 0 and 2147483647. ")


@every_choice
def test_a_choice_can_be_given_as_member_name_or_code(domain, name):
    for choice in domain.declared()[name].choices:
        chosen = domain(**{name: choice})
        assert getattr(chosen, name) is choice
        for way in (choice.name, choice.value, np.int64(choice.value)):
            assert domain(**{name: way}) == chosen
            assert getattr(domain(**{name: way}), name) is choice


@every_choice
def test_an_unknown_choice_is_rejected_with_a_list_of_all_choices(domain, name):
    choices = domain.declared()[name].choices
    another_kind = next(kind for kind in (Camera, Structure) if kind is not choices)
    for bad in ("nonsense", "", 99, -1, 1.0, True, None, another_kind(0), Camera, b"side"):
        message = error_message(domain, **{name: bad})
        assert message.startswith(f"{domain.__name__}.{name} is {bad!r}; it must be one of ")
        for choice in choices:
            assert f"{choice.name} ({choice.value})" in message


@every_choice
def test_a_misspelt_choice_gets_a_suggestion(domain, name):
    for choice in domain.declared()[name].choices:
        for typo in (choice.name.upper(), choice.name + choice.name[-1]):
            assert f"Did you mean '{choice.name}'?" in error_message(domain, **{name: typo})


def test_every_choice_has_its_own_code_and_a_sentence():
    for kind in Choice.__subclasses__():
        assert [choice.value for choice in kind] == list(range(len(kind)))
        assert all(choice.about for choice in kind)


@pytest.mark.parametrize("slot", ["selection", "crossover", "mutation"])
def test_an_operator_can_be_a_choice_a_function_or_a_list_of_these(slot):
    kind = Algorithm.declared()[slot].choices
    first, second = list(kind)[:2]
    bound = partial(user_function, size=7)
    for slot_given, kept in (
        (user_function, user_function),
        (bound, bound),
        ([first], first),
        ([user_function], user_function),
        ([first, second.name, second.value, user_function], (first, second, second, user_function)),
        ((first, first), (first, first)),
    ):
        assert getattr(Algorithm(**{slot: slot_given}), slot) == kept
    for bad in ([], (), [[first]], [first, "nonsense"], [None], {first}, int):
        assert error_message(Algorithm, **{slot: bad}).startswith(f"Algorithm.{slot} is ")


def test_a_partial_is_converted_to_what_a_run_file_returns():
    """Numbers of numpy become plain, and a partial that binds nothing becomes the function."""
    for given_one, shown in (
        (partial(user_function, size=np.int64(2)), "user_function(size=2)"),
        (partial(user_function, np.float64(0.5), how=np.bool_(True)), "user_function(0.5, how=True)"),
        (partial(user_function, size=np.array(7)), "user_function(size=7)"),
    ):
        alone, first = Algorithm(selection=given_one), Algorithm(selection=[given_one, user_function])
        assert function_name(alone.selection) == function_name(first.selection[0]) == shown
        again = Settings(algorithm=alone).with_(seed=3).algorithm
        assert again.selection is alone.selection
    assert Algorithm(selection=partial(user_function)).selection is user_function


def test_functions_and_lists_are_rejected_where_the_declaration_does_not_allow_them():
    assert Algorithm(fitness=user_function).fitness is user_function
    assert "or your own function" in error_message(Algorithm, fitness="nonsense")
    for domain, name, bad in (
        (Terrain, "structure", user_function),
        (Terrain, "structure", ["flat"]),
        (Algorithm, "fitness", ["distance", "velocity"]),
    ):
        assert error_message(domain, **{name: bad}).startswith(f"{domain.__name__}.{name} is ")
