"""Evolutions: repeatable with any executor, and never lost by an interruption."""

import itertools
import signal
import sqlite3
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution.lost_pressure import explain_lost_pressure
from walkerlab.ga import crossover, mutation, selection
from walkerlab.runfile import provenance, store
from walkerlab.settings.choices import Crossover, Fitness, Mutation, Selection
from walkerlab.text.numbers import format_significant

SETTINGS = wl.Settings().with_(duration=1.0, population_size=6, generations=3, n_elites=1, seed=5)
same = partial(pd.testing.assert_frame_equal, check_exact=True)


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(2) as pool:
        yield pool


@pytest.fixture(scope="module")
def run(threads):
    return wl.evolve(SETTINGS, executor=threads, progress=False)


def evolve(threads, **changes):
    return wl.evolve(SETTINGS.with_(**changes), executor=threads, progress=False)


class TestTable:
    def test_the_table_has_a_row_for_each_individual_and_generation(self, run):
        assert run.records.groupby("generation").size().tolist() == [6, 6, 6]
        assert not run.records.duplicated(["generation", "individual"]).any()

    def test_elites_are_unchanged_in_the_next_generation(self, run):
        for number in (1, 2):
            before = run.records[run.records.generation == number - 1]
            now = run.records[run.records.generation == number]
            best = before.loc[before.fitness.idxmax()]
            elite = now[now.born < number]
            assert elite.individual.tolist() == [best.individual]
            assert elite.fitness.tolist() == [best.fitness]
        assert run.records.groupby("generation").fitness.max().is_monotonic_increasing

    def test_the_champion_is_the_fittest_individual(self, run):
        champion = run.champion
        assert champion.fitness == run.records.fitness.max()
        assert wl.simulate(champion.genome, SETTINGS).verdict == champion.verdict == "ok"

    def test_parents_are_older_and_a_lineage_ends_in_generation_0(self, run):
        line = run.lineage(run.champion.individual)
        assert line.individual.iloc[0] == run.champion.individual
        assert line.born.min() == 0
        born = line.set_index("individual").born
        for row in line.itertuples():
            assert all(born[int(parent)] < row.born for parent in row.parents.split())
            assert bool(row.parents) == (row.operators != "random")

    def test_repr_summarises_the_run_in_a_line(self, run):
        assert repr(run).startswith("Run(3 generations of 6 robots; champion: robot ")
        assert f"distance {format_significant(run.champion.fitness)} m)" in repr(run)

    def test_the_table_has_its_units_in_attrs(self, run):
        assert run.records.attrs["units"]["velocity"] == "m/s"
        assert run.records.attrs["units"]["fitness"] == "m"


class TestRepeatable:
    def test_the_executor_and_the_number_of_workers_do_not_change_the_table(self, run):
        with ThreadPoolExecutor(4) as four, ThreadPoolExecutor(1) as one:
            same(evolve(four).records, run.records)
            same(evolve(one).records, run.records)
        same(wl.evolve(SETTINGS, progress=False).records, run.records)

    def test_iterating_over_an_evolution_gives_the_same_table(self, run, threads):
        evolution = wl.Evolution(SETTINGS, executor=threads)
        tables = [generation.records for generation in evolution]
        same(pd.concat(tables, ignore_index=True), run.records)
        same(evolution.run.records, run.records)

    def test_changing_only_the_mutation_leaves_selection_unchanged(self, run, threads):
        other = evolve(threads, mutation="macro")

        def parents(of):
            return of.records[of.records.born == 1].drop_duplicates("individual").parents.tolist()

        assert parents(other) == parents(run)
        assert other.records.genome.tolist() != run.records.genome.tolist()

    def test_a_fitness_outlier_warns_once_in_a_run(self, threads):
        def punishes(rollout):
            return -1e6 if rollout.distance < 0 else rollout.distance

        with pytest.warns(UserWarning, match=r'-1\.00e\+06.*selection="rank"') as caught:
            evolve(threads, fitness=punishes, selection="gradient", population_size=12, generations=2)
        assert len(caught) == 1

    def test_a_fitness_that_rejects_every_robot_warns(self, threads):
        with pytest.warns(UserWarning, match="returned None for every robot.*ends with a return statement") as caught:
            run = evolve(threads, fitness=lambda rollout: None, population_size=4, generations=2)
        assert len(caught) == 1
        assert run.n_generations == 2

    @pytest.mark.parametrize("structure", ["flat", "stairs"])
    def test_ordinary_generations_do_not_warn(self, structure, threads):
        settings = SETTINGS.with_(structure=structure)
        populations = [wl.generate_robot_population(settings.robot, 12, seed=seed) for seed in range(5)]
        walked = wl.evaluate(np.concatenate(populations), settings, threads)
        for fitness in np.array([one.fitness for one in walked]).reshape(5, 12):
            assert not explain_lost_pressure(fitness, settings.algorithm)

    def test_another_seed_gives_another_table(self, run, threads):
        assert evolve(threads, seed=6).records.genome.iloc[0] != run.records.genome.iloc[0]


