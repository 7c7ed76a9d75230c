"""The HTML representations of objects in notebooks are complete, have units, and escape hostile text."""

import re
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings

import walkerlab as wl
from tests.strategies import all_settings, genomes
from tests.text.test_html import HOSTILE, Seen, assert_harmless
from walkerlab.commands.worlds import WALKER_GENOME
from walkerlab.genome.features import LEG_FEATURES
from walkerlab.runfile.records import Individual, concatenate_tables
from walkerlab.settings.fields import Quantity
from walkerlab.settings.glossary import glossary_rows
from walkerlab.simulation.fitness import distance, velocity
from walkerlab.simulation.validity import VERDICTS
from walkerlab.text.numbers import with_unit
from walkerlab.view.summary import list_changed_settings

DOMAINS = (wl.Terrain, wl.Robot, wl.Algorithm, wl.Simulation)
GENOME = wl.Genome.random(wl.Robot(segments=(2, 4)), rng=np.random.default_rng(3))


def render_html(value):
    """Return the parsed HTML of a value after checking that it contains no active content."""
    return assert_harmless(value._repr_html_())


def hostile_function(*args):
    return 1.0


hostile_function.__name__ = HOSTILE


@pytest.fixture(scope="module")
def run():
    return wl.evolve(wl.Settings().with_(generations=2, population_size=6, duration=1), progress=False)


@pytest.mark.parametrize("domain", DOMAINS)
def test_every_setting_is_shown_with_value_unit_and_description(domain):
    for text in (render_html(domain()).text, render_html(wl.Settings()).text):
        for name, declared in domain.declared().items():
            value = getattr(domain(), name)
            assert name in text
            assert declared.about in text
            if isinstance(declared, Quantity) and not declared.components:
                assert f"{value:.10g}{f' {declared.unit}' if declared.unit else ''}" in text
            assert not isinstance(declared, Quantity) or declared.unit in text


@hypothesis_settings(max_examples=25)
@given(settings=all_settings)
def test_each_setting_is_shown_once_and_changed_settings_are_marked(settings):
    parsed = render_html(settings)
    assert parsed.text.count("●\N{NO-BREAK SPACE}") == len(settings.changes())
    assert len([row for row in parsed.all("tr") if row.get("class") == "strong"]) == len(settings.changes())
    for _, domain in settings:
        for row in glossary_rows(domain):
            assert row.value in parsed.text
            assert row.about in parsed.text


@given(settings=all_settings)
def test_changes_and_python_code_reproduce_the_settings(settings):
    assert wl.Settings().with_(**settings.changes()) == settings
    assert eval(settings.as_python(), {"wl": wl}) == settings


def test_operators_and_presets_are_shown_by_name():
    settings = wl.Settings().with_(
        gravity="moon", selection=["top_half", partial(wl.ga.selection.tournament, size=7)], weight=(2, 5)
    )
    text = render_html(settings).text
    for phrase in ("(0, 0, -1.62) m/s², moon", "top_half, tournament(size=7)", "2 to 5 kg"):
        assert phrase in text


def test_settings_are_shown_with_all_digits():
    settings = wl.Settings().with_(step_height=1 / 3, weight=(1 / 3, 2 / 3), wind=(1 / 3, 0, 0))
    for phrase in (f"{1 / 3!r} m", f"{1 / 3!r} to {2 / 3!r} kg", f"({1 / 3!r}, 0, 0) m/s"):
        assert phrase in render_html(settings).text
    assert f"Terrain.step_height = {1 / 3!r}  (default 0.08)" in list_changed_settings(settings.model_dump())


def test_function_names_that_are_not_identifiers_are_not_evaluated_when_pasted():
    settings = wl.Settings().with_(mutation=[hostile_function, partial(hostile_function, **{HOSTILE: 1})])
    assert HOSTILE in render_html(settings).text
    with pytest.raises(wl.SettingsError):
        eval(settings.as_python(), {"wl": wl})
    assert repr(wl.Algorithm(fitness=lambda rollout: 1.0)) == "Algorithm(fitness='<lambda>')"


