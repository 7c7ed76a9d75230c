"""The pictures of a report: what each is called, what it shows, and how a student reads it."""

from base64 import b64encode
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from zlib import crc32

import pandas as pd
from matplotlib.axes import Axes

from walkerlab.runfile.records import Individual, champion
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.rollout import Rollout
from walkerlab.text.html import Html, inline_svg, tag
from walkerlab.view import plots, summary
from walkerlab.view.plots.appearance import paper

KINDS = ("svg", "pdf", "png")
FOLDER = "pictures"
HALF, LOW, MIDDLE, WIDE, TALL = (5.2, 3.3), (8.0, 2.3), (8.0, 3.2), (8.0, 4.0), (8.0, 5.6)  # inches
MOST = 400_000  # characters of an SVG that goes into the page; the PNG of a larger one does


@dataclass(frozen=True)
class Subject:
    """What there is to draw: a run's settings and table, its champion, and the champion's walk."""

    settings: Settings
    records: pd.DataFrame
    champion: Individual
    rollout: Rollout

    @classmethod
    def of(cls, settings: Settings, records: pd.DataFrame) -> "Subject":
        """Find the champion, and let it walk once more.

        Raises:
            ValueError: if the table is empty.
        """
        best = champion(records)
        return cls(settings, records, best, poorest_walk(best.genome, settings))


@dataclass(frozen=True)
class Picture:
    """One picture: its file's name, its title, how to read it, its size [inches], and what draws it.

    Where the height follows from what is to be drawn, ``height`` says it.
    """

    name: str
    title: str
    reading: str
    size: tuple[float, float]
    draw: Callable[[Subject, Axes], object]
    height: Callable[[Subject], float] | None = None

    def axes(self, run: Subject) -> Axes:
        """Open a figure of its size."""
        width, height = self.size
        return paper(width, self.height(run) if self.height else height)


def _of_a_family(run: Subject) -> float:
    line = summary.select_descent(run.records, run.champion.individual)
    return 1.2 + 0.75 * min(sum(max(1, skipped) for _, skipped in line), 12)


def _trait(name: str, title: str, reading: str) -> Picture:
    return Picture(name, title, reading, HALF, lambda run, ax: plots.trait(run.records, name, ax))


PICTURES = (
    Picture(
        "champion",
        "The champion on its way",
        "The robot from the side, to scale, at the start, on its way and at the end; the later, the darker. The arrow "
        "is how far its centre of mass has come. Look at which legs carry it and which swing forward.",
        LOW,
        lambda run, ax: plots.stride(run.champion.genome, run.settings, ax),
    ),
    Picture(
        "fitness",
        "Fitness, generation by generation",
        "The solid line is the best robot of each generation, the dashed line the median: half of the robots are "
        "better, half are poorer. Where the median climbs after the best, the best robot's genes have spread. A line "
        "that has been flat for long says that nothing better is being found: for want of variety, or because there is "
        "no better.",
        WIDE,
        lambda run, ax: plots.fitness_curve(run.records, ax),
    ),
    Picture(
        "diversity",
        "How different the robots still are",
        "Selection uses variety up and mutation brings some back. When it has nearly gone, crossover only mixes robots "
        "that are alike, and the fitness curve goes flat.",
        HALF,
        lambda run, ax: plots.diversity(run.records, ax),
    ),
    Picture(
        "verdicts",
        "Which walks count",
        "A judge looks at each walk, and one that breaks a rule has no fitness. Many that do not count at first are "
        "chance; many later on mean that evolution is pressing against a rule.",
        HALF,
        lambda run, ax: plots.verdicts(run.records, ax),
    ),
    _trait("weight", "Weight", "Does it run against the limit that was set, and stay there? Then the limit decides."),
    _trait("body_length", "Body length", "Long bodies reach farther with each step, and bend and topple more easily."),
    _trait("n_segments", "Segments", "Where the middle half is a line, all robots have as many."),
    _trait("n_legs", "Legs", "They come in pairs; a segment may have none."),
    Picture(
        "body",
        "The champion's body",
        "The body that its gene describes, from the side and to scale; it walks to the right. The light blue legs are "
        "on the near side, its right; the dark ones on the far side.",
        MIDDLE,
        lambda run, ax: plots.body(run.champion.genome, ax, run.settings),
    ),
    Picture(
        "gait",
        "The champion's gait",
        "Which foot is on the ground, and when. Read it downwards at one moment to see what the robot stands on, "
        "and along a row to see how long a foot stays down. Rows that alternate are a walk or a trot; rows that are "
        "alike are a bound.",
        MIDDLE,
        lambda run, ax: plots.gait(run.champion.genome, run.settings, ax),
    ),
    Picture(
        "distance",
        "The champion's way, second by second",
        "How far its centre of mass has come. A straight line is an even pace; a step is a leap or a stumble; where it "
        "goes level, the robot is stuck.",
        MIDDLE,
        lambda run, ax: plots.distance_over_time(run.rollout, ax),
    ),
    Picture(
        "family",
        "The champion's family",
        "Follow the thick arrows: from a random robot of generation 0 down to the champion, through the fitter parent "
        "of each. Beside it stands the other parent, where there was one. Look for the step at which the body changed, "
        "and for the one after which the fitness jumped.",
        WIDE,
        lambda run, ax: plots.family_tree(run.records, ax, run.champion.individual, run.settings),
        height=_of_a_family,
    ),
    Picture(
        "genes",
        "The genes of the last generation",
        "Each row is a robot, the fittest on top, and each column a gene. A column of one colour is a gene on which "
        "all agree: it has been decided. A motley one matters little. Hatched genes are carried, and not grown.",
        TALL,
        lambda run, ax: plots.genes(run.records, ax),
    ),
)
"""Every picture, in the order in which it is drawn."""


def draw_all(run: Subject, folder: Path | None) -> Iterator[tuple[Picture, Html]]:
    """Draw every picture once, save it in every format if there is a folder, and yield it with what shows it."""
    with TemporaryDirectory() as passing:
        place, kinds = (folder / FOLDER, KINDS) if folder else (Path(passing), KINDS[:1])
        place.mkdir(parents=True, exist_ok=True)
        for picture in PICTURES:
            axes = picture.axes(run)
            picture.draw(run, axes)
            plots.save(axes, *(place / f"{picture.name}.{kind}" for kind in kinds))
            yield picture, _shown(axes, place / f"{picture.name}.svg", picture.name)


def inline(draw: Callable[[Axes], object], size: tuple[float, float]) -> Html:
    """Draw a picture for a notebook, and keep no file of it."""
    axes = paper(*size)
    draw(axes)
    with TemporaryDirectory() as passing:
        path = Path(passing) / "picture.svg"
        plots.save(axes, path)
        return _shown(axes, path, f"p{crc32(path.read_bytes()):08x}")


def _shown(axes: Axes, svg: Path, name: str) -> Html:
    """Put a saved picture into a page: as SVG, whose text can be searched, or as PNG if that would be too large."""
    alt, text = plots.alt_text(axes), svg.read_text(encoding="utf-8")
    if len(text) <= MOST:
        return inline_svg(text, name, alt)
    png = svg.with_suffix(".png")
    plots.save(axes, png)
    return tag("img", src=f"data:image/png;base64,{b64encode(png.read_bytes()).decode()}", alt=alt)
