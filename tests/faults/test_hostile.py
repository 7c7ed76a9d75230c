"""Malicious run files with valid seals are rejected, or their contents are shown as plain text."""

import json
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from functools import partial

import pytest

import walkerlab as wl
from tests.faults import bombs, number
from tests.faults.standins import attempt
from tests.frontends import book, run_all
from tests.runfile.test_schema import KEPT
from tests.widgets.test_panel import button, curve_says, picture, says
from walkerlab.__main__ import main
from walkerlab.evolution import outputs
from walkerlab.runfile import schema

SQL = "'); DROP TABLE records; --"
SCRIPT = "<script>window.hacked = 1</script><img src=x onerror='window.hacked = 2'>"
WORSE = '"></script><script>window.hacked = 3</script><svg onload="window.hacked = 4">'
FUNCTION = {"function": f"../../../{SCRIPT}.mine", "with": {"text": WORSE, "name": SQL, "path": "../../secret"}}


@pytest.fixture(scope="module")
def unmodified(tmp_path_factory):
    """Return the path of a small, unmodified run."""
    path = tmp_path_factory.mktemp("unmodified") / "run.walk"
    settings = wl.Settings().with_(population_size=6, generations=2, n_elites=1, duration=1, seed=2)
    with ThreadPoolExecutor(2) as pool:
        return wl.evolve(settings, path, executor=pool, progress=False).path


def write_forged(path, unmodified, *statements, settings=lambda plain: plain):
    """Copy a run to a path, change it, and seal it; return the path."""
    path.write_bytes(unmodified.read_bytes())
    with closing(sqlite3.connect(path)) as db, db:
        for statement in statements:
            db.execute(*([statement] if isinstance(statement, str) else [statement[0], statement[1:]]))
        schema.write_settings(db, json.dumps(settings(json.loads(schema.read_fact(db, "settings")))))
        made_with = [row for (row,) in db.execute("SELECT made_with FROM provenance")]
        db.execute("DELETE FROM generations")
        for (generation,) in db.execute("SELECT DISTINCT generation FROM records").fetchall():
            schema.seal_generation(db, generation, made_with[0])
    return path


@pytest.fixture
def forge(unmodified, tmp_path):
    """Return a function that writes a changed copy of the run: forge("UPDATE …", ["UPDATE … ?", text])."""
    return partial(write_forged, tmp_path / "run.walk", unmodified)


@pytest.fixture(scope="module")
def reported(unmodified, tmp_path_factory):
    """Return a run with hostile texts, beside whose file is the folder "report" with its report."""
    path = tmp_path_factory.mktemp("hostile") / "run.walk"
    run = wl.load(write_forged(path, unmodified, *TEXTS, settings=with_functions))
    run.save_report(path.with_name("report"))
    return run


def with_functions(plain):
    """Return settings with hostile texts as names of functions."""
    return {**plain, "algorithm": {**plain["algorithm"], "mutation": FUNCTION, "selection": ["gradient", FUNCTION]}}


TEXTS = (
    ["UPDATE records SET operators = ?, reason = ?", SCRIPT, WORSE],
    ["UPDATE records SET operators = ?, reason = ? WHERE individual = 4", SQL, "../../secret"],
    ["UPDATE provenance SET made_with = ?", json.dumps({SCRIPT: WORSE, "mujoco": SQL, "numpy": "../../secret"})],
    ["UPDATE run SET value = ? WHERE fact = 'id'", SCRIPT],
)


def test_a_forged_file_with_the_same_contents_is_read(forge, unmodified):
    assert wl.load(forge()).records.equals(wl.load(unmodified).records)


REJECTED = {
    "a verdict that moves the cursor": ["UPDATE records SET verdict = ?", "ok\x1b[2J\x1b]52;c;aGFja2Vk\x07"],
    "an unknown verdict": ["UPDATE records SET verdict = ?", SCRIPT],
    "operators that move the cursor": ["UPDATE records SET operators = ?", "\x9b2J"],
    "parents that are not numbers": ["UPDATE records SET parents = ?", SQL],
    "a parent with a million digits": ["UPDATE records SET parents = ?", "9" * 10**6],
    "an infinite fitness": "UPDATE records SET fitness = 9e999",
    "a missing fitness": "UPDATE records SET fitness = NULL",
    "a fitness that is a text": ["UPDATE records SET fitness = ?", SCRIPT],
    "a number that is a blob": "UPDATE records SET n_legs = zeroblob(90)",
    "a negative number": "UPDATE records SET individual = -individual - 1",
    "a huge number": "UPDATE records SET individual = individual + 1000000000000000000",
    "a huge generation": "UPDATE records SET generation = 9000000000000000000 WHERE generation = 1",
    "a negative generation": "UPDATE records SET generation = -1 WHERE generation = 1",
    "a generation of one": "DELETE FROM records WHERE generation = 1 AND individual > 6",
    "a text of a megabyte": ["UPDATE records SET reason = ?", "x" * 10**6],
    "settings of a megabyte": ["UPDATE run SET value = ? WHERE fact = 'settings'", " " * 10**6 + "{}"],
}


