"""Each setting is also a plain ipywidgets control that agrees with its declaration."""

import ipywidgets
import pytest

import walkerlab as wl
from walkerlab.settings.fields import OneOf
from walkerlab.widgets.controls import setting_label

LOCATIONS = wl.Settings.field_locations()
OTHER = wl.Settings().with_(
    structure="stairs", step_height=0.205, legs=(2, 6), gravity=(0, 0, -5), wind=(-3, 0, 0), seed=11, frozen=["mass"]
)


@pytest.mark.parametrize("name", LOCATIONS)
@pytest.mark.parametrize("settings", [wl.Settings(), OTHER], ids=["defaults", "others"])
def test_a_control_agrees_with_the_declaration_of_its_setting(name, settings):
    domain, field = LOCATIONS[name]
    declared = type(getattr(settings, domain)).declared()[field]
    control = wl.widgets.slider(name, settings)
    assert isinstance(control, ipywidgets.ValueWidget)
    assert settings.with_(**{name: control.value}) == settings
    assert control.description.startswith(setting_label(field, domain))
    assert control.tooltip.split()[-1] == declared.about.split()[-1]
    if isinstance(declared, OneOf):
        assert {value for _, value in control.options} == set(declared.choices.__members__)
    else:
        assert declared.unit in control.description
        if not declared.presets:
            assert (control.min, control.max) == (declared.low, declared.high)
    if hasattr(control, "step"):
        default = getattr(type(getattr(settings, domain))(), field)
        for number in (*(default if isinstance(default, tuple) else (default,)), declared.high):
            steps = (number - declared.low) / control.step
            assert steps == pytest.approx(round(steps))
        assert control.step == 1 or not declared.whole


def test_sliders_are_returned_by_name():
    controls = wl.widgets.sliders(["step_height", "texture"])
    assert {name: control.value for name, control in controls.items()} == {"step_height": 0.08, "texture": "rubber"}


def test_a_changed_control_gives_valid_settings():
    legs = wl.widgets.slider("legs")
    legs.value = (2, 6)
    assert wl.Settings().with_(legs=legs.value).robot.legs == (2, 6)


@pytest.mark.parametrize(
    ("name", "settings", "words"),
    [
        ("step_hight", None, "no setting 'step_hight'"),
        ("fitness", wl.Settings().with_(fitness=lambda walk: walk.distance), "user function"),
        ("mutation", wl.Settings().with_(mutation=["micro", "macro"]), "list of operators"),
    ],
)
def test_a_setting_without_a_plain_control_is_rejected(name, settings, words):
    with pytest.raises(ValueError, match=words):
        wl.widgets.slider(name, settings)
