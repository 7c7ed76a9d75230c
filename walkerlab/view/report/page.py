"""The report of a run: a self-contained page, with the pictures and tables as files in the same folder."""

import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import pandas as pd

from walkerlab.genome.display import genome_html
from walkerlab.runfile import provenance, store
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.records import RECORD_COLUMNS, birth_rows, find_champion
from walkerlab.settings.choices import Structure
from walkerlab.settings.glossary import glossary, glossary_rows
from walkerlab.settings.settings import Settings
from walkerlab.simulation.robustness import confirm
from walkerlab.simulation.rollout import Rollout
from walkerlab.system.file_sets import NewFiles, replacing_files
from walkerlab.system.files import folder_path, replace_atomically, write_text
from walkerlab.text.html import Html, code, details, escape_cell, facts, join, standalone_page, table, tag
from walkerlab.text.numbers import format_significant, with_unit
from walkerlab.view import summary
from walkerlab.view.replay import replay
from walkerlab.view.report.code import STEPS, as_python, user_functions
from walkerlab.view.report.pictures import FOLDER, FORMATS, PICTURES, Picture, Subject, draw_all

HERE = Path(__file__).parent
REPORT_FILE = "report.html"
REPLAY_FILE = "replay.html"
RECORDS_FILE = "records.csv"
TABLE_FOLDER = "tables"
GENERATIONS_FILE = f"{TABLE_FOLDER}/generations.csv"
WALK_FILE = f"{TABLE_FOLDER}/champion.csv"
FILE_NOTE = (
    f"The folder {FOLDER} contains each picture as SVG, PDF and PNG; the folder {TABLE_FOLDER} contains a table of the "
    "generations and a table of the champion's walk over time."
)
NO_FILE_NOTE = "To save each picture as SVG, PDF and PNG and more tables, call run.save_report(folder)."

GROUND_NAMES = {
    Structure.flat: "flat ground",
    Structure.incline: "a slope",
    Structure.stairs: "stairs",
    Structure.rough: "hills",
    Structure.gaps: "ground with trenches",
}

ALGORITHM = (
    "The first generation consists of {} random robots. Each robot walks and gets a fitness. The best ({}) are copied "
    "unchanged into the next generation. All others are replaced by children: selection chooses the parents, crossover "
    "combines their genes, and mutation changes some of them. This is repeated for each generation."
)

GLOSSARY = {
    "individual, or robot": "a body with its gait, as described by its genome.",
    "genome": "all numbers that a robot inherits, including those of segments that are not expressed.",
    "gene": "one number of a genome.",
    "generation": "all robots of the population at one step of the evolution. Generation 0 is random.",
    "fitness": "the number by which robots are compared when parents are selected; higher is better.",
    "elite": "one of the best robots, which is copied unchanged into the next generation.",
    "selection": "the choice of the parents.",
    "crossover": "the combination of the parents' genes.",
    "mutation": "random changes to the genes of children.",
    "verdict": "whether a walk counts, and if not, which rule it breaks.",
    "median": "the value in the middle: half of the robots are better, half are worse.",
}


def save_report(
    settings: Settings, records: pd.DataFrame, folder: str | Path, path: Path | None = None, *, files: bool = True
) -> Path:
    """Write the report of a run: ``report.html``, ``replay.html``, ``records.csv``, and folders of pictures and tables.

    An earlier report in the folder is replaced as a whole, after all files of the new one are written.

    Args:
        settings: Settings of the run.
        records: Table of the run.
        folder: Folder to write to; created if it does not exist.
        path: Run file, which contains the versions that the run was made with; the current versions are reported if
            None.
        files: Whether to write the folders of pictures and tables; the page does not depend on them.

    Returns:
        The path of the page.

    Raises:
        ValueError: If no generation is done yet.
        OSError: If a file cannot be made; the others are made nevertheless (see ``replacing_files``).
    """
    folder = folder_path(folder)
    find_champion(records)  # raises ValueError before any file is touched
    with replacing_files(folder) as new:
        write_report(new, settings, records, path, files=files)
    return folder / REPORT_FILE


