"""Evolution in a background thread: it can be paused, stepped and stopped, and the notebook stays responsive."""

import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor
from enum import StrEnum
from pathlib import Path
from typing import Any
from weakref import WeakSet

from tqdm.auto import tqdm

from walkerlab.evolution.evolution import Evolution
from walkerlab.evolution.forecast import n_walks
from walkerlab.evolution.resuming import PreparedRun
from walkerlab.evolution.run import Run
from walkerlab.evolution.stopping import Stop
from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.simulation.pausable import PausableExecutor, Stopped
from walkerlab.simulation.workers import WorkerLostWarning, check_executor, default_executor, n_workers
from walkerlab.system.readonly import ReadOnlyProperties


class State(StrEnum):
    """State of a run."""

    running = "running"
    paused = "paused"
    stopped = "stopped"
    finished = "finished"
    failed = "failed"


JOIN_TIME = 0.1  # s between two checks whether the thread has ended; without them, Ctrl-C has no effect on Windows
END_STATES = {State.stopped, State.finished, State.failed}

_live_runs = WeakSet["LiveRun"]()
"""All live runs: they share the default executor, which is shut down when none of them needs it."""


class LiveRun(ReadOnlyProperties):
    """A run in a background thread.

    Attributes:
        state: State of the run.
        error: Error that made it fail, or None.
        n_earlier: Number of generations of a stored run before it is continued here.
        n_done: Number of walks that are done.
        n_walks: Total number of walks.
        on_change: Function that is called with the run when it has changed.
        first_robots: Evaluations of the robots of generation 0 that have walked, keyed by number; empty when it is
            complete.
    """

    INSTEAD = Evolution.INSTEAD

    def __init__(
        self,
        start: Settings | PreparedRun,
        path: str | Path | None = None,
        executor: Executor | None = None,
        *,
        stop: Stop | None = None,
        on_change: Callable[["LiveRun"], None] = lambda _: None,
    ) -> None:
        """Check the settings; the run is paused until ``resume`` starts it.

        Args:
            start: Complete settings of a new run, or a stored run to continue.
            path: Run file of a new run; if None, the run is discarded when it is no longer referenced.
            executor: Any ``concurrent.futures.Executor``; loky on all cores if None.
            stop: Conditions under which the run finishes before its last generation.
            on_change: Function that is called with the run when walks are done or its state has changed, in the thread
                of the run or of the caller.

        Raises:
            OperatorError: If a user function does not do what its slot requires.
            RunFileError: If ``path`` exists already or cannot be created.
        """
        check_executor(executor)
        self._prepared = start if isinstance(start, PreparedRun) else None
        settings = start.settings if isinstance(start, PreparedRun) else start
        self._settings = settings
        self.state = State.paused
        self.n_done = 0
        self.error: BaseException | None = None
        self.n_earlier = self._prepared.run.n_generations if self._prepared else 0
        self.n_walks = n_walks(settings, self.n_earlier)
        self.first_robots: dict[int, Evaluation] = {}
        self._executor = executor
        self.on_change = on_change
        self._pausable = PausableExecutor(self._create_executor, n_workers)
        self._options: dict[str, Any] = {
            "executor": self._pausable,
            "on_walks": self._count_walks,
            "on_rated": self._collect_first_robots,
            "stop": stop,
        }
        self._evolution = None if self._prepared else Evolution(settings, path, **self._options)
        self._waiting_genomes: list[Genome] = []  # inserted before the stored run was prepared
        self._may_continue = threading.Event()
        self._pause_at = settings.algorithm.generations  # number of generations at which the run pauses
        self._resumed_at = 0.0  # s, of the monotonic clock
        self._seconds = 0.0  # running time until the last pause
        self._first_results = (0.0, 0)  # seconds and number of walks
        self._lock = threading.RLock()
        self._thread = threading.Thread(target=self._evolve, name="walkerlab run", daemon=True)
        self._default_executor: Executor | None = None
        self._n_losses = 0
        _live_runs.add(self)

    @property
    def settings(self) -> Settings:
        """Settings of the run."""
        return self._settings

    @property
    def run(self) -> Run:
        """The run so far."""
        if self._evolution:
            return self._evolution.run
        assert self._prepared
        return self._prepared.run

    @property
    def n_generations(self) -> int:
        """Number of generations that are done."""
        return self._evolution.n_generations if self._evolution else self.run.n_generations

    @property
    def is_over(self) -> bool:
        """Whether the run has ended."""
        return self.state in END_STATES

    def resume(self, generations: int | None = None) -> None:
        """Start or continue the run.

        Args:
            generations: Number of further generations; all that remain if None.
        """
        with self._lock:
            if self.is_over:
                return
            total = self.settings.algorithm.generations
            self._pause_at = total if generations is None else self.n_generations + generations
            if self.state == State.paused:
                self._resumed_at = time.monotonic()
            self.state = State.running
            self._pausable.resume()
            self._may_continue.set()
            if not self._thread.ident:
                self._thread.start()
        self.on_change(self)

    def finish(self) -> Run:
        """Continue the run, show a progress bar until it is over, and return it.

        Raises:
            BaseException: The error that made the run fail.
        """
        self.resume()
        with tqdm(total=self.n_walks, initial=self.n_done, unit=" walks") as bar:
            while self._thread.is_alive():
                self._thread.join(JOIN_TIME)
                bar.update(self.n_done - bar.n)
        if self.error:
            raise self.error
        return self.run

    def pause(self) -> None:
        """Let the current walks finish, and start no others."""
        self._change_state(State.paused, self._pausable.pause, self._may_continue.clear)

    def stop(self) -> None:
        """End the run; the generations that are done are saved, and the current one is lost."""
        self._change_state(State.stopped, self._pausable.stop, self._may_continue.set)

    def close(self, timeout: float = 2.0) -> None:
        """Stop the run, wait for its thread, and shut the default executor down if no other run needs it.

        Args:
            timeout: Time to wait for the thread, in seconds.
        """
        self.stop()
        if self._thread.ident:
            self._thread.join(timeout)
        if self._default_executor and all(run.is_over for run in _live_runs):
            self._default_executor.shutdown(wait=False)

    @property
    def inserted_genomes(self) -> list[Genome]:
        """Inserted genomes that are not in a completed generation yet."""
        return self._evolution.inserted_genomes if self._evolution else list(self._waiting_genomes)

    def insert(self, genome: Genome | str) -> int:
        """Insert a genome into the next generation to be bred, as ``Evolution.insert`` does.

        Args:
            genome: Genome or its text.

        Returns:
            Number of that generation.

        Raises:
            GenomeError: If a string is not a valid genome.
            ValueError: If the run is over, or ``Evolution.insert`` raises it.
        """
        if self.is_over:
            raise ValueError("this run is over; start another run and insert the genome there")
        with self._lock:
            if self._evolution:
                return self._evolution.insert(genome)
            self._waiting_genomes.append(Genome.of(genome))
            return self.n_generations

    @property
    def seconds(self) -> float:
        """Running time in seconds, without pauses."""
        current = time.monotonic() - self._resumed_at if self.state == State.running else 0.0
        return self._seconds + current

    @property
    def seconds_per_walk(self) -> float | None:
        """Seconds per walk since the first results, with all cores together; None until there are further results."""
        first_seconds, n_first = self._first_results
        n_further = self.n_done - n_first
        return (self.seconds - first_seconds) / n_further if n_further else None

    @property
    def seconds_left(self) -> float | None:
        """Estimated remaining time in seconds; None while ``seconds_per_walk`` is None."""
        return None if self.seconds_per_walk is None else self.seconds_per_walk * (self.n_walks - self.n_done)

    @property
    def loss_note(self) -> str:
        """Message about the last worker that this run lost; "" if it lost none."""
        losses = getattr(self._default_executor, "losses", [])[self._n_losses :]
        return str(WorkerLostWarning(losses[-1])) if losses else ""

    def _create_executor(self) -> Executor:
        if self._executor:
            return self._executor
        self._default_executor = default_executor()
        self._n_losses = len(getattr(self._default_executor, "losses", []))
        return self._default_executor

    def _count_walks(self, n: int) -> None:
        self.n_done += n
        _, n_first = self._first_results
        if not n_first:  # the time until now includes the start of the workers and the compilation of the first models
            self._first_results = self.seconds, n
        self.on_change(self)

    def _collect_first_robots(self, index: int, evaluation: Evaluation) -> None:
        if not self.n_generations:
            self.first_robots = {**self.first_robots, index: evaluation}

    def _change_state(self, state: State, *steps: Callable[[], None]) -> None:
        """Change to a state other than running, call the given steps, and report it; do nothing if the run is over."""
        with self._lock:
            if self.is_over or self.state == state:
                return
            self._seconds = self.seconds  # while the state is still running
            self.state = state
            for step in steps:
                step()
        self.on_change(self)

    def _evolve(self) -> None:
        """Evolve until the run is over; runs in the thread."""
        try:
            if not self._evolution:
                assert self._prepared
                evolution = self._prepared.create_evolution(**self._options)
                with self._lock:
                    for genome in self._waiting_genomes:
                        evolution.insert(genome)
                    self._evolution = evolution
                self._prepared = None
            for generation in self._evolution:
                self.first_robots = {}
                if generation.number + 1 == self._pause_at < self.settings.algorithm.generations:
                    self.pause()
                self.on_change(self)
                self._may_continue.wait()
                if self.is_over:
                    return
            self._change_state(State.finished)
        except Stopped:
            pass
        except BaseException as error:  # a user function may raise anything
            self.error = error
            self._change_state(State.failed)
