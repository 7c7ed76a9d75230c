"""A drawer hands on what is wished, and nothing that is half a wish."""

import pytest

from walkerlab.widgets.drawer import Drawer


@pytest.mark.parametrize(
    ("message", "wished"),
    [
        ({"load": "a.walk"}, ["a.walk"]),
        ({"export": True}, ["export"]),
        ({"settings": True}, ["settings"]),
        *(
            (half, [])
            for half in ({"export": False}, {"export": "yes"}, {"settings": 2}, {"load": 5}, {"load": None}, {}, None)
        ),
    ],
)
def test_whole_wishes_are_handed_on_and_no_others(message, wished):
    wishes = []
    drawer = Drawer(wishes.append, lambda: wishes.append("export"), lambda: wishes.append("settings"))
    drawer._handle_custom_msg(message, [])
    assert wishes == wished
