"""Output files of a run, beside the run file: a report, a replay, the table, and the champion for other programs."""

from pathlib import Path

from walkerlab.evolution.run import Run
from walkerlab.runfile.paths import RUN_FILE
from walkerlab.simulation.export import export_mjcf
from walkerlab.system.file_sets import replacing_files
from walkerlab.system.files import folder_path, write_text
from walkerlab.view import plots, report
from walkerlab.view.pages import write_page
from walkerlab.view.playground.page import build_page, prepare_walks
from walkerlab.view.plots.appearance import offscreen_axes
from walkerlab.view.report.page import REPORT_FILE

OUTPUT_FILES = {
    "report.html": "start here: the report of the run, with pictures and text; a self-contained page",
    "replay.html": "the champion walking, in 3D, in any browser",
    "champion.html": "the champion walking live, in any browser: change its genes and its world, and push it",
    RUN_FILE: "the complete run; walkerlab can show and resume it",
    "records.csv": "one row for each robot and generation, for a spreadsheet or pandas",
    "fitness.svg": "the fitness curve, as vector graphics",
    "fitness.png": "the fitness curve, as an image",
    "champion.png": "the champion during one stride",
    "champion.txt": "the genome of the champion, as text that can be edited",
    "champion.xml": "the body, world and gait of the champion as MJCF, for MuJoCo 3.9 to 3.17 without walkerlab",
}
"""Description of each file."""


def are_there(path: Path) -> bool:
    """Return whether all output files are beside a run file, and are up to date."""
    names = OUTPUT_FILES.keys() - {RUN_FILE}
    return all((path.parent / name).exists() for name in names) and _is_current(path.parent / REPORT_FILE, path)


def _is_current(file: Path, run_file: Path) -> bool:
    return file.stat().st_mtime_ns >= run_file.stat().st_mtime_ns


def write_outputs(run: Run, folder: Path) -> None:
    """Replace all output files of a run, except the run file.

    The old files stay until all new ones are written. If a part cannot be created, the others are still written, and
    the error names it. An old file of that part stays if it is up to date; if it is outdated, all old files stay.

    Args:
        run: Run with at least one generation.
        folder: Folder of the output files; created if it does not exist.

    Raises:
        ValueError: If no generation is complete yet.
        OutputError: If a file cannot be created or written.
    """
    folder = folder_path(folder)
    path = run.path
    best = run.champion.genome
    run_file = path if path and path.is_file() and folder.is_dir() and path.parent.samefile(folder) else None
    with replacing_files(folder, lambda file: run_file is not None and _is_current(file, run_file)) as new:
        with new.write_part("fitness.svg", "fitness.png"):
            plots.save(
                plots.fitness_curve(run.records, offscreen_axes(8, 4)),
                new.folder / "fitness.svg",
                new.folder / "fitness.png",
            )
        with new.write_part("champion.png"):
            plots.save(plots.stride(best, run.settings, offscreen_axes(9, 3)), new.folder / "champion.png")
        with new.write_part("champion.txt"):
            write_text(new.folder / "champion.txt", f"{best}\n")
        with new.write_part("champion.xml"):
            export_mjcf(best, run.settings, new.folder, name="champion")
        with new.write_part("champion.html"):
            walks = prepare_walks(run.champion, run.settings)
            write_page(lambda: build_page(walks, run.settings), new.folder / "champion.html")
        report.write_report(new, run.settings, run.records, path, files=False)
