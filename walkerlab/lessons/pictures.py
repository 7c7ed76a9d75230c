"""Script that draws the pictures of the index of the lessons, one for each lesson.

    python -m walkerlab.lessons.pictures notebooks/pictures [NAME ...]

It requires Playwright and Chromium, and takes about a minute. Without names, all pictures are drawn. They show saved
runs, except that of lesson 10, for which a small run is evolved.
"""

import argparse
import io
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from walkerlab.analysis.landscape import landscape
from walkerlab.analysis.selection import selection_probabilities
from walkerlab.evolution.births import explain_birth
from walkerlab.evolution.running import evolve
from walkerlab.ga.genes import Floats
from walkerlab.ga.selection import tournament
from walkerlab.genome.breeding import generate_robot_population
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.lessons import broken
from walkerlab.lessons.saved_results import saved_results
from walkerlab.lessons.saved_runs import RUN_CHANGES, saved_champion, saved_run
from walkerlab.settings.choices import Guard
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.simulation.rollout import simulate
from walkerlab.system.files import replace_atomically
from walkerlab.text.templates import Markup, render
from walkerlab.view import plots, sketch
from walkerlab.view.plots.appearance import offscreen_axes
from walkerlab.view.sketch.births import draw_birth
from walkerlab.view.sketch.svg import make_element, write_image
from walkerlab.view.sketch.walks import draw_walk
from walkerlab.view.snapshots import svg_image_html
from walkerlab.world.scene import compile_scene

SIZE = (480, 270)  # pixels, twice the size in the index
PLOT_SIZE = (4.8, 2.7)  # inches
LANE_SHARE = 0.2  # width of a robot in a race, as a share of the picture
BAR_MARGIN = 12  # pixels
BAR_COLOUR = "#0072b2"
N_COLOURS = 64  # of a picture, few for a small file


@dataclass(frozen=True)
class Picture:
    """A picture, made of drawings in rows.

    Attributes:
        drawings: Images, row by row.
        n_columns: Number of drawings in a row.
        left: Distance of each drawing from the left edge [% of the width], for a race; empty if they fill their places.
        width: Width of each drawing of a race [% of the width].
        code: Code that is shown instead of drawings.
    """

    drawings: Sequence[Markup] = ()
    n_columns: int = 1
    left: Sequence[float] = ()
    width: float = 100
    code: str = ""


def draw_pictures(folder: Path, names: Sequence[str] = ()) -> list[Path]:
    """Draw pictures and write them as PNG; return the files written.

    Args:
        folder: Folder of the files; created if it is missing.
        names: Names in ``PICTURES``; all if empty.
    """
    from playwright.sync_api import sync_playwright

    folder.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
        for name in names or PICTURES:
            picture = PICTURES[name]()
            page.set_content(render("lessons/picture.html", picture=picture), wait_until="load")
            image = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
            files.append(folder / f"{name}.png")
            with replace_atomically(files[-1]) as temporary:
                image.quantize(N_COLOURS, dither=Image.Dither.NONE).save(temporary, "PNG", optimize=True)
        browser.close()
    return files


def _plot(draw: Callable[..., Any], data: Any, size: tuple[float, float] = PLOT_SIZE) -> Markup:
    """Return a plot without its texts, which would be too small to read."""
    axes = draw(data, offscreen_axes(*size))
    figure: Any = axes.get_figure(root=True)
    for each in figure.axes:
        each.set(xticks=[], yticks=[])
    for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")):
        text.set_visible(False)
    for legend in filter(None, (each.get_legend() for each in figure.axes)):
        legend.remove()
    file = io.StringIO()
    figure.savefig(file, format="svg", bbox_inches="tight", pad_inches=0.1)
    return svg_image_html(file.getvalue(), "plot")


def _draw_walk(genome: Genome, settings: Settings, size: tuple[float, float] = SIZE) -> Markup:
    return svg_image_html(
        draw_walk(compile_scene(genome, settings), simulate(genome, settings), size=size, moves=False)
    )


def _draw_champion() -> Picture:
    run = saved_run("flat")
    return Picture([_draw_walk(run.champion.genome, run.settings)])


