"""Measurements of selection agree with theory, and probabilities are those with which the operator selects."""

import math
from functools import partial

import numpy as np
import pytest
from scipy.stats import chisquare, norm

import walkerlab as wl
from tests.ga.laws import MIN_P_VALUE
from walkerlab.analysis.selection_theory import exact_probabilities, selection_curve, selection_theory, takeover_theory
from walkerlab.ga.selection import gradient, rank, top_half, tournament, uniform

FITNESS = np.array([-2.0, 3.5, 3.5, -7.0, 0.0, 11.0, 3.5])
OURS = [gradient, rank, top_half, uniform, tournament, partial(tournament, size=2), partial(rank, pressure=1.2)]
TOLERANCE = 0.03


def by_measure(table, name):
    return table[table.selection == name].set_index("measure")


def softmax(fitness, n_parents, *, rng):
    weights = np.exp(fitness - fitness.max())
    return rng.choice(len(fitness), size=n_parents, p=weights / weights.sum())


# -------------------------------------------------------------------------------------------------------- theory


@pytest.mark.parametrize("size", [1, 2, 3, 5, 9])
def test_the_theory_of_tournaments_agrees_with_the_literature(size):
    theory = selection_theory(selection_curve(partial(tournament, size=size)))
    grid = np.linspace(-8, 8, 100_001)
    density = size * norm.cdf(grid) ** (size - 1) * norm.pdf(grid)  # of the maximum of several normal numbers
    intensity = np.trapezoid(grid * density, grid)
    assert theory.intensity == pytest.approx(intensity, abs=1e-5)
    assert theory.variance == pytest.approx(np.trapezoid(grid**2 * density, grid) - intensity**2, abs=1e-5)
    if size > 1:
        blickle_and_thiele = size ** (-1 / (size - 1)) - size ** (-size / (size - 1))
        assert theory.loss_of_diversity == pytest.approx(blickle_and_thiele, abs=1e-5)
    if size == 2:
        assert theory.unselected == pytest.approx((1 - math.exp(-2)) / 2, abs=1e-5)


def test_known_values_of_the_other_operators():
    top, linear, none = (selection_theory(selection_curve(each)) for each in (top_half, rank, uniform))
    assert top.intensity == pytest.approx(2 * norm.pdf(0), abs=1e-5)
    assert (top.loss_of_diversity, top.unselected) == pytest.approx((0.5, 0.5), abs=1e-5)
    assert linear.intensity == pytest.approx(0.8 / math.sqrt(math.pi), abs=1e-5)
    assert linear.loss_of_diversity == pytest.approx(0.8 / 4, abs=1e-5)
    assert (none.intensity, none.loss_of_diversity) == pytest.approx((0, 0), abs=1e-9)
    assert none.unselected == pytest.approx(math.exp(-1), abs=1e-5)


@pytest.mark.parametrize("n", [50, 100, 1000])
def test_the_takeover_time_of_tournaments_agrees_with_goldberg_and_deb(n):
    for size in (2, 3, 5):
        curve = selection_curve(partial(tournament, size=size))
        expected = (math.log(n) + math.log(math.log(n))) / math.log(size)
        assert abs(len(takeover_theory(curve, n, 100)) - 1 - expected) < 1


def test_operators_without_a_formula_have_no_theory():
    for unknown in (gradient, softmax, partial(tournament, 2), partial(softmax)):
        assert selection_curve(unknown) is None
    assert exact_probabilities(softmax, FITNESS, 7) is None


# -------------------------------------------------------------------------------------------------- measurements


@pytest.fixture(scope="module")
def measured():
    selections = {"two": partial(tournament, size=2), "five": partial(tournament, size=5), "top": top_half}
    return wl.analysis.measure_selection(selections, population_size=400, n_populations=60, seed=1)


def test_measurements_agree_with_theory(measured):
    known = {"two": (0.564, 0.25, 0.432), "five": (1.163, 0.535, 0.606), "top": (0.798, 0.5, 0.5)}
    for name, values in known.items():
        table = by_measure(measured, name)
        rows = table.loc[["intensity", "loss_of_diversity", "unselected"]]
        assert rows.measured.tolist() == pytest.approx(values, rel=TOLERANCE)
        assert rows.theory.tolist() == pytest.approx(values, rel=0.002)
        assert (rows.standard_error < TOLERANCE * rows.measured).all()
        assert table.loc["takeover"].measured == pytest.approx(table.loc["takeover"].theory, rel=0.15)


def test_the_exact_top_half_takes_over_100_individuals_in_7_generations():
    table = wl.analysis.follow_takeover("top_half", population_size=100, n_trials=5)
    assert table.share.tolist() == [0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.0]
    assert table.theory.tolist() == pytest.approx(table.share.tolist())
    assert (table.lowest == table.highest).all()
    measured = by_measure(wl.analysis.measure_selection("top_half", population_size=100, n_populations=5), "top_half")
    assert tuple(measured.loc["takeover"][["measured", "standard_error", "theory"]]) == (7, 0, 7)
    assert measured.loc["best_lost"].measured == 0


