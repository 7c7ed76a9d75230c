"""Settings are immutable, report all errors together, and return unchanged from JSON and from their own code."""

import json
import pydoc
import re
from functools import partial
from math import nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings

from tests.settings.cases import (
    DOMAINS,
    FIELDS,
    NAMESPACE,
    NUMBERS,
    default,
    error_message,
    every_field,
    user_function,
    with_part,
)
from tests.strategies import all_settings
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Choice, Crossover, Selection
from walkerlab.settings.fields import OneOf
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import code_text


@pytest.mark.parametrize("domain", DOMAINS.values())
def test_help_lists_each_setting_with_default_meaning_and_range_without_pydantic(domain):
    text = pydoc.plain(pydoc.render_doc(domain))
    one_line = re.sub(r"[\s|]+", " ", text)
    for name, declared in domain.declared().items():
        about = declared.about[0].upper() + declared.about[1:]
        own = ", or your own function" if getattr(declared, "functions", False) else ""
        see = f"; see help(wl.{declared.choices.__name__})" if isinstance(declared, OneOf) else ""
        assert f" {name} = {code_text(default(domain, name))} {about}. Allowed: {declared.range}{own}{see}." in one_line
        assert f"{name}: typing.Annotated" not in text
    assert "model_dump" not in text
    assert len(text.splitlines()) < 100


def test_help_of_a_choice_lists_each_member_with_its_code_and_meaning():
    for choices in Choice.__subclasses__():
        text = pydoc.plain(pydoc.render_doc(choices))
        assert all(f" {choice.name} ({choice.value}): {choice.about}" in text for choice in choices)


def test_all_errors_of_one_call_are_reported_together():
    beyond = {
        keyword: {
            name: next(with_part(domain, name, nan)) if (domain, name) in NUMBERS else "nonsense"
            for name in domain.declared()
        }
        for keyword, domain in DOMAINS.items()
    }
    everything = [f"{domain.__name__}.{name}" for domain, name in FIELDS]
    lines = error_message(Settings, **beyond).splitlines()
    assert [re.match(r"\w+\.\w+", line).group() for line in lines] == everything

    flat = {word: beyond[domain][name] for word, (domain, name) in Settings.field_locations().items()}
    assert len(error_message(Settings().with_, **flat, no_such=1).splitlines()) == len(everything) + 1


def test_all_errors_within_one_setting_are_reported_together():
    x, z = error_message(Terrain, gravity=(99, 0, nan)).splitlines()
    assert x.startswith("Terrain.gravity's x is 99 m/s²; it must be between -30 and 30 m/s².")
    assert z.startswith("Terrain.gravity's z is nan m/s²; it must be between -30 and 30 m/s².")
    assert len(error_message(Robot, weight=("heavy", -1), legs=(0, 99)).splitlines()) == 4


@every_field
def test_an_unknown_name_gets_a_suggestion(domain, name):
    for typo in (name[:-1], name + "s", name.capitalize(), name.replace("_", "")):
        if typo in domain.declared():
            continue
        wanted = f"has no setting '{typo}'. Did you mean '{name}'?"
        assert wanted in error_message(domain, **{typo: 1})
        assert wanted in error_message(Settings, **{typo: 1})
        assert wanted in error_message(Settings().with_, **{typo: 1})


def test_a_name_without_a_close_match_gets_the_list_of_names():
    assert "It has structure, incline," in error_message(Terrain, qqq=1)
    assert "It has terrain, robot, algorithm, simulation." in error_message(Settings().with_, qqq=1)
    assert "Did you mean 'terrain'?" in error_message(Settings, terain={})


@hypothesis_settings(max_examples=60)
@given(all_settings)
def test_settings_return_unchanged_from_json(settings):
    text = settings.model_dump_json()
    assert Settings(**json.loads(text)) == settings
    assert Settings.model_validate_json(text) == settings
    assert json.loads(text) == settings.model_dump()


def test_json_has_choices_by_name_and_functions_by_module_name_and_arguments():
    bound = partial(user_function, size=np.int64(7), table=np.ones(2), how="fast")
    algorithm = Algorithm(
        fitness=user_function,
        selection=[Selection.top_half, bound],
        crossover=Crossover.paired,
        mutation=lambda genomes: genomes,
    )
    settings = Settings(algorithm=algorithm)
    plain = json.loads(settings.model_dump_json())["algorithm"]
    assert plain == json.loads(json.dumps(settings.model_dump()))["algorithm"]
    assert plain["crossover"] == "paired"
    assert plain["fitness"] == {"function": f"{user_function.__module__}.user_function", "with": {}}
    with_it = {"size": 7, "table": {"array": [1.0, 1.0], "shape": [2], "dtype": "float64"}, "how": "fast"}
    positional = Algorithm(selection=partial(user_function, np.int64(3), "x", size=7)).model_dump()["selection"]
    assert positional == {
        "function": f"{user_function.__module__}.user_function",
        "with": {"size": 7},
        "args": [3, "x"],
    }
    assert plain["selection"] == [
        "top_half",
        {"function": f"{user_function.__module__}.user_function", "with": with_it},
    ]
    assert plain["mutation"] == {"function": f"{__name__}.<lambda>", "with": {}}
    assert (
        len(error_message(Algorithm, **plain).splitlines()) == 3
    )  # the name of a function is never taken for the function


@every_field
def test_settings_cannot_be_assigned(domain, name):
    settings = domain()
    whole = Settings()
    keyword = domain.__name__.lower()
    for changed, attribute, value in ((settings, name, default(domain, name)), (whole, keyword, settings)):
        message = error_message(setattr, changed, attribute, value)
        assert f"{type(changed).__name__}.{attribute} cannot be assigned: settings never change" in message
    assert (settings, whole) == (domain(), Settings())


def test_the_suggested_code_for_an_assignment_works():
    s = Settings()
    stairs = Terrain(structure="stairs")
    for changed, name, value in ((s.algorithm, "seed", 3), (s, "seed", 3), (s, "terrain", stairs)):
        fix = error_message(setattr, changed, name, value).rpartition(" s = ")[2]
        assert eval(fix, NAMESPACE | {"s": s}) == s.with_(**{name: value})


def test_each_way_to_make_settings_reports_the_same_errors():
    for kind, bad in ((Settings, {"terrain": {"incline": 99}, "no_such": 1}), (Terrain, {"incline": 99, "sep": 2})):
        expected = error_message(kind, **bad)
        assert (
            error_message(kind.model_validate, bad)
            == error_message(kind.model_validate_json, json.dumps(bad))
            == expected
        )
    assert "Invalid JSON" in error_message(Settings.model_validate_json, "{no")
    assert error_message(Settings.model_validate, 3).startswith("Settings is 3; ")


@hypothesis_settings(max_examples=100)
@given(all_settings)
def test_the_representation_is_code_that_makes_the_same_settings(settings):
    assert eval(repr(settings), NAMESPACE) == settings
    assert str(settings) == repr(settings)


def test_the_representation_has_only_changes_with_choices_and_functions_by_name():
    assert repr(Terrain(structure=2)) == "Terrain(structure='stairs')"
    algorithm = Algorithm(fitness=user_function, mutation=["macro", partial(user_function, 1, size=np.int64(7))])
    assert repr(algorithm) == "Algorithm(fitness=user_function, mutation=('macro', partial(user_function, 1, size=7)))"
    assert repr(Settings()) == "Settings()"