def write_report(
    new: NewFiles, settings: Settings, records: pd.DataFrame, path: Path | None = None, *, files: bool = True
) -> None:
    """Write the report as part of a set of new files; the other arguments are those of ``save_report``."""
    with new.write_part(RECORDS_FILE):
        _write_csv(_escape_formulas(records), new.folder / RECORDS_FILE)
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
    settings = run.settings
    figures = {
        picture.name: _figure(picture, drawn, files) for picture, drawn in draw_all(run, folder if files else None)
    }
    sections = {
        "Summary": _summary_section(run, figures),
        "Settings": _settings_section(settings),
        "Results": _results_section(run, figures, files),
        "Champion": _champion_section(run, figures),
        "Line of descent": _descent_section(run, figures),
        "Repeat the run": _repeat_section(run, _versions(path), files),
        "Glossary": facts("Terms used on this page", GLOSSARY.items()),
    }
    anchors = {title: title.lower().replace(" ", "-") for title in sections}
    links = (tag("a", title, href=f"#{anchor}") for title, anchor in anchors.items())
    parts = (tag("section", tag("h2", title), content, id=anchors[title]) for title, content in sections.items())
    style = (HERE / "report.css").read_text(encoding="utf-8")
    title = f"Walkers evolved on {_terrain_name(settings)}"
    return standalone_page(title, style, tag("h1", title), tag("nav", *links, aria_label="Contents"), *parts)


def _escape_formulas(records: pd.DataFrame) -> pd.DataFrame:
    """Escape all texts that a spreadsheet would execute as formulas; the table may come from another person."""
    text_columns = [name for name, (kind, *_) in RECORD_COLUMNS.items() if kind is str]
    return records.assign(**{name: records[name].map(escape_cell, na_action="ignore") for name in text_columns})


def _terrain_name(settings: Settings) -> str:
    terrain = settings.terrain
    obstacles = f" with {re.split('[,:]', terrain.obstacle.about)[0]}" if terrain.obstacle else ""
    return f"{GROUND_NAMES[terrain.structure]} of {terrain.texture.name}{obstacles}"


def _figure(picture: Picture, drawn: Html, files: bool) -> Html:
    """Return a picture with its title, its explanation and links to its files, if any."""
    links = (join(" ", tag("a", ending.upper(), href=f"{FOLDER}/{picture.name}.{ending}")) for ending in FORMATS)
    file_links = tag("span", *links, class_="files") if files else ""
    caption = tag("figcaption", tag("b", picture.title, ". "), picture.explanation, file_links)
    return tag("figure", tag("div", drawn, class_="card"), caption)


def _summary_section(run: Subject, figures: Mapping[str, Html]) -> Html:
    plain = run.settings.model_dump()
    born = birth_rows(run.records)
    row: Any = born.loc[run.champion.individual]
    numbers: list[tuple[str, str]] = []
    if run.champion.verdict == "ok":
        relative_speed = format_significant(row.velocity / row.body_length)
        numbers += [
            (with_unit(row.distance, "m"), f"forward in {run.settings.simulation.duration:g} s"),
            (with_unit(row.velocity, "m/s"), f"over the last two thirds: {relative_speed} body lengths a second"),
        ]
    numbers += [
        (f"{len(born)}", "robots walked"),
        (f"{(born.verdict == 'ok').mean():.0%}", "of the walks count"),
    ]
    cards = (tag("div", tag("b", number), tag("span", about)) for number, about in numbers)
    return join(
        tag("p", summary.describe_result(run.records, plain), class_="lead"),
        tag("div", *cards, class_="numbers"),
        tag("p", tag("a", "Watch the walk in 3D", href=REPLAY_FILE, class_="watch")),
        figures["champion"],
        tag("p", summary.describe_champion(run.records, plain)),
    )


