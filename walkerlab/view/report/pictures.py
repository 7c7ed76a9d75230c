"""The pictures of a report, each with a title and an explanation of how to read it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from zlib import crc32

import pandas as pd
from matplotlib.axes import Axes

from walkerlab.runfile.records import Individual, find_champion
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.rollout import Rollout
from walkerlab.text.html import inline_svg
from walkerlab.text.templates import Markup
from walkerlab.view import plots, summary
from walkerlab.view.plots.appearance import offscreen_axes
from walkerlab.view.snapshots import image_html

FORMATS = ("svg", "pdf", "png")
FOLDER = "pictures"
MAX_SVG_SIZE = 400_000  # characters; a picture with a larger SVG is shown on the page as PNG

# Sizes of pictures in inches: half the width of the page, or its full width with a given height.
HALF_WIDTH = (5.2, 3.3)
LOW = (8.0, 2.3)
MEDIUM = (8.0, 3.2)
HIGH = (8.0, 4.0)
VERY_HIGH = (8.0, 5.6)

FAMILY_MARGIN = 1.2  # inches; part of the family tree's height that does not depend on the ancestors
INCHES_PER_ANCESTOR = 0.75
MAX_ANCESTOR_ROWS = 12


@dataclass(frozen=True)
class Subject:
    """The run that the pictures show.

    Attributes:
        settings: Settings of the run.
        records: Table of the run.
        champion: Champion of the run.
        rollout: The champion's walk.
    """

    settings: Settings
    records: pd.DataFrame
    champion: Individual
    rollout: Rollout

    @classmethod
    def of(cls, settings: Settings, records: pd.DataFrame) -> "Subject":
        """Find the champion of a run and simulate its walk.

        Raises:
            ValueError: If the table is empty.
        """
        best = find_champion(records)
        return cls(settings, records, best, poorest_walk(best.genome, settings))


@dataclass(frozen=True)
class Picture:
    """Description of one picture.

    Attributes:
        name: Name of its files, without the extension.
        title: Heading above the picture.
        explanation: How to read it.
        size: Width and height [inches].
        draw: Function that draws it on an Axes.
        height: Function that computes the height [inches] from the run; if None, the height in ``size`` is used.
    """

    name: str
    title: str
    explanation: str
    size: tuple[float, float]
    draw: Callable[[Subject, Axes], object]
    height: Callable[[Subject], float] | None = None

    def axes(self, run: Subject) -> Axes:
        """Create a figure of the picture's size and return its Axes."""
        width, height = self.size
        return offscreen_axes(width, self.height(run) if self.height else height)


def _family_height(run: Subject) -> float:
    """Compute the height of the family tree [inches]."""
    line = summary.select_descent(run.records, run.champion.individual)
    n_rows = min(sum(max(1, n_skipped) for _, n_skipped in line), MAX_ANCESTOR_ROWS)
    return FAMILY_MARGIN + INCHES_PER_ANCESTOR * n_rows


def _trait(name: str, title: str, explanation: str) -> Picture:
    return Picture(name, title, explanation, HALF_WIDTH, lambda run, ax: plots.trait(run.records, name, ax))