@given(genome=genomes())
def test_a_genome_is_shown_with_all_genes_and_its_text(genome):
    parsed = render_html(genome)
    assert str(genome) in parsed.text
    assert len(parsed.all("tr")) == 2 * (2 + genome.n_parts)


def test_genes_that_are_not_grown_are_faint_and_labelled():
    parsed = render_html(GENOME)
    n_expressed = len(wl.express(GENOME).segments)
    assert n_expressed < GENOME.n_parts, "precondition of this test"
    assert parsed.text.count("(not expressed)") == 2 * (GENOME.n_parts - n_expressed)
    assert [row.get("class") for row in parsed.all("tr")].count("faint") == 2 * (GENOME.n_parts - n_expressed)


def test_genes_of_legs_that_repeat_others_are_faint_and_explained():
    for word, is_explained in (("own", False), ("repeat", True)):
        genome = wl.Genome.parse(WALKER_GENOME.replace("legs own", f"legs {word}"))
        html = genome._repr_html_()
        faint = re.findall(r'<span class="faint">(.+?)</span>', html)
        assert len(faint) == (1 + 2 * len(LEG_FEATURES) if is_explained else 1), "the first legs have none to repeat"
        assert ("Legs marked <i>repeat</i>" in html) == is_explained


def test_gene_names_are_those_of_the_genome_text():
    text = render_html(GENOME).text
    joints = ("hip", "knee", "amplitude", "phase", "stride")
    for word in ("seg", "length", "mass", "legs", "force", "frequency", "lag", "duty", "repeat", *joints):
        assert word in str(GENOME)
        assert word in text


def test_the_meaning_of_each_gene_is_shown_in_full():
    table = wl.gene_table(wl.Robot())
    for shown in (table, table.head(9), table[["gene", "meaning"]]):
        text = render_html(shown).text
        assert all(meaning in text for meaning in shown.meaning)


def test_an_individual_is_shown_with_meaning_of_the_verdict_and_parents():
    text = render_html(Individual(7, GENOME, 1.5, "ok", "", 3, (1, 2))).text
    assert "Robot 7" in text
    assert "1, 2" in text
    assert VERDICTS["ok"] in text
    text = render_html(Individual(7, GENOME, -np.inf, "fell", HOSTILE, 0, ())).text
    assert VERDICTS["fell"] in text
    assert HOSTILE in text
    assert "inf" not in text
    assert_harmless(Individual(7, GENOME, 1.5, HOSTILE, HOSTILE, 3, ())._repr_html_())


def test_a_walk_is_shown_with_verdict_and_results():
    rollout = wl.simulate(GENOME, wl.Settings().with_(duration=1))
    assert (rollout.distance, rollout.velocity) == (distance(rollout), velocity(rollout))
    text = render_html(rollout).text
    assert VERDICTS[rollout.verdict] in text
    assert rollout.reason in text
    for phrase in (with_unit(rollout.distance, "m"), with_unit(rollout.velocity, "m/s"), " J", "1 s"):
        assert phrase in text


def test_a_run_is_shown_with_result_plots_and_next_steps(run):
    parsed = render_html(run)
    assert f"robot {run.champion.individual}" in parsed.text
    assert with_unit(run.champion.fitness, "m") in parsed.text
    assert len(parsed.all("svg")) == 2
    for phrase in ("run.champion", "run.replay()", "run.save_report("):
        assert phrase in parsed.text
    assert len(Seen(run._repr_html_() + run._repr_html_()).all("svg")) == 4


def test_a_run_without_generations_is_shown_as_a_sentence():
    parsed = render_html(wl.Run(wl.Settings(), concatenate_tables([])))
    assert "No generation is complete yet" in parsed.text
    assert not parsed.all("svg")


def test_a_run_with_a_hostile_name_is_escaped(run, tmp_path):
    settings = run.settings.with_(fitness=hostile_function)
    named = wl.Run(settings, run.records.copy(), tmp_path / HOSTILE.replace("/", " "))
    text = render_html(named).text
    assert HOSTILE in text
