"""Plots show the numbers of the table or the walk, and have an alternative text with the main ones."""

import io
import math
import re
import struct
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import matplotlib as mpl
import mujoco
import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.patches import StepPatch

import walkerlab as wl
from walkerlab.ga.loop import first_population, next_population
from walkerlab.genome.breeding import generate_robot_population, resolve_operators
from walkerlab.genome.features import build_genes
from walkerlab.genome.repair import repair
from walkerlab.runfile.records import (
    RECORD_COLUMNS,
    EvaluationRow,
    birth_rows,
    concatenate_tables,
    fitter_line,
    name_fitness,
    parent_numbers,
    tabulate_generation,
    tidy_table,
)
from walkerlab.settings.choices import Obstacle, Structure
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.footfalls import find_footfalls, foot_names
from walkerlab.simulation.validity import VERDICTS
from walkerlab.view import summary
from walkerlab.view.plots import genomes as plots_of_genomes
from walkerlab.view.plots.ancestry import MAX_COMPLETE_LINE, N_DRAWN_OF_LONG_LINE
from walkerlab.view.plots.bodies import add_body, resting_scene
from walkerlab.world.geometry import surface_points
from walkerlab.world.heights import ground_height


def random_table(n=8, seed=0):
    rng = np.random.default_rng(seed)
    rows = pd.DataFrame(
        [(g, i, g, "", "random", rng.normal(g), "ok" if i else "airborne") for g in range(5) for i in range(n)],
        columns=list(RECORD_COLUMNS)[:7],
    )
    rows.loc[rows.verdict != "ok", "fitness"] = -np.inf
    table = rows.assign(distance=0.0, velocity=0.0, n_segments=1, n_legs=2, weight=1.0, body_length=1.0, genome="")
    return tidy_table(table)


def evolved_table(generations=6, size=10, *, void=0.2, **changes):
    """Return the table of a run with random evaluations in place of walks.

    Args:
        generations: Number of generations.
        size: Number of robots in a generation.
        void: Share of the walks that do not count.
        **changes: Settings that differ from the defaults.
    """
    settings = wl.Settings().with_(population_size=size, **changes)
    genes = build_genes(settings.robot)
    rng = np.random.default_rng(0)

    def evaluate_genome(values):
        robot = wl.express(wl.Genome(values))
        counts = rng.random() >= void
        measured = (len(robot.segments), robot.n_legs, robot.weight, robot.body_length)
        fitness, verdict = (rng.normal(), "ok") if counts else (-np.inf, rng.choice(list(VERDICTS)[1:]))
        return EvaluationRow(fitness, str(verdict), "", rng.normal(), rng.normal(), *measured, str(wl.Genome(values)))

    def evaluate(genomes):
        return [evaluate_genome(values) for values in genomes]

    population = first_population(generate_robot_population(settings.robot, size, seed=0), evaluate)
    tables = [tabulate_generation(population, "")]
    for _ in range(generations - 1):
        population = next_population(
            population, resolve_operators(settings.algorithm), genes, evaluate,
            repair=lambda genomes: repair(genomes, settings.robot), n_elites=settings.algorithm.n_elites, seed=0,
        )  # fmt: skip
        tables.append(tabulate_generation(population, ""))
    table = concatenate_tables(tables)
    name_fitness(table, "distance", "m")
    return table


@pytest.fixture(scope="module")
def records():
    return evolved_table()


GENOME = wl.Genome.random(wl.Robot(), rng=np.random.default_rng(2))
SETTINGS = wl.Settings().with_(duration=2.0)

TABLE_PLOTS = {
    "fitness_curve": wl.plots.fitness_curve,
    "diversity": wl.plots.diversity,
    "trait": lambda records, ax: wl.plots.trait(records, "weight", ax),
    "genes": wl.plots.genes,
    "verdicts": wl.plots.verdicts,
    "family_tree": wl.plots.family_tree,
    "pedigree": wl.plots.pedigree,
}
ROBOT_PLOTS = {
    "distance_over_time": lambda ax: wl.plots.distance_over_time(wl.simulate(GENOME, SETTINGS), ax),
    "gait": lambda ax: wl.plots.gait(GENOME, SETTINGS, ax),
    "body": lambda ax: wl.plots.body(GENOME, ax),
    "stride": lambda ax: wl.plots.stride(GENOME, SETTINGS, ax),
}
each_table_plot = pytest.mark.parametrize("draw", TABLE_PLOTS.values(), ids=TABLE_PLOTS)


def all_plots(records):
    return {name: lambda ax, draw=draw: draw(records, ax) for name, draw in TABLE_PLOTS.items()} | ROBOT_PLOTS


@pytest.fixture
def ax():
    return Figure().add_subplot()


def render(axes):
    axes.get_figure(root=True).canvas.draw()


def numbers_in(text):
    return [float(found) for found in re.findall(r"-?\d+(?:\.\d+)?", text.replace("−", "-"))]


# --------------------------------------------------------------------------------------------------- all plots


def test_every_plot_draws_on_the_given_axes_and_has_an_alternative_text(records):
    for name, draw in all_plots(records).items():
        axes = Figure().add_subplot()
        assert draw(axes) is axes, name
        render(axes)
        assert wl.plots.alt_text(axes).endswith("."), name
        assert not pyplot.get_fignums(), f"{name} created a second figure"


def test_without_axes_every_plot_creates_one_white_figure(records):
    for name, draw in all_plots(records).items():
        axes = draw(None)
        assert pyplot.get_fignums() == [axes.figure.number], name
        assert mpl.colors.same_color(axes.figure.get_facecolor(), "white")
        pyplot.close(axes.figure)


@pytest.mark.parametrize("kind", ["svg", "pdf", "png"])
def test_every_saved_file_contains_the_alternative_text(records, tmp_path, kind):
    for name, draw in all_plots(records).items():
        axes = draw(Figure().add_subplot())
        path = tmp_path / f"{name}.{kind}"
        wl.plots.save(axes, path)
        assert wl.plots.alt_text(axes) in read_description(path), name


