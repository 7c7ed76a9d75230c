"""An experiment is paired, resumable, and reported without saying more than its figures allow."""

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from functools import partial

import numpy as np
import pytest

import walkerlab as wl
from tests.faults import standins
from walkerlab.__main__ import main
from walkerlab.evolution import evolution
from walkerlab.experiment import compare
from walkerlab.runfile import experiments, records
from walkerlab.simulation import evaluation

SETTINGS = wl.Settings().with_(duration=1.0, population_size=6, generations=3, n_elites=2)
N_SEEDS = 10
CONDITIONS = {"calm": SETTINGS, "wild": SETTINGS.with_(mutation_rate=0.5), "random": wl.random_search}


@pytest.fixture(autouse=True)
def _stand_in(monkeypatch):
    for module in (evolution, compare):
        monkeypatch.setattr(module, "evaluate", standins.evaluate)


@pytest.fixture(scope="module")
def experiment():
    with pytest.MonkeyPatch.context() as patch:
        for module in (evolution, compare):
            patch.setattr(module, "evaluate", standins.evaluate)
        return wl.compare(CONDITIONS, seeds=range(N_SEEDS), progress=False)


def rows(experiment, condition, generation=None):
    table = experiment.records
    table = table[table.condition == condition]
    return table if generation is None else table[table.generation == generation]


def test_the_same_seeds_give_the_same_first_generation_and_as_many_evaluations(experiment):
    columns = ["seed", "individual", "fitness", "genome"]
    first = [rows(experiment, name, 0)[columns].reset_index(drop=True) for name in CONDITIONS]
    assert first[0].equals(first[1])
    assert first[0].equals(first[2])
    born = experiment.records[experiment.records.born == experiment.records.generation]
    assert born.groupby(["condition", "seed"]).size().nunique() == 1


def test_changing_only_the_mutation_keeps_the_draws_of_selection():
    drawn = {}

    def select(fitness, n_parents, name, *, rng):
        drawn.setdefault(name, []).append(rng.random(5).tolist())
        return rng.integers(len(fitness), size=n_parents)  # the number of robots that count can differ

    calm, wild = (
        SETTINGS.with_(selection=partial(select, name=name), mutation_rate=rate)
        for name, rate in (("calm", 0.02), ("wild", 0.5))
    )
    drawn.clear()
    wl.compare({"calm": calm, "wild": wild}, seeds=range(2), progress=False)
    n_draws = 2 * (SETTINGS.algorithm.generations - 1)
    assert drawn["calm"][-n_draws:] == drawn["wild"][-n_draws:]


def test_a_run_of_an_experiment_is_that_of_evolve(experiment):
    alone = wl.evolve(SETTINGS.with_(seed=3), progress=False)
    assert experiment.run("calm", 3).records.equals(alone.records)
    assert experiment.run("calm", 3).settings == alone.settings


def test_records_are_tidy_with_units(experiment):
    table = experiment.records
    assert list(table.columns) == ["condition", "seed", *records.RECORD_COLUMNS]
    assert not table.duplicated(["condition", "seed", "generation", "individual"]).any()
    assert table.attrs["fitness"] == "distance"
    assert table.attrs["units"]["fitness"] == "m"


def test_the_summary_agrees_with_the_table(experiment):
    summary = experiment.summary()
    best = experiment.records.groupby(["condition", "seed"]).fitness.max().unstack()
    for row in summary.conditions.itertuples():
        assert row.best == pytest.approx(best.loc[row.condition].median())
        assert row.best_low <= row.best <= row.best_high
    for row in summary.comparisons.itertuples():
        assert row.a_better == (best.loc[row.a] > best.loc[row.b]).sum()
    assert experiment.best().champion.fitness == best.to_numpy().max()
    assert experiment.best("calm").champion.fitness == best.loc["calm"].max()
    assert len(experiment.summary(against="random").comparisons) == 2


def hill_climber(evaluate, settings, n_evaluations, *, rng):
    best = wl.Genome.random(settings.robot, rng=rng).values
    (fitness,) = evaluate([best])
    while True:
        tried = best + rng.normal(0, 0.1, (4, len(best)))
        results = evaluate(tried)
        if results.max() >= fitness:
            best, fitness = tried[results.argmax()], results.max()