def test_stronger_selection_has_a_higher_intensity_and_a_shorter_takeover():
    selections = [uniform, gradient, partial(tournament, size=2), partial(tournament, size=6)]
    table = wl.analysis.measure_selection(selections, population_size=50, n_populations=30)
    intensity, loss, takeover = (
        table[table.measure == measure].measured.to_numpy()
        for measure in ("intensity", "loss_of_diversity", "takeover")
    )
    assert (np.diff(intensity) > 0).all()
    assert (np.diff(loss) > 0).all()
    assert (np.diff(takeover[1:]) < 0).all()
    assert table.theory[table.selection == "gradient"].isna().all()
    assert table.selection.unique().tolist() == ["uniform", "gradient", "tournament(size=2)", "tournament(size=6)"]


def test_a_user_function_and_operators_in_turn_are_measured_too():
    calls = []

    def strict(fitness, n_parents, *, rng, genomes, generation):
        calls.append((genomes.shape[0], generation))
        return np.resize(np.argsort(-fitness)[:1], n_parents)

    table = wl.analysis.measure_selection([strict, [top_half, strict]], population_size=30, n_populations=3)
    for name in ("strict", "top_half+strict"):
        rows = by_measure(table, name)
        assert rows.loc["takeover"].measured == 1
        assert rows.loc["unselected"].measured == pytest.approx(29 / 30)
        assert np.isnan(rows.loc["intensity"].theory)
    assert (30, 1) in calls


def test_measurements_can_be_repeated_and_depend_on_the_seed():
    first, same, other = (
        wl.analysis.measure_selection(softmax, population_size=10, n_populations=3, seed=seed) for seed in (2, 2, 3)
    )
    assert first.equals(same)
    assert not first.equals(other)


# ------------------------------------------------------------------------------------------------- probabilities


@pytest.mark.parametrize("select", OURS)
@pytest.mark.parametrize("n_parents", [7, 10])
def test_exact_probabilities_are_those_with_which_the_operator_selects(select, n_parents):
    table = wl.analysis.selection_probabilities(FITNESS, select, n_parents=n_parents)
    assert table.attrs["exact"]
    assert table.probability.sum() == pytest.approx(1)
    rng = np.random.default_rng(5)
    selected = np.concatenate([select(FITNESS, n_parents, rng=rng) for _ in range(1000)])
    seen = np.bincount(selected, minlength=len(FITNESS))
    possible = table.probability.to_numpy() > 0
    assert not seen[~possible].any()
    assert chisquare(seen[possible], seen.sum() * table.probability[possible]).pvalue > MIN_P_VALUE


def test_an_estimate_is_within_its_error_of_the_truth():
    table = wl.analysis.selection_probabilities(FITNESS, softmax)
    weights = np.exp(FITNESS)
    assert not table.attrs["exact"]
    assert (abs(table.probability - weights / weights.sum()) <= 4 * table.standard_error + 1e-3).all()


def test_an_estimate_and_a_formula_agree():
    exact = wl.analysis.selection_probabilities(FITNESS, tournament)
    estimate = wl.analysis.selection_probabilities(FITNESS, lambda fitness, n, *, rng: tournament(fitness, n, rng=rng))
    assert (abs(exact.probability - estimate.probability) <= 4 * estimate.standard_error + 1e-3).all()


@pytest.mark.parametrize("select", [*OURS, softmax])
def test_individuals_that_do_not_count_are_never_selected(select):
    fitness = np.array([-np.inf, 1.0, 2.0, -np.inf, 5.0])
    table = wl.analysis.selection_probabilities(fitness, select)
    assert table.probability[[0, 3]].tolist() == [0, 0]
    if table.attrs["exact"]:
        counted = wl.analysis.selection_probabilities(fitness[np.isfinite(fitness)], select, n_parents=5)
        assert table.probability[[1, 2, 4]].tolist() == pytest.approx(counted.probability.tolist())
    assert sorted(table["rank"]) == [1, 2, 3, 4, 5]


@pytest.mark.parametrize("wrong", [[], [[1.0, 2.0]], [1.0, np.nan]])
def test_wrong_fitness_is_rejected(wrong):
    for select in ("rank", softmax):
        with pytest.raises(ValueError, match=r"fitness"):
            wl.analysis.selection_probabilities(wrong, select)


def test_unknown_and_wrong_operators_are_rejected():
    with pytest.raises(ValueError, match="tournament"):
        wl.analysis.selection_probabilities(FITNESS, "tournamet")
    with pytest.raises(wl.OperatorError, match="must return"):
        wl.analysis.measure_selection(lambda fitness, n_parents, *, rng: None)
    with pytest.raises(ValueError, match="at least one"):
        wl.analysis.measure_selection([])
