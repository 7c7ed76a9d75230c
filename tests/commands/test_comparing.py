"""``walkerlab compare`` runs and continues the same experiment as ``wl.compare``, and reports errors first."""

import argparse
from functools import partial

import pytest

import walkerlab as wl
from tests.faults import standins
from walkerlab.__main__ import main
from walkerlab.commands.comparing import build_conditions, parse_seeds
from walkerlab.evolution import evolution
from walkerlab.experiment import compare
from walkerlab.experiment.experiment import Experiment
from walkerlab.ga.selection import tournament

SETTINGS = wl.Settings().with_(duration=1.0, population_size=4, generations=2)
TINY = ["--duration", "1", "--population-size", "4", "--generations", "2"]
WORDS = ["gentle:selection=tournament(size=2)", "harsh: selection=tournament(size=7) n-elites=1", "--random-search"]


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for module in (evolution, compare):
        monkeypatch.setattr(module, "evaluate", standins.evaluate)


def test_an_interrupted_comparison_is_continued_by_its_folder_and_equals_that_of_python(monkeypatch, capsys):
    n_calls = 0

    def interrupt(*given, **named):
        nonlocal n_calls
        n_calls += 1
        if n_calls > 9:
            raise KeyboardInterrupt
        return standins.evaluate(*given, **named)

    for module in (evolution, compare):
        monkeypatch.setattr(module, "evaluate", interrupt)
    reported = []
    monkeypatch.setattr(compare, "estimate_seconds", lambda settings: 30.0)
    monkeypatch.setattr(Experiment, "report", lambda run, folder: reported.append((run.seeds, folder.name)))
    assert main(["compare", "--out", "a", "--seeds", "0,4-5", *TINY, *WORDS]) == 130
    printed = capsys.readouterr().out
    assert "12 runs" in printed
    assert "of 12 runs have ended.\nContinue with: walkerlab compare --out a" in printed
    for module in (evolution, compare):
        monkeypatch.setattr(module, "evaluate", standins.evaluate)
    assert main(["compare", "--out", "a"]) == 0
    assert "With 3 seeds and 6 comparisons" in capsys.readouterr().out
    gentle = SETTINGS.with_(selection=partial(tournament, size=2))
    harsh = SETTINGS.with_(selection=partial(tournament, size=7), n_elites=1)
    conditions = {
        "gentle": gentle,
        "harsh": harsh,
        "gentle: random search": (wl.random_search, gentle),
        "harsh: random search": (wl.random_search, harsh),
    }
    expected = wl.compare(conditions, seeds=[0, 4, 5], progress=False)
    assert wl.load_experiment("a").records.equals(expected.records)
    assert reported[-1] == ([0, 4, 5], "a")


def test_without_conditions_evolution_is_compared_with_random_search():
    assert build_conditions([], SETTINGS, random_search=True) == {
        "evolution": SETTINGS,
        "random search": (wl.random_search, SETTINGS),
    }
    words = ["a:mutation_rate=0.2", "b:mutation_rate=0.3 legs=2,6", "c:mutation_rate=0.3"]
    both = build_conditions(words, SETTINGS, random_search=True)
    assert list(both) == ["a", "b", "c", "a: random search", "b: random search"]  # only b has other robots
    assert both["b"].robot.legs == (2, 6)


def test_seeds_are_numbers_and_ranges():
    assert parse_seeds("0-3,7, 9") == [0, 1, 2, 3, 7, 9]
    for wrong in ("", "a", "1-", "-3", "1.5"):
        with pytest.raises(argparse.ArgumentTypeError, match="as in 0-9 or 0,2,5"):
            parse_seeds(wrong)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "contains no experiment to be continued"),
        (
            ["--generations", "9"],
            "There is nothing to compare. Name at least two conditions: walkerlab compare gentle:",
        ),
        (["gentle"], "condition 'gentle' must have a name, a colon and changed settings"),
        (["a:selection"], "condition 'a': 'selection' must be SETTING=VALUE"),
        (["a:selection=turnament(size=2)"], "Did you mean 'tournament'?"),
        (["a:selection=tournament(sizes=2)"], "unexpected keyword argument 'sizes'"),
        (["a:mutation_rates=0.2"], "condition 'a': Settings has no setting 'mutation_rates'"),
        (["a:", "b:mutation_rate=7"], "condition 'b': Algorithm.mutation_rate is 7"),
        (["a:", "a:mutation_rate=0.1"], "two conditions are called 'a'"),
        (["a:", "b:seed=3", "--seeds", "2,2"], "seed 2 occurs twice"),
        (["a:", "b:", "--mutation-rates", "3"], "Did you mean --mutation-rate?"),
    ],
)
def test_errors_are_reported_before_anything_runs(words, message, tmp_path, capsys):
    assert main(["compare", *words]) == 2
    assert message in capsys.readouterr().err
    assert not any(tmp_path.iterdir())


def test_another_experiment_or_a_run_in_the_folder_is_never_overwritten(monkeypatch, capsys):
    monkeypatch.setattr(Experiment, "report", lambda *_: None)
    assert main(["compare", "a:", "--seeds", "1", "--out", "a", "--quiet", *TINY]) == 0
    before = wl.load_experiment("a").records
    for command, message in (
        (["compare", "a:n_elites=1", "--seeds", "1", "--out", "a", *TINY], "walkerlab compare … --out ANOTHER-FOLDER"),
        (["resume", "a"], "Continue it with: walkerlab compare --out a"),
        (["compare", "--out", "run"], "does not contain an experiment"),
    ):
        if "run" in command:
            wl.evolve(SETTINGS, "run/run.walk", progress=False)
        assert main(command) == 2
        assert message in capsys.readouterr().err
    assert wl.load_experiment("a").records.equals(before)


def test_an_experiment_with_functions_of_the_user_is_continued_in_python(capsys):
    def climb(evaluate, settings, n_evaluations, *, rng):
        evaluate([wl.Genome.random(settings.robot, rng=rng) for _ in range(n_evaluations)])

    def select(fitness, n_parents, *, rng):
        return rng.integers(len(fitness), size=n_parents)

    for folder, condition in (("climb", (climb, SETTINGS)), ("select", SETTINGS.with_(selection=select))):
        wl.compare({"mine": condition}, [1], f"{folder}/run.walk", progress=False)
        assert main(["compare", "--out", folder]) == 2
        printed = capsys.readouterr().err
        assert f"has the function {folder}" in printed
        assert "repeat the call of wl.compare" in printed
