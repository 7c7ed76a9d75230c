"""Jobs for several processes: each searches on one ground, measures the champions and stores the results."""

import hashlib
import json
import multiprocessing
import os
import platform
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import walkerlab as wl
from benchmarks.champions import measure_champion
from benchmarks.searches import METHODS
from walkerlab.commands.flags import build_settings
from walkerlab.commands.setting_texts import parse_setting
from walkerlab.simulation.pausable import PausableExecutor, Stopped
from walkerlab.simulation.workers import prepare_worker
from walkerlab.system.files import write_text

GROUNDS: dict[str, dict[str, Any]] = {
    "flat": {},
    "incline": {"terrain.structure": "incline", "terrain.incline": 10},
    "stairs": {"terrain.structure": "stairs", "terrain.step_height": 0.08},
    "gravel": {"terrain.texture": "gravel", "terrain.texture_density": 0.05, "terrain.obstacle": "rock"},
}
"""Settings of each ground that differ from the defaults."""

DECISIVE_SOURCES = (
    *("system/randomness.py", "evolution/fragility.py", "evolution/rating.py"),
    *("ga/*.py", "genome/*.py", "simulation/*.py", "world/**/*.py"),
)
"""Modules of walkerlab that determine how a search proceeds and how a robot walks."""


@dataclass(frozen=True)
class Job:
    """Search with one method from one seed on one ground.

    Attributes:
        folder: Folder of all results.
        ground: Name of the ground.
        method: Name of the search.
        seed: Seed of the search.
        budgets: Numbers of evaluations after which the champion is measured.
        changes: Texts of the changed settings by ``domain.field``.
        end: Time at which the search stops, in seconds since the epoch.
    """

    folder: Path
    ground: str
    method: str
    seed: int
    budgets: tuple[int, ...]
    changes: Mapping[str, str]
    end: float

    @property
    def path(self) -> Path:
        """Path of the files of this job, without suffix."""
        return self.folder / self.ground / f"{self.method}-{self.seed}"

    @property
    def name(self) -> str:
        """Name of this job in messages."""
        return f"{self.ground} {self.method} {self.seed}"

    def read_results(self) -> dict[str, Any]:
        """Return the stored measures of champions by number of evaluations."""
        path = self.path.with_suffix(".json")
        return json.loads(path.read_text(encoding="utf-8"))["champions"] if path.exists() else {}

    @property
    def is_done(self) -> bool:
        """Whether the champions of all budgets are measured."""
        return {str(budget) for budget in self.budgets} <= self.read_results().keys()


def run_job(job: Job) -> str:
    """Search, measure the champions and store the results; return a message."""
    if time.time() >= job.end:
        return ""
    settings = create_settings(job.ground, job.changes)
    job.path.parent.mkdir(parents=True, exist_ok=True)
    executor = PausableExecutor(lambda: ThreadPoolExecutor(1), lambda _: 1)
    timer = threading.Timer(max(0.0, min(job.end - time.time(), threading.TIMEOUT_MAX)), executor.stop)
    timer.daemon = True
    timer.start()
    try:
        champions = METHODS[job.method](settings, job.seed, job.budgets, job.path, executor)
    except Stopped:
        return f"{job.name}: stopped; to be resumed"
    finally:
        timer.cancel()
    results = job.read_results()
    for budget, champion in champions.items():
        if str(budget) not in results:
            results[str(budget)] = {
                "evaluations": champion.n_evaluations,
                **measure_champion(champion.genome, settings),
            }
    document = {
        **{name: getattr(job, name) for name in ("ground", "method", "seed")},
        "source": source_digest(settings),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores",
        "champions": results,
    }
    write_text(job.path.with_suffix(".json").absolute(), json.dumps(document, indent=1) + "\n")
    speeds = (
        f"{results[str(budget)]['body lengths/s'] or 0:.2f} body lengths/s at {budget:,}" for budget in job.budgets
    )
    return f"{job.name}: {', '.join(speeds)}"


def source_digest(settings: wl.Settings) -> str:
    """Return a digest of all that determines the results, so that results of different versions can be distinguished.

    Args:
        settings: Settings of the search; the seed of the algorithm has no effect.
    """
    assert wl.__file__
    package = Path(wl.__file__).parent
    digest = hashlib.sha256(repr(settings.with_(seed=0)).encode())
    for path in sorted(path for pattern in DECISIVE_SOURCES for path in package.glob(pattern)):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:8]


def run_jobs(jobs: Sequence[Job], n_processes: int) -> Iterator[str]:
    """Run jobs in several processes, each with one thread, and yield a message for each."""
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # inherited by the processes
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(n_processes, mp_context=context, initializer=prepare_worker, initargs=(os.getpid(),))
    try:
        futures = {pool.submit(run_job, job): job for job in jobs}
        for future in as_completed(futures):
            try:
                message = future.result()
            except Exception as error:
                message = f"{futures[future].name}: failed: {type(error).__name__}: {error}"
            if message:
                yield message
    except KeyboardInterrupt:  # files are complete at any time, so processes can be ended
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def create_settings(ground: str, changes: Mapping[str, str]) -> wl.Settings:
    """Create the settings of a ground with changes.

    Several values are separated by commas. An operator may have arguments: ``tournament(size=7)``.

    Args:
        ground: Name of the ground.
        changes: Texts of values by ``domain.field``.

    Raises:
        ValueError: If a value is not allowed.
    """
    values = dict(GROUNDS[ground])
    for place, text in changes.items():
        values[place] = parse_setting(place.rpartition(".")[2], text)
    return build_settings(values)