def read_description(path):
    """Read the alternative text from a file."""
    data = path.read_bytes()
    if path.suffix == ".svg":
        desc = ElementTree.fromstring(data).find("{http://www.w3.org/2000/svg}desc")
        return desc.text
    if path.suffix == ".png":
        texts = []
        place = 8  # after the signature
        while place < len(data):
            (length,) = struct.unpack(">I", data[place : place + 4])
            kind = data[place + 4 : place + 8]
            chunk = data[place + 8 : place + 8 + length]
            texts += [chunk.decode("latin-1" if kind == b"tEXt" else "utf-8")] if kind in (b"tEXt", b"iTXt") else []
            place += 12 + length
        return "\n".join(texts)
    subject = re.search(
        rb"/Subject \((.*?)(?<!\\)\)\s*/|/Subject \((.*?)(?<!\\)\)\s*>>|/Subject <([0-9a-fA-F]+)>", data, re.S
    )
    plain = next(part for part in subject.groups() if part is not None)
    plain = re.sub(rb"\\([()\\])", rb"\1", plain)
    return plain.decode("utf-16") if plain.startswith(b"\xfe\xff") else plain.decode("latin-1")


UNUSUAL_STYLE = [
    "dark_background",
    {"text.color": "lime", "font.size": 22, "xtick.direction": "in", "lines.linewidth": 9},
]


def pixels(figure):
    figure.savefig(file := io.BytesIO(), format="png")
    return file.getvalue()


def test_new_figures_do_not_depend_on_the_style_of_the_user(records, tmp_path):
    for name, draw in all_plots(records).items():
        with pyplot.style.context(UNUSUAL_STYLE):
            axes = draw(None)
            wl.plots.save(axes, tmp_path / "unusual.svg")
            unusual = pixels(axes.figure)
            assert mpl.rcParams["lines.linewidth"] == 9, "the style of the user is restored"
        plain = draw(None)
        wl.plots.save(plain, tmp_path / "plain.svg")
        assert unusual == pixels(plain.figure), name
        assert (tmp_path / "unusual.svg").read_bytes() == (tmp_path / "plain.svg").read_bytes(), name
        pyplot.close("all")


def test_a_second_run_on_a_new_figure_keeps_its_style(records):
    def draw_two_runs():
        axes = wl.plots.fitness_curve(records, label="a")
        return pixels(wl.plots.fitness_curve(records, axes, label="b").figure)

    with pyplot.style.context(UNUSUAL_STYLE):
        unusual = draw_two_runs()
    assert unusual == draw_two_runs()
    pyplot.close("all")


def test_plots_are_legible_on_dark_axes(records):
    def luminance_of(colour):
        return float(np.dot(mpl.colors.to_rgb(colour), (0.3, 0.6, 0.1)))

    with pyplot.style.context("dark_background"):
        for name, draw in all_plots(records).items():
            axes = draw(Figure().add_subplot())
            texts = [text for text in axes.findobj(mpl.text.Text) if text.get_text().strip()]
            assert all(luminance_of(text.get_color()) > 0.3 for text in texts), name
        bars = wl.plots.gait(GENOME, SETTINGS, Figure().add_subplot()).collections
        assert all(luminance_of(bar.get_facecolor()[0]) > 0.3 for bar in bars)
        body = wl.plots.body(GENOME, Figure().add_subplot())
        assert all(luminance_of(line.get_color()) > 0.4 for line in body.lines)
        stride = wl.plots.stride(GENOME, SETTINGS, Figure().add_subplot())
        drawn_bodies = [one for one in stride.collections if type(one) is PolyCollection]
        assert luminance_of(drawn_bodies[0].get_edgecolor()[0]) < luminance_of(drawn_bodies[-1].get_edgecolor()[0])


def test_axes_with_another_projection_are_rejected(records):
    for kind, name in (("polar", "PolarAxes"), ("3d", "Axes3D")):
        axes = Figure().add_subplot(projection=kind)
        for draw in all_plots(records).values():
            with pytest.raises(
                TypeError, match=rf"requires plain Axes, as returned by figure.add_subplot\(\); got {name}"
            ):
                draw(axes)
    with pytest.raises(TypeError, match="got ndarray"):
        wl.plots.fitness_curve(records, np.array([1]))


@pytest.mark.parametrize("label", ["cost $5 to $6", r"$\foo$", "_mine", r"\$1 of $2"])
def test_texts_of_the_user_are_shown_unchanged(label, ax, tmp_path):
    records = evolved_table(3, 6)
    records.loc[records.index[-1], "verdict"] = label
    name_fitness(records, label, "$")
    drawn = [
        wl.plots.fitness_curve(records, ax, label=label),
        wl.plots.trait(records.assign(**{label: 1.5}), label, Figure().add_subplot(), label=label),
        wl.plots.diversity(records, Figure().add_subplot(), label=label),
        wl.plots.distance_over_time(wl.simulate(GENOME, SETTINGS), Figure().add_subplot(), label=label),
        wl.plots.verdicts(records, Figure().add_subplot()),
        wl.plots.family_tree(records, Figure().add_subplot(), individual=int(records.individual.iloc[-1])),
    ]
    for axes in drawn:
        wl.plots.save(axes, tmp_path / "a.svg")
        svg_text = " ".join(
            "".join(one.itertext()) for one in ElementTree.parse(tmp_path / "a.svg").iter() if is_text_element(one)
        )
        assert label in svg_text.replace("\N{ZERO WIDTH SPACE}", "")
        if axes.get_legend():
            labels = " ".join(text.get_text() for text in axes.get_legend().get_texts())
            assert label.replace("$", r"\$") in labels


def is_text_element(element):
    return element.tag.endswith("}text")


def test_svg_files_contain_text_and_are_reproducible(tmp_path):
    for path in (tmp_path / "a.svg", tmp_path / "b.svg"):
        wl.plots.save(wl.plots.fitness_curve(random_table(), Figure().add_subplot()), path, str(tmp_path / "a.png"))
    assert "generation</text>" in (tmp_path / "a.svg").read_text()
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_clearing_the_axes_removes_the_alternative_text(ax):
    wl.plots.verdicts(random_table(), ax)
    ax.clear()
    assert wl.plots.alt_text(ax) == ""
    alone = wl.plots.alt_text(wl.plots.fitness_curve(random_table(), Figure().add_subplot()))
    assert wl.plots.alt_text(wl.plots.fitness_curve(random_table(), ax)) == alone


def test_saving_restores_the_layout_engine(tmp_path):
    figure = Figure(layout="constrained")
    engine = figure.get_layout_engine()
    wl.plots.save(wl.plots.fitness_curve(random_table(), figure.add_subplot()), tmp_path / "a.png")
    assert figure.get_layout_engine() is engine


