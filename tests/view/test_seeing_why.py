"""Plots of selection, convergence and improvement show and describe the numbers of wl.analysis."""

import re
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import walkerlab as wl
from walkerlab.analysis.price import TERMS
from walkerlab.ga.selection import tournament
from walkerlab.settings.choices import Crossover, Feature, Mutation, Selection
from walkerlab.view.plots.gene_notes import GENE_NOTES, STRIDE_ANGLE, explain_genes
from walkerlab.view.plots.operator_words import explain_operator, explain_operators

MAX_SENTENCES = 3  # of a caption

FITNESS = np.array([3.0, 1.0, -np.inf, 2.0, 5.0])


@pytest.fixture(scope="module")
def run():
    settings = wl.Settings().with_(population_size=6, generations=4, duration=1)
    with ThreadPoolExecutor(1) as pool:
        return wl.evolve(settings, executor=pool, progress=False)


def softmax(fitness, n_parents, *, rng):
    weights = np.exp(fitness)
    return rng.choice(len(fitness), size=n_parents, p=weights / weights.sum())


def caption(axes):
    return max((text.get_text() for text in axes.texts), key=len).replace("\n", " ").replace("\N{NO-BREAK SPACE}", " ")


def n_sentences(axes):
    return len(re.findall(r"\.(?= [A-Z]|$)", caption(axes)))


@pytest.mark.parametrize("select", ["gradient", partial(tournament, size=2), softmax])
def test_slices_and_bars_are_the_probabilities(select):
    table = wl.analysis.selection_probabilities(FITNESS, select)
    expected = table.sort_values("rank").probability
    wheel = wl.plots.roulette_wheel(table)
    slices = [(wedge.theta1 - wedge.theta2) % 360 / 360 for wedge in wheel.patches]
    assert slices == pytest.approx([1 - share for share in expected[expected > 0]], abs=1e-4)
    bars = wl.plots.selection_by_rank(table)
    assert [bar.get_height() for bar in bars.patches] == pytest.approx((100 * expected).tolist())
    for axes in (wheel, bars):
        assert f"{100 * expected.iloc[0]:.1f} %" in caption(axes)
        assert ("estimated" in caption(axes)) == (select is softmax)
        assert "1 robot cannot be selected" in wl.plots.alt_text(axes)
        assert n_sentences(axes) == MAX_SENTENCES


def test_measured_and_theoretical_pressure_are_drawn():
    table = wl.analysis.measure_selection(["top_half", "gradient"], population_size=20, n_populations=4)
    for measure in table.measure.unique():
        axes = wl.plots.selection_pressure(table, measure)
        rows = table[table.measure == measure]
        theory, measured = axes.lines[:2]
        assert np.array_equal(np.float64(theory.get_xdata()), rows.theory, equal_nan=True)
        assert np.array_equal(np.float64(measured.get_xdata()), rows.measured, equal_nan=True)
        has_theory = rows.theory.notna().any()
        assert ("theory" in axes.get_legend_handles_labels()[1]) == has_theory
        assert ("diamond" in caption(axes)) == has_theory
        assert n_sentences(axes) == MAX_SENTENCES
        names = [label.get_text().replace("\n", " ") for label in axes.get_yticklabels()]
        assert names == [f"{name} {Selection[name].about}" for name in rows.selection]
    with pytest.raises(ValueError, match="intensity, loss_of_diversity"):
        wl.plots.selection_pressure(table, "strength")


@pytest.mark.parametrize(
    ("name", "clause"), [("tournament", "best of 3 drawn"), ("tournament(size=5)", "best of 5 drawn")]
)
def test_a_caption_says_in_one_clause_what_each_operator_does(name, clause):
    assert clause in explain_operator(name, Selection)
    assert explain_operators(["mine", name], Selection) == [f"{name}: {explain_operator(name, Selection)}"]


def test_every_gene_has_a_note():
    assert GENE_NOTES.keys() == set(Feature)
    assert explain_genes([Feature.duty]) == f"Genes: duty = {GENE_NOTES[Feature.duty]}."
    assert explain_genes([Feature.lag]) == f"Genes: lag = {GENE_NOTES[Feature.lag]}; {STRIDE_ANGLE}."
    assert explain_genes([]) == ""


def texts_of(axes):
    return " ".join(" ".join(text.get_text().split()) for text in axes.texts)


def test_the_caption_of_a_birth_explains_each_operator_once_also_if_a_name_has_two_meanings():
    settings = wl.Settings().with_(crossover="randomized", mutation="randomized")
    rng = np.random.default_rng(0)
    parents = [wl.Genome.random(settings.robot, rng=rng) for _ in range(2)]
    births = (
        wl.analysis.mate(*parents, settings, rng=rng, mutates=True),
        wl.analysis.mutate(parents[0], settings, rng=rng),
    )
    crossed, mutated = (texts_of(wl.plots.birth(birth)) for birth in births)
    assert f"First randomized: {Crossover.randomized.about}. Then randomized: {Mutation.randomized.about}." in crossed
    assert f"First randomized: {Mutation.randomized.about}." in mutated
    assert Crossover.randomized.about not in mutated


