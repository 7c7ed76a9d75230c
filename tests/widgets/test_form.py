"""The form follows its controls, reports invalid values next to them, and survives any message of a browser."""

import json
import re
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from traitlets import TraitError

from tests.strategies import all_settings
from walkerlab.ga.selection import tournament
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Structure
from walkerlab.settings.fields import OneOf
from walkerlab.settings.model import SettingsError
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain
from walkerlab.widgets.controls import FUNCTION_PREFIX, make_controls, unused_settings
from walkerlab.widgets.form import DOMAINS as DOMAINS_BY_NAME
from walkerlab.widgets.form import Form
from walkerlab.widgets.presets import PRESETS

DOMAINS = (Terrain, Robot, Algorithm, Simulation)


def setting_names():
    return [f"{domain}.{field}" for domain, field in Settings.field_locations().values()]


def controls(form):
    return {f"{tab['domain']}.{control['name']}": control for tab in form.tabs for control in tab["controls"]}


def send(form, **values):
    """Send all values as a browser does, some of them changed (``terrain__step_height=0.2``)."""
    sent = json.loads(json.dumps(form.values))
    for setting, value in values.items():
        domain, _, field = setting.partition("__")
        sent[domain][field] = value
    form.set_state({"values": json.loads(json.dumps(sent))})


# -------------------------------------------------------------------------------------------------- controls


def test_every_setting_has_a_control():
    assert list(controls(Form())) == setting_names()


def test_each_tab_describes_its_domain_in_one_sentence():
    for tab in Form().tabs:
        assert re.fullmatch(r"[A-Z][^.]*\.", tab["about"])


@pytest.mark.parametrize("kind", DOMAINS)
def test_every_control_agrees_with_the_declaration_of_its_setting(kind):
    for control in make_controls(kind):
        declared = kind.declared()[control["name"]]
        assert control["about"].split()[-1] == declared.about.split()[-1]
        assert kind.declared()[control["name"]](control["default"]) == kind.model_fields[control["name"]].default
        if isinstance(declared, OneOf):
            offered = {option["name"] for option in control["options"]} | ({"none"} & set(declared.choices.__members__))
            assert offered == set(declared.choices.__members__)
            assert all(option["about"] for option in control["options"])
        else:
            assert (control["low"], control["high"], control["unit"]) == (declared.low, declared.high, declared.unit)


@pytest.mark.parametrize("kind", DOMAINS)
def test_a_slider_covers_its_range_in_visible_steps_and_stops_at_the_default(kind):
    for control in make_controls(kind):
        if "stops" in control:
            stops = control["stops"]
            default = control["default"]
            assert stops == sorted(set(stops))
            assert (stops[0], stops[-1]) == (control["low"], control["high"])
            assert set(default if isinstance(default, list) else [default]) <= set(stops)
            assert len(stops) <= 160
            assert len(stops) >= min(50, control["high"] - control["low"] + 1) or control["whole"]
            assert not control["whole"] or all(stop == int(stop) for stop in stops)


def test_a_wide_range_has_the_same_number_of_stops_in_each_decade():
    (weight,) = (control for control in make_controls(Robot) if control["name"] == "weight")
    assert [sum(low <= stop < 10 * low for stop in weight["stops"]) for low in (0.1, 1, 10)] == [35, 35, 35]


def test_the_traits_for_the_browser_are_plain_data():
    form = Form(Settings().with_(selection=tournament, mutation=["micro", partial(tournament, size=7)]))
    for trait in ("tabs", "values", "faults", "unused", "presets"):
        assert json.loads(json.dumps(getattr(form, trait))) == getattr(form, trait)


@pytest.mark.parametrize(
    ("only", "locations"),
    [
        (["step_height"], ["terrain.step_height"]),
        (["seed", "terrain_seed"], ["terrain.seed", "algorithm.seed"]),
        (["simulation"], [f"simulation.{name}" for name in Simulation.model_fields]),
        ("legs", ["robot.legs"]),
    ],
)
def test_a_form_of_some_settings_keeps_the_others(only, locations):
    form = Form(Settings().with_(duration=5, legs=(4, 6)), only=only)
    assert list(controls(form)) == locations
    send(form, terrain__step_height=0.2)
    assert form.settings == Settings().with_(duration=5, legs=(4, 6), step_height=0.2)