@each_table_plot
@pytest.mark.parametrize(
    "table",
    [
        concatenate_tables([]),
        evolved_table(generations=1, size=4),
        evolved_table(void=1.0),
        evolved_table(size=4, mutation="randomized", mutation_rate=0.0),
        evolved_table(size=4, robot=wl.Robot(segments=(1, 1), legs=(2, 2), weight=(5, 5), leg_force=(7, 7))),
        evolved_table(generations=1, size=4).iloc[:1],
        evolved_table(size=5, crossover="none"),
        evolved_table(size=12, crossover="randomized"),
    ],
    ids=[
        "empty",
        "one generation",
        "no walk counts",
        "clones",
        "constant genes",
        "one robot",
        "one parent",
        "many parents",
    ],
)
def test_degenerate_tables_are_drawn(draw, table, ax, tmp_path):
    draw(table, ax)
    wl.plots.save(ax, tmp_path / "a.svg", tmp_path / "a.png")
    assert wl.plots.alt_text(ax)


# ------------------------------------------------------------------------------------------------------------- curves


def test_fitness_curve_shows_best_and_median_of_the_walks_that_count(ax):
    records = random_table()
    wl.plots.fitness_curve(records, ax)
    lines = {line.get_label(): line.get_ydata() for line in ax.lines}
    lines["median"] = lines.pop("median (12 % not counted)")
    for generation in range(5):
        counted = records[(records.generation == generation) & (records.verdict == "ok")].fitness
        assert lines["best"][generation] == pytest.approx(max(counted))
        assert lines["median"][generation] == pytest.approx(np.median(counted))
    assert ax.get_xlabel() == "generation"


def test_the_value_axis_has_name_and_unit_of_the_fitness(ax):
    run = wl.Run(wl.Settings(), random_table())
    wl.plots.fitness_curve(run.records, ax)
    assert ax.get_ylabel() == "distance [m]"


@pytest.mark.parametrize("draw", [wl.plots.fitness_curve, wl.plots.diversity])
def test_runs_on_the_same_axes_differ_in_colour_and_marker(ax, draw):
    for seed, label in enumerate(("gentle", "harsh")):
        draw(evolved_table(seed + 3), ax, label=label)
    solid = [line for line in ax.lines if line.get_linestyle() == "-"]
    assert [line.get_label().partition(":")[0] for line in solid] == ["gentle", "harsh"]
    for look in ("color", "marker"):
        assert solid[0].properties()[look] != solid[1].properties()[look]
    assert all(label in wl.plots.alt_text(ax) for label in ("entle", "arsh"))


def test_the_alternative_text_has_first_and_last_values_of_best_and_median(records, ax):
    wl.plots.fitness_curve(records, ax)
    counted = records[records.verdict == "ok"].groupby("generation").fitness
    expected = [counted.max().iloc[0], counted.max().iloc[-1], counted.median().iloc[0], counted.median().iloc[-1]]
    expected[2:2] = [round(100 * (records.verdict != "ok").mean())]
    expected[:0] = [records.generation.nunique()]
    assert numbers_in(wl.plots.alt_text(ax)) == pytest.approx(expected, abs=0.006)
    assert " m" in wl.plots.alt_text(ax)


@pytest.mark.parametrize("name", ["weight", "body_length", "n_legs", "n_segments", "velocity", "distance", "fitness"])
def test_trait_shows_median_and_best_robot_with_the_unit(records, ax, name):
    wl.plots.trait(records, name, ax)
    lines = {line.get_label().partition(" (")[0]: line for line in ax.lines}
    walked = name in ("velocity", "distance", "fitness")
    for generation, all_of_it in records.groupby("generation"):
        counted = all_of_it[all_of_it.verdict == "ok"]
        place = lines["median"].get_xdata().tolist().index(generation)
        how = "lower" if name.startswith("n_") else "linear"
        middle = np.quantile((counted if walked else all_of_it)[name], 0.5, method=how)
        assert lines["median"].get_ydata()[place] == pytest.approx(middle)
        fittest = counted.loc[counted.fitness.idxmax()]
        assert lines["best robot"].get_ydata()[place] == fittest[name]
    unit = records.attrs["units"].get(name)
    assert ax.get_ylabel().endswith(f"[{unit}]" if unit else "s")


def test_the_median_of_an_integer_trait_is_a_value_that_occurs(ax):
    records = random_table(4).assign(n_legs=[2, 2, 4, 4] * 5)
    wl.plots.trait(records, "n_legs", ax)
    lines = {line.get_label(): line.get_ydata() for line in ax.lines}
    assert set(lines["median"]) == {2}


@pytest.mark.parametrize("name", ["verdict", "wieght", "generation"])
def test_a_column_that_is_not_a_trait_is_rejected_with_a_list_of_traits(records, name):
    with pytest.raises(ValueError, match=rf"no numeric column '{name}'; it has .*weight, body_length"):
        wl.plots.trait(records, name)
    assert not pyplot.get_fignums()


# ------------------------------------------------------------------------------------------- one quantity and one run


def table_with_fitness(name, unit):
    table = evolved_table(2, 4, void=0)
    name_fitness(table, name, unit)
    return table


DISTANCE_LABEL = table_with_fitness("distance", "m")
EFFICIENCY = table_with_fitness("efficiency", "m/J")
QUANTITIES = {
    "distance [m]": lambda ax: wl.plots.fitness_curve(DISTANCE_LABEL, ax, label="a"),
    "efficiency [m/J]": lambda ax: wl.plots.fitness_curve(EFFICIENCY, ax, label="b"),
    "weight [kg]": lambda ax: wl.plots.trait(DISTANCE_LABEL, "weight", ax),
    "number of legs": lambda ax: wl.plots.trait(DISTANCE_LABEL, "n_legs", ax),
    "genetic diversity": lambda ax: wl.plots.diversity(DISTANCE_LABEL, ax),
    "robots": lambda ax: wl.plots.verdicts(DISTANCE_LABEL, ax),
    "distance of the centre of mass [m]": lambda ax: wl.plots.distance_over_time(wl.simulate(GENOME, SETTINGS), ax),
}


@pytest.mark.parametrize("second", QUANTITIES)
def test_a_value_axis_shows_one_quantity(second):
    for first, draw in QUANTITIES.items():
        axes = draw(Figure().add_subplot())
        before = wl.plots.alt_text(axes), len(axes.lines), axes.get_ylabel()
        if first == second:
            QUANTITIES[second](axes)
            continue
        how = re.escape(f"show {first!r} and cannot also show {second!r}") + ".*separate Axes.*plt.subplots"
        with pytest.raises(ValueError, match=how):
            QUANTITIES[second](axes)
        assert before == (wl.plots.alt_text(axes), len(axes.lines), axes.get_ylabel()), "the plot is unchanged"


