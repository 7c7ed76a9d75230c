"""A run on a thread of its own brings forth the very table of one that was waited for."""

import threading
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.evolution import live as live_module
from walkerlab.evolution.live import LiveRun, State
from walkerlab.runfile.records import births
from walkerlab.view.report.code import as_python

SMALL = wl.Settings().with_(population_size=6, generations=4, duration=1)
PATIENCE = 60  # s


class Listener:
    """Hears the news of a run, and waits for what it wants to hear."""

    def __init__(self):
        self.news, self.states = threading.Condition(), []

    def hear(self, live):
        with self.news:
            self.states.append(live.state)
            self.news.notify_all()

    def until(self, holds):
        with self.news:
            assert self.news.wait_for(holds, PATIENCE)


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Be where a run that has no file may be kept."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def alive():
    """Makes live runs on two threads, and ends them."""
    with ThreadPoolExecutor(2) as pool:
        made = []

        def make(settings=SMALL, path=None):
            listener = Listener()
            listener.live = LiveRun(settings, path, pool, on_news=listener.hear)
            made.append(listener.live)
            return listener.live, listener

        yield make
        for live in made:
            live.close()


@pytest.fixture(scope="module")
def waited_for():
    with ThreadPoolExecutor(2) as pool:
        return wl.evolve(SMALL, executor=pool, progress=False).records


def test_it_brings_forth_the_table_of_a_run_that_was_waited_for(alive, waited_for, tmp_path):
    live, listener = alive(path=tmp_path / "run.walk")
    assert live.state == State.paused
    live.go_on()
    listener.until(lambda: live.is_over)
    assert live.state == State.finished
    pd.testing.assert_frame_equal(live.run.records, waited_for)
    pd.testing.assert_frame_equal(wl.load(tmp_path / "run.walk").records, waited_for)
    assert live.n_done == live.n_walks


def test_stepped_and_paused_it_is_the_same(alive, waited_for):
    live, listener = alive()
    for n in (1, 2):
        live.go_on(1)
        listener.until(lambda: live.state == State.paused)
        assert live.n_generations == n
    live.go_on()
    live.pause()
    assert live.state == State.paused
    live.go_on()
    listener.until(lambda: live.is_over)
    pd.testing.assert_frame_equal(live.run.records, waited_for)


def test_paused_in_the_middle_of_a_generation_those_that_walk_finish_and_no_other_begins(alive, monkeypatch):
    monkeypatch.setattr(live_module, "n_workers", lambda _: 1)
    live, listener = alive(SMALL.with_(population_size=200, n_elites=0))
    live.go_on()
    listener.until(lambda: live.n_done > 0)
    live.pause()
    listener.until(lambda: not live._gate._submitted)
    assert live._gate._waiting
    assert live.n_generations == 0
    assert live.seconds_left > 0


def test_stopped_it_keeps_the_generations_that_are_done(alive, waited_for):
    live, listener = alive()
    live.go_on(2)
    listener.until(lambda: live.state == State.paused)
    live.stop()
    live.go_on()
    assert live.state == State.stopped
    live._thread.join(PATIENCE)
    pd.testing.assert_frame_equal(live.run.records, waited_for[waited_for.generation < 2])


@pytest.mark.parametrize("press", [LiveRun.stop, LiveRun.go_on])
def test_a_button_pressed_while_it_comes_to_rest_is_heard(alive, monkeypatch, press):
    live, _ = alive()
    pause, begun, pressed = live._gate.pause, threading.Event(), threading.Event()
    monkeypatch.setattr(live._gate, "pause", lambda: (begun.set(), pressed.wait(0.2), pause()))
    live.go_on(1)
    assert begun.wait(PATIENCE)
    press(live)
    pressed.set()
    live._thread.join(PATIENCE)
    assert not live._thread.is_alive()


def test_stopped_at_rest_its_thread_ends(alive):
    live, listener = alive()
    live.go_on(1)
    listener.until(lambda: live.state == State.paused)
    live.stop()
    live._thread.join(PATIENCE)
    assert not live._thread.is_alive()


def test_stopped_in_the_middle_of_a_generation_it_lets_go_at_once(alive):
    live, listener = alive(SMALL.with_(population_size=1000))
    live.go_on()
    listener.until(lambda: live.n_done > 0)
    live.stop()
    live._thread.join(1)
    assert not live._thread.is_alive()
    assert live.run.records.empty


def test_a_fitness_that_fails_fails_the_run_and_keeps_the_rest(alive):
    def moody(rollout):
        if any(one.n_generations == 1 for one in lives):
            raise ArithmeticError("not today")
        return rollout.distance

    lives = []
    live, listener = alive(SMALL.with_(fitness=moody))
    lives.append(live)
    live.go_on()
    listener.until(lambda: live.is_over)
    assert live.state == State.failed
    assert isinstance(live.error, wl.OperatorError)
    assert isinstance(live.error.__cause__, ArithmeticError)
    assert live.n_generations == 1


def test_the_time_left_does_not_count_what_was_before_the_first_walks(alive):
    live, _ = alive()
    for seconds in (100.0, 110.0):
        live._seconds = seconds
        live._walked(1)
    assert live.seconds_left == pytest.approx(10.0 * (live.n_walks - 2))


