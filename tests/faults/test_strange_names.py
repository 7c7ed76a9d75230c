"""Texts from files or users are escaped in terminals, spreadsheets, pictures, pages and file names."""

import re
from concurrent.futures import ThreadPoolExecutor
from xml.etree import ElementTree

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

import walkerlab as wl
from walkerlab.__main__ import main
from walkerlab.evolution.run import Run
from walkerlab.text.escape import escape_cell, printable
from walkerlab.view.plots import fitness_curve, save
from walkerlab.view.report.code import user_functions
from walkerlab.view.table_files import escape_formulas

SMALL = wl.Settings().with_(population_size=4, generations=2, duration=1)
STRANGE = "=x\x1b]0;pwned\x07\x1b[2J\x00\u202e\ud800</script><img src=x onerror=alert(1)>\nimport this"
FORMULAS = ["=1+1", "+1", "-1", "@sum(A1)"]


def fitness_named(name):
    """Return a fitness function with this name."""

    def fitness(rollout):
        return wl.fitness.distance(rollout)

    fitness.__name__ = name
    return fitness


def evolved(path=None):
    with ThreadPoolExecutor(1) as pool:
        return wl.evolve(SMALL, path, pool, progress=False)


@pytest.fixture(scope="module")
def run():
    """Run whose table contains malicious texts."""
    records = evolved().records
    malicious = {"operators": [STRANGE, *FORMULAS], "reason": [f"+{STRANGE}", *FORMULAS]}
    told = {name: [texts[i % len(texts)] for i in range(len(records))] for name, texts in malicious.items()}
    return Run(SMALL, records.assign(**told))


@pytest.fixture(scope="module")
def report(run, tmp_path_factory):
    """Folder of the report of that run."""
    return run.save_report(tmp_path_factory.mktemp("report")).parent


@given(st.text())
def test_printable_text_is_unchanged_and_control_characters_are_escaped(text):
    said = printable(text, keep="\n")
    assert all(one.isprintable() or one == "\n" for one in said)
    said.encode("utf-8")
    assert printable(said, keep="\n") == said
    assert not text.isprintable() or said == text


@given(st.text())
def test_no_cell_is_a_formula(text):
    assert not escape_cell(text).startswith(("=", "+", "-", "@", "\t", "\r"))
    assert escape_cell(text) in (printable(text, keep="\n"), f"'{printable(text, keep=chr(10))}")


def test_the_table_contains_no_formulas(report):
    table = pd.read_csv(report / "records.csv", keep_default_na=False)
    for name in ("operators", "reason"):
        assert {f"'{formula}" for formula in FORMULAS} < set(table[name])
        assert not table[name].str.startswith(tuple("=+-@\t\r")).any()


def test_a_table_without_formulas_is_unchanged():
    records = evolved().records
    pd.testing.assert_frame_equal(escape_formulas(records), records)


def test_a_report_contains_no_scripts_and_valid_pictures(report):
    page = (report / "report.html").read_text(encoding="utf-8")
    assert "<img src=x" not in page
    assert "<script" not in page
    for picture in (report / "pictures").glob("*.svg"):
        ElementTree.parse(picture)


def test_strange_labels_give_valid_pictures(tmp_path, run):
    axes = fitness_curve(run.records, Figure().add_subplot(), label=STRANGE)
    save(axes, tmp_path / "curve.svg")
    ElementTree.parse(tmp_path / "curve.svg")


def test_strange_names_are_escaped_in_a_replay(tmp_path):
    robots = wl.generate_robot_population(SMALL.robot, 2, seed=0)
    for walkers in ({STRANGE: robots[0]}, {STRANGE: robots[0], "Bob": robots[1]}):
        page = wl.replay(walkers, SMALL).to_html(tmp_path / "replay.html").read_text(encoding="utf-8")
        assert "<img src=x" not in page
        assert len(re.findall("</script>", page)) == len(re.findall("<script", page))


def test_the_name_of_a_function_cannot_end_a_comment():
    (name,) = user_functions(SMALL.with_(fitness=fitness_named(STRANGE)))
    assert name.isprintable()


def test_show_prints_no_control_characters(tmp_path, capsys, monkeypatch, run):
    evolved(tmp_path / "run.walk")
    strange = Run(SMALL, run.records.assign(operators=STRANGE))
    monkeypatch.setattr("walkerlab.evolution.loading.load", lambda path: strange)
    assert main(["show", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert "pwned" in shown
    assert all(one.isprintable() or one == "\n" for one in shown)


def test_errors_contain_no_control_characters(tmp_path, capsys):
    assert main(["show", str(tmp_path / "\x1b[2J")]) == 2
    assert "\x1b" not in capsys.readouterr().err


@pytest.mark.parametrize("name", ["", ".", "..", "../x", "a/b", "a\\b", "a\x00b", "a\nb", "\x1b[2J", "c:x", "\ud800"])
def test_an_invalid_file_name_is_rejected(tmp_path, name):
    robot = wl.generate_robot_population(SMALL.robot, 1, seed=0)[0]
    with pytest.raises(ValueError, match="must be a file name without a folder"):
        wl.export_mjcf(wl.Genome(robot), SMALL, tmp_path / "new", name=name)
    assert not list(tmp_path.iterdir())


def test_a_file_name_may_use_any_alphabet(tmp_path):
    robot = wl.generate_robot_population(SMALL.robot, 1, seed=0)[0]
    assert wl.export_mjcf(wl.Genome(robot), SMALL, tmp_path, name="Ωmega der 2. (=schnell)").is_file()