def test_an_unknown_setting_is_reported_with_a_similar_name():
    with pytest.raises(ValueError, match=r"no setting 'step_hight'.* 'step_height'"):
        Form(only=["step_hight"])


# ------------------------------------------------------------------------------------------------ settings


@given(all_settings)
@settings(max_examples=60, deadline=None)
def test_settings_survive_a_round_trip_through_the_controls(expected_settings):
    form = Form()
    form.settings = expected_settings
    assert form.settings == expected_settings
    assert form.fault == ""
    values = json.loads(json.dumps(form.values))
    other = Form()
    other.set_state({"values": values})
    assert other.settings == expected_settings
    assert other.values == values


def test_a_changed_control_notifies_once():
    form = Form()
    notified = []
    form.observe(lambda change: notified.append(change.new), "settings")
    send(form, terrain__step_height=0.2)
    send(form, terrain__step_height=0.2)
    assert notified == [Settings().with_(step_height=0.2)]


def test_setting_settings_changes_the_controls_and_notifies_once():
    form = Form()
    notified = []
    form.observe(lambda change: notified.append(change.new), "settings")
    form.settings = Settings().with_(structure="stairs")
    assert form.values["terrain"]["structure"] == "stairs"
    assert notified == [Settings().with_(structure="stairs")]


def test_settings_of_another_type_are_rejected():
    with pytest.raises(TraitError):
        Form().settings = {"terrain": {}}


def user_selection(fitness, n_parents, *, rng):
    return rng.permutation(n_parents)


def test_user_functions_are_options_and_stay_when_other_settings_change():
    sharp = partial(tournament, size=7)
    expected_settings = Settings().with_(selection=[sharp, "rank", user_selection], fitness=user_selection)
    form = Form(expected_settings)
    assert form.values["algorithm"]["selection"] == [
        f"{FUNCTION_PREFIX}tournament(size=7)",
        "rank",
        f"{FUNCTION_PREFIX}user_selection",
    ]
    offered = [option["name"] for option in controls(form)["algorithm.selection"]["options"]]
    assert offered[-2:] == [f"{FUNCTION_PREFIX}tournament(size=7)", f"{FUNCTION_PREFIX}user_selection"]
    send(form, simulation__duration=5)
    assert form.settings == expected_settings.with_(duration=5)
    send(form, algorithm__selection="gradient")
    send(form, algorithm__selection=["uniform", f"{FUNCTION_PREFIX}user_selection"])
    assert form.settings == expected_settings.with_(duration=5, selection=["uniform", user_selection])


def test_functions_of_the_same_name_are_distinguished():
    first, second, third = ((lambda fitness, n, *, rng: None) for _ in range(3))
    form = Form(Settings().with_(selection=[first, second, first]))
    assert form.values["algorithm"]["selection"] == [
        f"{FUNCTION_PREFIX}<lambda>",
        f"{FUNCTION_PREFIX}<lambda>′",
        f"{FUNCTION_PREFIX}<lambda>",
    ]
    assert form.settings.algorithm.selection == (first, second, first)
    form.settings = Settings().with_(selection=third)
    form.settings = Settings().with_(selection=first)
    assert form.settings.algorithm.selection is first


def test_a_function_that_was_not_given_is_rejected():
    form = Form()
    send(form, algorithm__selection=f"{FUNCTION_PREFIX}system")
    assert form.settings is None
    assert "algorithm.selection" in form.faults


# ------------------------------------------------------------------------------------------ invalid values

