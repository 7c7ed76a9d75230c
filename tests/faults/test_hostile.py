"""Run files made to do harm, with every seal in its place: they are refused, or what is in them is text."""

import json
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

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
def honest(tmp_path_factory):
    """A small run that nobody has touched."""
    path = tmp_path_factory.mktemp("honest") / "run.walk"
    settings = wl.Settings().with_(population_size=6, generations=2, n_elites=1, duration=1, seed=2)
    with ThreadPoolExecutor(2) as pool:
        return wl.evolve(settings, path, executor=pool, progress=False).path


@pytest.fixture
def forge(honest, tmp_path):
    """Return a function that copies the run, changes it, and seals it anew: forge("UPDATE …", ["UPDATE … ?", text])."""

    def forged(*statements, settings=lambda plain: plain):
        path = tmp_path / "run.walk"
        path.write_bytes(honest.read_bytes())
        with closing(sqlite3.connect(path)) as db, db:
            for statement in statements:
                db.execute(*([statement] if isinstance(statement, str) else [statement[0], statement[1:]]))
            schema.write_settings(db, json.dumps(settings(json.loads(schema.read_fact(db, "settings")))))
            made_with = [row for (row,) in db.execute("SELECT made_with FROM provenance")]
            db.execute("DELETE FROM generations")
            for (generation,) in db.execute("SELECT DISTINCT generation FROM records").fetchall():
                schema.seal_generation(db, generation, made_with[0])
        return path

    return forged


def with_functions(plain):
    """Put hostile texts where functions are named."""
    return {**plain, "algorithm": {**plain["algorithm"], "mutation": FUNCTION, "selection": ["gradient", FUNCTION]}}


TEXTS = (
    ["UPDATE records SET operators = ?, reason = ?", SCRIPT, WORSE],
    ["UPDATE records SET operators = ?, reason = ? WHERE individual = 4", SQL, "../../secret"],
    ["UPDATE provenance SET made_with = ?", json.dumps({SCRIPT: WORSE, "mujoco": SQL, "numpy": "../../secret"})],
    ["UPDATE run SET value = ? WHERE fact = 'id'", SCRIPT],
)


def test_a_forged_file_that_is_honest_is_read(forge, honest):
    assert wl.load(forge()).records.equals(wl.load(honest).records)


