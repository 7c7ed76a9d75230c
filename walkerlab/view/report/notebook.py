"""The display of a run in a notebook: a sentence, the fitness curve, the champion, and suggested next steps."""

from pathlib import Path

import pandas as pd

from walkerlab.runfile.records import find_champion
from walkerlab.settings.settings import Settings
from walkerlab.system import files
from walkerlab.text.html import Html, join, shown, tag
from walkerlab.view import plots, summary
from walkerlab.view.report.pictures import inline

PICTURE_SIZE = (6.0, 3.4)  # inches

NEXT_STEPS = (
    ("run.champion", "the fittest robot and its genome"),
    ("run.replay()", "its walk in 3D"),
    ("run.confirm()", "does its fitness depend on luck? It walks again from other starts"),
    ("run.records", "the table of all robots, one row for each robot in each generation"),
    ('run.save_report("folder")', "a report with all pictures and tables"),
)
"""Code to run next, and what it shows."""


def run_html(settings: Settings, records: pd.DataFrame, path: Path | None) -> str:
    """Return the HTML of a run that is the last value of a notebook cell.

    Args:
        settings: Settings of the run.
        records: Table of the run, which may be empty.
        path: Run file, or None.
    """
    headline = tag("p", tag("strong", summary.describe_result(records, settings.model_dump())))
    if records.empty:
        return shown(headline)
    best = find_champion(records)
    curve = inline(lambda ax: plots.fitness_curve(records, ax), PICTURE_SIZE)
    body = inline(lambda ax: plots.body(best.genome, ax, settings), PICTURE_SIZE)
    caption = "The champion" if best.verdict == "ok" else f"Robot {best.individual}, whose walk does not count"
    saved = tag("p", "The run is saved in ", tag("code", files.display_path(path)), ".") if path else Html("")
    pictures = tag("div", _figure(curve, "Fitness"), _figure(body, caption), class_="pictures")
    return shown(headline, saved, pictures, _next_steps())


def _figure(picture: Html, caption: str) -> Html:
    return tag("figure", picture, tag("figcaption", caption))


def _next_steps() -> Html:
    items = (tag("li", tag("code", code), " – ", about) for code, about in NEXT_STEPS)
    return join(tag("p", "Next steps, if the variable ", tag("code", "run"), " is this run:"), tag("ul", *items))
