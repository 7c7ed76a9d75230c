"""Sets of output files: all old or all new, after any error and after a kill at any moment."""

import json
import os
import subprocess
import sys
import threading
from contextlib import nullcontext
from pathlib import Path

import pytest

from tests.faults import number
from walkerlab.evolution import outputs
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.system import file_sets
from walkerlab.system.file_sets import HIDDEN_FOLDER, JOURNAL_NAME, OUTPUT_NAMES, OutputError, replacing_files, restore
from walkerlab.view.report.pictures import FOLDER, FORMATS, PICTURES

OLD = {"report.html": "old", "records.csv": "old", "pictures/body.svg": "old", "champion.txt": "old"}
NEW = {"report.html": "new", "records.csv": "new", "pictures/body.svg": "new", "tables/champion.csv": "new"}
"""One old file has no new version, and one new file has no old version."""
OTHERS = {RUN_FILE: "a run", "notes.md": "mine"}
AFTER = OLD | NEW | OTHERS

posix = pytest.mark.skipif(os.name == "nt", reason="as POSIX has it")


def fill(folder, texts):
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def contents(folder):
    return {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*") if path.is_file()}


def replace(folder, texts=NEW, failing=(), **options):
    with replacing_files(folder, **options) as new:
        for name, text in texts.items():
            with new.write_part(name):
                (new.folder / name).write_text(text)
                if name in failing:
                    raise ValueError(f"no {name}")


@pytest.fixture
def folder(tmp_path):
    fill(tmp_path, OLD | OTHERS)
    return tmp_path


def test_all_output_files_may_be_replaced_and_no_run_file():
    names = {*outputs.OUTPUT_FILES} - {RUN_FILE}
    names |= {f"{FOLDER}/{picture.name}.{kind}" for picture in PICTURES for kind in FORMATS}
    assert all(map(OUTPUT_NAMES.fullmatch, names))
    for other in (RUN_FILE, "notes.md", "../report.html", "pictures/../report.html", "/report.html", "report.html\n"):
        assert not OUTPUT_NAMES.fullmatch(other)


def test_the_old_set_stays_until_the_new_one_is_complete(folder):
    with replacing_files(folder) as new:
        for name, text in NEW.items():
            with new.write_part(name):
                (new.folder / name).write_text(text)
            assert {name: text for name, text in contents(folder).items() if HIDDEN_FOLDER not in name} == OLD | OTHERS
    assert contents(folder) == AFTER
    assert not (folder / HIDDEN_FOLDER).exists()


def test_a_missing_folder_is_created(tmp_path):
    replace(tmp_path / "a" / "b")
    assert contents(tmp_path / "a" / "b") == NEW


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_after_an_error_outside_of_the_parts_all_files_are_unchanged(folder, error):
    def fail():
        with replacing_files(folder) as new:
            (new.folder / "report.html").write_text("new")
            raise error

    with pytest.raises(error):
        fail()
    assert contents(folder) == OLD | OTHERS


@pytest.mark.parametrize("name", sorted(NEW))
def test_a_failed_part_is_named_and_an_outdated_file_of_it_keeps_the_old_set(folder, name):
    with pytest.raises(OutputError, match=rf"{name}: ValueError: no {name}") as caught:
        replace(folder, failing=[name])
    if name in OLD:
        assert "No file was changed" in str(caught.value)
        assert contents(folder) == OLD | OTHERS
    else:
        assert "All other files were written" in str(caught.value)
        assert contents(folder) == {one: text for one, text in AFTER.items() if one != name}
    assert not (folder / HIDDEN_FOLDER).exists()


def test_in_an_empty_folder_all_other_parts_are_written_and_all_failed_parts_named(tmp_path):
    with pytest.raises(OutputError) as caught:
        replace(tmp_path, failing=["report.html", "records.csv"])
    assert contents(tmp_path) == dict.fromkeys(("pictures/body.svg", "tables/champion.csv"), "new")
    assert "report.html: ValueError: no report.html" in str(caught.value)
    assert "records.csv: ValueError: no records.csv" in str(caught.value)
    assert isinstance(caught.value.__cause__, ValueError)


def test_a_failed_part_with_an_up_to_date_file_does_not_block_the_others(folder):
    with pytest.raises(OutputError, match="All other files were written"):
        replace(folder, failing=["records.csv"], is_current=lambda path: path.name == "records.csv")
    assert contents(folder) == AFTER | {"records.csv": "old"}


@pytest.mark.parametrize("broken", range(len(NEW)))
def test_a_file_that_cannot_be_replaced_is_named_and_the_old_set_restored(folder, broken, monkeypatch):
    """As on Windows for a table that is open in a spreadsheet program."""
    rename = os.replace
    calls = iter(range(99))

    def replaced(source, target):
        is_swap = f"{HIDDEN_FOLDER}{os.sep}new" in str(source) and HIDDEN_FOLDER not in str(target)
        if is_swap and next(calls) == broken:
            raise PermissionError(13, "held by another program", str(source), None, str(target))
        rename(source, target)

    monkeypatch.setattr(os, "replace", replaced)
    with pytest.raises(OutputError, match="could not be replaced: held by another program"):
        replace(folder)
    assert contents(folder) == OLD | OTHERS
    assert not (folder / "tables").exists()
    assert not (folder / HIDDEN_FOLDER).exists()


def test_files_are_replaced_without_hard_links(folder, monkeypatch):
    def link(*_, **__):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", link)
    replace(folder)
    assert contents(folder) == AFTER


def test_two_writers_wait_for_each_other(folder):
    entered, may_continue = threading.Event(), threading.Event()

    def first():
        with replacing_files(folder) as new:
            entered.set()
            may_continue.wait(10)
            fill(new.folder, {"report.html": "first", "records.csv": "first"})

    thread = threading.Thread(target=first)
    thread.start()
    entered.wait(10)
    restore(folder)
    assert (folder / HIDDEN_FOLDER).exists(), "restore does nothing while another process writes"
    threading.Timer(0.1, may_continue.set).start()
    replace(folder)
    thread.join()
    assert contents(folder) == AFTER


def test_waiting_for_another_writer_ends_with_an_error(folder, monkeypatch):
    monkeypatch.setattr(file_sets, "LOCK_TIMEOUT", 0.0)
    with replacing_files(folder), pytest.raises(OutputError, match="another program is writing"):
        replace(folder)
    assert contents(folder) == OLD | OTHERS


# ------------------------------------------------------------------------------------------------------------ kills

KILLS = """
import json, os, shutil, signal, sys, tempfile
from multiprocessing import resource_tracker
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from walkerlab.system import file_sets, files, folder_locks

os.fsync = lambda file: None  # slow, and has an effect only after a power failure
resource_tracker.ensure_running()  # otherwise each child starts one
step, old, new, others = map(json.loads, sys.argv[2:6])
memory = "/dev/shm"  # faster than a disk, if it exists
passing = tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None)
top = Path(passing.name)
CODE = {files.__file__, file_sets.__file__, folder_locks.__file__}

def fill(folder, texts):
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)

def contents(folder, hidden=True):
    found = {p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()}
    return {name: text for name, text in found.items() if hidden or file_sets.HIDDEN_FOLDER not in name}

def replace(folder):
    with file_sets.replacing_files(folder) as made:
        for name, text in new.items():
            with made.write_part(name):
                files.write_text(made.folder / name, text)

def killed(at, call):
    "Make a call in a process that is killed before this line of code; return whether it was."
    if not (child := os.fork()):
        left = at
        def trace(frame, event, _):
            nonlocal left
            if frame.f_code.co_filename not in CODE:
                return None
            if event == "line":
                left -= 1
                if left < 0:
                    os.kill(os.getpid(), signal.SIGKILL)
            return trace
        sys.settrace(trace)
        call()
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) != 0

def kind(found):
    return "before" if found == old | others else "after" if found == old | new | others else "mixed"

seen, ends, mixed = [], [], []
for at in range(0, 100_000, step):
    folder = top / f"{at}"
    fill(folder, old | others)
    if not killed(at, lambda: replace(folder)):
        break
    seen.append(kind(contents(folder, hidden=False)))
    if seen[-1] == "mixed":
        shutil.copytree(folder, top / f"mixed {at}")
        mixed.append(top / f"mixed {at}")
    file_sets.restore(folder)
    ends.append(kind(contents(folder)))
    shutil.rmtree(folder)

again = []
for folder in mixed[:: max(1, len(mixed) // 3)]:
    for at in range(0, 100_000, step):
        copy = folder.with_name("copy")
        shutil.copytree(folder, copy)
        over = not killed(at, lambda: file_sets.restore(copy))
        file_sets.restore(copy)
        again.append(kind(contents(copy)))
        shutil.rmtree(copy)
        if over:
            break
print(json.dumps([seen, ends, again]))
"""


@posix
def test_after_a_kill_at_any_line_restore_gives_the_old_set_or_the_new_one(request):
    given = map(json.dumps, (number(4, 1), OLD, NEW, OTHERS))
    command = [sys.executable, "-c", KILLS, str(request.config.rootpath), *given]
    seen, ends, again = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    print(f"\n{len(seen)} kills; state before restoring: { {one: seen.count(one) for one in set(seen)} }")
    assert set(ends) == {"before", "after"}
    assert set(again) == {"before"}
    assert ends == sorted(ends, reverse=True), "the old set before the commit, the new one afterwards"
    assert 0 < seen.count("mixed") < len(seen) / 3


# ------------------------------------------------------------------------------------------ untrusted folders


@posix
def test_an_untrusted_folder_changes_only_its_own_output_files(folder, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    fill(elsewhere, {"report.html": "precious", "body.svg": "precious"})
    fill(
        folder,
        {
            f"{HIDDEN_FOLDER}/old/notes.md": "forged",
            f"{HIDDEN_FOLDER}/old/{RUN_FILE}": "forged",
            f"{HIDDEN_FOLDER}/old/x/y": "forged",
        },
    )
    absent = ["notes.md", RUN_FILE, "../report.html", str(elsewhere / "report.html"), "pictures/body.svg", 5, None, []]
    (folder / HIDDEN_FOLDER / JOURNAL_NAME).write_text(json.dumps(absent))
    (folder / "pictures" / "body.svg").unlink()
    (folder / "pictures").rmdir()
    (folder / "pictures").symlink_to(elsewhere)
    before = {path: path.read_text() for path in (folder / "notes.md", folder / RUN_FILE, *elsewhere.iterdir())}
    restore(folder)
    assert {path: path.read_text() for path in before} == before
    with pytest.raises(OutputError, match="is a symbolic link"):
        replace(folder)
    assert {path: path.read_text() for path in before} == before


@posix
@pytest.mark.parametrize("inside", ["", "old", "new", "lock", JOURNAL_NAME])
def test_links_in_a_hidden_folder_are_not_followed(folder, tmp_path_factory, inside):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    fill(elsewhere, {"report.html": "precious", "lock": "precious", JOURNAL_NAME: "[]"})
    before = contents(elsewhere)
    if inside:
        (folder / HIDDEN_FOLDER).mkdir()
        is_file = inside in ("lock", JOURNAL_NAME)
        (folder / HIDDEN_FOLDER / inside).symlink_to(elsewhere / inside if is_file else elsewhere)
    else:
        (folder / HIDDEN_FOLDER).symlink_to(elsewhere)
    restore(folder)
    assert contents(elsewhere) == before
    assert {name: text for name, text in contents(folder).items() if HIDDEN_FOLDER not in name} == OLD | OTHERS
    with pytest.raises(OutputError) if inside == "lock" else nullcontext():
        replace(folder)
    assert contents(elsewhere) == before


@pytest.mark.parametrize("text", ["", "{", "null", '{"a": 1}', "[" * 50_000, "x" * 200_000])
def test_an_invalid_journal_is_ignored(folder, text):
    (folder / HIDDEN_FOLDER).mkdir()
    (folder / HIDDEN_FOLDER / JOURNAL_NAME).write_text(text)
    restore(folder)
    assert contents(folder) == OLD | OTHERS
    assert not (folder / HIDDEN_FOLDER).exists()


def test_files_of_a_writer_killed_before_replacing_are_deleted(folder):
    fill(
        folder,
        {
            f"{HIDDEN_FOLDER}/new/report.html": "half",
            f"{HIDDEN_FOLDER}/lock": "",
            f"{HIDDEN_FOLDER}/old/records.csv": "old",
        },
    )
    restore(folder)
    assert contents(folder) == OLD | OTHERS
    assert not Path(folder / HIDDEN_FOLDER).exists()