def test_robots_are_drawn_under_both_fitness_functions(run):
    table = wl.analysis.rescore(run, "velocity")
    axes = wl.plots.rescoring(table)
    counted = table[np.isfinite(table.fitness) & np.isfinite(table.fitness_after)]
    robots = axes.lines[0]
    assert sorted(np.float64(robots.get_ydata())) == pytest.approx(sorted(counted.fitness_after))
    marked = {line.get_label(): np.float64(line.get_xydata())[0] for line in axes.lines[1:]}
    best, best_after = (counted.loc[counted[rank].idxmin()] for rank in ("rank", "rank_after"))
    expected = {"fittest by distance": best, "fittest by velocity": best_after}
    if best.individual == best_after.individual:
        expected = {"fittest by both": best}
    assert marked.keys() == expected.keys()
    for label, robot in expected.items():
        assert marked[label] == pytest.approx([robot.fitness, robot.fitness_after])
    assert table.attrs["summary"] in caption(axes)
    with pytest.raises(ValueError, match=r"wl\.analysis\.rescore"):
        wl.plots.rescoring(run.records)


def test_takeover_and_onemax_are_drawn_beside_theory():
    takeover = wl.plots.takeover(wl.analysis.follow_takeover(["top_half", "rank"], population_size=8, n_trials=3))
    assert "slowest trial: top_half 3" in caption(takeover)
    assert n_sentences(takeover) == MAX_SENTENCES
    assert takeover.lines[0].get_ydata().tolist() == pytest.approx([12.5, 25, 50, 100])
    table = wl.analysis.evolve_onemax("top_half", n_bits=9, population_size=20, n_matings=1, seeds=[0])
    onemax = wl.plots.onemax(table)
    measured, theory, linked = (line.get_ydata() for line in onemax.lines[:3])
    assert measured.tolist() == table.mean_fitness.tolist()
    assert theory.tolist() == table.theory.tolist()
    assert linked.tolist() == table.theory_linked.tolist()


def test_a_takeover_that_never_happens_can_be_drawn():
    def worst(fitness, n_parents, *, rng):
        return np.full(n_parents, np.argmin(fitness))

    axes = wl.plots.takeover(wl.analysis.follow_takeover(worst, population_size=4, n_trials=2))
    assert "worst never" in caption(axes)


def test_bars_of_the_improvement_add_up_to_its_line(run):
    axes = wl.plots.improvement(run)
    split = wl.analysis.price_equation(run)
    line = next(line for line in axes.lines if "sum" in str(line.get_label()))
    assert line.get_ydata() == pytest.approx(split.change.to_numpy())
    total = sum(bar.get_height() for bar in axes.patches)
    shown = [term for term in TERMS if split[term].abs().sum() > 0.005 * split[[*TERMS]].abs().sum().sum()]
    assert total == pytest.approx(split[shown].sum().sum())
    assert "selection +" in caption(axes)
    assert n_sentences(axes) == MAX_SENTENCES
    with pytest.raises(ValueError, match="cannot also show"):
        wl.plots.improvement(run, axes, trait="body_length")
    assert "no two successive" in wl.plots.alt_text(wl.plots.improvement(run.records.head(0)))


def test_a_long_run_is_drawn_with_few_bars():
    generation = np.arange(101)
    table = pd.DataFrame({"generation": generation, "individual": generation, "born": generation, "verdict": "ok"})
    table = table.assign(parents=["", *map(str, generation[:-1])], fitness=generation**2.0)
    axes = wl.plots.improvement(table)
    assert len(axes.patches) <= 40
    assert axes.get_xlabel() == "generation (each bar: mean of 3)"
    assert axes.patches[0].get_height() == pytest.approx(np.mean([1, 3, 5]))


def test_credit_is_drawn_for_each_pair_of_operators(run):
    credit = wl.analysis.operator_credit(run)
    axes = wl.plots.operator_credit(run)
    assert [bar.get_width() for bar in axes.patches] == pytest.approx((100 * credit.better).tolist())
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        "crossover {}\nmutation {}".format(*credit.loc[0, ["crossover", "mutation"]])
    ]
    assert n_sentences(axes) == MAX_SENTENCES
    assert "no robot has parents yet" in wl.plots.alt_text(wl.plots.operator_credit(run.records.head(0))).lower()


def test_aligned_diversity_has_its_own_quantity(run):
    axes = wl.plots.diversity(run, aligned=True)
    last = run.records[run.records.generation == 3].genome.tolist()
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(wl.analysis.aligned_diversity(last))
    assert axes.lines[0].get_ydata()[-1] != pytest.approx(wl.plots.diversity(run).lines[0].get_ydata()[-1])
    with pytest.raises(ValueError, match="cannot also show"):
        wl.plots.diversity(run, axes)


def test_a_caption_stays_below_the_axes_of_the_user():
    figure = Figure(figsize=(6, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    table = wl.analysis.selection_probabilities(FITNESS, "rank")
    wl.plots.roulette_wheel(table, left)
    wl.plots.selection_by_rank(table, right)
    figure.draw_without_rendering()
    for axes in (left, right):
        box = max(axes.texts, key=lambda text: len(text.get_text())).get_window_extent()
        assert box.y1 < axes.get_window_extent().y0
        assert box.y0 >= 0


def test_tables_from_elsewhere_are_rejected(run):
    with pytest.raises(ValueError, match=r"wl\.analysis\.selection_probabilities"):
        wl.plots.roulette_wheel(run.records)
    with pytest.raises(ValueError, match=r"wl\.analysis\.evolve_onemax"):
        wl.plots.onemax("top_half")


def test_captions_do_not_shrink_the_drawings(run):
    settings = wl.Settings().with_(crossover="randomized", mutation="randomized")
    rng = np.random.default_rng(0)
    parents = [wl.Genome.random(settings.robot, rng=rng) for _ in range(2)]
    child = wl.analysis.mate(*parents, settings, rng=rng, mutates=True)
    for axes in (wl.plots.birth(child), wl.plots.pedigree(run)):
        axes.figure.canvas.draw()
        assert axes.get_window_extent().width > 0.95 * axes.figure.bbox.width
