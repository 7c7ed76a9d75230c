"""Live runs: evolved in a background thread, with the same table as a run in the foreground."""

import threading
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution import live as live_module
from walkerlab.evolution.live import LiveRun, State
from walkerlab.runfile.records import birth_rows
from walkerlab.view.report.code import as_python

SMALL = wl.Settings().with_(population_size=6, generations=4, duration=1)
PATIENCE = 60  # s


class Listener:
    """Records the states of a run, and waits for a condition."""

    def __init__(self):
        self.news = threading.Condition()
        self.states = []

    def record(self, live):
        with self.news:
            self.states.append(live.state)
            self.news.notify_all()

    def until(self, holds):
        with self.news:
            assert self.news.wait_for(holds, PATIENCE)


@pytest.fixture(autouse=True)
def in_temporary_folder(tmp_path, monkeypatch):
    """Work in a temporary folder, in which a run without a file may be saved."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def make_live():
    """Function that creates live runs with two workers; they are closed after the test."""
    with ThreadPoolExecutor(2) as pool:
        made = []

        def make(settings=SMALL, path=None):
            listener = Listener()
            listener.live = LiveRun(settings, path, pool, on_change=listener.record)
            made.append(listener.live)
            return listener.live, listener

        yield make
        for live in made:
            live.close()


@pytest.fixture(scope="module")
def expected():
    with ThreadPoolExecutor(2) as pool:
        return wl.evolve(SMALL, executor=pool, progress=False).records


def test_a_live_run_gives_the_table_of_a_foreground_run(make_live, expected, tmp_path):
    live, listener = make_live(path=tmp_path / "run.walk")
    assert live.state == State.paused
    live.resume()
    listener.until(lambda: live.is_over)
    assert live.state == State.finished
    pd.testing.assert_frame_equal(live.run.records, expected)
    pd.testing.assert_frame_equal(wl.load(tmp_path / "run.walk").records, expected)
    assert live.n_done == live.n_walks


def test_steps_and_pauses_do_not_change_the_table(make_live, expected):
    live, listener = make_live()
    for n in (1, 2):
        live.resume(1)
        listener.until(lambda: live.state == State.paused)
        assert live.n_generations == n
    live.resume()
    live.pause()
    assert live.state == State.paused
    live.resume()
    listener.until(lambda: live.is_over)
    pd.testing.assert_frame_equal(live.run.records, expected)


def test_pause_lets_current_walks_finish_and_begins_no_other(make_live, monkeypatch):
    monkeypatch.setattr(live_module, "n_workers", lambda _: 1)
    live, listener = make_live(SMALL.with_(population_size=200, n_elites=0))
    live.resume()
    listener.until(lambda: live.n_done > 0)
    live.pause()
    listener.until(lambda: not live._pausable._submitted)
    assert live._pausable._waiting
    assert live.n_generations == 0
    assert live.seconds_left > 0


def test_stop_keeps_the_generations_that_are_done(make_live, expected):
    live, listener = make_live()
    live.resume(2)
    listener.until(lambda: live.state == State.paused)
    live.stop()
    live.resume()
    assert live.state == State.stopped
    live._thread.join(PATIENCE)
    pd.testing.assert_frame_equal(live.run.records, expected[expected.generation < 2])


@pytest.mark.parametrize("press", [LiveRun.stop, LiveRun.resume])
def test_stop_and_resume_during_a_pause_take_effect(make_live, monkeypatch, press):
    live, _ = make_live()
    pause = live._pausable.pause
    begun = threading.Event()
    pressed = threading.Event()
    monkeypatch.setattr(live._pausable, "pause", lambda: (begun.set(), pressed.wait(0.2), pause()))
    live.resume(1)
    assert begun.wait(PATIENCE)
    press(live)
    pressed.set()
    live._thread.join(PATIENCE)
    assert not live._thread.is_alive()


def test_stop_during_a_pause_ends_the_thread(make_live):
    live, listener = make_live()
    live.resume(1)
    listener.until(lambda: live.state == State.paused)
    live.stop()
    live._thread.join(PATIENCE)
    assert not live._thread.is_alive()


def test_stop_during_a_generation_ends_the_thread_at_once(make_live):
    live, listener = make_live(SMALL.with_(population_size=1000))
    live.resume()
    listener.until(lambda: live.n_done > 0)
    live.stop()
    live._thread.join(1)
    assert not live._thread.is_alive()
    assert live.run.records.empty


def test_a_fitness_that_raises_fails_the_run_and_keeps_earlier_generations(make_live):
    def fails_in_second_generation(rollout):
        if any(one.n_generations == 1 for one in lives):
            raise ArithmeticError("not today")
        return rollout.distance

    lives = []
    live, listener = make_live(SMALL.with_(fitness=fails_in_second_generation))
    lives.append(live)
    live.resume()
    listener.until(lambda: live.is_over)
    assert live.state == State.failed
    assert isinstance(live.error, wl.OperatorError)
    assert isinstance(live.error.__cause__, ArithmeticError)
    assert live.n_generations == 1


def test_the_remaining_time_ignores_the_time_before_the_first_results(make_live):
    live, _ = make_live()
    for seconds in (100.0, 110.0):
        live._seconds = seconds
        live._count_walks(1)
    assert live.seconds_left == pytest.approx(10.0 * (live.n_walks - 2))


def test_closing_the_last_run_shuts_the_default_executor_down(monkeypatch):
    workers = ThreadPoolExecutor(2)
    lives = []
    monkeypatch.setattr(live_module, "default_executor", lambda: workers)
    monkeypatch.setattr(live_module, "_live_runs", weakref.WeakSet())
    for _ in range(2):
        listener = Listener()
        lives.append(LiveRun(SMALL, on_change=listener.record))
        lives[-1].resume(1)
        listener.until(lambda: lives[-1].state == State.paused)
    lives[0].close()
    assert workers.submit(int).result() == 0
    lives[1].close()
    with pytest.raises(RuntimeError, match="after shutdown"):
        workers.submit(int)


def test_invalid_arguments_raise_before_the_run_begins(tmp_path):
    with pytest.raises(wl.OperatorError):
        LiveRun(SMALL.with_(mutation=lambda genomes, genes, *, rng: genomes[:1]))
    (tmp_path / "run.walk").touch()
    with pytest.raises(wl.RunFileError):
        LiveRun(SMALL, tmp_path / "run.walk")


class TestInsertedGenome:
    """A genome that a user inserts into the next generation."""

    GENE = str(wl.generate_robot_gene(SMALL.robot, rng=np.random.default_rng(5)))

    def evolve(self, pool):
        evolution = wl.Evolution(SMALL, executor=pool)
        for generation in evolution:
            if generation.number == 1:
                evolution.insert(self.GENE)
        return evolution.run

    def test_it_replaces_the_last_child_and_nothing_else_changes(self, expected):
        with ThreadPoolExecutor(2) as pool:
            run = self.evolve(pool)
        third = run.records[run.records.generation == 2]
        inserted = third.iloc[-1]
        assert (inserted.genome, inserted.operators, inserted.parents, inserted.born) == (self.GENE, "by hand", "", 2)
        before = expected[expected.generation == 2]
        pd.testing.assert_frame_equal(third.iloc[:-1], before.iloc[:-1])
        pd.testing.assert_frame_equal(run.records[run.records.generation < 2], expected[expected.generation < 2])

    def test_the_code_of_the_report_reproduces_the_run(self):
        with ThreadPoolExecutor(2) as pool:
            run = self.evolve(pool)
        code = as_python(run.settings, run.records)
        place = {}
        exec(code, place)
        pd.testing.assert_frame_equal(place["run"].records, run.records)

    def test_it_requires_a_place_and_an_earlier_generation(self):
        evolution = wl.Evolution(SMALL)
        with pytest.raises(ValueError, match="first generation, which is random"):
            evolution.insert(self.GENE)
        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool)
            next(iter(evolution))
            with pytest.raises(wl.GenomeError):
                evolution.insert("wl1")
            for _ in range(4):
                evolution.insert(self.GENE)
            with pytest.raises(ValueError, match="4 places for children"):
                evolution.insert(self.GENE)

    def test_it_is_in_the_next_generation_to_be_bred_and_rejected_without_one(self):
        accepted, rejected = {}, {}

        def insert_once():
            moment = evolution.n_generations
            if moment and not {moment} & (accepted.keys() | rejected.keys()):
                try:
                    accepted[moment] = evolution.insert(self.GENE)
                except ValueError as error:
                    rejected[moment] = str(error)

        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool, on_walks=lambda _: insert_once())
            records = [generation.records for generation in evolution][-1]
        with pytest.raises(ValueError, match="generation 3 is the last"):
            evolution.insert(self.GENE)
        assert accepted == {1: 2, 2: 3}
        assert "generation 3 is the last" in rejected[3]
        assert (records[records.operators == "by hand"].born == 3).sum() == 1

    def test_after_an_interruption_it_is_in_the_generation_that_is_bred_again(self):
        interruptions = []

        def walked(_):
            if evolution.n_generations == 1 and not interruptions:
                interruptions.append(evolution.insert(self.GENE))  # while the other inserted genomes walk
                raise KeyboardInterrupt

        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool, on_walks=walked)
            next(iter(evolution))
            accepted = [evolution.insert(self.GENE) for _ in range(4)]
            with pytest.raises(KeyboardInterrupt):
                next(iter(evolution))
            assert evolution.n_generations == 1
            records = [generation.records for generation in evolution]
        assert accepted == 4 * [1]
        by_hand = [int(((table.operators == "by hand") & (table.born == table.generation)).sum()) for table in records]
        assert by_hand[:2] == [4, 1]

    def test_inserted_between_two_generations_it_is_in_the_second(self):
        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool)
            accepted = [evolution.insert(self.GENE) for generation in evolution if generation.number < 3]
        born = birth_rows(evolution.run.records)
        assert accepted == born[born.operators == "by hand"].born.tolist() == [1, 2, 3]

    def test_its_genes_are_clipped_to_the_limits(self):
        tight = SMALL.with_(legs=(2, 2), generations=2)
        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(tight, executor=pool)
            for generation in evolution:
                if generation.number == 0:
                    evolution.insert(self.GENE)
        inserted = evolution.run.records.iloc[-1]
        assert inserted.operators == "by hand"
        assert inserted.genome == str(wl.Genome.parse(self.GENE).within(tight.robot)) != self.GENE
        assert inserted.n_legs == 2

    def test_a_run_that_is_over_rejects_it(self, make_live):
        live, listener = make_live()
        live.resume(1)
        listener.until(lambda: live.state == State.paused)
        live.stop()
        with pytest.raises(ValueError, match="over"):
            live.insert(self.GENE)
