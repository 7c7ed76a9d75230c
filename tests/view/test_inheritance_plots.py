"""Plots of births show the origin and the change of every gene, and have an alternative text."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import walkerlab as wl
from walkerlab.view.inheritance import cell_colour, mark_genes
from walkerlab.view.painted_bodies import paint_child, painted_parts

SETTINGS = wl.Settings()
POOL = wl.generate_robot_population(SETTINGS.robot, 5, seed=2)


def births():
    rng = np.random.default_rng(0)
    crossed = [
        wl.analysis.mate(POOL[0], POOL[1], SETTINGS.with_(crossover=name), rng=rng, others=POOL[2:], fitness=range(5))
        for name in ("paired", "weighted", "randomized", "none")
    ]
    mutants = [wl.analysis.mutate(POOL[0], SETTINGS.with_(mutation="macro", mutation_rate=0.2), rng=rng)]
    return [*crossed, *mutants]


@pytest.mark.parametrize("birth", births(), ids=lambda birth: "+".join(birth.operators))
def test_every_gene_has_a_cell_in_the_colour_of_its_origin(birth):
    axes = wl.plots.birth(birth, Figure(figsize=(12, 6)).add_subplot())
    axes.figure.canvas.draw()
    cells = {patch.get_gid().removeprefix("gene-"): patch for patch in axes.patches if patch.get_gid()}
    assert set(cells) == set(birth.genes.names)
    for mark in mark_genes(birth):
        assert to_rgb(cells[mark.name].get_facecolor()) == pytest.approx(cell_colour(mark))
    changes = sorted(mark.change for mark in mark_genes(birth) if mark.change)
    written = [text.get_text() for text in axes.texts if text.get_weight() == "bold"]
    assert sorted(one for one in written if one[0] in "+−w") == changes
    assert f"of the {len(birth.genes)} genes" in wl.plots.alt_text(axes).lower()


def test_parts_of_a_body_have_the_colour_of_their_parent():
    birth = births()[0]
    paint = paint_child(birth)
    parts, _ = painted_parts(birth.genome, paint)
    assert {f"trunk{i + 1}" for i in range(len(wl.express(birth.genome).segments))} <= set(paint.colours)
    drawn = {tuple(np.round(colour[:3].astype(float), 3).tolist()) for _, colour in parts}
    assert {tuple(np.round(colour, 3).tolist()) for colour in paint.colours.values()} <= drawn


def test_before_and_after_shows_spread_and_changed_share():
    settings = SETTINGS.with_(mutation="gaussian", mutation_rate=0.25)
    after = wl.mutate_population(POOL, SETTINGS.robot, settings.algorithm, generation=1)
    axes = wl.plots.before_after(POOL, after, Figure().add_subplot(), label="gaussian")
    axes.figure.canvas.draw()
    share = (np.abs(POOL - after) > 1e-9).mean()
    assert f"{share:.1%} of all genes changed" in wl.plots.alt_text(axes)
    same = wl.plots.before_after(POOL, POOL, Figure().add_subplot())
    assert "0.0% of all genes changed" in wl.plots.alt_text(same)
    with pytest.raises(ValueError, match="each genome must have 56 genes"):
        wl.plots.before_after(POOL, [wl.Genome(POOL[0][:17])])
