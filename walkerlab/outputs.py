"""What a run leaves in its folder, beside the run file: a report, a replay, and the champion to take elsewhere."""

from pathlib import Path

from walkerlab import plots, report
from walkerlab.export import export_mjcf
from walkerlab.plots.look import paper
from walkerlab.report.page import NAME
from walkerlab.run import Run
from walkerlab.store import RUN_FILE

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
    """Say whether all is there beside a run file, and of the run as it is now; the report comes last."""
    whole = all((path.parent / name).exists() for name in FILES.keys() - {RUN_FILE})
    return whole and (path.parent / NAME).stat().st_mtime_ns >= path.stat().st_mtime_ns


def write(run: Run, folder: Path) -> None:
    """Write all but the run file, which is there already, anew; the report comes last.

    Raises:
        OSError: if a file cannot be written.
    """
    for name in FILES.keys() - {RUN_FILE}:
        (folder / name).unlink(missing_ok=True)  # also what points elsewhere
    best = run.champion.genome
    plots.save(plots.fitness_curve(run.records, paper(8, 4)), folder / "fitness.svg", folder / "fitness.png")
    plots.save(plots.stride(best, run.settings, paper(9, 3)), folder / "champion.png")
    (folder / "champion.txt").write_text(f"{best}\n", encoding="utf-8")
    export_mjcf(best, run.settings, folder, name="champion")
    report.save(run.settings, run.records, folder, run.path, files=False)
