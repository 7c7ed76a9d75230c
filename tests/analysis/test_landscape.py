"""A landscape varies one or two genes and keeps all others, and the walks of its points can be played."""

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

import walkerlab as wl
from walkerlab.analysis.inheritance import ROUNDING_TOLERANCE
from walkerlab.genome.features import build_genes
from walkerlab.view.replay.page import Frame

SETTINGS = wl.Settings().with_(duration=1)
GENES = build_genes(SETTINGS.robot)
GENOME = wl.Genome.random(SETTINGS.robot, rng=np.random.default_rng(4))


@pytest.fixture(scope="module")
def slice_of_two(pool):
    return wl.analysis.landscape(GENOME, SETTINGS, ["frequency", "seg1.leg_length"], n=4, executor=pool)


@pytest.fixture(scope="module")
def slice_of_one(pool):
    return wl.analysis.landscape(GENOME, SETTINGS, "seg1.length", n=5, executor=pool, span=0.5)


def test_only_the_named_genes_vary_except_for_repair(slice_of_one, slice_of_two):
    for table in (slice_of_one, slice_of_two):
        names = table.attrs["genes"]
        indices = [GENES.names.index(name) for name in names]
        for row in table.to_dict("records"):
            requested = GENOME.values.copy()
            requested[indices] = [row[name] for name in names]
            walked = wl.Genome.parse(row["genome"]).values
            assert (np.abs(walked - requested) > ROUNDING_TOLERANCE).sum() == row["n_repaired"]
    assert (slice_of_two.n_repaired == 0).any()


def test_every_fitness_is_that_of_the_walk_of_its_genome(slice_of_two, pool):
    sample = slice_of_two.iloc[[0, 5, 16]]
    walks = wl.evaluate(sample.genome.tolist(), SETTINGS, pool)
    assert [walk.fitness for walk in walks] == sample.fitness.tolist()
    assert slice_of_two.is_centre.tolist() == [True] + 16 * [False]
    assert slice_of_two.genome[0] == str(GENOME)


def test_values_cover_the_range_or_the_span(slice_of_one, slice_of_two, pool):
    low, high = (ends[GENES.names.index("frequency")] for ends in (GENES.low, GENES.high))
    assert sorted(set(slice_of_two.frequency[1:])) == pytest.approx(np.linspace(low, high, 4), abs=0.001)
    lengths = slice_of_one["seg1.length"][1:]
    j = GENES.names.index("seg1.length")
    assert np.ptp(lengths) == pytest.approx((GENES.high[j] - GENES.low[j]) / 2, abs=0.002)
    legs = wl.analysis.landscape(GENOME, SETTINGS, "seg2.legs", executor=pool)
    assert legs["seg2.legs"][1:].tolist() == [0, 1]
    assert len(wl.analysis.landscape(GENOME, SETTINGS, "lag", n=3, executor=pool)) == 4


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"genes": "wings"}, "there is no gene 'wings'"),
        ({"genes": []}, "the name of one gene or the names of two different genes"),
        ({"genes": ["lag", "lag"]}, "the name of one gene or the names of two different genes"),
        ({"n": 1}, "n is 1; it must be between 2 and 100"),
        ({"span": 0}, "span is 0; it must be above 0"),
    ],
)
def test_wrong_arguments_are_rejected(arguments, message):
    with pytest.raises(ValueError, match=message):
        wl.analysis.landscape(GENOME, SETTINGS, **arguments)


def test_the_plot_shows_the_fitness_of_each_point(slice_of_one, slice_of_two):
    axes = wl.plots.landscape(slice_of_two, Figure().add_subplot())
    [mesh] = [child for child in axes.get_children() if isinstance(child, QuadMesh)]
    walks = slice_of_two[1:]
    expected = walks.fitness.where(walks.verdict == "ok").to_numpy().reshape(4, 4).T
    assert np.ma.allequal(np.ma.masked_invalid(expected), mesh.get_array())
    assert "16 walks in which only frequency and leg length of segment 1 varies" in wl.plots.alt_text(axes)
    curve = wl.plots.landscape(slice_of_one, Figure().add_subplot())
    curve.figure.canvas.draw()
    assert curve.get_xlabel() == "length of segment 1 [m]"
    with pytest.raises(ValueError, match=r"needs the table of wl\.analysis\.landscape"):
        wl.plots.landscape(slice_of_one.drop(columns="fitness"), Figure().add_subplot())


def test_a_click_plays_the_walk_of_the_point(slice_of_one, slice_of_two, monkeypatch):
    for table in (slice_of_one, slice_of_two):
        widget = wl.widgets.Landscape(table)
        played = []
        monkeypatch.setattr(Frame, "play", lambda _, played=played: played.append(True))
        widget.plot._handle_custom_msg({"walk": 3}, [])
        assert played
        assert widget.plot.selected == 3
        [walk] = widget.frame._make().walks
        assert str(walk.scene.genome) == table.genome[3]
        assert walk.rollout.distance == pytest.approx(table.distance[3])
        assert np.all((np.array(widget.plot.points) >= 0) & (np.array(widget.plot.points) <= 1))
        widget.plot._handle_custom_msg({"walk": 999}, [])
        assert widget.plot.selected == 3
        assert "data:image/png" in widget.snapshot()
    positions = np.array(widget.plot.points)[1:].reshape(4, 4, 2)
    assert (np.diff(positions[:, :, 0], axis=0) > 0).all()
    assert (np.diff(positions[:, :, 1], axis=1) < 0).all()