class TestNeverLost:
    def test_a_run_file_holds_the_complete_run(self, run, threads, tmp_path):
        path = tmp_path / "deep" / "run.walk"
        kept = wl.evolve(SETTINGS, path, executor=threads, progress=False)
        same(wl.load(path).records, run.records)
        same(kept.records, run.records)
        assert wl.load(path).settings == SETTINGS
        assert wl.load(path).records.attrs == run.records.attrs
        assert [p.name for p in path.parent.iterdir()] == ["run.walk"]

    def test_a_resumed_run_equals_an_uninterrupted_run(self, run, threads, tmp_path):
        path = tmp_path / "run.walk"
        wl.evolve(SETTINGS.with_(generations=1), path, executor=threads, progress=False)
        resumed = wl.resume(path, generations=3, executor=threads, progress=False)
        same(resumed.records, run.records)
        same(wl.load(path).records, run.records)
        assert wl.load(path).settings == SETTINGS

    def test_a_file_is_never_overwritten(self, threads, tmp_path):
        path = tmp_path / "run.walk"
        path.write_text("my homework")
        with pytest.raises(wl.RunFileError, match="exists already"):
            wl.Evolution(SETTINGS, path, threads)
        assert path.read_text() == "my homework"

    @pytest.mark.parametrize("moment", ["before", "after"])
    def test_after_ctrl_c_while_storing_run_and_file_agree(self, moment, threads, tmp_path, monkeypatch):
        def interrupted(*stored, append=store.append):
            _, generation, *_ = stored
            if moment == "after":
                append(*stored)
            if generation.generation.iloc[0] == 1:
                signal.raise_signal(signal.SIGINT)
            if moment == "before":
                append(*stored)

        path = tmp_path / "run.walk"
        monkeypatch.setattr(store, "append", interrupted)
        kept = wl.evolve(SETTINGS, path, executor=threads, progress=False)
        assert kept.n_generations == 2
        same(wl.load(path).records, kept.records)

    def test_a_run_that_fails_before_its_first_generation_is_resumed_from_its_settings(self, threads, tmp_path):
        def fails_after_four_walks(rollout, calls=itertools.count()):  # noqa: B008
            return float(rollout.com[-1, 0]) if next(calls) < 4 else 1 / 0

        path = tmp_path / "run.walk"
        with pytest.raises(wl.OperatorError, match="'fails_after_four_walks' raised ZeroDivisionError"):
            wl.evolve(
                SETTINGS.with_(fitness=fails_after_four_walks, n_elites=0), path, executor=threads, progress=False
            )
        assert wl.load(path).n_generations == 0

        def fixed(rollout):
            return float(rollout.com[-1, 0])

        fixed.__name__ = "fails_after_four_walks"
        settings = SETTINGS.with_(fitness=fixed, n_elites=0)
        whole = wl.evolve(settings, executor=threads, progress=False)
        same(wl.resume(path, executor=threads, progress=False, fitness=fixed).records, whole.records)

    def test_fewer_generations_than_are_done_raise(self, run, threads, tmp_path):
        path = tmp_path / "run.walk"
        wl.evolve(SETTINGS, path, executor=threads, progress=False)
        with pytest.raises(wl.SettingsError, match="3 generations already"):
            wl.resume(path, 2, executor=threads, progress=False)
        assert wl.load(path).settings == SETTINGS
        same(wl.resume(tmp_path, executor=threads, progress=False).records, run.records)

    @pytest.mark.parametrize("damage", [
        "DELETE FROM records WHERE generation = 1", "DELETE FROM records WHERE individual = 14",
        "UPDATE run SET value = '{}' WHERE fact = 'settings'", "UPDATE run SET value = '[]' WHERE fact = 'settings'",
        "UPDATE records SET genome = 'wl1' WHERE individual = 14",
    ])  # fmt: skip
    def test_a_damaged_file_is_not_resumed(self, damage, threads, tmp_path):
        path = tmp_path / "run.walk"
        wl.evolve(SETTINGS, path, executor=threads, progress=False)
        with sqlite3.connect(path) as db:
            db.execute(damage)
        db.close()
        with pytest.raises(wl.RunFileError, match="damaged"):
            wl.resume(path, 4, executor=threads, progress=False)

    def test_changing_a_returned_table_does_not_change_the_run(self, run, threads):
        evolution = wl.Evolution(SETTINGS, executor=threads)
        for generation in evolution:
            table = generation.records
            table["fitness"] = 99.0
        same(evolution.run.records, run.records)

    def test_ctrl_c_returns_the_generations_that_are_done(self, run, threads):
        done = []

        def interrupted(rollout):
            if done:
                signal.raise_signal(signal.SIGINT)
            return float(rollout.com[-1, 0] - rollout.com[0, 0])

        settings = SETTINGS.with_(fitness=interrupted)
        kept = wl.evolve(settings, executor=threads, progress=False, on_generation=done.append)
        assert kept.n_generations == 1
        same(kept.records.drop(columns="operators"), run.records.head(6).drop(columns="operators"))

    def test_resume_after_kill_equals_an_uninterrupted_run(self, run, threads, tmp_path):
        path = tmp_path / "run.walk"
        script = (
            "import os, signal, walkerlab as wl\n"
            "from concurrent.futures import ThreadPoolExecutor\n"
            f"s = wl.Settings(**{SETTINGS.model_dump()!r})\n"
            f"for g in wl.Evolution(s, {str(path)!r}, ThreadPoolExecutor(1), \n"
            "        on_walks=lambda n, d=[]: (d.append(n), sum(d) > 8 and os.kill(os.getpid(), signal.SIGKILL))):\n"
            "    pass\n"
        )
        killed = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False)
        assert killed.returncode == -signal.SIGKILL, killed.stderr.decode()
        assert wl.load(path).n_generations == 1
        same(wl.resume(path, executor=threads, progress=False).records, run.records)

    @pytest.mark.parametrize("name", ["run.walk", None])
    def test_the_note_of_an_error_names_the_saved_run_and_code_that_resumes_it(
        self, name, threads, tmp_path, monkeypatch
    ):
        monkeypatch.chdir(tmp_path)
        calls = itertools.count()
        path = tmp_path / name if name else None

        def shake(genomes, genes, *, rng):
            """Fail in generation 2, after two trials and generation 1."""
            if next(calls) == 3:
                raise LookupError("error of a user function")
            return genomes

        settings = SETTINGS.with_(mutation=shake)
        with pytest.raises(wl.OperatorError) as caught:
            wl.evolve(settings, path, threads, progress=False)
        note = caught.value.__notes__[-1]
        kept = path or tmp_path / "kept.walk"
        assert note.startswith(f"The run is saved in {kept.name}, with 2 generations.")
        assert caught.value.saved_path == kept
        before = wl.load(kept)
        code = note.splitlines()[-1].replace(")", ", executor=threads, progress=False)").strip()
        names = {"wl": wl, "shake": shake, "threads": threads}
        exec(code, names)
        whole = wl.evolve(settings, executor=threads, progress=False)
        same(names["run"].records, whole.records)
        same(before.records, whole.records.head(12))
        assert names["run"].path == kept

    def test_a_run_without_a_file_is_saved_under_an_unused_name_or_in_the_temporary_folder(
        self, threads, tmp_path, monkeypatch
    ):
        evolution = wl.Evolution(SETTINGS, executor=threads)
        next(iter(evolution))
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(store, "gettempdir", lambda: str(tmp_path / "elsewhere"))
        (tmp_path / "kept.walk").write_text("other contents")
        archive = evolution._archive
        assert archive.save() == archive.save() == tmp_path / "kept-2.walk", "the second call does nothing"
        assert (tmp_path / "kept.walk").read_text() == "other contents"
        again = wl.Evolution(SETTINGS, executor=threads)
        next(iter(again))
        (tmp_path / "gone").mkdir()
        monkeypatch.chdir(tmp_path / "gone")
        (tmp_path / "gone").rmdir()
        assert again._archive.save() == tmp_path / "elsewhere" / "kept.walk"

    def test_resuming_with_other_versions_warns(self, run, threads, tmp_path, monkeypatch):
        path = tmp_path / "run.walk"
        wl.evolve(SETTINGS.with_(generations=2), path, threads, progress=False)
        here = provenance.current_facts()
        monkeypatch.setattr(provenance, "current_facts", lambda: {**here, "mujoco": "9.9", "processor": "abacus"})
        with pytest.warns(UserWarning, match="was made with") as said:
            same(wl.resume(path, 3, threads, progress=False).records, run.records)
        [words] = [str(one.message) for one in said]
        assert f"mujoco {here['mujoco']} (here 9.9), processor {here['processor']} (here abacus)" in words
        assert store.read_facts(path)[1]["mujoco"] == "9.9"