@pytest.mark.parametrize("statement", REJECTED.values(), ids=REJECTED)
def test_values_that_no_run_writes_are_rejected_with_a_message(forge, statement, capsys):
    path = forge(statement)
    with pytest.raises(wl.RunFileError) as caught:
        wl.load(path)
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 800
    for words in (["show", str(path)], ["resume", str(path), "--quiet"], ["evolve", "--out", str(path.parent)]):
        assert main(words) == 2
        printed = capsys.readouterr()
        assert (printed.out + printed.err).replace("\n", "").isprintable()


@pytest.mark.parametrize(
    "name", ["\n__import__('os')", SCRIPT, "a b", "", "\x1b[2J", "9", "\ud800", "eval", "ｅｖａｌ", "exit"]
)
def test_a_function_without_a_valid_name_is_rejected(forge, name):
    """Otherwise its name would become a line of the code that repeats the run."""
    functions = [{"function": f"module.{name}", "with": {}}, {"function": "module.mine", "with": {name: 1}}]
    for function in functions[: 1 if name in ("eval", "exit") else 2]:
        path = forge(
            settings=lambda plain, given=function: {**plain, "algorithm": {**plain["algorithm"], "fitness": given}}
        )
        with pytest.raises(wl.RunFileError, match="a function of a run cannot be called"):
            wl.load(path)


