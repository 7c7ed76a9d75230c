"""The report of an experiment, and its display in a notebook."""

from pathlib import Path
from typing import Any

from walkerlab.experiment.conditions import Condition
from walkerlab.runfile import provenance
from walkerlab.settings.values import pluralize
from walkerlab.system.file_sets import replacing_files
from walkerlab.system.files import folder_path, write_text
from walkerlab.text.escape import escape_cell
from walkerlab.text.templates import render
from walkerlab.view import plots
from walkerlab.view.plots.comparison import draw_experiment, figure_html
from walkerlab.view.table_files import save_table

TERMS = (
    ("median", "half of the runs are better, half are worse"),
    ("95 % interval", "from draws of the seeds with replacement (bootstrap); with few seeds it tends to be too narrow"),
    ("threshold", "the fitness to reach; by default, the lowest median"),
    (
        "robots until then",
        "median over the runs; > means that at least half of them did not reach it with all their robots",
    ),
    ("seeds won", "number of seeds in which the first or the second condition is better"),
    ("A12", "probability that a run of the first condition is better than one of the second; 0.5 if they are equal"),
    ("p", "share of experiments with a result as clear as this, if there were no difference (signed-rank test)"),
    ("p, corrected", "the same, corrected for the number of comparisons (Holm); clear if it is below 0.05"),
    ("detectable", "true difference that would be found in four of five experiments with as many seeds"),
)


CAPTION = (
    "Left: the best fitness found up to each generation. Each line is the median of the runs of a condition, and the "
    "area around it contains the middle half of these runs. Right: the best fitness of each run. Thin lines connect "
    "runs with the same seed, and a thick line marks the median of each condition."
)


def experiment_html(experiment: Any) -> str:
    """Return an experiment as a notebook shows it."""
    figure = draw_experiment(experiment.records, experiment.compared, on_screen=False)
    picture = "" if experiment.records.empty else figure_html(figure)
    return render(
        "experiment/experiment.html",
        summary=experiment.summary().to_html(),
        picture=picture,
        caption=CAPTION,
        status=experiment.status,
    )


def save_report(experiment: Any, folder: str | Path) -> Path:
    """Write the report of an experiment; see ``Experiment.report``."""
    folder = folder_path(folder)
    summary = experiment.summary()
    if not summary.n_seeds:
        raise ValueError(f"there is nothing to report yet: {summary.text}")
    records = experiment.records
    with replacing_files(folder) as new:
        with new.write_part("records.csv"):
            save_table(records, new.folder / "records.csv")
        with new.write_part("tables/conditions.csv", "tables/comparisons.csv"):
            conditions = summary.conditions.assign(condition=summary.conditions.condition.map(escape_cell))
            conditions.to_csv(new.folder / "tables/conditions.csv", index=False)
            summary.comparisons.to_csv(new.folder / "tables/comparisons.csv", index=False)
        pictures = [f"pictures/experiment.{ending}" for ending in ("svg", "pdf", "png")]
        with new.write_part("report.html", *pictures):
            figure = draw_experiment(records, experiment.compared, on_screen=False)
            plots.save(figure.axes[0], *(new.folder / name for name in pictures))
            page = render(
                "experiment/report.html",
                title=f"Experiment with {len(experiment.conditions)} conditions and {summary.n_seeds} seeds",
                summary=summary.to_html(),
                status=experiment.status,
                pictures=[figure_html(figure)],
                caption=CAPTION,
                terms=TERMS,
                conditions=[(one.name, _notes(one), one.settings.as_python()) for one in experiment.plan],
                seeds=", ".join(map(str, experiment.complete_seeds)),
                versions=provenance.current_facts().items(),
            )
            write_text(new.folder / "report.html", page)
    return folder / "report.html"


def _notes(condition: Condition) -> list[str]:
    """Return sentences with the facts about a condition that its settings do not contain."""
    notes: list[str] = []
    if condition.optimiser:
        notes.append(f"The optimiser {condition.optimiser} replaces the genetic algorithm.")
    if condition.founders:
        n = len(condition.founders)
        first = f": {condition.founders[0].genome:.300}" if n == 1 else ", which are in the run file"
        notes.append(f"Generation 0 begins with {pluralize(n, 'given genome')}{first}.")
    return notes