REFUSED = {
    "a verdict that moves the cursor": ["UPDATE records SET verdict = ?", "ok\x1b[2J\x1b]52;c;aGFja2Vk\x07"],
    "a verdict that is no word": ["UPDATE records SET verdict = ?", SCRIPT],
    "operators that move the cursor": ["UPDATE records SET operators = ?", "\x9b2J"],
    "parents that are none": ["UPDATE records SET parents = ?", SQL],
    "a parent with a million digits": ["UPDATE records SET parents = ?", "9" * 10**6],
    "a fitness without end": "UPDATE records SET fitness = 9e999",
    "a fitness that is none": "UPDATE records SET fitness = NULL",
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


@pytest.mark.parametrize("statement", REFUSED.values(), ids=REFUSED)
def test_what_no_run_has_in_it_is_refused_in_words(forge, statement, capsys):
    path = forge(statement)
    with pytest.raises(wl.RunFileError) as refused:
        wl.load(path)
    assert str(path) in str(refused.value)
    assert len(str(refused.value)) < 800
    for words in (["show", str(path)], ["resume", str(path), "--quiet"], ["evolve", "--out", str(path.parent)]):
        assert main(words) == 2
        told = capsys.readouterr()
        assert (told.out + told.err).replace("\n", "").isprintable()


@pytest.mark.parametrize(
    "name", ["\n__import__('os')", SCRIPT, "a b", "", "\x1b[2J", "9", "\ud800", "eval", "ｅｖａｌ", "exit"]
)
def test_a_function_that_has_no_name_is_refused(forge, name):
    """Or its name would be a line of the code that repeats the run."""
    functions = [{"function": f"home.{name}", "with": {}}, {"function": "home.mine", "with": {name: 1}}]
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
def test_settings_that_cannot_be_are_refused_in_words(forge, settings, capsys):
    path = forge(settings=lambda plain: {**plain, **settings} if isinstance(settings, dict) and settings else settings)
    with pytest.raises(wl.RunFileError, match="damaged"):
        wl.load(path)
    assert main(["show", str(path)]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_a_genome_that_is_none_is_told_where_it_is_needed(forge, capsys):
    path = forge(["UPDATE records SET genome = ?", SCRIPT])
    with pytest.raises(wl.GenomeError):
        wl.load(path).champion  # noqa: B018
    assert main(["show", str(path)]) == 2
    with pytest.raises(wl.RunFileError, match="damaged"):
        wl.resume(path, 3, progress=False)


GREEDY = """
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
def test_a_text_that_says_it_is_a_gigabyte_takes_no_memory(forge):
    """The file is cut off behind the text's beginning, and its header made to agree."""
    path = forge()
    size = path.stat().st_size
    with closing(sqlite3.connect(path)) as db, db:
        db.execute("PRAGMA synchronous = OFF")
        db.execute("UPDATE records SET reason = zeroblob(?) WHERE individual = 0", [number(3_000_000, 999_000_000)])
    with path.open("r+b") as file:
        file.truncate(size)
        file.seek(28)
        file.write((size // 8192).to_bytes(4, "big"))
    told = subprocess.run([sys.executable, "-c", GREEDY, path], capture_output=True, text=True, check=True).stdout
    *refusals, grown = told.splitlines()
    assert refusals
    assert int(grown) < 50_000, "kB"


def test_nothing_but_the_folder_is_written_to(forge, tmp_path):
    path = forge(*TEXTS, settings=with_functions)
    before = {one.name for one in tmp_path.iterdir()}
    run = wl.load(path)
    run.save_report(tmp_path / "report")
    wl.export_mjcf(run.champion.genome, run.settings, tmp_path / "report")
    assert {one.name for one in tmp_path.iterdir()} == before | {"report"}
    with pytest.raises(wl.RunFileError, match="holds no code"):
        wl.resume(path, progress=False)


def test_in_a_terminal_it_is_text(forge, capsys):
    path = forge(*TEXTS, settings=with_functions)
    assert main(["show", str(path)]) == 0
    told = capsys.readouterr().out
    assert SCRIPT in told
    assert told.replace("\n", "").isprintable()


def unharmed(page):
    """Say whether nothing of the stranger's has run in a page, nor in any frame of it."""
    return all(frame.evaluate("window.hacked") is None for frame in page.frames)


def test_in_a_browser_it_is_text(forge, page, tmp_path):
    run = wl.load(forge(*TEXTS, settings=with_functions))
    report = run.save_report(tmp_path / "report")
    card = tmp_path / "card.html"
    card.write_text(f"<!doctype html><meta charset=utf-8>{run._repr_html_()}", encoding="utf-8")
    for shown in (report, report.with_name("replay.html"), card):
        page.goto(shown.as_uri())
        page.wait_for_load_state("networkidle")
        assert unharmed(page)
    page.goto(report.as_uri())
    page.get_by_text(SCRIPT).first.scroll_into_view_if_needed()
    picture(page, "hostile-report")


def test_in_the_panel_it_is_text(forge, page, jupyter):
    path = forge(*TEXTS, settings=with_functions)
    page.set_viewport_size({"width": 1280, "height": 800})
    cells = f"import walkerlab as wl\nwl.load({str(path)!r})", "lab = wl.Lab()\nlab"
    assert run_all(page, jupyter.put(book(*cells), "JupyterLab")) == []
    page.get_by_label("run file to load").fill(str(path))
    button(page, "Load", ".wl-drawer").click()
    says(page, "Loaded", ".wl-drawer")
    curve_says(page, "generations:")
    button(page, "Copy as code", ".wl-drawer").click()
    page.wait_for_timeout(1000)
    assert unharmed(page)
    picture(page, "hostile-panel")


@pytest.mark.parametrize("bomb", [bombs.endless_schema, bombs.endless_index])
def test_a_file_without_an_end_is_refused_before_long(forge, bomb, tmp_path):
    path = forge()
    bomb(path)
    before = time.process_time()
    with pytest.raises(wl.RunFileError):
        wl.load(path)
    rescued, refusal = attempt(wl.rescue, path, tmp_path / "rescued.walk")
    assert refusal or not rescued.n_generations, "the settings at most"
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
def test_a_text_of_a_run_is_no_line_of_the_next(forge, capsys):
    path = forge(["UPDATE provenance SET made_with = ?", json.dumps({"mujoco": "1\x1b[2J\nok   all is well"})])
    main(["show", str(path)])
    main(["resume", str(path), "--generations", "3", "--quiet"])
    told = capsys.readouterr()
    assert "\x1b" not in told.out + told.err
    assert "\nok " not in told.out + told.err
    assert "Note: " in told.err


def test_what_points_elsewhere_is_not_written_through(forge, tmp_path):
    path = forge()
    precious = tmp_path / "precious"
    precious.write_text("three years of work")
    for name in outputs.OUTPUT_FILES.keys() - {"run.walk", "champion.png"}:
        (path.parent / name).symlink_to(precious)
    assert main(["resume", str(path), "--quiet"]) == 0
    assert precious.read_text() == "three years of work"
    assert outputs.are_there(path)
