"""A number that is shown can be read back, and a fitness is shown in one way wherever it is shown."""

import ast
import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

import walkerlab as wl
from tests.simulation.test_validity import WALKER
from tests.view.test_plots import evolved_table
from walkerlab.evolution import running
from walkerlab.evolution.generation import Generation
from walkerlab.runfile.records import Individual, name_fitness
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.simulation.robustness import Confirmation
from walkerlab.text.numbers import (
    NO_VALUE,
    format_fixed_column,
    format_significant,
    format_significant_column,
    with_unit,
)
from walkerlab.view import film, summary
from walkerlab.view.replay import replay
from walkerlab.view.report import content
from walkerlab.view.report.pictures import Subject
from walkerlab.widgets.listing import SORT_COLUMNS, describe_generation
from walkerlab.widgets.panel.card import robot_card
from walkerlab.widgets.panel.run_folders import best_result

SIZES = st.floats(-9, 9).map(lambda power: 10**power)
FITNESS = st.one_of(st.just(0.0), SIZES, SIZES.map(lambda size: -size))


def is_read_back(text, value):
    """Say whether a text is this number to three significant figures."""
    number = float(text.replace("−", "-"))
    half = 0.5 * 10.0 ** (math.floor(math.log10(abs(value))) - 2) if value else 0.0
    return abs(number - value) <= half * (1 + 1e-9) + 1e-15 * abs(value)


# ---------------------------------------------------------------------------------------------------------- numbers


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0032, "0.00320"),
        (0.001, "0.00100"),
        (0.00099951, "0.00100"),
        (0.0009994, "9.99e-04"),
        (2.0, "2.00"),
        (-2.345678, "-2.35"),
        (9.996, "10.0"),
        (12345.6, "12346"),
        (99949.0, "99949"),
        (1e5, "1.00e+05"),
        (1e90, "1.00e+90"),
        (-1.234e-7, "-1.23e-07"),
        (0.0, "0"),
        (-0.0, "0"),
        (-math.inf, NO_VALUE),
        (math.nan, NO_VALUE),
    ],
)
def test_a_number_is_written_to_three_significant_figures(value, text):
    assert format_significant(value) == text


def test_a_unit_follows_after_a_blank():
    assert (with_unit(1.5, "m"), with_unit(1.5, "")) == ("1.50 m", "1.50")


@given(st.floats(-1e100, 1e100))
def test_any_number_is_read_back_and_is_short(value):
    assert float(format_significant(value)) == pytest.approx(value, rel=5.1e-3, abs=0)
    assert len(format_significant(value)) <= 10


@given(st.lists(FITNESS, min_size=1, max_size=8))
def test_every_number_of_a_column_is_read_back(values):
    for text, value in zip(format_significant_column(values), values, strict=True):
        assert is_read_back(text, value)
        assert not re.fullmatch(r"-0\.?0*", text)


def test_the_points_of_a_column_align_as_far_as_its_sizes_allow():
    assert format_significant_column([2.345, 0.0412, -0.5, 0.0]) == ["2.3450", "0.0412", "-0.5000", "0.0000"]
    assert format_significant_column([2.345, 1e-6, math.nan]) == ["2.3450", "1.00e-06", NO_VALUE]
    assert format_significant_column([1e-6, 2e-5]) == ["1.00e-06", "2.00e-05"]
    assert format_significant_column([-math.inf]) == [NO_VALUE]


def test_a_column_of_known_scale_has_more_decimals_where_all_are_small():
    assert format_fixed_column([1.234, -0.0001, math.nan], 2) == ["1.23", "0.00", NO_VALUE]
    assert format_fixed_column([0.004, 0.001], 2) == ["0.00400", "0.00100"]


# ---------------------------------------------------------------------------------------------------------- fitness


def near(rollout):
    return rollout.distance


SETTINGS = wl.Settings().with_(duration=1, population_size=4, fitness=near)
PLAIN = SETTINGS.model_dump()
TABLE = evolved_table(2, 4, void=0)


