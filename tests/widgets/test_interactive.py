"""Interactive calls a function with the values of its controls, and shows all that it prints, displays and returns."""

import io
from base64 import b64encode

import pytest
from PIL import Image

from tests.text.test_html import Seen
from walkerlab.view.snapshots import snapshot_html
from walkerlab.widgets import Interactive
from walkerlab.widgets.interactive import _to_html


def texts(widget):
    return "".join(output["text"] for output in widget.output.outputs)


def test_the_function_is_called_with_the_values_and_again_after_each_change():
    calls = []

    def show(**values):
        calls.append(values)
        print(values["step_height"], values["texture"])

    widget = Interactive(show, ["step_height", "texture"])
    widget.controls["step_height"].value = 0.2
    widget.controls["texture"].value = "ice"
    assert calls[0].keys() == {"step_height", "texture"}
    assert calls[-1] == {"step_height": 0.2, "texture": "ice"}
    assert len(calls) == 3
    assert texts(widget) == "0.2 ice\n"
    seen = Seen(snapshot_html(widget)).text
    assert "step height [m]0.2 textureice 0.2 ice" in " ".join(seen.split())


def test_an_error_of_the_function_is_shown_and_the_next_call_replaces_it():
    widget = Interactive(lambda incline: print(1 / incline), ["incline"])
    widget.controls["incline"].value = 0
    assert "ZeroDivisionError" in texts(widget)
    widget.controls["incline"].value = 10
    assert texts(widget) == "0.1\n"


def test_an_unknown_setting_is_reported():
    with pytest.raises(ValueError, match="Did you mean 'step_height'"):
        Interactive(print, ["step_hight"])


def test_pictures_are_shown_and_html_of_the_user_is_shown_as_text():
    file = io.BytesIO()
    Image.new("RGB", (2, 2)).save(file, "PNG")
    data = {"image/png": b64encode(file.getvalue()).decode(), "text/plain": "a picture"}
    [image] = Seen(_to_html({"data": data})).all("img")
    assert image["alt"] == "a picture"
    assert (
        _to_html({"data": {"text/html": "<b onclick=alert(1)>x</b>", "text/plain": "a < b"}}) == "<pre>a &lt; b</pre>"
    )
