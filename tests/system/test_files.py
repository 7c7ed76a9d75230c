"""Paths from users, and files that are replaced in one step."""

import os
import shlex
import stat
from pathlib import Path

import pytest

from walkerlab.system.files import (
    PathError,
    absolute_path,
    display_path,
    file_path,
    folder_path,
    quote_path,
    replace_atomically,
    write_text,
)

posix = pytest.mark.skipif(os.name == "nt", reason="as POSIX has it")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    return tmp_path


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("walk", "walk"),
        (Path("walk"), "walk"),
        ("./a/run.walk", "a/run.walk"),
        ("~", "home"),
        ("~/r/run.walk", "home/r/run.walk"),
        (Path("~/r"), "home/r"),
        ("a/~/b", "a/~/b"),
        ("~no-such-user", "~no-such-user"),
        ("a b/ü(1).walk", "a b/ü(1).walk"),
        ("2:1.walk", "2:1.walk"),
        ("a/../b", "b"),
        ("walk/", "walk"),
    ],
)
def test_a_path_is_made_absolute_and_its_tilde_is_expanded(here, given, meant):
    assert absolute_path(given) == here / meant


@pytest.mark.parametrize(
    "given",
    ["", " ", ":memory:", "file:y.walk", "FILE:y", "file:///y", "https://x/y", "a\0b", "\ud800", "~no-such-user/x"],
)
@pytest.mark.parametrize("read", [absolute_path, file_path, folder_path])
def test_an_invalid_path_raises_with_its_name_and_value(given, read):
    with pytest.raises(PathError) as caught:
        read(given, "somewhere")
    assert str(caught.value).startswith(f"somewhere is {given!r}")


@pytest.mark.parametrize("given", [None, 5, 1.5, ["a"]])
def test_a_value_of_another_type_raises_a_type_error(given):
    with pytest.raises(TypeError, match="must be a path"):
        absolute_path(given)


def test_files_and_folders_are_not_interchangeable(here):
    Path("file").touch()
    for folder in (".", "..", "new/", str(here), "/"):
        with pytest.raises(PathError, match="which is a folder"):
            file_path(folder)
    with pytest.raises(PathError, match="which is a file"):
        folder_path("file")
    assert file_path("file") == here / "file"
    assert folder_path("new/") == here / "new"


@posix
def test_the_parent_of_a_link_is_that_of_its_target(here):
    (here / "far" / "away").mkdir(parents=True)
    Path("link").symlink_to("far/away")
    assert absolute_path("link/../x") == here / "far" / "x"
    assert absolute_path("link") == here / "link"


@posix
def test_without_a_current_folder_relative_paths_raise(here, monkeypatch):
    (here / "gone").mkdir()
    monkeypatch.chdir(here / "gone")
    (here / "gone").rmdir()
    with pytest.raises(PathError, match="current folder was deleted"):
        absolute_path("walk")
    assert absolute_path(here / "walk") == here / "walk"
    assert display_path(here / "walk") == str(here / "walk")


@pytest.mark.parametrize("name", ["walk", "a b/c", "~/x", "-x", ":memory:", "file:y", "it's", '"$HOME"', "a\\b", "!!"])
def test_a_shown_path_is_read_as_the_same_path_by_walkerlab_and_by_a_shell(here, name):
    path = here / name
    assert absolute_path(display_path(path)) == path
    if os.name != "nt":
        [word] = shlex.split(quote_path(path))
        assert absolute_path(word) == path
        assert not word.startswith("-")


def test_a_shown_path_is_relative_only_in_the_current_folder(here):
    assert display_path(here / "a" / "b") == os.path.join("a", "b")
    assert display_path(here.parent) == str(here.parent)
    assert display_path("as it is") == "as it is"


# ------------------------------------------------------------------------------------------------- replacing a file


def test_a_file_is_replaced_when_the_block_ends(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")
    with replace_atomically(path) as temporary:
        temporary.write_text("new")
        assert path.read_text() == "old"
        assert temporary.parent == tmp_path
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [ValueError, OSError, KeyboardInterrupt])
def test_after_an_error_the_old_file_is_unchanged(tmp_path, error):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def fail(one):
        with replace_atomically(one) as temporary:
            temporary.write_text("half")
            raise error

    for one in (path, tmp_path / "new.txt"):
        with pytest.raises(error):
            fail(one)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_of_renaming_names_the_file_and_leaves_it_unchanged(tmp_path, monkeypatch):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def held(source, target):
        raise PermissionError(13, "held by another program", str(source), None, str(target))

    monkeypatch.setattr(os, "replace", held)
    with pytest.raises(PermissionError) as caught:
        write_text(path, "new")
    assert caught.value.filename == str(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@posix
def test_a_symbolic_link_is_replaced_and_not_followed(tmp_path):
    precious = tmp_path / "precious"
    link = tmp_path / "link"
    precious.write_text("three years of work")
    link.symlink_to(precious)
    write_text(link, "new")
    assert precious.read_text() == "three years of work"
    assert link.read_text() == "new"
    assert not link.is_symlink()


@posix
def test_devices_and_folders_are_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to(os.devnull)
    for path in (tmp_path / "pipe", tmp_path / "folder", tmp_path / "link", Path(os.devnull)):
        with pytest.raises(PathError, match="must be the path of a file"):
            write_text(path, "new")
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)
    assert {path.name for path in tmp_path.iterdir()} == {"pipe", "folder", "link"}


def test_a_missing_folder_is_named_without_an_error_number(here):
    with pytest.raises(FileNotFoundError) as caught:
        write_text(here / "none" / "file.txt", "new")
    assert str(caught.value) == "there is no folder none for the file file.txt; create it first."


@posix
@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_the_new_file_has_default_permissions(tmp_path, mask):
    before = os.umask(mask)
    try:
        write_text(tmp_path / "file.txt", "new")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "file.txt").stat().st_mode) == 0o666 & ~mask


@posix
def test_a_name_may_have_the_maximum_length_of_the_file_system(tmp_path):
    path = tmp_path / ("w" * 255)
    write_text(path, "new")
    with pytest.raises(OSError, match="long"):
        write_text(tmp_path / ("w" * 256), "new")
    assert list(tmp_path.iterdir()) == [path]
