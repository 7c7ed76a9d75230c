"""What a run leaves in its folder, beside the run file: the table, the curve and the champion."""

from pathlib import Path

from matplotlib.figure import Figure

from walkerlab import plots
from walkerlab.evolution import Run
from walkerlab.export import export_mjcf
from walkerlab.store import RUN_FILE

FILES = {
    RUN_FILE: "the whole run; walkerlab can show it, and go on with it",
    "records.csv": "a row for every robot and generation, for a spreadsheet or pandas",
    "fitness.svg": "the fitness curve, for a report",
    "fitness.png": "the same as a picture",
    "champion.txt": "the champion's gene, as text that can be edited",
    "champion.png": "the champion, caught in its stride",
    "champion.xml": "its body and world as MJCF, for any MuJoCo (its gait is computed by walkerlab from the gene)",
}
"""Each file and what it is."""


def write(run: Run, folder: Path) -> None:
    """Write all but the run file, which is there already, anew.

    Raises:
        OSError: if a file cannot be written.
    """
    run.records.to_csv(folder / "records.csv", index=False)
    axes = Figure(figsize=(7.2, 4.0), layout="constrained").add_subplot()
    plots.save(plots.fitness_curve(run.records, axes), *(str(folder / f"fitness.{kind}") for kind in ("svg", "png")))
    axes = Figure(figsize=(9, 3), layout="constrained").add_subplot()
    plots.save(plots.stride(run.champion.genome, run.settings, axes), str(folder / "champion.png"))
    (folder / "champion.txt").write_text(f"{run.champion.genome}\n", encoding="utf-8")
    export_mjcf(run.champion.genome, run.settings, folder, name="champion")