def _draw_random_robots(n: int, n_columns: int, seed: int) -> Picture:
    robot = Robot(segments=(1, 5), legs=(2, 10))
    genomes = map(Genome, generate_robot_population(robot, n, seed=seed))
    size = (SIZE[0] / n_columns, SIZE[1] / (n // n_columns))
    return Picture([svg_image_html(sketch.draw_robot(each, robot, size=size)) for each in genomes], n_columns)


def _draw_grounds() -> Picture:
    runs = map(saved_run, ("stairs", "gravel", "ice", "moon"))
    size = (0.8 * SIZE[0], 0.8 * SIZE[1])  # shrunk to half the picture's size, so that the labels fit
    return Picture([_draw_walk(run.champion.genome, run.settings, size) for run in runs], 2)


def _draw_wheels() -> Picture:
    fitness = np.linspace(0, 1, 12)
    tables = [selection_probabilities(fitness, partial(tournament, size=size)) for size in (2, 4)]
    return Picture([_plot(plots.roulette_wheel, table, (3, 3)) for table in tables], 2)


def _draw_crossover() -> Picture:
    run = saved_run("flat")
    births = run.records[run.records.parents.str.contains(" ")]
    birth = explain_birth(run, int(births.individual.iloc[-1]))
    return Picture([svg_image_html(each) for each in draw_birth(birth, size=(240, 130))], 2)


def _draw_landscape() -> Picture:
    run = saved_run("flat")
    return Picture([_plot(plots.landscape, landscape(run.champion, run.settings, ["frequency", "lag"], n=16))])


def _draw_curve() -> Picture:
    return Picture([_plot(plots.fitness_curve, saved_run("flat"))])


def _draw_results() -> Picture:
    return Picture([_plot(plots.best_of_each_run, saved_results().assign(generation=0, verdict="ok"))])


def _draw_code() -> Picture:
    lines = ["def nudge(genomes, genes, *, rng):", "    steps = rng.normal(", "        size=genomes.shape)"]
    return Picture(code="\n".join([*lines, "    return genomes + 0.1 * steps"]))


def _draw_suspects() -> Picture:
    """Draw what each operator of lesson 09 does, as bars: chances by rank, or genes changed, or shares of a parent."""
    rng = np.random.default_rng(0)
    fitness = np.linspace(-1, 1, 12)
    robot = Robot()
    genes = build_genes(robot)
    genomes = generate_robot_population(robot, 12, seed=0)
    selections = (broken.operator_a, broken.operator_d, broken.operator_f)
    mutations = (broken.operator_b, broken.operator_e)
    bars: list[Any] = [
        *(selection_probabilities(fitness, each).sort_values("rank").probability for each in selections),
        *((each(genomes, genes, rng=rng) != genomes).sum(axis=0) for each in mutations),
    ]
    children = broken.operator_c(genomes, fitness, 12, rng=rng)
    less_fit, fitter = genomes[children.parents.T]
    bars.append(np.abs(children.genomes - less_fit).sum(axis=1) / np.abs(fitter - less_fit).sum(axis=1))
    return Picture([svg_image_html(_draw_bars(np.asarray(each, dtype=float))) for each in bars], 3)


def _draw_bars(heights: Floats) -> str:
    """Draw bars, the highest of which fills the height, as SVG."""
    width, height = SIZE[0] / 3, SIZE[1] / 2
    step = (width - 2 * BAR_MARGIN) / len(heights)
    highest = height - 2 * BAR_MARGIN
    bars = [
        make_element(
            "rect",
            x=BAR_MARGIN + i * step,
            y=BAR_MARGIN + highest * (1 - share),
            width=0.8 * step,
            height=highest * share,
            fill=BAR_COLOUR,
        )
        for i, share in enumerate((heights / heights.max()).tolist())
    ]
    return write_image((width, height), "bars", *bars)


def _draw_cheat() -> Picture:
    guards = [guard.name for guard in Guard if guard.name != "none"]
    settings = Settings().with_(texture="ice", wind=(15, 0, 0), forgive=guards, population_size=24, duration=4)
    run = evolve(settings.with_(generations=10), progress=False)
    return Picture([_draw_walk(run.champion.genome, settings)])


def _draw_tournament() -> Picture:
    genomes = [saved_champion(name).genome for name in RUN_CHANGES]
    distances = [simulate(genome, Settings(), poses=False).distance for genome in genomes]
    order = np.argsort(distances)[::-1]
    size = (LANE_SHARE * SIZE[0], SIZE[1] / len(genomes))
    drawings = [svg_image_html(sketch.draw_robot(genomes[i], size=size)) for i in order]
    left = [100 * (1 - LANE_SHARE) * max(0.0, distances[i]) / max(distances) for i in order]
    return Picture(drawings, left=left, width=100 * LANE_SHARE)


PICTURES: dict[str, Callable[[], Picture]] = {
    "00_meet_a_walker": _draw_champion,
    "01_bodies_and_genes": partial(_draw_random_robots, 6, 3, seed=3),
    "02_the_ground": _draw_grounds,
    "03_selection": _draw_wheels,
    "04_crossover": _draw_crossover,
    "05_mutation": _draw_landscape,
    "06_evolve_and_watch": _draw_curve,
    "07_is_it_better": _draw_results,
    "08_your_own_operator": _draw_code,
    "09_broken_operators": _draw_suspects,
    "10_when_evolution_cheats": _draw_cheat,
    "11_class_tournament": _draw_tournament,
    "12_a_bigger_computer": partial(_draw_random_robots, 60, 10, seed=1),
}
"""Function that draws the picture of each lesson."""


def main() -> None:
    """Parse the arguments, draw the pictures and print their paths and sizes."""
    parser = argparse.ArgumentParser(
        description="Draw the pictures of the index of the lessons. Requires Playwright and Chromium."
    )
    parser.add_argument("folder", type=Path, help="folder of the PNG files; created if it is missing")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"pictures, such as {next(iter(PICTURES))} [all]")
    arguments = parser.parse_args()
    if unknown := set(arguments.names) - set(PICTURES):
        parser.error(f"there is no picture {sorted(unknown)[0]}; the pictures are {', '.join(PICTURES)}")
    for written in draw_pictures(arguments.folder, arguments.names):
        print(f"{written}: {written.stat().st_size} bytes")


if __name__ == "__main__":
    main()