def run_of(value):
    """Make up a run in which every robot has this fitness."""
    table = TABLE.assign(fitness=value)
    name_fitness(table, "near", "")
    return wl.Run(SETTINGS, table)


def found(pattern, text):
    (numbers,) = set(re.findall(pattern, text, re.S))
    return [numbers] if isinstance(numbers, str) else list(numbers)


def evaluation(value):
    genome = wl.Genome.parse(WALKER)
    return Evaluation(genome, value, "ok", "", 1.0, 1.0, 2, 4, 1.0, 1.0)


def progress(run):
    class Finished:
        def __iter__(self):
            return iter([Generation(0, run.records)])

    done = Finished()
    words = []
    done.run = run
    running._run_to_end(done, SimpleNamespace(set_postfix_str=words.append))
    return words[0]


def of_report(run):
    subject = Subject(run.settings, run.records, run.champion, None)
    (_, best, median, *_), *_ = content.generation_cells(subject)
    *_, (_, _, fitness, _) = content.descent_cells(subject)
    return [best, median, fitness]


def of_roster(run):
    row = describe_generation(run.records[run.records.generation == 0])["rows"][0]
    cell = dict(zip(SORT_COLUMNS, row["cells"], strict=True))["fitness"]
    return [cell, row["label"], *found(r"Its near is (\S+)\.", row["description"])]


def of_confirmation(value):
    confirmed = Confirmation(value, value, (value,), ("ok", "ok"), "near(target=2, k=3)")
    return found(r"k=3\) of (\S+), when", str(confirmed)) + found(r"k=3\) of ([^\s,]+),? when", str(confirmed.table()))


PLACES = {
    "run": lambda run, _: found(r"near (\S+)\)$", repr(run)),
    "individual": lambda run, _: found(r">fitness</th><td>(.*?)<", run.champion._repr_html_()),
    "evaluation": lambda _, value: found(r"fitness (\S+),", repr(evaluation(value))),
    "summary": lambda run, _: found(r" of (\S+), from (\S+) in", summary.describe_result(run.records, PLAIN)),
    "champion": lambda run, _: found(r"\) is (\S+)\.\n", summary.describe_champion(run.records, PLAIN)),
    "generations": lambda run, _: summary.tabulate_generations(run.records, PLAIN).split("\n")[-1].split()[1:3],
    "descent": lambda run, _: [
        summary.tabulate_descent(run.records, run.champion.individual).split("\n")[-1].split()[2]
    ],
    "report": lambda run, _: of_report(run),
    "list of runs": lambda run, _: [best_result(run)],
    "film": lambda run, _: [film._write_caption(film.ChampionPeriod(run.champion, 0, 1), "").split(" · ")[-1]],
    "card": lambda run, _: found(r">Fitness</th><td>(.*?)<", robot_card(run.records, run.champion.individual)),
    "roster": lambda run, _: of_roster(run),
    "progress": lambda run, _: found(r"best (\S+)$", progress(run)),
    "confirmation": lambda _, value: of_confirmation(value),
}


@settings(max_examples=20)
@given(FITNESS)
def test_a_fitness_is_read_back_from_every_text(value):
    run = run_of(value)
    for name, read in PLACES.items():
        texts = read(run, value)
        assert texts, name
        assert all(is_read_back(text, value) for text in texts), (name, texts)


DRAWN = [0.0, *(sign * 1.2345 * 10.0**power for power in (-9, -4, 0, 4, 8) for sign in (1, -1))]


@pytest.mark.parametrize("value", DRAWN)
def test_a_fitness_is_read_back_from_every_picture(value):
    run = run_of(value)
    curve, trait, tree = (Figure().add_subplot() for _ in range(3))
    wl.plots.fitness_curve(run, curve)
    wl.plots.trait(run.records, "fitness", trait)
    wl.plots.family_tree(run, tree, individual=0)
    texts = found(r"best stays at (\S+), the median stays at (\S+)\.", wl.plots.alt_text(curve))
    texts += found(r"median stays at (\S+), the value of the best robot stays at (\S+)\.", wl.plots.alt_text(trait))
    texts += found(r": fitness (\S+)\. It", wl.plots.alt_text(tree))
    texts += [text.get_text() for text in tree.texts if text.get_weight() == "bold"]
    assert len(texts) == 6
    assert all(is_read_back(text, value) for text in texts), texts


