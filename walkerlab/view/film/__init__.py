"""Films of one walk or of a whole evolution in time-lapse, rendered with sky and sun to a video file.

    wl.film(run.champion, run.settings, "champion.mp4")
    wl.timelapse(run, "evolution.mp4")

MuJoCo selects its OpenGL backend when it is first imported, which a notebook has usually done by then, so a film is
rendered in a separate process. That process imports this module too, which therefore must not import MuJoCo.
"""

from itertools import groupby
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome, HasGenome
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.text.numbers import with_unit
from walkerlab.view.film.job import Clip, FilmError, Job, is_integer
from walkerlab.view.film.process import film_path, render_film
from walkerlab.view.film.result import Film

if TYPE_CHECKING:
    import pandas as pd

    from walkerlab.runfile.records import Individual

__all__ = ["Film", "FilmError", "film", "timelapse"]

DEFAULT_SIZE = (480, 360)  # pixels
DEFAULT_FPS = 25  # shows every second recorded pose
AT_MOST_RANGE = (2, 1000)  # allowed number of champions in a time-lapse


class EvolutionResult(Protocol):
    """Result of an evolution, such as a ``Run``."""

    @property
    def records(self) -> "pd.DataFrame":
        """Table with one row for each individual of each generation."""
        ...

    @property
    def settings(self) -> Settings:
        """Settings of the evolution."""
        ...


class ChampionPeriod(NamedTuple):
    """Consecutive generations with the same champion.

    Attributes:
        champion: Individual with the best fitness in these generations.
        first: First generation of the period.
        last: Last generation of the period.
    """

    champion: "Individual"
    first: int
    last: int


def film(
    genome: Genome | str | Floats | HasGenome,
    settings: Settings,
    path: str | Path,
    *,
    camera: Camera | str | int | None = None,
    size: tuple[int, int] = DEFAULT_SIZE,
    fps: int = DEFAULT_FPS,
    caption: str = "",
    progress: bool = True,
) -> Film:
    """Render one walk to a video file.

    If there are several starts, it is the walk with the lowest fitness, rated by the default fitness, not by the
    fitness in the settings. A notebook plays the returned film.

    Args:
        genome: Genome, its text, its values of shape (n_genes,), or an individual.
        settings: Settings of terrain, robot and simulation.
        path: Path of the file: .mp4, .webm or .gif. An existing file is replaced when the film is complete.
        camera: Camera; if None, the camera in the settings.
        size: Width and height [pixels]; even numbers.
        fps: Frames per second.
        caption: Text above the picture.
        progress: Whether to show a progress bar.

    Raises:
        GenomeError: If ``genome`` is text but not a valid genome.
        ValueError: If ``camera``, ``size``, ``fps`` or the suffix of ``path`` is not allowed.
        TypeError: If ``genome`` is a run, a table or settings.
        FilmError: If OpenGL cannot render off-screen here, or the film cannot be written.
    """
    text = str(Genome.of(genome))
    settings = _with_camera(settings, camera)
    path = film_path(path)
    clip = Clip(text, settings.simulation.duration, caption)
    about = f"A walk of {clip.seconds:g} s; camera: {settings.simulation.camera.about}"
    return _render_film(Job((clip,), settings, size, fps, path.suffix.lower()), path, about, progress)


def timelapse(
    run: EvolutionResult,
    path: str | Path,
    *,
    seconds: float = 2.0,
    at_most: int = 20,
    camera: Camera | str | int | None = None,
    size: tuple[int, int] = DEFAULT_SIZE,
    fps: int = DEFAULT_FPS,
    progress: bool = True,
) -> Film:
    """Render the champions of an evolution to a video file, one after the other.

    A champion of several consecutive generations is shown once.

    Args:
        run: Result of an evolution.
        path: Path of the file: .mp4, .webm or .gif. An existing file is replaced when the film is complete.
        seconds: How long each champion is shown [s], at most the duration of its walk.
        at_most: Maximum number of champions; if there are more, evenly spaced ones are shown, including the first and
            the last.
        camera: Camera; if None, the camera in the settings.
        size: Width and height [pixels]; even numbers.
        fps: Frames per second.
        progress: Whether to show a progress bar.

    Raises:
        ValueError: If the run has no individuals, or ``seconds``, ``at_most``, ``camera``, ``size``, ``fps`` or the
            suffix of ``path`` is not allowed.
        FilmError: If OpenGL cannot render off-screen here, or the film cannot be written.
    """
    if not hasattr(run, "settings") or not hasattr(run, "records"):
        raise TypeError(f"a time-lapse requires a run, such as wl.load(path); got a {type(run).__name__}")
    path = film_path(path)
    settings = _with_camera(run.settings, camera)
    table = run.records
    if not isinstance(seconds, Real) or isinstance(seconds, bool) or not 0 < seconds < float("inf"):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"seconds is {seconds!r}; it must be a number above 0. It is how long each champion is shown.")
    low, high = AT_MOST_RANGE
    if not (is_integer(at_most) and low <= at_most <= high):
        raise ValueError(
            f"at_most is {at_most!r}; it must be a whole number between {low} and {high}. "
            "It is the maximum number of champions that are shown."
        )
    unit = table.attrs.get("units", {}).get("fitness", "")
    shown_seconds = min(float(seconds), settings.simulation.duration)
    clips = tuple(
        Clip(str(period.champion.genome), shown_seconds, _write_caption(period, unit), period.last)
        for period in _select_evenly(_champion_periods(table), at_most)
    )
    first, last = int(table.generation.min()), int(table.generation.max())
    job = Job(clips, settings, size, fps, path.suffix.lower(), (first, last))
    about = f"{len(clips)} champions of generations {first} to {last}, walking one after the other"
    return _render_film(job, path, about, progress)


def _with_camera(settings: Settings, camera: Any) -> Settings:
    require_settings(settings)
    return settings if camera is None else settings.with_(camera=camera)


def _render_film(job: Job, path: Path, about: str, progress: bool) -> Film:
    render_film(job, path, progress=progress)
    return Film(path, about, job.size, job.fps, job.n_frames)


def _champion_periods(table: "pd.DataFrame") -> list[ChampionPeriod]:
    """Return the champions in the order of their generations, each with the generations of its period."""
    from walkerlab.runfile.records import find_champion

    if table.empty:
        raise ValueError("no robot has walked yet, so there is nothing to film")
    champions = [(int(number), find_champion(rows)) for number, rows in table.groupby("generation")]  # type: ignore[call-overload]
    periods = (list(period) for _, period in groupby(champions, key=lambda pair: pair[1].individual))
    return [ChampionPeriod(period[0][1], period[0][0], period[-1][0]) for period in periods]


def _select_evenly(periods: list[ChampionPeriod], at_most: int) -> list[ChampionPeriod]:
    """Return at most ``at_most`` periods at even intervals, always with the first and the last."""
    selected = np.linspace(0, len(periods) - 1, min(at_most, len(periods)))
    return [periods[i] for i in np.rint(selected).astype(int).tolist()]


def _write_caption(period: ChampionPeriod, unit: str) -> str:
    champion, first, last = period
    generations = f"generation {first}" if first == last else f"generations {first}–{last}"
    fitness = with_unit(champion.fitness, unit)
    result = fitness if champion.verdict == "ok" else f"does not count: {champion.verdict}"
    return f"{generations} · robot {champion.individual} · {result}"