def test_the_workers_go_home_with_the_last_run(monkeypatch):
    workers, lives = ThreadPoolExecutor(2), []
    monkeypatch.setattr(live_module, "default_executor", lambda: workers)
    monkeypatch.setattr(live_module, "_RUNS", weakref.WeakSet())
    for _ in range(2):
        listener = Listener()
        lives.append(LiveRun(SMALL, on_news=listener.hear))
        lives[-1].go_on(1)
        listener.until(lambda: lives[-1].state == State.paused)
    lives[0].close()
    assert workers.submit(int).result() == 0
    lives[1].close()
    with pytest.raises(RuntimeError, match="after shutdown"):
        workers.submit(int)


def test_what_cannot_run_is_refused_before_it_begins(tmp_path):
    with pytest.raises(wl.OperatorError):
        LiveRun(SMALL.with_(mutation=lambda genomes, genes, *, rng: genomes[:1]))
    (tmp_path / "run.walk").touch()
    with pytest.raises(wl.RunFileError):
        LiveRun(SMALL, tmp_path / "run.walk")


class TestByHand:
    """A gene that somebody puts into the next generation."""

    GENE = str(wl.generate_robot_gene(SMALL.robot, rng=np.random.default_rng(5)))

    def evolve(self, pool):
        evolution = wl.Evolution(SMALL, executor=pool)
        for generation in evolution:
            if generation.number == 1:
                evolution.insert(self.GENE)
        return evolution.run

    def test_it_takes_the_place_of_the_last_child_and_nothing_else_changes(self, waited_for):
        with ThreadPoolExecutor(2) as pool:
            run = self.evolve(pool)
        third = run.records[run.records.generation == 2]
        guest = third.iloc[-1]
        assert (guest.genome, guest.operators, guest.parents, guest.born) == (self.GENE, "by hand", "", 2)
        before = waited_for[waited_for.generation == 2]
        pd.testing.assert_frame_equal(third.iloc[:-1], before.iloc[:-1])
        pd.testing.assert_frame_equal(run.records[run.records.generation < 2], waited_for[waited_for.generation < 2])

    def test_the_code_of_the_run_does_it_again(self):
        with ThreadPoolExecutor(2) as pool:
            run = self.evolve(pool)
        code, place = as_python(run.settings, run.records), {}
        exec(code, place)
        pd.testing.assert_frame_equal(place["run"].records, run.records)

    def test_there_must_be_room_and_a_generation_before(self):
        evolution = wl.Evolution(SMALL)
        with pytest.raises(ValueError, match="first generation is random"):
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

    def test_it_is_in_the_next_generation_that_is_bred_and_refused_where_there_is_none(self):
        told, refused = {}, {}

        def put_in():
            moment = evolution.n_generations
            if moment and not {moment} & (told.keys() | refused.keys()):
                try:
                    told[moment] = evolution.insert(self.GENE)
                except ValueError as error:
                    refused[moment] = str(error)

        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool, on_walks=lambda _: put_in())
            records = [generation.records for generation in evolution][-1]
        with pytest.raises(ValueError, match="generation 3 is the last"):
            evolution.insert(self.GENE)
        assert told == {1: 2, 2: 3}
        assert "generation 3 is the last" in refused[3]
        assert (records[records.operators == "by hand"].born == 3).sum() == 1

    def test_it_waits_when_its_generation_is_interrupted(self):
        interruptions = []

        def walked(_):
            if evolution.n_generations == 1 and not interruptions:
                interruptions.append(evolution.insert(self.GENE))  # while its elder walks already
                raise KeyboardInterrupt

        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool, on_walks=walked)
            next(iter(evolution))
            told = [evolution.insert(self.GENE) for _ in range(4)]
            with pytest.raises(KeyboardInterrupt):
                next(iter(evolution))
            assert evolution.n_generations == 1
            records = [generation.records for generation in evolution]
        assert told == 4 * [1]
        by_hand = [int(((table.operators == "by hand") & (table.born == table.generation)).sum()) for table in records]
        assert by_hand[:2] == [4, 1]

    def test_between_two_generations_it_is_in_the_second(self):
        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(SMALL, executor=pool)
            told = [evolution.insert(self.GENE) for generation in evolution if generation.number < 3]
        born = births(evolution.run.records)
        assert told == born[born.operators == "by hand"].born.tolist() == [1, 2, 3]

    def test_beyond_the_limits_it_is_brought_within_them(self):
        tight = SMALL.with_(legs=(2, 2), generations=2)
        with ThreadPoolExecutor(2) as pool:
            evolution = wl.Evolution(tight, executor=pool)
            for generation in evolution:
                if generation.number == 0:
                    evolution.insert(self.GENE)
        guest = evolution.run.records.iloc[-1]
        assert guest.operators == "by hand"
        assert guest.genome == str(wl.Genome.parse(self.GENE).within(tight.robot)) != self.GENE
        assert guest.n_legs == 2

    def test_of_a_run_that_is_over_it_is_refused(self, alive):
        live, listener = alive()
        live.go_on(1)
        listener.until(lambda: live.state == State.paused)
        live.stop()
        with pytest.raises(ValueError, match="over"):
            live.insert(self.GENE)