class TestOperatorSlots:
    # Every crossover with every mutation, and the other two slots in turn: slots are resolved independently.
    DESIGN = tuple(
        (tuple(Fitness)[i % 2], tuple(Selection)[i // 2 % 2], *pair)
        for i, pair in enumerate(itertools.product(tuple(Crossover)[:3], tuple(Mutation)[:4]))
    )
    TINY = SETTINGS.with_(population_size=4, generations=2)

    @pytest.mark.parametrize("combination", DESIGN, ids=lambda c: "-".join(x.name for x in c))
    def test_names_codes_and_functions_give_the_same_table_for_every_combination(self, combination, threads):
        fitness, select, cross, mutate = combination
        tables = [
            wl.evolve(
                self.TINY.with_(fitness=f, selection=s, crossover=c, mutation=m), executor=threads, progress=False
            ).records.drop(columns=["operators", "reason"])  # the unit of a function is unknown
            for f, s, c, m in (
                (fitness.name, select.name, cross.name, mutate.name),
                (int(fitness), int(select), int(cross), int(mutate)),
                (
                    getattr(wl.fitness, fitness.name),
                    getattr(selection, select.name),
                    getattr(crossover, cross.name),
                    getattr(mutation, mutate.name),
                ),
            )
        ]
        same(tables[0], tables[1])
        same(tables[0], tables[2])
        assert len(tables[0]) == 8

    def test_two_operators_in_one_slot_are_applied_in_turn(self, threads):
        slots = {"selection": ["top_half", 0], "crossover": ["paired", "weighted"], "mutation": ["micro", "macro"]}
        run = evolve(threads, population_size=12, generations=2, **slots)
        assert run.records.operators.iloc[-1] == "top_half+gradient > paired+weighted > micro+macro"
        assert len(run.records) == 24
        assert max(len(parents.split()) for parents in run.records.parents) > 2, "a double crossing has grandparents"

    def test_user_functions_work_in_every_slot_with_worker_processes(self):
        def best_two(fitness, n_parents, *, rng):
            return rng.permutation(np.resize(np.argsort(-fitness)[:2], n_parents))

        def mean(parents, fitness, n_children, *, rng):
            mothers, fathers = rng.integers(len(parents), size=(2, n_children))
            return (parents[mothers] + parents[fathers]) / 2, np.stack([mothers, fathers], axis=1)

        def nudge(genomes, genes, *, rng, rate):
            assert rate == 0.5, "the slider reaches a mutation that asks for it"
            return genomes + 0.01 * rng.normal(size=genomes.shape)

        def height(rollout):
            return rollout.com[:, 2].mean()

        own = {"selection": best_two, "crossover": mean, "mutation": nudge, "fitness": height}
        run = wl.evolve(SETTINGS.with_(mutation_rate=0.5, **own), progress=False)
        assert run.records.operators.iloc[-1] == "best_two > mean > nudge"
        assert ((run.records.fitness > 0) == (run.records.verdict == "ok")).all()

    def test_user_functions_are_required_to_resume_but_not_to_view_a_run(self, threads, tmp_path):
        def nudge(genomes, genes, *, rng):
            return genomes + 0.01 * rng.normal(size=genomes.shape)

        path = tmp_path / "run.walk"
        ours = {"mutation": nudge, "selection": partial(selection.tournament, size=2)}
        whole = evolve(threads, **ours)
        wl.evolve(SETTINGS.with_(generations=1, **ours), path, executor=threads, progress=False)
        assert wl.load(path).n_generations == 1
        assert wl.load(path).settings.algorithm.selection.keywords == {"size": 2}
        with pytest.raises(wl.RunFileError, match=r"wl\.resume\(.*, mutation=nudge\)"):
            wl.resume(path, generations=3, executor=threads, progress=False)
        same(wl.resume(path, 3, executor=threads, progress=False, mutation=nudge).records, whole.records)

    def test_a_resumed_run_takes_only_the_functions_it_was_made_with(self, threads, tmp_path):
        """A user function in the slot of a user function must be the one that the run was made with."""

        def nudge(genomes, genes, *, rng, step=0.01):
            return genomes + step * rng.normal(size=genomes.shape)

        path = tmp_path / "run.walk"
        slot = [partial(nudge, step=0.02), "macro"]
        evolve_to = partial(wl.evolve, executor=threads, progress=False)
        evolve_to(SETTINGS.with_(generations=1, mutation=slot), path)
        resume = partial(wl.resume, path, 3, threads, progress=False)
        for given, error, message in (
            ({}, wl.RunFileError, r"mutation=\[partial\(nudge, step=0.02\), 'macro'\]"),
            ({"mutation": nudge}, wl.RunFileError, r"mutation=\[partial\(nudge, step=0.02\), 'macro'\]"),
            ({"mutation": slot, "mutatoin": slot}, wl.SettingsError, "no setting 'mutatoin'.* Did you mean 'mutation'"),
        ):
            with pytest.raises(error, match=message):
                resume(**given)
            assert wl.load(path).n_generations == 1
        same(resume(mutation=slot).records, evolve_to(SETTINGS.with_(mutation=slot)).records)

    def test_an_invalid_operator_raises_before_any_simulation(self):
        def shrinks(fitness, n_parents, *, rng):
            return np.argsort(-fitness)[: n_parents // 2]

        class NoPhysics(ThreadPoolExecutor):
            def submit(self, *args, **kwargs):
                raise AssertionError("physics ran")

        with pytest.raises(wl.OperatorError, match="shrinks"):
            evolve(NoPhysics(), selection=shrinks)


def test_a_run_file_contains_what_its_walks_record(tmp_path):
    def pitch(rollout):
        return float(rollout.orientation[:, 2, 0].std()) + rollout.distance

    settings = SETTINGS.with_(fitness=pitch, record="orientation", duration=1, population_size=4, generations=2)
    with ThreadPoolExecutor(1) as pool:
        whole = wl.evolve(settings, executor=pool, progress=False)
        wl.evolve(settings.with_(generations=1), tmp_path / "run.walk", executor=pool, progress=False)
        resumed = wl.resume(tmp_path / "run.walk", 2, fitness=pitch, executor=pool, progress=False)
        assert wl.load(tmp_path / "run.walk").settings.simulation.record == wl.Recording.orientation
        pd.testing.assert_frame_equal(resumed.records, whole.records, check_exact=True)
        with pytest.raises(wl.OperatorError, match=r"no orientation.*record=\['orientation'\]"):
            wl.evolve(settings.with_(record="joint_angles"), executor=pool, progress=False)