def test_a_second_value_axis_can_show_another_quantity(ax):
    wl.plots.fitness_curve(DISTANCE_LABEL, ax)
    right = wl.plots.fitness_curve(EFFICIENCY, ax.twinx())
    assert (ax.get_ylabel(), right.get_ylabel()) == ("distance [m]", "efficiency [m/J]")
    ax.clear()
    wl.plots.fitness_curve(EFFICIENCY, ax)


def test_a_fitness_and_a_trait_of_the_same_quantity_share_an_axis(ax):
    wl.plots.fitness_curve(DISTANCE_LABEL, ax)
    wl.plots.trait(DISTANCE_LABEL, "distance", ax)
    assert wl.plots.trait(DISTANCE_LABEL, "fitness", ax).get_ylabel() == "distance [m]"


def test_a_table_from_a_csv_file_has_the_default_units(ax, tmp_path):
    DISTANCE_LABEL.to_csv(tmp_path / "records.csv", index=False)
    table = pd.read_csv(tmp_path / "records.csv")
    assert wl.plots.trait(table, "weight", Figure().add_subplot()).get_ylabel() == "weight [kg]"
    assert wl.plots.fitness_curve(table, Figure().add_subplot()).get_ylabel() == "fitness"
    wl.plots.fitness_curve(DISTANCE_LABEL, ax)
    with pytest.raises(ValueError, match=r"from read_csv.*table\.attrs = run\.records\.attrs"):
        wl.plots.fitness_curve(table, ax)
    table.attrs = DISTANCE_LABEL.attrs
    wl.plots.fitness_curve(table, ax)


@each_table_plot
def test_a_table_of_several_runs_is_rejected_with_a_solution(draw, ax):
    runs = [evolved_table(2, 4, void=0) for _ in range(2)]
    with pytest.raises(ValueError, match=r"contains several runs\. .*\[run_a, run_b\].*run_b\}"):
        draw(pd.concat(runs), ax)
    assert not wl.plots.alt_text(ax)


# ----------------------------------------------------------------------------------------------------------- verdicts


@pytest.mark.parametrize("generations", [1, 6, 61, 130])
def test_bars_add_up_to_the_population_and_show_each_verdict_that_occurs(generations, ax):
    records = evolved_table(generations, 8)
    wl.plots.verdicts(records, ax)
    bars = {bar.get_label(): bar.get_data() for bar in ax.patches if isinstance(bar, StepPatch)}
    assert {"ok" if label == "counts" else label for label in bars} == set(records.verdict)
    heights = {label: bar.values - bar.baseline for label, bar in bars.items()}
    assert sum(heights.values()) == pytest.approx(np.full(len(next(iter(heights.values()))), 8))
    for label, bar in bars.items():
        together = np.diff(bar.edges)
        n = (records.verdict == ("ok" if label == "counts" else label)).sum()
        assert (heights[label] * together).sum() == pytest.approx(n)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == list(bars)[::-1]


def test_missing_generations_have_no_bar(ax):
    records = evolved_table(6, 8)
    wl.plots.verdicts(records[records.generation.isin([0, 1, 5])], ax)
    drawn = sum(np.nan_to_num(bar.get_data().values - bar.get_data().baseline) for bar in ax.patches)
    assert drawn.tolist() == [8, 8, 0, 0, 0, 8]
    assert ax.get_xlim() == (-0.5, 5.5)
    render(ax)


def test_all_verdicts_differ_in_colour_and_hatching(ax):
    table = random_table(2 * len(VERDICTS))
    table["verdict"] = np.tile(list(VERDICTS), 10)
    wl.plots.verdicts(table, ax)
    looks = [(bar.get_facecolor(), bar.get_hatch()) for bar in ax.patches]
    assert len(set(looks)) == len(looks) == len(VERDICTS)
    hatches = [hatch for colour, hatch in looks]
    assert len(set(hatches)) == len(hatches), "they differ in black and white"


# ------------------------------------------------------------------------------------------------------- several runs


@pytest.mark.parametrize("given", ["list", "dict", "experiment"])
def test_of_several_runs_the_median_and_the_middle_half_are_drawn(given, ax):
    tables = [random_table(seed=seed) for seed in range(5)]
    best = np.array([table[table.verdict == "ok"].groupby("generation").fitness.max().cummax() for table in tables])
    experiment = pd.concat([table.assign(condition="a", seed=seed) for seed, table in enumerate(tables)])
    runs = {"list": tables, "dict": {"a": tables}, "experiment": experiment}[given]
    wl.plots.fitness_curve(runs, ax)
    line = ax.lines[-1]
    assert line.get_ydata() == pytest.approx(np.median(best, axis=0))
    edges = {round(float(y), 9) for path in ax.collections[0].get_paths() for y in path.vertices[:, 1]}
    assert {round(float(y), 9) for y in np.quantile(best, [0.25, 0.75], axis=0).ravel()} <= edges
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    if given == "list":
        assert labels == ["middle half of the runs", "median of 5 runs"]
    else:
        assert labels == ["a"]
        assert ax.get_legend().get_title().get_text() == "lines: median of 5 runs; areas: their middle half"
    assert "5 runs" in wl.plots.alt_text(ax)


@pytest.mark.parametrize("draw", [wl.plots.diversity, lambda runs, ax: wl.plots.trait(runs, "velocity", ax)])
def test_other_curves_of_several_runs_have_a_line_for_each_name(draw, ax):
    draw({"a": [evolved_table(3), evolved_table(3)], "b": evolved_table(4)}, ax)
    lines = {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}
    assert [(name, len(line.get_xdata())) for name, line in lines.items()] == [("a", 3), ("b", 4)]
    assert lines["a"].get_linestyle() != lines["b"].get_linestyle()
    assert wl.plots.alt_text(ax)


