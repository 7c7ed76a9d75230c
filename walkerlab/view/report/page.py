"""The report of a run: a self-contained page, with the pictures and tables as files in the same folder."""

from pathlib import Path
from typing import Any

import pandas as pd

from walkerlab.runfile import provenance, store
from walkerlab.runfile.records import find_champion
from walkerlab.settings.settings import Settings
from walkerlab.simulation.rollout import Rollout
from walkerlab.system.file_sets import NewFiles, replacing_files
from walkerlab.system.files import folder_path, replace_atomically, write_text
from walkerlab.text.templates import render
from walkerlab.view import summary
from walkerlab.view.replay import replay
from walkerlab.view.report.content import report_values
from walkerlab.view.report.pictures import FOLDER, FORMATS, PICTURES, Subject, draw_all
from walkerlab.view.table_files import save_table

REPORT_FILE = "report.html"
REPLAY_FILE = "replay.html"
RECORDS_FILE = "records.csv"
TABLE_FOLDER = "tables"
GENERATIONS_FILE = f"{TABLE_FOLDER}/generations.csv"
WALK_FILE = f"{TABLE_FOLDER}/champion.csv"


def save_report(
    settings: Settings, records: pd.DataFrame, folder: str | Path, path: Path | None = None, *, files: bool = True
) -> Path:
    """Write the report of a run: ``report.html``, ``replay.html``, ``records.csv``, and folders of pictures and tables.

    An earlier report in the folder is replaced as a whole, after all files of the new one are written.

    Args:
        settings: Settings of the run.
        records: Table of the run.
        folder: Folder to write to; created if it does not exist.
        path: Run file, from which the versions are reported; if None, the current versions are reported.
        files: Whether to write the folders of pictures and tables; the page does not depend on them.

    Returns:
        The path of the page.

    Raises:
        ValueError: If no generation is complete yet.
        OSError: If a file cannot be created; the others are still written (see ``replacing_files``).
    """
    folder = folder_path(folder)
    find_champion(records)  # raises ValueError before any file is touched
    with replacing_files(folder) as new:
        write_report(new, settings, records, path, files=files)
    return folder / REPORT_FILE


def write_report(
    new: NewFiles, settings: Settings, records: pd.DataFrame, path: Path | None = None, *, files: bool = True
) -> None:
    """Write the report as part of a set of new files; for the other arguments see ``save_report``."""
    with new.write_part(RECORDS_FILE):
        save_table(records, new.folder / RECORDS_FILE)
    if files:
        with new.write_part(GENERATIONS_FILE):
            _write_csv(summary.generation_statistics(records), new.folder / GENERATIONS_FILE)
    with new.write_part(REPLAY_FILE):
        replay(find_champion(records), settings).to_html(new.folder / REPLAY_FILE)
    picture_files = [f"{FOLDER}/{picture.name}.{ending}" for picture in PICTURES for ending in FORMATS]
    with new.write_part(REPORT_FILE, *([WALK_FILE, *picture_files] if files else [])):
        run = Subject.of(settings, records)
        if files:
            _write_csv(_walk_table(run.rollout), new.folder / WALK_FILE)
        write_text(new.folder / REPORT_FILE, _page(run, new.folder, path, files))


def _write_csv(frame: pd.DataFrame, path: Path) -> None:
    with replace_atomically(path) as part:
        frame.to_csv(part, index=False)


def _page(run: Subject, folder: Path, path: Path | None, files: bool) -> str:
    """Return the HTML of the page; save the pictures in the folder if ``files`` is true."""
    return render(
        "view/report/report.html",
        **report_values(run),
        pictures={picture.name: picture for picture in PICTURES},
        drawings={picture.name: drawing for picture, drawing in draw_all(run, folder if files else None)},
        versions=_versions(path),
        files=files,
        picture_folder=FOLDER,
        picture_formats=FORMATS,
        table_folder=TABLE_FOLDER,
        replay_file=REPLAY_FILE,
        records_file=RECORDS_FILE,
        generations_file=GENERATIONS_FILE,
    )


def _versions(path: Path | None) -> dict[str, str]:
    """Return the versions recorded in the run file, or the versions on this machine if there is no run file."""
    if path and path.exists():
        identity, versions = store.read_facts(path)
        return versions | identity
    return dict(provenance.current_facts())


def _walk_table(rollout: Rollout) -> pd.DataFrame:
    """Return a walk as a table, one row for each control step: times in s, lengths in m, work in J."""
    columns: dict[str, Any] = {"time": rollout.time, **dict(zip(("x", "y", "z"), rollout.com.T, strict=True))}
    columns |= {"on_ground": rollout.on_ground.astype(int), "sink": rollout.sink, "work": rollout.work}
    if rollout.load.size:
        columns |= dict(zip(("load_x", "load_y", "load_z"), rollout.load.T, strict=True))
    return pd.DataFrame(columns)