def _settings_section(settings: Settings) -> Html:
    algorithm = {row.name: row for row in glossary_rows(settings.algorithm)}
    steps = [[name, algorithm[name].value, algorithm[name].choice] for name in STEPS]
    return join(
        tag("p", ALGORITHM.format(algorithm["population_size"].value, algorithm["n_elites"].value)),
        table("Steps of the algorithm", ["step", "setting", "meaning"], steps),
        *(glossary(domain) for _, domain in settings),
    )


def _results_section(run: Subject, figures: Mapping[str, Html], files: bool) -> Html:
    generations = summary.select_generations(int(run.records.generation.max()))
    unit = run.records.attrs.get("units", {}).get("fitness", "")
    columns = [
        "generation",
        *(f"{name}{f' [{unit}]' if unit else ''}" for name in ("best", "median")),
        "counted",
        "robots",
    ]
    rows = [
        [row.generation, best, median, row.counted, row.robots]
        for row, best, median in summary.format_generations(run.records, generations)
    ]
    verdicts = [[verdict, n, meaning] for verdict, n, meaning in summary.count_verdicts(run.records)]
    link = tag("a", GENERATIONS_FILE, href=GENERATIONS_FILE)
    file_note = tag("p", "All generations, with quartiles, are in ", link, ".") if files else ""
    traits = (figures[name] for name in ("weight", "body_length", "n_segments", "n_legs"))
    return join(
        figures["fitness"],
        details(
            "The same as a table",
            table("Fitness of the walks that count", columns, rows, numbers=range(5)),
            file_note,
        ),
        tag("div", figures["diversity"], figures["verdicts"], class_="pair"),
        table("Verdicts; each walk is counted once", ["verdict", "walks", "meaning"], verdicts, numbers=(1,)),
        tag("h3", "How the bodies changed"),
        tag(
            "p",
            "A trait that becomes constant early was fixed by selection or by chance. A trait that keeps changing has "
            "little effect on fitness.",
        ),
        tag("div", *traits, class_="pair"),
        figures["genes"],
    )


def _champion_section(run: Subject, figures: Mapping[str, Html]) -> Html:
    return join(
        figures["body"],
        genome_html(run.champion.genome.values),
        figures["gait"],
        figures["distance"],
        _confirmation_table(run),
    )


def _confirmation_table(run: Subject) -> Html:
    """Return how much of the champion's fitness remains when it walks again; empty if its fitness is not known."""
    if run.champion.verdict != "ok":
        return Html("")
    with suppress(RunFileError):  # a loaded run knows only the name of a user function
        return confirm(run.champion.genome, run.settings).table()
    return Html("")


def _descent_section(run: Subject, figures: Mapping[str, Html]) -> Html:
    rows = [
        ["…", f"{n_skipped} more", "", ""] if n_skipped else [birth.individual, birth.born, fitness, birth.operators]
        for birth, fitness, n_skipped in summary.format_descent(run.records, run.champion.individual)
    ]
    columns = ["robot", "generation", "fitness", "made by selection > crossover > mutation"]
    caption = "Line of descent of the champion, through the fitter parent of each robot"
    return join(figures["family"], table(caption, columns, rows, numbers=(1, 2)))


def _repeat_section(run: Subject, versions: Mapping[str, str], files: bool) -> Html:
    functions = user_functions(run.settings)
    note = f"Define these functions of yours before this code: {', '.join(functions)}." if functions else ""
    return join(
        tag("p", "With the same versions, this code gives exactly the same table, on any number of cores."),
        tag("p", note) if note else "",
        code(as_python(run.settings, run.records)),
        facts("Versions", versions.items()),
        tag(
            "p",
            "The table of all robots, one row for each robot in each generation, is in ",
            tag("a", RECORDS_FILE, href=RECORDS_FILE),
            ". ",
            FILE_NOTE if files else NO_FILE_NOTE,
        ),
    )


def _versions(path: Path | None) -> dict[str, str]:
    """Return the versions that the run was made with, from its run file, or else those of this machine."""
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