def test_an_optimiser_of_the_user_has_as_many_evaluations_and_can_be_resumed(tmp_path):
    path = tmp_path / "e.walk"
    conditions = {"ga": SETTINGS, "climber": hill_climber}
    whole = wl.compare(conditions, seeds=[5], progress=False)
    assert (whole.records.condition == "climber").sum() == 6 + 2 * 4
    calls = 0

    def stop(*_, **__):
        nonlocal calls
        calls += 1
        if calls > 4:
            raise OSError("stopped")
        return standins.evaluate(*_, **__)

    with pytest.MonkeyPatch.context() as patch:
        for module in (evolution, compare):
            patch.setattr(module, "evaluate", stop)
        with pytest.raises(OSError, match="stopped") as error:
            wl.compare(conditions, seeds=[5], path=path, progress=False)
    assert "continue the experiment with the same call" in error.value.__notes__[0]
    assert not wl.load_experiment(path).complete_seeds
    assert wl.compare(conditions, seeds=[5], path=path, progress=False).records.equals(whole.records)


SERVER = """
import os
import sys
from tests.faults import standins
from tests.experiment.test_compare import CONDITIONS, N_SEEDS
from walkerlab.evolution import evolution
from walkerlab.experiment import compare
from walkerlab.runfile import experiments
import walkerlab as wl

def append(*given):
    stored(*given)
    print("stored", flush=True)

stored, experiments.append = experiments.append, append
evolution.evaluate = compare.evaluate = standins.evaluate
for _ in sys.stdin:  # a process for each line, so that the packages are imported only once
    process = os.fork()
    if not process:
        print(os.getpid(), flush=True)
        wl.compare(CONDITIONS, seeds=range(N_SEEDS), path=sys.argv[1], progress=False)
        os._exit(0)
    os.waitpid(process, 0)
    print("ended", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="nothing there kills like SIGKILL")
def test_an_experiment_killed_at_three_moments_has_the_same_table(experiment, tmp_path, request):
    path = tmp_path / "e.walk"
    environment = {**os.environ, "PYTHONPATH": str(request.config.rootpath)}
    sizes = []
    command = [sys.executable, "-c", SERVER, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, text=True) as server:
        for n_generations in (3, 20, 31):
            print(file=server.stdin, flush=True)
            process = int(server.stdout.readline())
            for _ in range(n_generations):
                assert server.stdout.readline() == "stored\n"
            os.kill(process, signal.SIGKILL)
            while server.stdout.readline() != "ended\n":
                pass
            sizes.append(sum(len(run.table) for run in experiments.read(path)[1].runs.values()))
    resumed = wl.compare(CONDITIONS, seeds=range(N_SEEDS), path=path, progress=False)
    assert sizes == sorted(set(sizes))
    assert sizes[-1] < len(experiment.records)
    assert resumed.records.equals(experiment.records)
    assert str(resumed.summary()) == str(experiment.summary())
    assert wl.load_experiment(path).records.equals(experiment.records)


def test_every_condition_begins_with_the_given_population_and_keeps_frozen_genes(experiment, tmp_path):
    path = tmp_path / "e.walk"
    given = [experiment.best("calm").champion, experiment.best("wild").champion]
    conditions = {"gait": SETTINGS.with_(frozen=["body"]), "all": SETTINGS, "random": (wl.random_search, SETTINGS)}
    found = wl.compare(conditions, seeds=[3], path=path, progress=False, population=given)
    first = [rows(found, name, 0).genome.tolist() for name in conditions]
    assert first[1] == first[2]
    assert all(genomes[0] == str(given[0].genome) for genomes in first)
    assert first[1][1] == str(given[1].genome)
    assert rows(found, "all", 0).operators.tolist()[0] == f"given: robot {given[0].individual}"
    n_bodies = {name: rows(found, name).genome.str.partition("| gait")[0].nunique() for name in conditions}
    assert n_bodies["gait"] == 1 < n_bodies["all"]
    assert wl.load_experiment(path).run("gait", 3).founders == found.run("gait", 3).founders
    with pytest.raises(wl.RunFileError, match="population has other genomes"):
        wl.compare(conditions, seeds=[3], path=path, progress=False, population=given[:1])
    alone = wl.compare(conditions, seeds=[3], progress=False, population={"gait": given, "random": given[:1]})
    assert rows(alone, "gait").equals(rows(found, "gait"))
    for population, message in (({"gate": given}, "Did you mean 'gait'"), (None, "population="), ([], "is empty")):
        with pytest.raises(ValueError, match=message):
            wl.compare(conditions, seeds=[3], progress=False, population=population)
    with pytest.raises(ValueError, match="keyword-only parameter population"):
        wl.compare({"climber": (hill_climber, SETTINGS)}, [3], progress=False, population=given)


def test_interrupted_experiments_have_complete_pairs(tmp_path, monkeypatch):
    calls = 0

    def interrupt(*given, **named):
        nonlocal calls
        calls += 1
        if calls > 25:
            raise KeyboardInterrupt
        return standins.evaluate(*given, **named)

    for module in (evolution, compare):
        monkeypatch.setattr(module, "evaluate", interrupt)
    found = wl.compare(CONDITIONS, seeds=range(6), path=tmp_path / "e.walk", progress=False)
    assert 0 < len(found.complete_seeds) < 6
    assert found.summary().n_seeds == len(found.complete_seeds)
    assert "runs have ended; to continue, repeat the call" in found.status


def test_a_changed_experiment_is_not_continued(tmp_path):
    path = tmp_path / "e.walk"
    wl.compare({"a": SETTINGS}, seeds=[1], path=path, progress=False)
    for conditions, message in (
        ({"b": SETTINGS}, "contains an experiment with the conditions 'a'; got 'b'"),
        ({"a": SETTINGS.with_(n_elites=1)}, "algorithm.n_elites is 2, not 1"),
        ({"a": (hill_climber, SETTINGS)}, "optimiser is '', not 'hill_climber'"),
    ):
        with pytest.raises(wl.RunFileError, match=message):
            wl.compare(conditions, seeds=[1], path=path, progress=False)
    with pytest.warns(UserWarning, match="1 seed added to a complete experiment"):
        added = wl.compare({"a": SETTINGS}, seeds=[1, 2], path=path, progress=False)
    assert added.seeds == added.complete_seeds == [1, 2]


@pytest.mark.parametrize(
    ("conditions", "seeds", "message"),
    [
        ([SETTINGS], [1], "conditions must be a dict"),
        ({"a": SETTINGS.terrain}, [1], "settings must be a Settings"),
        ({"a": wl.random_search}, [1], "no condition has settings"),
        ({"a": SETTINGS, "b": SETTINGS.with_(fitness="velocity")}, [1], "different fitness"),
        (
            {"a": SETTINGS, "b": SETTINGS.with_(duration=2), "c": wl.random_search},
            [1],
            "unclear which of their settings",
        ),
        ({"a\n": SETTINGS}, [1], "one line of 1 to"),
        ({"a": SETTINGS}, 10, r"seeds=range\(10\)"),
        ({"a": SETTINGS}, [1, 1], "seed 1 occurs twice"),
        ({"a": SETTINGS}, [], "seeds is empty"),
        ({"a": SETTINGS}, [-1], "seed"),
    ],
)
def test_wrong_arguments_are_reported_before_anything_runs(conditions, seeds, message, tmp_path):
    with pytest.raises((TypeError, ValueError), match=message):
        wl.compare(conditions, seeds=seeds, path=tmp_path / "e.walk", progress=False)
    assert not (tmp_path / "e.walk").exists()


def test_a_sweep_names_every_combination(monkeypatch):
    monkeypatch.setattr(compare, "compare", lambda conditions, *_, population: conditions)
    conditions = wl.sweep(SETTINGS, mutation_rate=[0.02, 0.3], selection=["rank", "tournament"])
    assert list(conditions) == [
        *("mutation_rate=0.02, selection=rank", "mutation_rate=0.02, selection=tournament"),
        *("mutation_rate=0.3, selection=rank", "mutation_rate=0.3, selection=tournament"),
    ]
    assert conditions["mutation_rate=0.3, selection=rank"] == SETTINGS.with_(mutation_rate=0.3, selection="rank")
    for wrong, message in (
        ({}, "needs a setting with several values"),
        ({"mutation_rate": 0.3}, r"mutation_rate=\[…\]"),
        ({"mutation": [0.3]}, "mutation"),
        ({"mutation_rate": [0.1, 0.1]}, "two conditions"),
        ({"mutation_rates": [0.1]}, "mutation_rate"),
    ):
        with pytest.raises((TypeError, ValueError), match=message):
            wl.sweep(SETTINGS, **wrong)


def test_runs_without_counted_walks_are_the_worst(monkeypatch):
    def evaluate(genomes, settings, executor=None, *, on_done=lambda n: None, starts=None, **_):
        found = standins.evaluate(genomes, settings)
        if settings.algorithm.mutation_rate < 0.4:
            return found
        kept = [one.genome for one in found]
        return [evaluation.Evaluation(genome, -np.inf, "fell", "it fell", 0.0, 0.0, 2, 4, 5.0, 0.6) for genome in kept]

    monkeypatch.setattr(evolution, "evaluate", evaluate)
    short = SETTINGS.with_(generations=2)
    found = wl.compare({"a": short, "b": short.with_(mutation_rate=0.5)}, seeds=range(6), progress=False)
    summary = found.summary()
    assert "a is better than b" in summary.text
    assert "no counted walk" in summary.text
    assert summary.comparisons.p[0] == pytest.approx(2 / 2**6)
    assert "in 6 of them no walk counted" in found._repr_html_()


# ------------------------------------------------------------------------------------------------------------ the file


@pytest.fixture(scope="module")
def intact(tmp_path_factory):
    path = tmp_path_factory.mktemp("intact") / "e.walk"
    with pytest.MonkeyPatch.context() as patch:
        for module in (evolution, compare):
            patch.setattr(module, "evaluate", standins.evaluate)
        wl.compare({"a": SETTINGS, "b": wl.random_search}, seeds=[1], path=path, progress=False)
    return path


def test_load_and_show_say_what_an_experiment_is(tmp_path, capsys):
    path = tmp_path / "e.walk"
    whole = wl.compare({"a": SETTINGS, "b": wl.random_search}, seeds=[1, 2], path=path, progress=False)
    with pytest.raises(wl.RunFileError, match="contains an experiment"):
        wl.load(path)
    with pytest.raises(wl.RunFileError, match="contains an experiment"):
        wl.resume(path)
    assert main(["show", str(path)]) == 0
    shown = capsys.readouterr().out
    assert whole.summary().text.split(":")[0] in shown
    wl.evolve(SETTINGS, tmp_path / "run.walk", progress=False)
    with pytest.raises(wl.RunFileError, match="does not contain an experiment"):
        wl.load_experiment(tmp_path / "run.walk")


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE records SET fitness = 99 WHERE generation = 1",
        "DELETE FROM records WHERE generation = 2",
        "DELETE FROM generations WHERE generation = 2",
        "DELETE FROM finished",
        "UPDATE finished SET n_generations = 2",
        "INSERT INTO finished VALUES (7, 7, 0, '')",
        "UPDATE experiment SET value = '[1, 2, 3]' WHERE fact = 'seeds'",
        "UPDATE experiment SET value = '{}' WHERE fact = 'condition 0'",
        "DELETE FROM experiment WHERE fact = 'condition 1'",
        "CREATE TRIGGER t AFTER INSERT ON records BEGIN DELETE FROM records; END",
        "CREATE VIEW v AS SELECT * FROM records",
    ],
)
def test_a_changed_or_hostile_file_is_rejected(change, intact, tmp_path):
    path = shutil.copy(intact, tmp_path / "e.walk")
    with closing(sqlite3.connect(path)) as db, db:
        db.execute(change)
    if change == "DELETE FROM finished":  # an interrupted experiment
        assert not wl.load_experiment(path).complete_seeds
    else:
        with pytest.raises(wl.RunFileError, match="damaged"):
            wl.load_experiment(path)


def test_texts_of_a_file_are_escaped(tmp_path):
    script = "<script>alert(1)</script>"
    found = wl.compare({script: SETTINGS, "=1+1": wl.random_search}, seeds=[1, 2], progress=False)
    page = found.report(tmp_path / "report").read_text(encoding="utf-8")
    assert script not in page + found._repr_html_()
    assert "\n=1+1" not in (tmp_path / "report" / "records.csv").read_text(encoding="utf-8")
    assert (tmp_path / "report" / "tables" / "comparisons.csv").exists()


def test_the_curves_of_an_experiment_are_a_table_as_well(experiment):
    table = wl.stats.curves(experiment)
    assert len(table) == 3 * N_SEEDS * 3
    row = table[(table.condition == "calm") & (table.seed == 2)].iloc[-1]
    run = experiment.run("calm", 2)
    assert row.best_so_far == run.champion.fitness
    assert row.robots == 6
    assert wl.stats.curves(run).diversity.iloc[-1] == pytest.approx(row.diversity)


def test_a_forecast_is_shown_before_an_experiment(capsys, monkeypatch):
    monkeypatch.setattr(compare, "estimate_seconds", lambda settings: 30.0)
    wl.compare({"a": SETTINGS, "b": wl.random_search}, seeds=[1, 2], progress=True)
    assert "4 runs, 56 walks: about 2 minutes on " in capsys.readouterr().out
