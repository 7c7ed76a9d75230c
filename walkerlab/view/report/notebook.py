"""A run as a notebook shows it: a sentence, the curve, the champion, and what to do next."""

from pathlib import Path

import pandas as pd

from walkerlab.runfile.records import champion
from walkerlab.settings.settings import Settings
from walkerlab.system import files
from walkerlab.text.html import Html, join, shown, tag
from walkerlab.view import plots, summary
from walkerlab.view.report.pictures import inline

NEXT = (
    ("run.champion", "the fittest robot, and its gene"),
    ("run.replay()", "watch it walk, in 3D"),
    ("run.confirm()", "is it good, or was it lucky?"),
    ("run.records", "the table of all robots, a row for each in each generation"),
    ('run.save_report("folder")', "every picture and table, and a page to hand in"),
)
"""What may be done with a run, and why one would."""


def panel(settings: Settings, records: pd.DataFrame, path: Path | None) -> str:
    """Write what stands below a cell that ends in a run.

    Args:
        settings: of the run.
        records: its table, which may be empty.
        path: its run file, or None.
    """
    said = tag("p", tag("strong", summary.describe_result(records, settings.model_dump())))
    if records.empty:
        return shown(said)
    best = champion(records)
    curve = inline(lambda ax: plots.fitness_curve(records, ax), (6.0, 3.4))
    body = inline(lambda ax: plots.body(best.genome, ax, settings), (6.0, 3.4))
    caption = "The champion" if best.verdict == "ok" else f"Robot {best.individual}, whose walk does not count"
    kept = tag("p", "It is kept in ", tag("code", files.shown(path)), ".") if path else Html("")
    return shown(said, kept, tag("div", _figure(curve, "Fitness"), _figure(body, caption), class_="pictures"), _next())


def _figure(picture: Html, caption: str) -> Html:
    return tag("figure", picture, tag("figcaption", caption))


def _next() -> Html:
    items = (tag("li", tag("code", code), " – ", about) for code, about in NEXT)
    return join(tag("p", "What next? If this run is called ", tag("code", "run"), ":"), tag("ul", *items))