CLASHES = [
    {"texture_density": 0.9, "texture_size": 0.02},
    {"structure": "stairs", "step_depth": 0.1, "texture_density": 0.2, "texture_size": 0.2},
    {"structure": "gaps", "gap_distance": 0.2, "texture_density": 0.2, "texture_size": 0.2},
    {"structure": "stairs", "step_depth": 0.2, "obstacle": "log", "obstacle_size": 0.2},
    {"structure": "gaps", "gap_distance": 0.2, "obstacle": "box", "obstacle_size": 0.4},
    {"obstacle": "rock", "obstacle_size": 1.0, "obstacle_density": 2.0},
    {"legs": [3, 3]},
    {"legs": [10, 12], "segments": [1, 4]},
    {"segments": [8, 8], "segment_length": [0.5, 0.5], "body_length": [0.4, 1.2]},
    {"segments": [1, 1], "segment_length": [0.2, 0.3], "body_length": [2.0, 3.0]},
    {"segments": [2, 3], "segment_length": [0.3, 0.4], "body_length": [0.85, 0.88]},
    {"carry_weight": 0.005},
    {"drag_weight": 0.005},
    {"weight": [12, 3]},
    {"step_height": 0.9},
    {"n_elites": 60},
    {"population_size": 4.5},
    {"forgive": []},
]


@pytest.mark.parametrize("clash", CLASHES, ids=lambda clash: ", ".join(clash))
def test_an_invalid_combination_is_reported_at_each_setting_that_it_names(clash):
    form = Form()
    locations = Settings.field_locations()
    with pytest.raises(SettingsError) as caught:
        Settings().with_(**clash)
    send(form, **{"__".join(locations[name]): value for name, value in clash.items()})
    assert form.settings is None
    assert form.fault == str(caught.value)
    named = {word.rstrip(".,:;").lower() for word in form.fault.split()} & {*setting_names()}
    assert set(form.faults) == named
    assert {".".join(locations[name]) for name in clash} & named
    for sentence in form.faults.values():
        assert sentence[0].isupper()
        assert not any(f"{kind.__name__}." in sentence for kind in DOMAINS)
    send(form, **{"__".join(locations[name]): Form().values[locations[name][0]][locations[name][1]] for name in clash})
    assert (form.settings, form.fault, form.faults) == (Settings(), "", {})


def test_errors_of_several_domains_are_all_reported():
    form = Form()
    send(form, terrain__step_height=9, robot__legs=[3, 3], algorithm__n_elites=500)
    assert set(form.faults) == {
        "terrain.step_height", "robot.legs", "algorithm.n_elites", "algorithm.population_size",
    }  # fmt: skip


def test_setting_settings_fixes_invalid_values():
    form = Form()
    send(form, terrain__step_height=9)
    form.settings = Settings()
    assert (form.settings, form.fault, form.faults) == (Settings(), "", {})
    assert form.values["terrain"]["step_height"] == 0.08


garbage = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.sampled_from([10**400, "ƒ", "\0", "Robot.x"]),
    lambda inside: (
        st.lists(inside) | st.dictionaries(st.text() | st.sampled_from([*DOMAINS_BY_NAME, "seed", "legs"]), inside)
    ),
    max_leaves=8,
)


@given(place=st.sampled_from(sorted(Settings.field_locations().values())), sent=garbage)
@settings(deadline=None)
def test_an_invalid_value_is_reported_at_its_setting_and_raises_nothing(place, sent):
    form = Form()
    (domain, field) = place
    form.set_state({"values": form.values | {domain: form.values[domain] | {field: sent}}})
    if form.settings is None:
        assert f"{domain}.{field}" in form.faults
    else:
        assert form.fault == ""


def test_each_tab_is_described_by_one_sentence():
    for tab in Form().tabs:
        assert tab["about"].endswith(".")
        assert not {"\n", "="} & set(tab["about"])


@given(st.dictionaries(st.sampled_from(sorted(Form().keys)), garbage), garbage)
@settings(deadline=None)
def test_the_form_stays_consistent_for_any_message(state, values):
    form = Form()
    tabs = form.tabs
    presets = form.presets
    form.set_state(state)
    form.set_state({"values": values, "preset": values})
    assert {domain: list(fields) for domain, fields in form.values.items()} == {
        domain: list(kind.model_fields) for domain, kind in DOMAINS_BY_NAME.items()
    }
    assert (form.tabs, form.presets) == (tabs, presets)
    assert (form.settings is None) == bool(form.fault)
    form.settings = Settings().with_(duration=3)
    assert (form.fault, form.values["simulation"]["duration"]) == ("", 3)


