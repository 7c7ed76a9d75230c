"""The display of a run in a notebook: a sentence, the fitness curve, the champion, and suggested next steps."""

from pathlib import Path

import pandas as pd

from walkerlab.runfile.records import find_champion
from walkerlab.settings.settings import Settings
from walkerlab.system import files
from walkerlab.text.templates import Markup, render
from walkerlab.view import plots, summary
from walkerlab.view.report.pictures import inline

PICTURE_SIZE = (6.0, 3.4)  # inches


def run_html(settings: Settings, records: pd.DataFrame, path: Path | None) -> str:
    """Return the HTML of a run that is the last value of a notebook cell.

    Args:
        settings: Settings of the run.
        records: Table of the run, which may be empty.
        path: Run file, or None.
    """
    pictures: list[tuple[Markup, str]] = []
    if not records.empty:
        best = find_champion(records)
        name = "The champion" if best.verdict == "ok" else f"Robot {best.individual}, whose walk does not count"
        pictures = [
            (inline(lambda ax: plots.fitness_curve(records, ax), PICTURE_SIZE), "Fitness"),
            (inline(lambda ax: plots.body(best.genome, ax, settings), PICTURE_SIZE), name),
        ]
    return render(
        "view/report/notebook.html",
        result=summary.describe_result(records, settings.model_dump()),
        pictures=pictures,
        path=files.display_path(path) if path else "",
    )