PICTURES = (
    Picture(
        "champion",
        "The champion's walk",
        "The robot from the side, to scale, at the start, during the walk and at the end; later poses are darker. The "
        "arrow shows the distance covered by its centre of mass. Look at which legs support it and which swing "
        "forward.",
        LOW,
        lambda run, ax: plots.stride(run.champion.genome, run.settings, ax),
    ),
    Picture(
        "fitness",
        "Fitness over the generations",
        "The solid line shows the best robot of each generation, the dashed line the median: half of the robots are "
        "better, half are worse. Where the median follows the best upward, the genes of the best robot have spread. A "
        "line that stays flat means that evolution finds nothing better, because the robots no longer differ or "
        "because nothing better exists.",
        HIGH,
        lambda run, ax: plots.fitness_curve(run.records, ax),
    ),
    Picture(
        "diversity",
        "How different the robots are",
        "Selection reduces diversity, and mutation increases it. Once diversity is low, crossover only combines robots "
        "that are alike, and the fitness no longer rises.",
        HALF_WIDTH,
        lambda run, ax: plots.diversity(run.records, ax),
    ),
    Picture(
        "verdicts",
        "Which walks count",
        "Each walk is checked, and a walk that breaks a rule has no fitness. In the first generations, walks that do "
        "not count are due to chance. If there are many in later generations, evolution is exploiting something that "
        "a rule forbids.",
        HALF_WIDTH,
        lambda run, ax: plots.verdicts(run.records, ax),
    ),
    _trait("weight", "Weight", "If it stays at one of the limits in the settings, that limit determines the weight."),
    _trait("body_length", "Body length", "Long bodies take longer steps, but bend and topple more easily."),
    _trait("n_segments", "Segments", "If the band is a line, the middle half of the robots have the same number."),
    _trait("n_legs", "Legs", "Legs come in pairs; a segment may have none."),
    Picture(
        "body",
        "The champion's body",
        "The body that the genome describes, from the side and to scale; it walks to the right. The light blue legs "
        "are on its right side, which is nearer; the dark ones are on its left side.",
        MEDIUM,
        lambda run, ax: plots.body(run.champion.genome, ax, run.settings),
    ),
    Picture(
        "gait",
        "The champion's gait",
        "When each foot is on the ground. A column shows which feet support the robot at one moment, a row how long "
        "a foot stays on the ground. In a walk or a trot the rows alternate; in a bound they are alike.",
        MEDIUM,
        lambda run, ax: plots.gait(run.champion.genome, run.settings, ax),
    ),
    Picture(
        "distance",
        "The champion's distance over time",
        "The distance covered by its centre of mass. A straight line means a constant speed, a step a leap or a "
        "stumble, and a level part means that the robot is stuck.",
        MEDIUM,
        lambda run, ax: plots.distance_over_time(run.rollout, ax),
    ),
    Picture(
        "family",
        "The champion's family tree",
        "The thick arrows lead from a random robot of generation 0 down to the champion, through the fitter parent "
        "of each robot. The other parent, if there is one, is drawn beside it. Look for the generation in which the "
        "body changed, and for the one in which the fitness rose most.",
        HIGH,
        lambda run, ax: plots.family_tree(run.records, ax, run.champion.individual, run.settings),
        height=_family_height,
    ),
    Picture(
        "genes",
        "The genes of the last generation",
        "Each row is a robot, the fittest at the top, and each column a gene. If a column has one colour, all robots "
        "have the same value of that gene: selection or chance has fixed it. A column of many colours has little "
        "effect on fitness. Hatched genes are inherited but not expressed.",
        VERY_HIGH,
        lambda run, ax: plots.genes(run.records, ax),
    ),
)
"""All pictures, in the order in which they are drawn."""


def draw_all(run: Subject, folder: Path | None) -> Iterator[tuple[Picture, Markup]]:
    """Draw all pictures.

    Args:
        run: Run to show.
        folder: Folder of the report, in which each picture is saved in every format; no files are saved if None.

    Yields:
        Each picture and the HTML that shows it.
    """
    with TemporaryDirectory() as temporary:
        picture_folder = folder / FOLDER if folder else Path(temporary)
        formats = FORMATS if folder else ("svg",)
        picture_folder.mkdir(parents=True, exist_ok=True)
        for picture in PICTURES:
            axes = picture.axes(run)
            picture.draw(run, axes)
            plots.save(axes, *(picture_folder / f"{picture.name}.{ending}" for ending in formats))
            yield picture, _picture_html(axes, picture_folder / f"{picture.name}.svg", picture.name)


def inline(draw: Callable[[Axes], object], size: tuple[float, float]) -> Markup:
    """Draw a picture for a notebook without saving it.

    Args:
        draw: Function that draws on an Axes.
        size: Width and height [inches].
    """
    axes = offscreen_axes(*size)
    draw(axes)
    with TemporaryDirectory() as temporary:
        path = Path(temporary) / "picture.svg"
        plots.save(axes, path)
        return _picture_html(axes, path, f"p{crc32(path.read_bytes()):08x}")


def _picture_html(axes: Axes, svg: Path, name: str) -> Markup:
    """Return the HTML of a saved picture: SVG, whose text can be searched, or PNG if the SVG is too large.

    Args:
        axes: Axes of the picture.
        svg: Saved SVG file.
        name: Prefix of the identifiers in the SVG, unique on the page.
    """
    alt = plots.alt_text(axes)
    text = svg.read_text(encoding="utf-8")
    if len(text) <= MAX_SVG_SIZE:
        return inline_svg(text, name, alt)
    png = svg.with_suffix(".png")
    plots.save(axes, png)
    return image_html("image/png", png.read_bytes(), alt)