@pytest.mark.parametrize("fitness_changed", [False, True])
def test_the_best_so_far_begins_again_with_the_ratings_of_a_new_stage(fitness_changed, ax):
    tables = [random_table(seed=seed) for seed in range(3)]
    for table in tables:
        table.attrs |= {"stages": {3: "new"}, "rated_since": 3, "fitness_since": 3 if fitness_changed else 0}
    best = np.array([table[table.verdict == "ok"].groupby("generation").fitness.max() for table in tables])
    expected = np.hstack([np.maximum.accumulate(part, axis=1) for part in (best[:, :3], best[:, 3:])])
    wl.plots.fitness_curve(tables, ax)
    drawn = dict(zip(*ax.lines[-1].get_data(), strict=True))
    first = 3 if fitness_changed else 0
    assert drawn == pytest.approx(dict(zip(range(first, 5), np.median(expected, axis=0)[first:], strict=True)))


def test_runs_of_different_fitness_do_not_share_axes(ax):
    with pytest.raises(ValueError, match="have different fitness, 'distance \\[m\\]' and 'efficiency \\[m/J\\]'"):
        wl.plots.fitness_curve({"a": DISTANCE_LABEL, "b": EFFICIENCY}, ax)
    with pytest.raises(ValueError, match="no run to draw"):
        wl.plots.fitness_curve([], ax)
    assert not ax.lines


def test_runs_without_a_counted_walk_are_lower_than_all_others(ax):
    tables = [random_table(seed=seed) for seed in range(4)]
    void = [table.assign(verdict="airborne", fitness=-np.inf) for table in tables]
    wl.plots.fitness_curve({"some": [*tables, *void[:1]], "most": [*tables[:1], *void]}, ax)
    lines = {line.get_label(): line.get_ydata() for line in ax.lines}
    assert [np.isfinite(lines[name]).sum() for name in ("some", "most")] == [5, 0]


# ------------------------------------------------------------------------------------------------------------ genomes


def genomes(records):
    return np.array([wl.Genome.parse(text).values for text in records.genome])


def test_diversity_is_the_root_mean_square_distance_over_all_pairs(records, ax):
    wl.plots.diversity(records, ax)
    values, table = plots_of_genomes._parse_genomes(records)
    span = table.high - table.low
    for generation, diversity in zip(*ax.lines[0].get_data(), strict=True):
        squares = []
        for a, b in combinations(values[records.generation == generation], 2):
            distance = (a - b) / span
            squares.append(np.where(table.is_cyclic, np.sin(np.pi * distance), distance) ** 2)
        assert diversity == pytest.approx(np.sqrt(np.mean(squares)))


def test_the_diversity_of_a_generation_does_not_depend_on_the_others(records, ax):
    wl.plots.diversity(records, ax)
    wl.plots.diversity(records[records.generation < 2], ax)
    long, short = (line.get_ydata() for line in ax.lines)
    assert short == pytest.approx(long[:2], abs=1e-12)


