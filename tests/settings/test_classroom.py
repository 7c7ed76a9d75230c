"""The file of a class: each wrong entry is named with its value, what is allowed, and how to fix it."""

import json

import pytest

import walkerlab as wl
from walkerlab.settings.classroom import Classroom, read_class

VALID = {
    "name": "Biology 10b",
    "only": ["terrain", "selection", "generations"],
    "locked": {"population_size": 24, "step_height": 0.05},
    "presets": {"Low stairs": {"structure": "stairs"}},
    "budget": 500,
    "shared_folder": "hand-in",
    "seed_per_student": True,
}

WRONG = {
    "name": (7, "at most 80 characters"),
    "only": (["terrian"], "Did you mean 'terrain'?"),
    "locked": ({"step_height": 9}, "step_height is 9 m; it must be between 0.01 and 0.4 m"),
    "presets": ({"Ice": {"texture": "eis"}}, "presets.Ice: Terrain.texture is 'eis'"),
    "budget": (-3, "a whole number of walks between 1 and"),
    "shared_folder": (7, "the path of a folder"),
    "seed_per_student": ("yes", "true or false"),
    "bugdet": (5, "Did you mean 'budget'?"),
}


@pytest.fixture
def write(tmp_path):
    (tmp_path / "hand-in").mkdir()
    file = tmp_path / "class.json"

    def write(content):
        file.write_text(content if isinstance(content, str) else json.dumps(content))
        return file

    return write


def test_a_valid_file_is_read_and_its_folder_is_relative_to_the_file(write, tmp_path):
    classroom = read_class(write(VALID))
    assert classroom.shared_folder == tmp_path / "hand-in"
    assert classroom.model_dump(exclude={"shared_folder"}) == Classroom(
        **{**VALID, "only": tuple(VALID["only"])}
    ).model_dump(exclude={"shared_folder"})
    assert read_class(write({})) == Classroom()


def test_all_wrong_entries_are_reported_together_with_file_value_and_fix(write):
    with pytest.raises(wl.SettingsError) as caught:
        read_class(write({name: value for name, (value, _) in WRONG.items()}))
    message = str(caught.value)
    for name, (_, expected) in WRONG.items():
        assert expected in message, name
    assert all("class.json: " in line for line in message.splitlines())


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ('{"name": "a",}', "line 1"),
        ('{"name": "a", "name": "b"}', "more than once"),
        ([1], "must contain an object"),
        ({"shared_folder": "nowhere"}, "create it"),
        ({"only": ["terrain"], "presets": {"x": {"selection": "rank"}}}, 'not in "only"'),
        ({"locked": {"texture": "ice"}, "presets": {"x": {"texture": "sand"}}}, "which is locked"),
        ({"locked": {"seed": 1}, "seed_per_student": True}, "remove one of the two"),
        ({"locked": {"n_elites": 90}}, "n_elites is 90"),
        ("[" * 100_000, "not a class file"),
        (" " * 200_000, "must contain an object"),
    ],
)
def test_an_unusable_file_is_reported(write, content, expected):
    with pytest.raises(wl.SettingsError, match=expected):
        read_class(write(content))


def test_a_missing_file_is_reported(tmp_path):
    with pytest.raises(wl.SettingsError, match="cannot be read"):
        read_class(tmp_path / "class.json")