@pytest.mark.parametrize("value", [value for value in DRAWN if value])
@pytest.mark.parametrize("spread", [1.0, 1e-2])
def test_the_ticks_of_a_curve_are_read_back_and_lie_off_its_legend(value, spread):
    run = run_of(value)
    table = run.records
    table["fitness"] = value * (1 + spread * np.linspace(-1, 1, len(table)))
    axes = wl.plots.fitness_curve(table, Figure(layout="constrained").add_subplot())
    axes.figure.draw_without_rendering()
    power = axes.yaxis.get_offset_text()
    factor = float(power.get_text().replace("−", "-") or 1)
    low, high = axes.get_ylim()
    ticks = [(float(label.get_text().replace("−", "-")), place) for label, place in zip(
        axes.get_yticklabels(), axes.get_yticks(), strict=True) if low <= place <= high]  # fmt: skip
    assert len(ticks) >= 2
    assert all(shown * factor == pytest.approx(place, rel=1e-6, abs=1e-6 * abs(value)) for shown, place in ticks)
    assert all(len(label.get_text()) <= 9 for label in axes.get_yticklabels())
    if power.get_text():
        assert not power.get_window_extent().overlaps(axes.get_legend().get_window_extent())


@pytest.mark.parametrize("value", DRAWN)
def test_a_fitness_is_read_back_from_the_board_of_a_replay(value, walked):
    shown = replace(walked, settings=walked.settings.with_(fitness=lambda _: value))
    assert is_read_back(dict(shown._walk_facts(shown.walks[0])["facts"])["<lambda>"], value)


@pytest.fixture(scope="module")
def walked():
    return replay(WALKER, SETTINGS)


def test_where_no_walk_counts_no_number_is_shown():
    run = wl.Run(SETTINGS, TABLE.assign(fitness=-math.inf, verdict="fell", reason="it lay down"))
    tree = wl.plots.family_tree(run, Figure().add_subplot())
    texts = [
        repr(run),
        repr(replace(evaluation(-math.inf), verdict="fell")),
        run.champion._repr_html_(),
        summary.describe_result(run.records, PLAIN),
        summary.describe_champion(run.records, PLAIN),
        summary.tabulate_generations(run.records, PLAIN),
        summary.tabulate_descent(run.records, run.champion.individual),
        best_result(run),
        robot_card(run.records, run.champion.individual),
        progress(run),
        str(Confirmation(-math.inf, -math.inf, (-math.inf,), ("fell", "fell"), "near")),
        wl.plots.alt_text(wl.plots.fitness_curve(run, Figure().add_subplot())),
        wl.plots.alt_text(tree),
        str(describe_generation(run.records)["rows"]),
        film._write_caption(film.ChampionPeriod(run.champion, 0, 1), ""),
    ]
    for text in texts:
        assert not re.search(r"\b(inf|nan)\b", text), text
        assert "fitness fell" not in text
    assert "its walk does not count (fell)" in wl.plots.alt_text(tree)


def test_no_fitness_is_formatted_anywhere_else():
    """A format of its own would be another way to show a fitness."""
    for path in Path(wl.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FormattedValue) and node.format_spec:
                shown = ast.unparse(node.value)
                how = ast.unparse(node.format_spec)
                is_number = re.search(r"[.\d}][fge]'?$", how)
                assert not (is_number and re.search(r"fitness|best|score|median", shown)), (path.name, shown)


def test_an_individual_has_its_fitness_to_the_last_digit_for_programs():
    one = Individual(1, wl.Genome.parse(WALKER), 1.23456789, "ok", "", 0, ())
    assert "fitness=1.23456789" in repr(one)
