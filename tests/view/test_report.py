"""The report of a run is complete, accessible and harmless; its code repeats the run."""

import re
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot

import walkerlab as wl
from tests.text.test_html import HOSTILE, assert_harmless
from tests.view.test_display import hostile_function
from walkerlab.ga.selection import tournament
from walkerlab.runfile.records import RECORD_COLUMNS, concatenate_tables
from walkerlab.simulation.fitness import distance
from walkerlab.simulation.robustness import Confirmation
from walkerlab.text.numbers import with_unit
from walkerlab.view import report
from walkerlab.view.report import page, pictures
from walkerlab.view.report.code import as_python
from walkerlab.view.report.pictures import FORMATS, PICTURES

TINY = wl.Settings().with_(
    generations=3, population_size=6, duration=1, structure="stairs", step_height=0.02, selection=["top_half", "rank"]
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    with ThreadPoolExecutor(1) as thread:
        return wl.evolve(TINY, tmp_path_factory.mktemp("run") / "run.walk", thread, progress=False)


@pytest.fixture(scope="module")
def path(run, tmp_path_factory):
    return run.save_report(tmp_path_factory.mktemp("report") / "new")


@pytest.fixture
def only_svg(monkeypatch):
    """Save each picture in one format, which is faster; the page then also links to one format."""
    monkeypatch.setattr(pictures, "FORMATS", ("svg",))
    monkeypatch.setattr(page, "FORMATS", ("svg",))


@pytest.fixture(scope="module")
def seen(path):
    return assert_harmless(path.read_text(encoding="utf-8"))


def tagged(seen, tag):
    return [attributes for name, attributes in seen.elements if name == tag]


def test_the_folder_contains_the_page_all_pictures_and_all_tables(run, path):
    assert path.name == "report.html"
    files = {file.relative_to(path.parent).as_posix() for file in path.parent.rglob("*") if file.is_file()}
    pictures = {f"pictures/{picture.name}.{ending}" for picture in PICTURES for ending in FORMATS}
    assert files == {
        "report.html",
        "replay.html",
        "records.csv",
        "tables/generations.csv",
        "tables/champion.csv",
        *pictures,
    }
    for name, start in {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG"}.items():
        assert all(file.read_bytes().startswith(start) for file in path.parent.rglob(f"*.{name}"))


def test_every_picture_is_on_the_page_with_a_title_and_an_explanation(seen):
    assert len(tagged(seen, "svg")) + len(tagged(seen, "img")) == len(PICTURES) == len(tagged(seen, "figcaption"))
    for picture in PICTURES:
        assert picture.title in seen.text
        assert picture.explanation in seen.text


def test_every_link_leads_to_a_section_or_a_file_of_the_report(path, seen):
    for link in tagged(seen, "a"):
        assert link["href"].startswith("#") or (path.parent / link["href"]).is_file()


def test_levels_of_headings_are_not_skipped(seen):
    levels = [int(tag[1]) for tag, _ in seen.elements if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))


def test_the_page_contains_settings_versions_and_the_champion(run, seen):
    for name in TINY.changes():
        assert f"●\N{NO-BREAK SPACE}{name}" in seen.text
    champion = run.champion
    for text in (
        "mujoco",
        "python",
        str(champion.genome),
        f"robot {champion.individual}",
        with_unit(champion.fitness, "m"),
    ):
        assert text in seen.text
    for domain in (wl.Terrain, wl.Robot, wl.Algorithm, wl.Simulation):
        assert all(declared.about in seen.text for declared in domain.declared().values())


def test_the_table_files_contain_the_numbers_of_the_run(run, path):
    records = pd.read_csv(path.parent / "records.csv", keep_default_na=False)
    pd.testing.assert_frame_equal(records, run.records)
    texts = pd.read_csv(path.parent / "records.csv", dtype=str)
    for name in ("fitness", "distance", "velocity", "weight", "body_length"):
        assert texts[name].map(float).tolist() == run.records[name].tolist()
    generations = pd.read_csv(path.parent / "tables" / "generations.csv")
    counted = run.records[run.records.verdict == "ok"]
    assert generations.best.tolist() == pytest.approx(counted.groupby("generation").fitness.max().tolist())
    assert generations.robots.tolist() == [6, 6, 6]
    walk = pd.read_csv(path.parent / "tables" / "champion.csv")
    assert walk.x.iloc[-1] - walk.x.iloc[0] == pytest.approx(run.champion.fitness)


def test_columns_of_tables_on_the_page_match_their_headers(run, path):
    text = path.read_text(encoding="utf-8")
    rows = rows_under(text, "Fitness of the walks that count")
    assert [cell.partition(" ")[0] for cell in rows[0]] == ["generation", "best", "median", "counted", "robots"]
    for row, (generation, table) in zip(rows[1:], run.records.groupby("generation"), strict=True):
        counted = table.fitness[table.verdict == "ok"]
        assert [float(cell.replace("–", "nan")) for cell in row[1:3]] == pytest.approx(
            [counted.max(), counted.median()], rel=0.006, nan_ok=True
        )
        assert [row[0], *row[3:]] == [str(generation), f"{len(counted)}", "6"]
    confirmed = run.confirm()
    shares = [row[1] for row in rows_under(text, "when it walks again")[1:3]]
    assert shares == [f"{confirmed.kept_finer:.0%}", f"{confirmed.kept_nudged:.0%}"]
    confirmation = Confirmation(2.0, 1.0, (0.2, 0.5, 0.6), ("ok",) * 4, "distance m")
    shown = rows_under(str(confirmation.table()), "when it walks again")
    assert [row[1] for row in shown[1:]] == ["50%", "25%", "10%"]


def rows_under(page, caption):
    """Return the rows of the table whose caption contains a text."""
    (table,) = [table for table in re.findall("<table.*?</table>", page, re.S) if caption in table]
    rows = re.findall("<tr.*?</tr>", table, re.S)
    return [[re.sub("<.*?>", "", cell).strip() for cell in re.findall(r"<t[hd].*?</t[hd]>", row, re.S)] for row in rows]


def test_the_share_of_walks_that_count_is_taken_over_births(run, tmp_path):
    records = run.records.copy()
    elite = records[records.generation > records.born].individual.iloc[0]
    records.loc[records.individual != elite, ["verdict", "fitness"]] = ["fell", -np.inf]
    n_walks, n_rows = records.individual.nunique(), len(records)
    text = report.save_report(TINY, records, tmp_path, files=False).read_text(encoding="utf-8")
    assert f"{1 / n_walks:.0%}" != f"{(records.verdict == 'ok').sum() / n_rows:.0%}", "the shares must differ"
    assert f"<b>{1 / n_walks:.0%}</b>" in text
    assert f"<b>{n_walks}</b>" in text


def test_a_table_without_its_first_generation_is_reported_in_any_matplotlib_style(run, tmp_path):
    run.records[run.records.born >= 1].to_csv(tmp_path / "records.csv", index=False)
    later = wl.Run(TINY, pd.read_csv(tmp_path / "records.csv"))
    plain = report.save_report(TINY, later.records, tmp_path / "plain", files=False).read_bytes()
    assert b"the table begins with generation 1" in plain
    with pyplot.style.context("dark_background"):
        assert report.save_report(TINY, later.records, tmp_path / "dark", files=False).read_bytes() == plain


def my_mutation(genomes, genes, *, rng, strength=1.0):
    return genomes.copy()


@pytest.mark.parametrize(
    "settings",
    [
        wl.Settings(),
        TINY,
        TINY.with_(gravity="moon", weight=(2, 5.5), terrain_seed=3, seed=4, forgive=["fell", "airborne"]),
        TINY.with_(fitness=distance, selection=[partial(tournament, size=7), "rank"]),
        TINY.with_(mutation=[partial(my_mutation, strength=0.5), my_mutation]),
    ],
    ids=["default", "tiny", "many", "built-in", "user"],
)
def test_the_code_that_repeats_a_run_has_the_same_settings(settings):
    evolved = []
    code = as_python(settings).replace("wl.evolve(", "evolve(")
    exec(code, {"evolve": evolved.append, "my_mutation": my_mutation})
    assert [evolved_settings.model_dump() for evolved_settings in evolved] == [settings.model_dump()]


def test_the_page_contains_this_code(seen):
    assert as_python(TINY) in seen.text


def test_the_page_links_to_the_replay(run, path, seen):
    assert "replay.html" in [link["href"] for link in tagged(seen, "a")]
    assert f"robot {run.champion.individual}" in (path.parent / "replay.html").read_text(encoding="utf-8")


def test_the_same_run_gives_the_same_page(run, path, tmp_path):
    assert run.save_report(tmp_path).read_bytes() == path.read_bytes()


def test_an_earlier_report_stays_if_the_new_one_cannot_be_written(run, tmp_path, only_svg, monkeypatch):
    run.save_report(tmp_path)
    before = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    assert tmp_path / "report.html" in before

    def disk_full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", disk_full)
    with pytest.raises(OSError, match="No space"):
        run.save_report(tmp_path)
    assert {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == before


def test_hostile_texts_stay_texts(run, tmp_path, only_svg):
    records = run.records.copy()
    records["reason"] = HOSTILE
    records["operators"] = HOSTILE
    records.loc[records.index[3], "verdict"] = "<script>x()</script>"
    settings = run.settings.with_(fitness=hostile_function, mutation=hostile_function)
    written = wl.Run(settings, records).save_report(tmp_path / HOSTILE.replace("/", " "))
    assert HOSTILE in assert_harmless(written.read_text(encoding="utf-8")).text


def test_a_loaded_run_with_user_functions_is_reported(tmp_path, only_svg):
    settings = TINY.with_(fitness=partial(my_fitness, power=2), mutation=my_mutation, generations=1)
    with ThreadPoolExecutor(1) as thread:
        wl.evolve(settings, tmp_path / "run.walk", thread, progress=False)
    text = assert_harmless(wl.load(tmp_path).save_report(tmp_path).read_text(encoding="utf-8")).text
    assert "mutation=my_mutation" in text
    assert "my_fitness, my_mutation" in text


def my_fitness(rollout, power):
    return abs(rollout.distance) ** power


def test_a_run_in_which_no_walk_counts_is_reported(tmp_path, only_svg):
    settings = TINY.with_(structure="flat", generations=1, gravity=(0, 0, 1), forgive=["restless", "too_high"])
    with ThreadPoolExecutor(1) as thread:
        run = wl.evolve(settings, executor=thread, progress=False)
    assert run.champion.verdict != "ok", "the test requires a run without a walk that counts"
    seen = assert_harmless(run.save_report(tmp_path).read_text(encoding="utf-8"))
    assert "No walk counted" in seen.text
    assert not re.search(r"\b(nan|inf)\b", seen.text)
    assert_harmless(run._repr_html_())


def test_an_empty_run_has_no_report(tmp_path):
    with pytest.raises(ValueError, match="no robot has walked yet"):
        wl.Run(wl.Settings(), concatenate_tables([])).save_report(tmp_path / "none")
    assert not (tmp_path / "none").exists()


def test_columns_are_the_documented_ones(path):
    header = Path(path.parent / "records.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header.split(",") == list(RECORD_COLUMNS)
    assert np.isfinite(pd.read_csv(path.parent / "tables" / "champion.csv").to_numpy()).all()