# ----------------------------------------------------------------------------------------- unused settings


@given(all_settings)
@settings(max_examples=30, deadline=None)
def test_every_unused_setting_has_a_short_reason(expected_settings):
    for setting, reason in unused_settings(expected_settings.model_dump()).items():
        assert setting in setting_names()
        assert 0 < len(reason) <= 18


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"structure": "stairs"}, {"terrain.step_height", "terrain.step_depth"}),
        ({"structure": "incline"}, {"terrain.incline"}),
        ({"structure": "gaps"}, {"terrain.gap_width", "terrain.gap_distance"}),
        ({"structure": "rough"}, {"terrain.hill_height", "terrain.hill_length", "terrain.seed"}),
        ({"texture_density": 0.1}, {"terrain.texture_size", "terrain.seed"}),
        ({"obstacle": "box"}, {"terrain.obstacle_size", "terrain.obstacle_density", "terrain.seed"}),
        ({"mutation": ["micro", "favored"]}, {"algorithm.favored_gene"}),
        ({"mutation": user_selection}, {"algorithm.favored_gene"}),
    ],
)
def test_an_option_uses_the_settings_that_it_needs(changes, expected):
    form = Form()
    unused_before = set(form.unused)
    form.settings = Settings().with_(**changes)
    assert unused_before - set(form.unused) == expected


def test_the_limit_of_a_forgiven_verdict_is_unused():
    assert set(Form(Settings().with_(forgive=["too_fast", "airborne"])).unused) >= {
        "simulation.max_speed", "simulation.max_airborne",
    }  # fmt: skip


# ------------------------------------------------------------------------------------------------- presets


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_changes_only_terrain_and_loads(name):
    form = Form(Settings().with_(structure="stairs", legs=(4, 8), seed=5, duration=3))
    form.set_state({"preset": name})
    assert form.preset == name
    assert form.settings == Settings().with_(legs=(4, 8), seed=5, duration=3, **PRESETS[name].changes)
    send(form, robot__legs=[2, 6])
    assert form.preset == name, "the limits of the robot do not belong to the world"


def test_the_preset_is_named_while_the_settings_equal_it():
    form = Form()
    assert form.preset == "Earth"
    form.settings = Settings().with_(gravity="moon", texture="sand", duration=3)
    assert form.preset == "Moon"
    send(form, terrain__wind=[1, 0, 0])
    assert form.preset == ""
    form.set_state({"preset": "Nowhere"})
    assert form.preset == ""
    form.settings = Settings().with_(incline=20)
    assert form.preset == "Earth", "the incline has no effect on flat ground"


def test_a_preset_fixes_invalid_values():
    form = Form()
    send(form, terrain__step_height=9)
    form.set_state({"preset": "Earth"})
    assert form.settings == Settings()


def test_a_form_offers_the_presets_of_the_shown_domains():
    assert not Form(only=["structure"]).presets
    assert not Form(only=["algorithm"]).presets
    offered = {preset["name"] for preset in Form(only=["terrain"]).presets}
    assert "Moon" in offered
    assert "Caravan" not in offered
    form = Form(Settings().with_(legs=(4, 8)), only=["terrain"])
    form.set_state({"preset": "Ice"})
    assert form.settings == Settings().with_(legs=(4, 8), texture="ice")


def test_settings_that_are_hidden_if_unused_are_used_by_some_option():
    hidden = {
        f"{kind.__name__.lower()}.{control['name']}"
        for kind in DOMAINS
        for control in make_controls(kind)
        if control["hidden_if_unused"]
    }
    options = [
        *({"structure": structure} for structure in Structure),
        {"obstacle": "box"},
        {"mutation": "favored"},
        {"fitness": lambda rollout: rollout.distance},
    ]
    unused = [Form(Settings().with_(**option)).unused.keys() for option in options]
    assert hidden <= set.union(*map(set, unused))
    assert not hidden & set.intersection(*map(set, unused))


def test_the_two_seeds_have_different_labels():
    labels = [control["label"] for control in controls(Form()).values()]
    assert len(labels) == len(set(labels))
