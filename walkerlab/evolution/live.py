"""An evolution on a thread of its own: it can be paused, stepped and stopped, and the notebook goes on meanwhile."""

import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor
from enum import StrEnum
from pathlib import Path
from weakref import WeakSet

from walkerlab.evolution.evolution import Evolution, n_walks
from walkerlab.evolution.run import Run
from walkerlab.genome.genome import Genome
from walkerlab.readonly import ReadOnlyProperties
from walkerlab.settings.settings import Settings
from walkerlab.simulation.pausable import PausableExecutor, Stopped
from walkerlab.simulation.workers import WorkerLostWarning, check_executor, default_executor, n_workers


class State(StrEnum):
    """What a run is doing."""

    running = "running"
    paused = "paused"
    stopped = "stopped"
    finished = "finished"
    failed = "failed"


OVER = {State.stopped, State.finished, State.failed}

_RUNS = WeakSet["LiveRun"]()
"""All that there are: they share the workers, who go home with the last."""


class LiveRun(ReadOnlyProperties):
    """A run that goes on by itself.

    Attributes:
        state: what it is doing.
        error: what made it fail, or None.
        n_done: walks that are done.
        n_walks: walks that there will be.
    """

    INSTEAD = Evolution.INSTEAD

    def __init__(
        self,
        settings: Settings,
        path: str | Path | None = None,
        executor: Executor | None = None,
        *,
        on_news: Callable[["LiveRun"], None] = lambda _: None,
    ) -> None:
        """Check the settings, and wait to be told to go on.

        Args:
            settings: of all four domains.
            path: its run file; without one, nothing of it is kept.
            executor: any ``concurrent.futures.Executor``; loky on all cores if None.
            on_news: called with it, on its thread or the caller's, when more walks are done or its state has changed.

        Raises:
            OperatorError: if an operator or fitness of the user's own does not do what its slot needs.
            RunFileError: if there is a file at ``path``, or none can be made there.
        """
        check_executor(executor)
        self._settings = settings
        self.state = State.paused
        self.n_done = 0
        self.error: BaseException | None = None
        self.n_walks = n_walks(settings)
        self._executor, self._on_news = executor, on_news
        self._gate = PausableExecutor(self._workers, n_workers)
        self._evolution = Evolution(settings, path, self._gate, on_walks=self._walked)
        self._may_go, self._pause_at = threading.Event(), settings.algorithm.generations
        self._since, self._seconds, self._first = 0.0, 0.0, (0.0, 0)
        self._lock = threading.RLock()
        self._thread = threading.Thread(target=self._evolve, name="walkerlab run", daemon=True)
        self._pool: Executor | None = None
        self._n_losses = 0
        _RUNS.add(self)

    @property
    def settings(self) -> Settings:
        """The settings of the run."""
        return self._settings

    @property
    def run(self) -> Run:
        """All that is done so far."""
        return self._evolution.run

    @property
    def n_generations(self) -> int:
        """How many generations are done."""
        return self._evolution.n_generations

    @property
    def is_over(self) -> bool:
        """Whether it will never go on."""
        return self.state in OVER

    def go_on(self, generations: int | None = None) -> None:
        """Start, or go on, to the end, or for so many generations more."""
        with self._lock:
            if self.is_over:
                return
            total = self.settings.algorithm.generations
            self._pause_at = total if generations is None else self.n_generations + generations
            if self.state == State.paused:
                self._since = time.monotonic()
            self.state = State.running
            self._gate.resume()
            self._may_go.set()
            if not self._thread.ident:
                self._thread.start()
        self._on_news(self)

    def pause(self) -> None:
        """Let the robots that are walking finish, and no other begin."""
        self._rest(State.paused, self._gate.pause, self._may_go.clear)

    def stop(self) -> None:
        """End it here: the generations that are done are kept, the one that is walking is not."""
        self._rest(State.stopped, self._gate.stop, self._may_go.set)

    def close(self, timeout: float = 2.0) -> None:
        """Stop, wait for the thread, and send the workers home if no other run needs them; a later one starts others.

        Args:
            timeout: s to wait for the thread.
        """
        self.stop()
        if self._thread.ident:
            self._thread.join(timeout)
        if self._pool and all(run.is_over for run in _RUNS):
            self._pool.shutdown(wait=False)

    def insert(self, genome: Genome | str) -> int:
        """Put a genome into a generation to come, as ``Evolution.insert`` does.

        Raises:
            ValueError: if the run is over, or for what ``Evolution.insert`` does.
        """
        if self.is_over:
            raise ValueError("this run is over; start another, and put the gene into that")
        return self._evolution.insert(genome)

    @property
    def seconds(self) -> float:
        """How long it has been running, without its pauses."""
        return self._seconds + (time.monotonic() - self._since if self.state == State.running else 0.0)

    @property
    def pace(self) -> float | None:
        """How many s a walk has taken since the first robots were back, all cores together; None before that."""
        at_first, n_first = self._first
        more = self.n_done - n_first
        return (self.seconds - at_first) / more if more else None

    @property
    def seconds_left(self) -> float | None:
        """How long it will still take at its pace; None before it has one."""
        return None if self.pace is None else self.pace * (self.n_walks - self.n_done)

    @property
    def note(self) -> str:
        """What befell its workers last, in words; "" if nothing has."""
        losses = getattr(self._pool, "losses", [])[self._n_losses :]
        return str(WorkerLostWarning(losses[-1])) if losses else ""

    def _workers(self) -> Executor:
        if self._executor:
            return self._executor
        self._pool = default_executor()
        self._n_losses = len(getattr(self._pool, "losses", []))
        return self._pool

    def _walked(self, n: int) -> None:
        self.n_done += n
        if not self._first[1]:  # until now the workers were started, and bodies built for the first time
            self._first = self.seconds, n
        self._on_news(self)

    def _rest(self, state: State, *steps: Callable[[], None]) -> None:
        """Change from running or paused to a state of rest, take the steps to it, and say so; or leave it as it is."""
        with self._lock:
            if self.is_over or self.state == state:
                return
            self._seconds, self.state = self.seconds, state
            for step in steps:
                step()
        self._on_news(self)

    def _evolve(self) -> None:
        """Go from generation to generation: the whole life of the thread."""
        try:
            for generation in self._evolution:
                if generation.number + 1 == self._pause_at < self.settings.algorithm.generations:
                    self.pause()
                self._on_news(self)
                self._may_go.wait()
                if self.is_over:
                    return
            self._rest(State.finished)
        except Stopped:
            pass
        except BaseException as error:  # whatever a student's function may raise
            self.error = error
            self._rest(State.failed)
