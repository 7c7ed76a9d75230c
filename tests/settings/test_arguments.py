"""Typical wrong arguments: each error names the value, what is allowed and the fix, not the inside of a library."""

import re
import shutil
from concurrent.futures import ThreadPoolExecutor

import matplotlib as mpl
import numpy as np
import pytest

import walkerlab as wl

SETTINGS = wl.Settings().with_(population_size=4, generations=1, n_elites=1, duration=1)


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """What the calls below are made with."""
    folder = tmp_path_factory.mktemp("run")
    with ThreadPoolExecutor(1) as thread:
        run = wl.evolve(SETTINGS, folder / "a.walk", thread, progress=False)
    for name in ("two/a.walk", "two/b.walk"):
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copy(folder / "a.walk", folder / name)
    (folder / "empty").mkdir()
    run.records.to_csv(folder / "table.csv")
    genome = run.champion.genome
    values = {"S": SETTINGS, "G": genome, "run": run, "T": run.records, "W": wl.simulate(genome, SETTINGS)}
    return values | {"wl": wl, "np": np, "at": folder, "X": ThreadPoolExecutor(1)}


SETTINGS_WANTED = "settings must be a Settings"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        # run files and folders
        ("wl.load(at / 'two')", ["2 run files", "a.walk, b.walk", "Name one of them: ", "two/a.walk"]),
        ("wl.resume(at / 'two')", ["2 run files"]),
        ("wl.load(at / 'empty')", ["empty contains no run file", ".walk"]),
        ("wl.load(at / 'table.csv')", ["table.csv", "not a run file", ".walk"]),
        ("wl.load(None)", ["path must be a path", "got None"]),
        ("wl.load(run)", ["path must be a path", "run.path"]),
        ("wl.resume(run)", ["path must be a path", "run.path"]),
        ("wl.rescue(at / 'a.walk', None)", ["to must be a path", "got None"]),
        ("wl.evolve(S, at / 'two', X)", ["which is a folder", "two/run.walk"]),
        ("wl.evolve(S, 3)", ["path must be a path", "got 3"]),
        ("wl.evolve(S, X)", ["path must be a path", "executor=…"]),
        # names of arguments
        (
            "wl.evolve(seed=3)",
            ["'seed' is a setting, not an argument of evolve", "wl.evolve(wl.Settings().with_(seed=3))"],
        ),
        ("wl.evolve(S, pth='x')", ["no argument 'pth'", "settings, path, executor, progress", "Did you mean 'path'?"]),
        ("wl.Evolution(S, seed=3)", ["wl.Evolution(wl.Settings().with_(seed=3))"]),
        ("wl.Settings({'seed': 3})", ["by name", "{'seed': 3}"]),
        ("S.with_({'seed': 3})", ["by name", "with_(duration=4)"]),
        # settings
        ("wl.evolve(wl.Settings)", [SETTINGS_WANTED, "wl.Settings()"]),
        ("wl.evolve({'seed': 3})", [SETTINGS_WANTED, "{'seed': 3}", "with_(seed=3)"]),
        ("wl.evolve('a.walk')", [SETTINGS_WANTED, "wl.load(path).settings"]),
        ("wl.simulate(G, None)", [SETTINGS_WANTED, "got None"]),
        ("wl.simulate(G, wl.Settings)", [SETTINGS_WANTED, "Call the class"]),
        ("wl.simulate(G, S.terrain)", [SETTINGS_WANTED, "wl.Settings(terrain=…)"]),
        ("wl.simulate(G, run)", [SETTINGS_WANTED, "run.settings"]),
        ("wl.simulate(G, G)", [SETTINGS_WANTED, "The genome comes first"]),
        ("wl.evaluate([G], {})", [SETTINGS_WANTED, "got {}"]),
        ("wl.compile_scene(G, None)", [SETTINGS_WANTED]),
        ("wl.confirm(G, {})", [SETTINGS_WANTED]),
        ("wl.replay(G, 'top')", [SETTINGS_WANTED, "got 'top'"]),
        ("wl.export_mjcf(G, None, at)", [SETTINGS_WANTED]),
        ("wl.film(G, None, at / 'x.mp4')", [SETTINGS_WANTED]),
        ("wl.plots.stride(G, None)", [SETTINGS_WANTED]),
        ("wl.plots.gait(G, None)", [SETTINGS_WANTED]),
        ("wl.plots.body(G, None, 'x')", [SETTINGS_WANTED]),
        ("wl.Lab('a.walk')", [SETTINGS_WANTED]),
        ("G.within(S)", ["a Robot such as settings.robot"]),
        ("wl.generate_terrain(S)", ["settings.terrain"]),
        ("wl.generate_robot(G)", ["(True, False, True)", "wl.compile_scene(genome, settings)"]),
        ("wl.select_from_population([1.0, 2.0], 4, S, generation=1)", ["such as settings.algorithm"]),
        ("wl.mutate_population([G], S.robot, S, generation=1)", ["such as settings.algorithm"]),
        # genomes
        ("wl.simulate(S, G)", ["a genome is expected; pass the genome first"]),
        ("wl.confirm(S, G)", ["a genome is expected; pass the genome first"]),
        ("wl.simulate(None, S)", ["a genome is expected", "got None"]),
        ("wl.simulate([G], S)", ["one genome is expected", "genomes[0]"]),
        ("wl.simulate(W, S)", ["this is a walk", "a genome is expected"]),
        ("wl.express(None)", ["a genome is expected", "got None"]),
        ("wl.express(S)", ["a genome is expected"]),
        ("wl.evaluate(G, S)", ["put it in a list"]),
        ("wl.evaluate(None, S)", ["several genomes are expected, as a list", "got None"]),
        ("wl.evaluate(3, S)", ["several genomes are expected, as a list", "got 3"]),
        ("wl.evaluate({'a': G}, S)", ["list(genomes.values())"]),
        ("wl.evaluate(run, S)", ["run.records.genome"]),
        ("wl.evaluate(T, S)", ["table.genome"]),
        ("wl.replay([0, 1])", ["got the number 0", "run.replay(0, 1)"]),
        ("wl.replay(None)", ["replay takes a genome", "got None"]),
        ("wl.replay(W)", ["replay takes a genome", "got Rollout"]),
        ("wl.replay(T)", ["table.genome[0]"]),
        ("wl.timelapse(T, at / 'x.mp4')", ["a time-lapse requires a run", "got a DataFrame"]),
        # numbers
        ("wl.Genome.random(S.robot, rng=1)", ["numpy random Generator; got 1", "np.random.default_rng(1)"]),
        ("wl.generate_robot_gene(S.robot, rng=None)", ["numpy random Generator; got None"]),
        ("wl.generate_robot_population(S.robot, '5', seed=1)", ["size is '5'", "a whole number, 1 or more"]),
        ("wl.generate_robot_population(S.robot, 5, seed=None)", ["seed is None", "a whole number, 0 or more"]),
        ("wl.select_from_population(None, 4, S.algorithm, generation=1)", ["fitness must be a row of numbers"]),
        ("wl.select_from_population([], 4, S.algorithm, generation=1)", ["fitness is empty"]),
        ("wl.select_from_population([1.0, 2.0], 2.5, S.algorithm, generation=1)", ["n_parents is 2.5"]),
        ("wl.crossover_population([G, G], ['a', 2], 3, S.robot, S.algorithm, generation=1)", ["row of numbers"]),
        ("wl.crossover_population([], [], 3, S.robot, S.algorithm, generation=1)", ["parents is empty"]),
        ("run.replay('0')", ["'0' is not the number of a generation", "run.replay(0, -1)"]),
        ("run.replay(0.5)", ["0.5 is not the number of a generation"]),
        ("run.confirm('3')", ["n_nudges is '3'", "a whole number, 1 or more"]),
        # tables
        ("wl.plots.fitness_curve(T.drop(columns='fitness'))", ["no column 'fitness'", "run.records"]),
        ("wl.plots.trait(T.drop(columns='verdict'), 'weight')", ["no column 'verdict'"]),
        ("wl.plots.verdicts(T.drop(columns=['verdict', 'generation']))", ["'generation' and no column 'verdict'"]),
        ("wl.plots.diversity(T.drop(columns='genome'))", ["no column 'genome'"]),
        ("wl.plots.genes(T.drop(columns='genome'))", ["no column 'genome'"]),
        ("wl.plots.family_tree(T.drop(columns='parents'))", ["no column 'parents'"]),
    ],
)
def test_a_wrong_argument_is_named_with_the_fix(call, words, known):
    with mpl.rc_context({"backend": "agg"}), pytest.raises((TypeError, ValueError)) as caught:
        eval(call, known)
    for word in words:
        assert word in str(caught.value)
    assert not re.search(r"has no attribute|not supported between|unexpected keyword", str(caught.value))


def test_a_folder_means_its_only_run_file_or_the_one_of_the_usual_name(known):
    folder = known["at"] / "two"
    shutil.copy(folder / "a.walk", folder / "run.walk")
    try:
        assert wl.load(folder).path == folder / "run.walk"
    finally:
        (folder / "run.walk").unlink()
    assert wl.load(str(known["at"])).path == known["at"] / "a.walk"
