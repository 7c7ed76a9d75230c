"""A line of descent shows exactly the genes that differ from each robot to the next, on one screen."""

import re
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure

import walkerlab as wl
from tests.view.test_plots import evolved_table
from walkerlab.runfile.records import birth_rows, fitter_line, parent_numbers
from walkerlab.view.pedigree import changed_parts, describe_step, genes_of_text, trace_line

SCREEN = (1280, 800)


@pytest.fixture(scope="module", params=["paired", "none"])
def records(request):
    return evolved_table(100, 8, crossover=request.param, n_elites=1, mutation_rate=0.02, void=0.0)


@pytest.mark.parametrize("max_robots", [None, 10])
def test_the_genes_of_each_step_are_exactly_those_that_differ(records, max_robots):
    youngest = int(records.individual.max())
    steps = trace_line(records, youngest, max_robots)
    births = birth_rows(records)
    for before, step in pairwise(steps):
        old, new = (wl.Genome.parse(births.genome[one.individual]).values for one in (before, step))
        names = np.array(genes_of_text(step.genome).names)
        assert {change.gene for change in step.changes} == set(names[old != new])
        for change in step.changes:
            j = names.tolist().index(change.gene)
            assert (change.before, change.after) == (old[j], new[j])
            if change.is_inherited:
                assert step.n_births == 1
                assert wl.Genome.parse(births.genome[step.other_parent]).values[j] == new[j]
                assert step.other_parent in parent_numbers(births.parents[step.individual])
    table = wl.lineage_changes(records, youngest, max_robots)
    assert len(table) == sum(len(step.changes) for step in steps)


def test_only_robots_that_equal_the_one_before_are_left_out(records):
    youngest = int(records.individual.max())
    line = fitter_line(birth_rows(records), youngest)[::-1]
    steps = trace_line(records, youngest)
    shown = [step.individual for step in steps]
    assert [shown[0], shown[-1]] == [line[0], line[-1]]
    assert sum(step.n_births for step in steps) == len(line) - 1
    assert sum(step.n_generations for step in steps) == steps[-1].born - steps[0].born
    genome = birth_rows(records).genome
    for one in set(line) - set(shown):
        last = max(number for number in shown if line.index(number) < line.index(one))
        assert wl.express(wl.Genome.parse(genome[one])) == wl.express(wl.Genome.parse(genome[last]))
    assert len(trace_line(records, youngest, 10)) == min(10, len(steps))


def test_the_text_of_a_step_counts_the_genes_with_an_effect_the_largest_change_first(records):
    steps = trace_line(records, int(records.individual.max()))
    for step in steps[1:]:
        first, second = describe_step(step, genes_of_text(step.genome), 60)
        visible = [change for change in step.changes if change.is_expressed]
        assert sum(int(number) for number in re.findall(r"(\d+) genes?\b", first)) == len(visible), first
        named = second.count("→")
        more = re.search(r"and (\d+) more$", second)
        assert named + (int(more[1]) if more else 0) == len(visible), second
        assert [abs(change.share) for change in visible] == sorted((abs(c.share) for c in visible), reverse=True)
        assert not visible or second.startswith(visible[0].gene.replace("_", " ").replace(".", " "))
        assert max(len(first), len(second)) < 90


def test_a_changed_part_differs_from_the_parent_or_is_new(records):
    steps = trace_line(records, int(records.individual.max()))
    for before, step in pairwise(steps):
        old, new = (wl.express(wl.Genome.parse(one.genome)).segments for one in (before, step))
        parts = changed_parts(step, genes_of_text(step.genome))
        for i in range(len(new)):
            if i >= len(old):
                assert f"trunk{i + 1}" in parts
            elif f"trunk{i + 1}" not in parts:
                assert (new[i].length, new[i].mass) == (old[i].length, old[i].mass)


def test_a_line_of_100_generations_fits_on_one_screen(records):
    axes = wl.plots.pedigree(records, individual=int(records.individual.max()))
    figure = axes.figure
    figure.canvas.draw()
    width, height = figure.get_size_inches() * 100
    assert width <= SCREEN[0]
    assert height <= SCREEN[1]
    window = figure.bbox
    renderer = figure.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in axes.texts]
    assert all(window.x0 - 1 <= box.x0 and box.x1 <= window.x1 + 1 for box in boxes)
    assert min(text.get_fontsize() for text in axes.texts) > 6
    assert wl.plots.alt_text(axes).startswith("Line of descent of robot")


def test_an_empty_or_a_wrong_table_is_reported(records):
    axes = wl.plots.pedigree(records[:0], Figure().add_subplot())
    assert wl.plots.alt_text(axes) == "No robot has walked yet."
    with pytest.raises(ValueError, match="individual 99999 is not in this run"):
        wl.plots.pedigree(records, Figure().add_subplot(), individual=99999)
    with pytest.raises(ValueError, match="max_robots is 1; it must be 2 or more"):
        trace_line(records, max_robots=1)


def test_ancestors_race_from_the_first_to_the_last_of_the_line(records):
    run = wl.Run(wl.Settings().with_(duration=1), records)
    steps = trace_line(run)
    race = wl.race_ancestors(run, n=2)
    assert [walk.label for walk in race.walks] == [
        f"generation {step.born}: robot {step.individual}" for step in (steps[0], steps[-1])
    ]
    with pytest.raises(ValueError, match="n is 0; it must be 1 or more"):
        wl.race_ancestors(run, n=0)