def test_the_diversity_of_a_large_generation_is_estimated_from_a_sample(ax, monkeypatch):
    table = evolved_table(size=60)
    for read in (60, 59, 30):
        monkeypatch.setattr(plots_of_genomes, "MAX_SAMPLE", read)
        chosen = table[plots_of_genomes._select_sample(table)]
        assert chosen.groupby("generation").size().tolist() == [read] * 6
        places = chosen.index[chosen.generation == 0]
        assert np.diff(places, append=60).max() <= -(-60 // read)
        wl.plots.diversity(table, ax)
        wl.plots.genes(table, Figure().add_subplot(), generation=2)
    exact, *estimated = (line.get_ydata() for line in ax.lines)
    for some in estimated:
        np.testing.assert_allclose(some, exact, rtol=0.15)


def test_all_robots_of_a_large_generation_are_drawn(ax, monkeypatch):
    monkeypatch.setattr(plots_of_genomes, "MAX_SAMPLE", 4)
    wl.plots.genes(evolved_table(), ax)
    assert ax.collections[0].get_array().shape[0] == 10


def test_clones_have_zero_diversity_and_the_order_of_rows_does_not_matter(records, ax):
    clones = records.assign(genome=np.where(records.generation == 3, records.genome[0], records.genome))
    shuffled = clones.sample(frac=1, random_state=0)
    for table in (clones, shuffled):
        wl.plots.diversity(table, ax)
    first, second = (line.get_ydata() for line in ax.lines)
    assert first[3] == pytest.approx(0, abs=1e-7)
    assert (np.delete(first, 3) > 0).all()
    assert first == pytest.approx(second, abs=1e-12)


def has_effect(genome, index, table):
    """Return whether another value of a gene changes the robot; genes of the whole body always count."""
    if "." not in table.names[index]:
        return True
    values = genome.values.copy()
    values[index] = 1 - values[index] if table.is_count[index] else values[index] + 0.01
    return wl.express(wl.Genome(values)) != wl.express(genome)


def test_the_colour_of_a_gene_is_its_position_in_the_range_if_it_has_an_effect(records, ax):
    wl.plots.genes(records, ax, generation=2)
    table = build_genes(wl.Robot())
    values = genomes(records)
    picture = next(child for child in ax.get_children() if isinstance(child, QuadMesh)).get_array()
    rows = records[records.generation == 2].sort_values(["fitness", "individual"], ascending=[False, True])
    assert picture.shape == (len(rows), len(table))
    low = np.where(table.is_cyclic, 0, values.min(axis=0))
    high = np.where(table.is_cyclic, table.high, values.max(axis=0))
    for colours, text in zip(picture, rows.genome, strict=True):
        genome = wl.Genome.parse(text)
        for i, name in enumerate(table.names):
            is_coloured = colours[i] is not np.ma.masked
            assert is_coloured == has_effect(genome, i, table), name
            if is_coloured and high[i] > low[i]:
                assert colours[i] == pytest.approx((genome.values[i] - low[i]) / (high[i] - low[i]))
    assert picture.mask.any(), "precondition of this test"


def test_columns_are_labelled_with_gene_and_segment(records, ax):
    wl.plots.genes(records, ax)
    names = [label.get_text() for label in ax.get_xticklabels()]
    expected = [name.rpartition(".")[2].replace("_", " ") for name in build_genes(wl.Robot()).names]
    assert names == expected
    assert {"body", "segment 1", "segment 4"} <= {text.get_text() for text in ax.texts}


def test_genes_of_the_last_generation_are_drawn_by_default(records, ax):
    wl.plots.genes(records, ax)
    assert "generation 5" in wl.plots.alt_text(ax)
    with pytest.raises(ValueError, match="generation 77 is not in this table; the table contains generations 0 to 5"):
        wl.plots.genes(records, ax, generation=77)


# -------------------------------------------------------------------------------------------------------- family tree


def gids(axes, shape):
    found = [re.fullmatch(shape, str(child.get_gid())) for child in axes.get_children()]
    return {tuple(map(int, match.groups())) for match in found if match}


def bodies(axes):
    return {one for (one,) in gids(axes, r"robot-(\d+)")}


def edges(axes):
    return gids(axes, r"robot-(\d+)-to-robot-(\d+)")


@pytest.mark.parametrize("crossover", ["paired", "none", "randomized"])
@pytest.mark.parametrize("generations", [1, 2, 8, 40])
def test_the_edges_of_a_tree_are_those_of_the_table(generations, crossover, ax):
    records = evolved_table(generations, 8, crossover=crossover)
    wl.plots.family_tree(records, ax)
    drawn = bodies(ax)
    births = records.drop_duplicates("individual").set_index("individual")
    kin = {(parent, child) for child in drawn for parent in parent_numbers(births.parents[child]) if parent in drawn}
    assert edges(ax) == kin
    best = records.sort_values(["fitness", "individual"], ascending=[False, True]).individual.iloc[0]
    assert best in drawn


def test_a_short_tree_shows_both_parents_of_each_robot_of_the_line(ax):
    records = evolved_table(8, 8)
    wl.plots.family_tree(records, ax)
    births = records.drop_duplicates("individual").set_index("individual")
    number = records.sort_values(["fitness", "individual"], ascending=[False, True]).individual.iloc[0]
    while parents := parent_numbers(births.parents[number]):
        assert {(parent, number) for parent in parents} <= edges(ax)
        number = max(parents, key=lambda parent: births.fitness[parent])


def test_a_long_tree_is_drawn_in_part_with_the_number_of_omitted_robots(ax):
    records = evolved_table(60, 6, n_elites=0)
    youngest = int(records.individual.max())
    wl.plots.family_tree(records, ax, individual=youngest)
    births = records.drop_duplicates("individual").set_index("individual")
    line = [youngest]
    while parents := parent_numbers(births.parents[line[-1]]):
        line.append(max(parents, key=lambda parent: births.fitness[parent]))
    assert len(line) > MAX_COMPLETE_LINE, "precondition of this test"
    assert {line[0], line[-1]} <= bodies(ax)
    left_out = [int(match[1]) for text in ax.texts if (match := re.fullmatch(r"\s*(\d+) omitted", text.get_text()))]
    assert sum(left_out) == len(line) - N_DRAWN_OF_LONG_LINE
    assert len(bodies(ax) & set(line)) >= N_DRAWN_OF_LONG_LINE
    assert f"has {len(line)} robots" in wl.plots.alt_text(ax)


def test_the_tree_of_an_unknown_individual_is_rejected(records):
    with pytest.raises(ValueError, match="individual 999 is not in this run"):
        wl.plots.family_tree(records, Figure().add_subplot(), individual=999)


def csv_round_trip(records, path, **options):
    records.to_csv(path, index=False)
    return pd.read_csv(path, **options)


def user_tables(records, folder):
    return {
        "read from CSV": csv_round_trip(records, folder / "a.csv"),
        "read as it is": csv_round_trip(records, folder / "a.csv", keep_default_na=False),
        "from generation 3 on": records[records.generation >= 3],
        "every second generation": records[records.generation % 2 == 0],
        "the last generation": records[records.generation == records.generation.max()],
        "CSV from 3 on": csv_round_trip(records[records.generation >= 3], folder / "b.csv"),
        "shuffled": records.sample(frac=1, random_state=0),
    }


def test_the_line_of_descent_ends_at_a_robot_that_is_its_own_parent(records):
    looped = records.copy()
    last = int(looped.individual.max())
    looped.loc[looped.individual == last, "parents"] = f"{last} {last + 1}"
    assert fitter_line(birth_rows(looped), last) == [last]


@pytest.mark.parametrize("crossover", ["paired", "none"])
def test_descent_reaches_as_far_back_as_the_table(crossover, tmp_path):
    records = evolved_table(8, 8, crossover=crossover)
    for name, table in user_tables(records, tmp_path).items():
        axes = Figure().add_subplot()
        best = wl.Run(wl.Settings(), table).champion
        wl.plots.family_tree(table, axes)
        render(axes)
        own = table.drop_duplicates("individual").set_index("individual")
        assert best.individual in bodies(axes) <= set(own.index), name
        assert {(parent, best.individual) for parent in best.parents if parent in own.index} <= edges(axes), name
        found = wl.Run(wl.Settings(), table).lineage(best.individual)
        assert best.individual in set(found.individual) <= set(own.index), name
        assert str(best.individual) in summary.tabulate_descent(table, best.individual), name
        assert summary.describe_result(table, wl.Settings().model_dump()), name
        assert "nan" not in found.parents.str.cat() + best.reason, name
    resumed = records.copy()
    resumed.attrs["rated_since"] = 2  # the settings of the world were changed
    assert " in generation 2." in summary.describe_result(resumed, wl.Settings().model_dump())
    whole, later = Figure().add_subplot(), Figure().add_subplot()
    youngest = int(records.individual.max())
    wl.plots.family_tree(records, whole, individual=youngest)
    wl.plots.family_tree(records[records.generation >= 3], later, individual=youngest)
    assert "begins with generation" not in whole.get_title(loc="left")
    assert "the table begins with generation 3" in later.get_title(loc="left")


@pytest.mark.parametrize(
    ("cell", "numbers"), [("3 17", (3, 17)), ("", ()), (math.nan, ()), (None, ()), (5.0, (5,)), (np.int64(5), (5,))]
)
def test_parents_are_read_from_any_type_of_cell(cell, numbers):
    assert parent_numbers(cell) == numbers


# -------------------------------------------------------------------------------------------------------------- walks


def test_distance_over_time_is_that_of_the_centre_of_mass(ax):
    rollout = wl.simulate(GENOME, SETTINGS)
    wl.plots.distance_over_time(rollout, ax)
    assert ax.lines[0].get_ydata() == pytest.approx(rollout.com[:, 0] - rollout.com[0, 0])
    assert ax.get_xlabel() == "time [s]"
    assert "not count" not in wl.plots.alt_text(ax)


def test_a_walk_that_does_not_count_is_labelled_with_the_reason(ax):
    rollout = wl.simulate(GENOME, SETTINGS)
    number = np.array([math.nan if 0.5 < time < 0.6 else 0.0 for time in rollout.time])
    unstable = replace(
        rollout, verdict="unstable", reason="a number was not finite", com=rollout.com + number[:, np.newaxis]
    )
    for void in (replace(rollout, verdict="fell", reason="the body touched the ground"), unstable):
        wl.plots.distance_over_time(void, ax, label="the other")
        assert f"does not count: {void.verdict} ({void.reason})" in wl.plots.alt_text(ax)
        assert ax.get_legend().get_texts()[-1].get_text() == f"the other (does not count: {void.verdict})"
    render(ax)


def test_the_bars_of_a_gait_are_its_footfalls(ax):
    wl.plots.gait(GENOME, SETTINGS, ax)
    scene = wl.compile_scene(GENOME, SETTINGS)
    rollout = wl.simulate(GENOME, SETTINGS)
    down = find_footfalls(scene, rollout.poses)
    rows = {child.get_gid(): child for child in ax.collections if child.get_gid()}
    assert set(rows) == set(foot_names(scene))
    for name, on_ground in zip(foot_names(scene), down.T, strict=True):
        spans = [path.vertices[:, 0] for path in rows[name].get_paths()]
        middles = (rollout.time[:-1] + rollout.time[1:]) / 2
        black = [any(span.min() < moment < span.max() for span in spans) for moment in middles]
        assert black == on_ground[:-1].tolist()
    shares = [label.get_text() for label in ax.child_axes[0].get_yticklabels()]
    assert shares == [f"{share:.0%}" for share in down.mean(axis=0)]


def test_the_gait_of_a_long_walk_shows_the_last_ten_seconds(ax):
    wl.plots.gait(GENOME, wl.Settings().with_(duration=12), ax)
    assert ax.get_xlim() == pytest.approx((2, 12), abs=0.03)
    assert "in a walk of 12 s" in wl.plots.alt_text(ax)


def test_the_poorest_of_several_starts_is_drawn():
    genome = wl.Genome.random(wl.Robot(), rng=np.random.default_rng(18))
    settings = SETTINGS.with_(n_starts=4)
    counted, first = poorest_walk(genome, settings), wl.simulate(genome, settings)
    assert counted.distance != first.distance, "precondition of this test"
    shown = wl.plots.gait(genome, settings, Figure().add_subplot())
    shares = [label.get_text() for label in shown.child_axes[0].get_yticklabels()]
    down = find_footfalls(wl.compile_scene(genome, settings), counted.poses)
    assert shares == [f"{share:.0%}" for share in down.mean(axis=0)]
    start, end = arrow_ends(wl.plots.stride(genome, settings, Figure().add_subplot()))
    assert (start, end) == pytest.approx(counted.com[[0, -1], 0])


def arrow_ends(axes):
    found = {(note.xyann[0], note.xy[0]) for note in axes.texts if getattr(note, "arrow_patch", None)}
    (span,) = found
    return span


# ------------------------------------------------------------------------------------------------------------- bodies


@pytest.mark.parametrize("seed", range(5))
def test_a_body_is_drawn_to_scale_on_the_ground_with_its_dimensions(seed, ax):
    genome = wl.Genome.random(wl.Robot(), rng=np.random.default_rng(seed))
    robot = wl.express(genome)
    wl.plots.body(genome, ax)
    (drawn,) = ax.collections
    assert len(drawn.get_paths()) == len(robot.segments) + 2 * robot.n_legs
    corners = np.concatenate([path.vertices for path in drawn.get_paths()])
    assert corners[:, 1].min() == pytest.approx(0, abs=0.01)
    trunk = [path.vertices for path in drawn.get_paths()][robot.n_legs : robot.n_legs + len(robot.segments)]
    diameters = sum(np.linalg.norm(np.ptp(one, axis=0)) for one in trunk)
    assert 0.9 * robot.body_length < diameters < 1.25 * robot.body_length
    assert ax.get_aspect() == 1
    expected = [len(robot.segments), robot.n_legs, robot.weight, robot.body_length]
    assert numbers_in(wl.plots.alt_text(ax)) == pytest.approx(expected, abs=0.006, rel=0.005)
    assert ax.get_title() in wl.plots.alt_text(ax)


@pytest.mark.parametrize("seed", range(3))
def test_the_scale_bar_of_a_body_has_the_length_of_its_label(seed, ax):
    wl.plots.body(wl.Genome.random(wl.Robot(), rng=np.random.default_rng(seed)), ax)
    bar = ax.lines[-1]
    label = ax.texts[-1]
    assert label.get_text().endswith(" m")
    assert [np.ptp(bar.get_xdata())] == pytest.approx(numbers_in(label.get_text()))


def test_add_body_places_and_scales_a_body_and_returns_its_extent(ax):
    scene = resting_scene(GENOME)
    parts = surface_points(scene, scene.start)
    left, right, bottom, top = add_body(ax, parts)
    assert add_body(ax, parts, at=(3.0, -2.0), scale=0.5) == pytest.approx(
        (3 + left / 2, 3 + right / 2, -2 + bottom / 2, -2 + top / 2)
    )
    assert len(ax.get_children()) == len(Figure().add_subplot().get_children()) + 2, "nothing else is added"


def test_far_legs_are_darker_than_near_legs_and_shifted_to_the_left(ax):
    wl.plots.body(GENOME, ax)
    (drawn,) = ax.collections
    n_legs = wl.express(GENOME).n_legs
    far, near = drawn.get_paths()[:n_legs], drawn.get_paths()[-n_legs:]
    luminance = drawn.get_facecolor()[:, :3] @ (0.3, 0.6, 0.1)
    assert luminance[:n_legs].max() + 0.1 < luminance[-n_legs:].min()
    assert np.mean([path.vertices[:, 0].mean() for path in far]) < np.mean(
        [path.vertices[:, 0].mean() for path in near]
    )


def test_without_settings_a_robot_outside_the_default_limits_is_drawn(ax):
    large = wl.Robot(segments=(6, 8), body_length=(4, 6), segment_length=(0.5, 1), weight=(50, 60), legs=(10, 16))
    genome = wl.Genome.random(large, rng=np.random.default_rng(0))
    wl.plots.body(genome, ax)
    assert f"{len(wl.express(genome).segments)} segments" in wl.plots.alt_text(ax)


def test_loads_of_the_settings_are_drawn(ax):
    loaded = SETTINGS.with_(carry_weight=2, drag_weight=2)
    wl.plots.body(GENOME, ax, loaded)
    wl.plots.body(GENOME, ax)
    with_loads, without = (len(drawn.get_paths()) for drawn in ax.collections)
    assert with_loads > without


class TestStride:
    """A stride shows the robot that walked, to scale."""

    genome = wl.Genome.random(wl.Robot(), rng=np.random.default_rng(2))
    settings = wl.Settings().with_(duration=2.0)

    def test_bodies_are_drawn_to_scale_above_the_ground(self, ax):
        wl.plots.stride(self.genome, self.settings, ax)
        robot = wl.express(self.genome)
        one = len(robot.segments) + 2 * robot.n_legs
        drawn_bodies = [child for child in ax.collections if type(child) is PolyCollection]
        assert 1 <= len(drawn_bodies) <= 4
        assert all(len(body.get_paths()) == one for body in drawn_bodies)
        assert min(path.vertices[:, 1].min() for body in drawn_bodies for path in body.get_paths()) > -0.02
        assert ax.get_aspect() == 1

    def test_an_unstable_walk_is_drawn_with_its_verdict(self, ax):
        unstable = wl.Settings().with_(
            gravity=(-30, 12, -30), carry_weight=60, duration=2, timestep=0.01, texture_size=0.2
        )
        unstable = unstable.with_(robot=wl.Robot(leg_force=(500, 500), weight=(0.1, 0.3), carry_weight=60))
        rollout = wl.simulate(self.genome, unstable)
        assert rollout.verdict == "unstable", "precondition of this test"
        wl.plots.stride(self.genome, unstable, ax)
        assert any(type(child) is PolyCollection for child in ax.collections)
        assert "does not count: unstable" in wl.plots.alt_text(ax)

    def test_an_unstable_walk_is_drawn_up_to_its_last_valid_pose(self, ax, monkeypatch):
        rollout = wl.simulate(self.genome, self.settings)
        poses = rollout.poses.copy()
        poses[60:, 0] += 500
        unstable = replace(rollout, poses=poses, verdict="unstable", reason="a number was not finite")
        monkeypatch.setattr("walkerlab.view.plots.bodies.poorest_walk", lambda *_: unstable)
        wl.plots.stride(self.genome, self.settings, ax)
        assert ax.get_xlim()[1] < 10
        assert f"after {rollout.time[59]:.2f}".rstrip("0") + " s" in wl.plots.alt_text(ax)

    def test_bodies_become_darker_and_the_arrow_shows_the_distance(self, ax):
        walks = {seed: wl.Genome.random(wl.Robot(), rng=np.random.default_rng(seed)) for seed in range(8)}
        genome = max(walks.values(), key=lambda one: wl.simulate(one, self.settings).distance)
        rollout = wl.simulate(genome, self.settings)
        wl.plots.stride(genome, self.settings, ax)
        drawn_bodies = [child for child in ax.collections if type(child) is PolyCollection]
        assert len(drawn_bodies) > 1, "precondition of this test"
        edges = [float(body.get_edgecolor()[0, 0]) for body in drawn_bodies]
        assert edges == sorted(edges, reverse=True)
        assert len(set(edges)) == len(edges)
        forward = np.sign(rollout.distance)
        places = [np.concatenate([path.vertices for path in body.get_paths()])[:, 0].mean() for body in drawn_bodies]
        assert forward * places[0] < forward * places[-1]
        assert arrow_ends(ax) == pytest.approx(rollout.com[[0, -1], 0])
        (label,) = [text.get_text() for text in ax.texts if " in " in text.get_text()]
        assert numbers_in(label) == pytest.approx([rollout.com[-1, 0] - rollout.com[0, 0], rollout.time[-1]], abs=0.006)

    @pytest.mark.parametrize("obstacle", [kind for kind in Obstacle if kind])
    def test_skins_have_the_extent_of_the_geoms_in_every_direction(self, obstacle):
        settings = self.settings.with_(obstacle=obstacle, carry_weight=2, drag_weight=2)
        scene = wl.compile_scene(self.genome, settings)
        rollout = wl.simulate(self.genome, settings)
        model = scene.model
        data = mujoco.MjData(scene.model)
        data.qpos[:] = rollout.poses[-1]
        mujoco.mj_kinematics(model, data)
        *parts, rope = surface_points(scene, rollout.poses[-1])
        parts += surface_points(scene, rollout.poses[-1], loose=True)
        assert len(rope[0]) == 2
        moving = [geom for geom in range(model.ngeom) if model.geom_bodyid[geom]]
        directions = np.random.default_rng(0).normal(size=(20, 3))
        for geom, (skin, _) in zip(moving, parts, strict=True):
            for direction in directions / np.linalg.norm(directions, axis=1, keepdims=True):
                farthest = np.max((skin - data.geom_xpos[geom]) @ direction)
                along = np.abs(data.geom_xmat[geom].reshape(3, 3).T @ direction)
                size = model.geom_size[geom]
                reach = {
                    mujoco.mjtGeom.mjGEOM_SPHERE: size[0],
                    mujoco.mjtGeom.mjGEOM_CAPSULE: size[0] + size[1] * along[2],
                    mujoco.mjtGeom.mjGEOM_CYLINDER: size[0] * np.hypot(*along[:2]) + size[1] * along[2],
                    mujoco.mjtGeom.mjGEOM_BOX: size @ along,
                    mujoco.mjtGeom.mjGEOM_MESH: farthest,  # represented by its vertices
                }[mujoco.mjtGeom(model.geom_type[geom])]
                assert farthest == pytest.approx(reach, rel=0.03)

    @pytest.mark.parametrize("structure", [kind for kind in Structure if kind != Structure.rough])
    def test_the_ground_has_the_height_of_the_mujoco_terrain(self, structure):
        settings = self.settings.with_(structure=structure)
        scene = wl.compile_scene(self.genome, settings)
        data = mujoco.MjData(scene.model)
        mujoco.mj_forward(scene.model, data)
        for x in (-0.5, 0.7, 1.3, 2.9, 6.1):
            above = np.array([x, 3.0, 8.0])  # beside the robot, which is at y = 0
            depth = mujoco.mj_ray(scene.model, data, above, np.array([0, 0, -1.0]), None, 1, -1, np.zeros(1, np.int32))
            assert 8.0 - depth == pytest.approx(ground_height(settings.terrain, np.array([x]))[0], abs=1e-6)
