"""The drawer calls its callbacks for valid messages and ignores all others."""

import pytest

from walkerlab.widgets.panel.drawer import Drawer


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ({"load": "a.walk"}, ["a.walk"]),
        ({"export": True}, ["export"]),
        ({"settings": True}, ["settings"]),
        ({"further": 3, "with_form": True}, [(3, True)]),
        *(
            (invalid, [])
            for invalid in (
                {"export": False},
                {"export": "yes"},
                {"settings": 2},
                {"further": 0, "with_form": False},
                {"further": "3", "with_form": False},
                {"load": 5},
                {"load": None},
                {},
                None,
            )
        ),
    ],
)
def test_only_valid_messages_call_a_callback(message, expected):
    calls = []
    drawer = Drawer(
        calls.append,
        lambda: calls.append("export"),
        lambda: calls.append("settings"),
        lambda n, with_form: calls.append((n, with_form)),
    )
    drawer._handle_custom_msg(message, [])
    assert calls == expected
