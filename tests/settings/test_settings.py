"""Single settings are changed by name in any domain; values of whole domains are checked."""

import re

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.settings.cases import (
    CHOICES,
    DOMAINS,
    NAMESPACE,
    error_message,
    every_field,
)
from tests.strategies import all_settings, robots
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Crossover, Fitness, Mutation
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import COMMON_NAMES, Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain


def test_each_setting_has_a_unique_name_and_the_algorithm_has_the_shared_one():
    locations = Settings.field_locations()
    assert sorted(locations.values()) == sorted(
        (keyword, name) for keyword in DOMAINS for name in DOMAINS[keyword].declared()
    )
    assert locations["seed"] == ("algorithm", "seed")
    both = Settings().with_(seed=3, terrain_seed=4)
    assert (both.algorithm.seed, both.terrain.seed) == (3, 4)


@pytest.mark.parametrize("keyword", DOMAINS)
def test_a_wrong_domain_is_reported_together_with_all_other_errors(keyword):
    kind = DOMAINS[keyword]
    other = DOMAINS["robot" if keyword == "terrain" else "terrain"]()
    for bad in ("stairs", None, [], 3, kind, other, {1}):
        expected = f"Settings.{keyword} is {bad!r}; it must be a {kind.__name__}, or a dict of its settings."
        assert error_message(Settings, **{keyword: bad}).startswith(expected)
        singles = {"incline": 99, "weight": 1, "seed": -1, "duration": 0}
        first, *rest = error_message(Settings().with_, **singles, **{keyword: bad}, no_such=1).splitlines()
        assert first.startswith(expected)
        assert len(rest) == len(singles) + 1
        error_message(Settings().with_, **{keyword: bad}, incline=5, weight=(3, 4), seed=1, duration=4)


def test_a_choice_given_for_its_domain_gets_a_suggestion():
    for domain, name in CHOICES:
        for choice in domain.declared()[name].choices:
            keyword = domain.__name__.lower()
            message = error_message(Settings, **{keyword: choice.name})
            fix = re.search(r"Did you mean (.*)\?$", message).group(1)
            assert choice.name in eval(f"dict({fix})", NAMESPACE)[keyword].model_dump().values()


@pytest.mark.parametrize(("guessed", "name"), COMMON_NAMES.items())
def test_a_name_that_is_easily_guessed_wrong_gets_the_right_one(guessed, name):
    assert guessed not in Settings.field_locations()
    assert f"Did you mean {name!r}?" in error_message(Settings().with_, **{guessed: 3})
    assert name in Settings.field_locations()


@every_field
def test_a_setting_given_outside_its_domain_is_reported_with_its_domain(domain, name):
    keyword = domain.__name__.lower()
    word = next(word for word, place in Settings.field_locations().items() if place == (keyword, name))
    assert f"{keyword}={domain.__name__}({name}=…)" in error_message(Settings, **{word: 1})


@hypothesis_settings(max_examples=60)
@given(all_settings, all_settings, st.sampled_from(list(Settings.field_locations())))
def test_with_changes_only_the_named_setting(settings, others, word):
    domain, name = Settings.field_locations()[word]
    settings = settings.with_(robot=Robot(), terrain=Terrain(texture_size=0.3))  # so that any single change is allowed
    value = getattr(getattr(others, domain), name)
    if domain == "robot":
        value = getattr(Robot(), name)
    if name in ("population_size", "n_elites"):
        settings = settings.with_(population_size=10_000, n_elites=0)
        value = max(value, 4) if name == "population_size" else value
    before = settings.model_dump()
    changed = settings.with_(**{word: value})
    assert settings.model_dump() == before
    assert getattr(getattr(changed, domain), name) == value
    after = changed.model_dump()
    after[domain][name] = before[domain][name]
    assert after == before


@given(robots(), robots())
@hypothesis_settings(max_examples=30)
def test_with_changes_a_domain_and_single_settings_of_it_together(one, other):
    changed = Settings(robot=one).with_(robot=other, leg_force=one.leg_force, duration=3)
    assert dict(changed.robot) == dict(other) | {"leg_force": one.leg_force}
    assert changed.simulation == Simulation(duration=3.0)
    assert changed.with_(**dict(one)).robot == one


def test_settings_are_equal_if_given_as_objects_or_plain_data():
    a = Settings(terrain=Terrain(structure="stairs"), algorithm=Algorithm(fitness=1, crossover="weighted"))
    b = Settings(terrain={"structure": 2}, algorithm={"fitness": Fitness.velocity, "crossover": [Crossover.weighted]})
    assert a == b
    assert hash(a) == hash(b)
    assert a != b.with_(mutation=Mutation.macro)
