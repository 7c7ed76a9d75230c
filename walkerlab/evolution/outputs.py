"""What a run leaves in its folder, beside the run file: a report, a replay, and the champion to take elsewhere."""

from pathlib import Path

from walkerlab.evolution.run import Run
from walkerlab.runfile.store import RUN_FILE
from walkerlab.simulation.export import export_mjcf
from walkerlab.system.file_sets import replacing_files
from walkerlab.system.files import folder_path, write_text
from walkerlab.view import plots, report
from walkerlab.view.plots.appearance import paper
from walkerlab.view.report.page import REPORT_FILE

FILES = {
    "report.html": "start here: what happened, in pictures and words; a page that stands alone",
    "replay.html": "the champion walking, in 3D, in any browser",
    RUN_FILE: "the whole run; walkerlab can show it, and go on with it",
    "records.csv": "a row for every robot and generation, for a spreadsheet or pandas",
    "fitness.svg": "the fitness curve, for a report",
    "fitness.png": "the same as a picture",
    "champion.png": "the champion, caught in its stride",
    "champion.txt": "the champion's gene, as text that can be edited",
    "champion.xml": "its body, world and gait as MJCF, for MuJoCo 3.9 to 3.17 without walkerlab",
}
"""Each file and what it is."""


def are_there(path: Path) -> bool:
    """Tell whether all output files are beside a run file, and of its present state."""
    names = FILES.keys() - {RUN_FILE}
    return all((path.parent / name).exists() for name in names) and _is_current(path.parent / REPORT_FILE, path)


def _is_current(file: Path, run_file: Path) -> bool:
    return file.stat().st_mtime_ns >= run_file.stat().st_mtime_ns


def write(run: Run, folder: Path) -> None:
    """Replace all output files of a run, but not the run file.

    The old files stay until all new ones are written. If one part fails, the others are made nevertheless, and the
    error names it; a file of it that is up to date stays, and beside one that is outdated nothing changes.

    Raises:
        ValueError: If no generation is done yet.
        OutputError: If a file cannot be made or written.
    """
    folder, best, path = folder_path(folder), run.champion.genome, run.path
    own = path if path and path.is_file() and folder.is_dir() and path.parent.samefile(folder) else None
    with replacing_files(folder, lambda file: own is not None and _is_current(file, own)) as new:
        place = new.folder
        with new.part("fitness.svg", "fitness.png"):
            plots.save(plots.fitness_curve(run.records, paper(8, 4)), place / "fitness.svg", place / "fitness.png")
        with new.part("champion.png"):
            plots.save(plots.stride(best, run.settings, paper(9, 3)), place / "champion.png")
        with new.part("champion.txt"):
            write_text(place / "champion.txt", f"{best}\n")
        with new.part("champion.xml"):
            export_mjcf(best, run.settings, place, name="champion")
        report.write_report(new, run.settings, run.records, path, files=False)