@pytest.mark.parametrize("settings", [
    {}, [], 7, "settings", {"algorithm": {}}, {"algorithm": 7}, {"terrain": {"structure": SCRIPT}},
    {"algorithm": {"population_size": 10**30}}, {"robot": {"segments": [1, 10**400]}},
])  # fmt: skip
def test_invalid_settings_are_rejected_with_a_message(forge, settings, capsys):
    path = forge(settings=lambda plain: {**plain, **settings} if isinstance(settings, dict) and settings else settings)
    with pytest.raises(wl.RunFileError, match="damaged"):
        wl.load(path)
    assert main(["show", str(path)]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_an_invalid_genome_is_reported_where_it_is_used(forge, capsys):
    path = forge(["UPDATE records SET genome = ?", SCRIPT])
    with pytest.raises(wl.GenomeError):
        wl.load(path).champion  # noqa: B018
    assert main(["show", str(path)]) == 2
    with pytest.raises(wl.RunFileError, match="damaged"):
        wl.resume(path, 3, progress=False)


MEMORY_TEST = """
import resource, sys, walkerlab as wl
from walkerlab.runfile import paths, store
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
path = paths.locate_run_file(sys.argv[1])
for use in (wl.load, store.read_facts, lambda path: wl.rescue(path, f"{path}.rescued")):
    try:
        use(path)
    except wl.RunFileError as error:
        print(error)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no module resource there")
def test_a_text_with_a_declared_size_of_a_gigabyte_uses_no_memory(forge):
    """The file is truncated after the start of the text, and its header adapted."""
    path = forge()
    size = path.stat().st_size
    with closing(sqlite3.connect(path)) as db, db:
        db.execute("PRAGMA synchronous = OFF")
        db.execute("UPDATE records SET reason = zeroblob(?) WHERE individual = 0", [number(3_000_000, 999_000_000)])
    with path.open("r+b") as file:
        file.truncate(size)
        file.seek(28)
        file.write((size // 8192).to_bytes(4, "big"))
    output = subprocess.run(
        [sys.executable, "-c", MEMORY_TEST, path], capture_output=True, text=True, check=True
    ).stdout
    *errors, growth = output.splitlines()
    assert errors
    assert int(growth) < 50_000, "kB"


def test_only_the_given_folder_is_written_to(reported):
    folder = reported.path.parent
    wl.export_mjcf(reported.champion.genome, reported.settings, folder / "report")
    assert {one.name for one in folder.iterdir()} == {"run.walk", "report"}
    with pytest.raises(wl.RunFileError, match="holds no code"):
        wl.resume(reported.path, progress=False)


def test_hostile_texts_are_plain_text_in_a_terminal(forge, capsys):
    path = forge(*TEXTS, settings=with_functions)
    assert main(["show", str(path)]) == 0
    output = capsys.readouterr().out
    assert SCRIPT in output
    assert output.replace("\n", "").isprintable()


def ran_no_script(page):
    """Return whether no script of the file has run in a page or in one of its frames."""
    return all(frame.evaluate("window.hacked") is None for frame in page.frames)


def test_hostile_texts_are_plain_text_in_a_browser(reported, page, tmp_path):
    report = reported.path.with_name("report") / "report.html"
    card = tmp_path / "card.html"
    card.write_text(f"<!doctype html><meta charset=utf-8>{reported._repr_html_()}", encoding="utf-8")
    for shown in (report, report.with_name("replay.html"), card):
        page.goto(shown.as_uri())
        page.wait_for_load_state("networkidle")
        assert ran_no_script(page)
    page.goto(report.as_uri())
    page.get_by_text(SCRIPT).first.scroll_into_view_if_needed()
    picture(page, "hostile-report")


def test_hostile_texts_are_plain_text_in_the_panel(forge, page, jupyter):
    path = forge(*TEXTS, settings=with_functions)
    page.set_viewport_size({"width": 1280, "height": 800})
    cells = f"import walkerlab as wl\nwl.load({str(path)!r})", "lab = wl.Lab()\nlab"
    assert run_all(page, jupyter.put(book(*cells), "JupyterLab")) == []
    page.get_by_label("run file to load").select_option("other file")
    page.get_by_label("path of the run file").fill(str(path))
    button(page, "Load", ".wl-drawer").click()
    says(page, "Loaded", ".wl-drawer")
    curve_says(page, "generations:")
    button(page, "Copy as code", ".wl-drawer").click()
    says(page, "Copied", ".wl-drawer")
    page.locator(".wl-population [role=option]").first.wait_for()
    assert ran_no_script(page)
    picture(page, "hostile-panel")


@pytest.mark.parametrize("bomb", [bombs.endless_schema, bombs.endless_index])
def test_a_practically_endless_file_is_rejected_within_seconds(forge, bomb, tmp_path):
    path = forge()
    bomb(path)
    before = time.process_time()
    with pytest.raises(wl.RunFileError):
        wl.load(path)
    rescued, error = attempt(wl.rescue, path, tmp_path / "rescued.walk")
    assert error or not rescued.n_generations, "the settings at most"
    assert time.process_time() - before < 10


def test_an_old_file_that_is_mostly_empty_is_not_copied(tmp_path):
    path = tmp_path / "run.walk"
    path.write_bytes((KEPT / "layout_2.walk").read_bytes())
    with closing(sqlite3.connect(path)) as db, db:
        db.execute("CREATE TABLE more (words)")
        db.execute("INSERT INTO more VALUES (zeroblob(1000000))")
        db.execute("DROP TABLE more")
    with pytest.raises(wl.RunFileError, match="most of it is empty"):
        wl.load(path)


@pytest.mark.filterwarnings("default")
def test_texts_of_a_run_cannot_add_lines_to_the_output(forge, capsys):
    path = forge(["UPDATE provenance SET made_with = ?", json.dumps({"mujoco": "1\x1b[2J\nok   all is well"})])
    main(["show", str(path)])
    main(["resume", str(path), "--generations", "3", "--quiet"])
    printed = capsys.readouterr()
    assert "\x1b" not in printed.out + printed.err
    assert "\nok " not in printed.out + printed.err
    assert "Note: " in printed.err


def test_symbolic_links_are_not_followed_when_writing(forge, tmp_path):
    path = forge()
    precious = tmp_path / "precious"
    precious.write_text("three years of work")
    for name in outputs.OUTPUT_FILES.keys() - {"run.walk", "champion.png"}:
        (path.parent / name).symlink_to(precious)
    assert main(["resume", str(path), "--quiet"]) == 0
    assert precious.read_text() == "three years of work"
    assert outputs.are_there(path)
