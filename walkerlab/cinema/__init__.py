"""Films: one walk, or a whole evolution in time-lapse, drawn with sky and sun and written to a video file.

    wl.film(run.champion, run.settings, "champion.mp4")
    wl.timelapse(run, "evolution.mp4")

A kernel has usually imported MuJoCo before anybody thinks of a GL, so a film is drawn in a process of its own. That
process comes in by this door as well, which therefore loads nothing that loads MuJoCo.
"""

from itertools import groupby
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np

from walkerlab.arguments import require_settings
from walkerlab.choices import Camera
from walkerlab.cinema.crew import film_path, make
from walkerlab.cinema.job import Act, FilmError, Job, is_whole
from walkerlab.cinema.result import Film
from walkerlab.genes import Floats
from walkerlab.genome import Genome, HasGenome
from walkerlab.number_format import with_unit
from walkerlab.settings import Settings

if TYPE_CHECKING:
    import pandas as pd

    from walkerlab.records import Individual

__all__ = ["Film", "FilmError", "film", "timelapse"]

SIZE = (480, 360)  # pixels
RATE = 25  # frames a second: every second recorded pose
ACTS = (2, 1000)  # walks in a time-lapse


class Evolved(Protocol):
    """What a time-lapse is made from, such as a ``Run``: the tidy table, and the settings."""

    @property
    def records(self) -> "pd.DataFrame":
        """The tidy table."""
        ...

    @property
    def settings(self) -> Settings:
        """From which it was made."""
        ...


def film(
    genome: Genome | str | Floats | HasGenome,
    settings: Settings,
    path: str | Path,
    *,
    camera: Camera | str | int | None = None,
    size: tuple[int, int] = SIZE,
    fps: int = RATE,
    caption: str = "",
    progress: bool = True,
) -> Film:
    """Film one walk.

    It is the walk that counts: from several starts the poorest, as judged by the fitness that settings have unless
    told otherwise, whatever fitness these name. In a notebook the answer plays.

    Args:
        genome: a genome, its text or its (n_genes,) values, or an individual.
        settings: of terrain, robot and simulation.
        path: the file to be made: .mp4, .webm or .gif. One that is there is replaced once the film is whole.
        camera: which view; the settings' own if None.
        size: width and height in pixels, even numbers.
        fps: frames a second.
        caption: written on it.
        progress: whether to show a bar.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if camera, size, fps or the ending of the path will not do.
        TypeError: if a run, a table or settings are given in place of a genome.
        FilmError: if there is no GL that draws without a screen, or the film cannot be written.
    """
    text, seen = str(Genome.of(genome)), _seen(settings, camera)
    act = Act(text, seen.simulation.duration, caption)
    about = f"A walk of {act.seconds:g} s, seen from {seen.simulation.camera.about}"
    path = film_path(path)
    return _make(Job((act,), seen, size, fps, path.suffix.lower()), path, about, progress)


def timelapse(
    run: Evolved,
    path: str | Path,
    *,
    seconds: float = 2.0,
    at_most: int = 20,
    camera: Camera | str | int | None = None,
    size: tuple[int, int] = SIZE,
    fps: int = RATE,
    progress: bool = True,
) -> Film:
    """Film an evolution: the champion of each generation in turn, each from the start of its walk.

    A champion that stays one for several generations is shown once.

    Args:
        run: what came of an evolution.
        path: the file to be made: .mp4, .webm or .gif. One that is there is replaced once the film is whole.
        seconds: for which each champion is shown, unless its walk is shorter.
        at_most: how many champions are shown; of more, every second or so, and always the first and the last.
        camera: which view; the settings' own if None.
        size: width and height in pixels, even numbers.
        fps: frames a second.
        progress: whether to show a bar.

    Raises:
        ValueError: if no robot has walked yet, or seconds, at_most, camera, size, fps or the ending of the path will
            not do.
        FilmError: if there is no GL that draws without a screen, or the film cannot be written.
    """
    if not hasattr(run, "settings") or not hasattr(run, "records"):
        raise TypeError(f"a time-lapse is made from a run, such as wl.load(path); got a {type(run).__name__}")
    path, settings, table = film_path(path), _seen(run.settings, camera), run.records
    longest = settings.simulation.duration
    if not isinstance(seconds, Real) or isinstance(seconds, bool) or not 0 < seconds < float("inf"):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(
            f"seconds is {seconds!r}; it must be a number over 0. It is for how long each champion is shown."
        )
    if not (is_whole(at_most) and ACTS[0] <= at_most <= ACTS[1]):
        raise ValueError(
            f"at_most is {at_most!r}; it must be a whole number, {ACTS[0]} to {ACTS[1]}. "
            "It is how many champions are shown."
        )
    unit = table.attrs.get("units", {}).get("fitness", "")
    reigns = _thinned(_reigns(table), at_most)
    acts = tuple(
        Act(str(best.genome), min(float(seconds), longest), _caption(best, first, last, unit), last)
        for best, first, last in reigns
    )
    ruler = (int(table.generation.min()), int(table.generation.max()))
    job = Job(acts, settings, size, fps, path.suffix.lower(), ruler)
    about = f"{len(acts)} champions of the generations {ruler[0]} to {ruler[1]}, walking one after the other"
    return _make(job, path, about, progress)


def _seen(settings: Settings, camera: Any) -> Settings:
    require_settings(settings)
    return settings if camera is None else settings.with_(camera=camera)


def _make(job: Job, path: Path, about: str, progress: bool) -> Film:
    make(job, path, progress=progress)
    return Film(path, about, job.size, job.fps, job.n_frames)


Reign: TypeAlias = "tuple[Individual, int, int]"
"""A champion, and the first and last generation of which it was the champion without a break."""


def _reigns(table: "pd.DataFrame") -> list[Reign]:
    from walkerlab.records import champion

    if table.empty:
        raise ValueError("no robot has walked yet, so there is nothing to be filmed")
    best = [(int(number), champion(those)) for number, those in table.groupby("generation")]  # type: ignore[call-overload]
    reigns = (list(one) for _, one in groupby(best, key=lambda pair: pair[1].individual))
    return [(reign[0][1], reign[0][0], reign[-1][0]) for reign in reigns]


def _thinned(reigns: list[Reign], at_most: int) -> list[Reign]:
    """Leave out some, evenly, but neither the first nor the last."""
    kept = np.linspace(0, len(reigns) - 1, min(at_most, len(reigns)))
    return [reigns[i] for i in np.rint(kept).astype(int).tolist()]


def _caption(best: "Individual", first: int, last: int, unit: str) -> str:
    when = f"generation {first}" if first == last else f"generations {first}–{last}"
    good = with_unit(best.fitness, unit) if best.verdict == "ok" else f"does not count: {best.verdict}"
    return f"{when} · robot {best.individual} · {good}"
