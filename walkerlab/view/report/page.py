"""The report of a run: a page that stands alone, and the pictures and tables beside it."""

import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import pandas as pd

from walkerlab.genome import genome
from walkerlab.runfile import provenance, store
from walkerlab.runfile.records import COLUMNS, births, champion
from walkerlab.runfile.store import RunFileError
from walkerlab.settings.choices import Structure
from walkerlab.settings.glossary import glossary, rows_of
from walkerlab.settings.settings import Settings
from walkerlab.simulation.robustness import confirm
from walkerlab.simulation.rollout import Rollout
from walkerlab.system.file_sets import NewFiles, replacing_files
from walkerlab.system.files import folder_path, replacing, write_text
from walkerlab.text.html import Html, cell, code, details, facts, join, page, table, tag
from walkerlab.text.numbers import significant, with_unit
from walkerlab.view import summary
from walkerlab.view.replay import replay
from walkerlab.view.report.code import STEPS, as_python, own_functions
from walkerlab.view.report.pictures import FOLDER, KINDS, PICTURES, Picture, Subject, draw_all

HERE = Path(__file__).parent
NAME = "report.html"
REPLAY = "replay.html"
TABLES = "tables"
ROWS = ", a row for every robot and generation. "
FILES = (
    f"In {FOLDER} is each picture as SVG, PDF and PNG; in {TABLES}, the generations and the champion's walk over time."
)
MORE = "Every picture as SVG, PDF and PNG, and more tables, are written by run.save_report(folder)."

GROUNDS = {
    Structure.flat: "flat ground",
    Structure.incline: "a slope",
    Structure.stairs: "stairs",
    Structure.rough: "hills",
    Structure.gaps: "ground with trenches",
}

ROUND = (
    "{} robots are drawn by chance. Each walks, and gets a fitness. The best ({}) live on as they are; the others make "
    "room for children: selection chooses their parents, crossover combines these, mutation varies the outcome. "
    "And so on, generation after generation."
)

WORDS = {
    "individual, or robot": "one body with its gait, as its genome describes it.",
    "genome": "all the numbers that a robot inherits, also those of segments that it has not grown.",
    "generation": "as many robots as the population has. Generation 0 is drawn by chance.",
    "fitness": "what is compared when parents are chosen: higher is better.",
    "elite": "one of the best, which lives on unchanged into the next generation.",
    "selection, crossover, mutation": "who becomes a parent; how parents' genes are combined; how children then vary.",
    "verdict": "whether a walk counts; if not, why not.",
    "median": "the one in the middle: half are better, half are poorer.",
}


def save(
    settings: Settings, records: pd.DataFrame, folder: str | Path, path: Path | None = None, *, files: bool = True
) -> Path:
    """Write the report of a run: ``report.html``, ``replay.html``, ``records.csv``, and folders of pictures and tables.

    An earlier report in the folder is replaced as a whole, once all files of the new one are written.

    Args:
        settings: of the run.
        records: its tidy table.
        folder: where to write; made if need be.
        path: its run file, which knows the versions that it was made with.
        files: whether to write the folders too; the page stands alone.

    Returns:
        The path of the page.

    Raises:
        ValueError: if no generation is done yet.
        OSError: if a file cannot be made; the others are made nevertheless (see ``fileset``).
    """
    folder = folder_path(folder)
    champion(records)  # or there is nothing to report
    with replacing_files(folder) as new:
        write(new, settings, records, path, files=files)
    return folder / NAME


def write(
    new: NewFiles, settings: Settings, records: pd.DataFrame, path: Path | None = None, *, files: bool = True
) -> None:
    """Write the report among the new files of a folder; the arguments are those of ``save``."""
    with new.part("records.csv"):
        _write_csv(_for_spreadsheets(records), new.folder / "records.csv")
    if files:
        with new.part(f"{TABLES}/generations.csv"):
            _write_csv(summary.generations(records), new.folder / TABLES / "generations.csv")
    with new.part(REPLAY):
        replay(champion(records), settings).to_html(new.folder / REPLAY)
    pictures = [f"{FOLDER}/{picture.name}.{kind}" for picture in PICTURES for kind in KINDS]
    with new.part(NAME, *([f"{TABLES}/champion.csv", *pictures] if files else [])):
        run = Subject.of(settings, records)
        if files:
            _write_csv(_walk(run.rollout), new.folder / TABLES / "champion.csv")
        write_text(new.folder / NAME, _page(run, new.folder, path, files))


def _write_csv(table: pd.DataFrame, path: Path) -> None:
    with replacing(path) as part:
        table.to_csv(part, index=False)


def _page(run: Subject, folder: Path, path: Path | None, files: bool) -> str:
    """Write the page, and the pictures beside it if there are to be files of them."""
    settings = run.settings
    drawn = {
        picture.name: _figure(picture, shown, files) for picture, shown in draw_all(run, folder if files else None)
    }
    sections = {
        "In short": _in_short(run, drawn),
        "What was evolved": _evolved(settings),
        "What came of it": _came(run, drawn, files),
        "The champion": _champion(run, drawn),
        "Where it comes from": _descent(run, drawn),
        "Do it again": _again(run, _facts(path), files),
        "Words": facts("Words that stand above", WORDS.items()),
    }
    anchors = {title: title.lower().replace(" ", "-") for title in sections}
    links = (tag("a", title, href=f"#{anchor}") for title, anchor in anchors.items())
    parts = (tag("section", tag("h2", title), content, id=anchors[title]) for title, content in sections.items())
    style = (HERE / "report.css").read_text(encoding="utf-8")
    title = f"Walkers evolved on {_terrain(settings)}"
    return page(title, style, tag("h1", title), tag("nav", *links, aria_label="Contents"), *parts)


def _for_spreadsheets(records: pd.DataFrame) -> pd.DataFrame:
    """Make sure that no text of a table, which may be somebody else's, is a formula."""
    texts = [name for name, (kind, *_) in COLUMNS.items() if kind is str]
    return records.assign(**{name: records[name].map(cell, na_action="ignore") for name in texts})


def _terrain(settings: Settings) -> str:
    terrain = settings.terrain
    strewn = f", among {re.split('[,:]', terrain.obstacle.about)[0]}" if terrain.obstacle else ""
    return f"{GROUNDS[terrain.structure]} of {terrain.texture.name}{strewn}"


def _figure(picture: Picture, shown: Html, files: bool) -> Html:
    links = join(*(join(" ", tag("a", kind.upper(), href=f"{FOLDER}/{picture.name}.{kind}")) for kind in KINDS))
    there = tag("span", links, class_="files") if files else ""
    caption = tag("figcaption", tag("b", picture.title, ". "), picture.reading, there)
    return tag("figure", tag("div", shown, class_="card"), caption)


def _in_short(run: Subject, drawn: Mapping[str, Html]) -> Html:
    plain, born = run.settings.model_dump(), births(run.records)
    row: Any = born.loc[run.champion.individual]
    seconds, pace = run.settings.simulation.duration, row.velocity / row.body_length
    reached = [
        (with_unit(row.distance, "m"), f"forward in {seconds:g} s"),
        (with_unit(row.velocity, "m/s"), f"over the last two thirds: {significant(pace)} body lengths a second"),
    ]
    figures = [
        *(reached if run.champion.verdict == "ok" else []),
        (f"{len(born)}", "robots were born"),
        (f"{(born.verdict == 'ok').mean():.0%}", "of their walks count"),
    ]
    cards = (tag("div", tag("b", figure), tag("span", about)) for figure, about in figures)
    watch = tag("p", tag("a", "Watch it walk, in 3D", href=REPLAY, class_="watch"))
    told = tag("p", summary.champion_story(run.records, plain))  # whose lines run on
    lead = tag("p", summary.summary(run.records, plain), class_="lead")
    return join(lead, tag("div", *cards, class_="figures"), watch, drawn["champion"], told)


def _evolved(settings: Settings) -> Html:
    algorithm = {row.name: row for row in rows_of(settings.algorithm)}
    steps = [[name, algorithm[name].value, algorithm[name].choice] for name in STEPS]
    return join(
        tag("p", ROUND.format(algorithm["population_size"].value, algorithm["n_elites"].value)),
        table("The algorithm", ["step", "chosen", "which means"], steps),
        *(glossary(domain) for _, domain in settings),
    )


def _came(run: Subject, drawn: Mapping[str, Html], files: bool) -> Html:
    shown = summary.round_steps(int(run.records.generation.max()))
    unit = run.records.attrs.get("units", {}).get("fitness", "")
    columns = [
        "generation",
        *(f"{name}{f' [{unit}]' if unit else ''}" for name in ("best", "median")),
        "counted",
        "robots",
    ]
    rows = [
        [row.generation, best, median, row.counted, row.robots]
        for row, best, median in summary.best_and_median(run.records, shown)
    ]
    verdicts = [[verdict, n, meaning] for verdict, n, meaning in summary.verdicts(run.records)]
    link = tag("a", f"{TABLES}/generations.csv", href=f"{TABLES}/generations.csv")
    all_of_them = tag("p", "Every generation, and its quartiles, are in ", link, ".") if files else ""
    traits = (drawn[name] for name in ("weight", "body_length", "n_segments", "n_legs"))
    return join(
        drawn["fitness"],
        details(
            "The same as a table",
            table("Fitness of the walks that count", columns, rows, numbers=range(5)),
            all_of_them,
        ),
        tag("div", drawn["diversity"], drawn["verdicts"], class_="pair"),
        table("Verdicts, each walk once", ["verdict", "walks", "meaning"], verdicts, numbers=(1,)),
        tag("h3", "How the bodies changed"),
        tag(
            "p",
            "A trait that settles early was decided by selection, or lost by chance; one that keeps wandering makes "
            "little difference to how far a robot gets.",
        ),
        tag("div", *traits, class_="pair"),
        drawn["genes"],
    )


def _champion(run: Subject, drawn: Mapping[str, Html]) -> Html:
    return join(
        drawn["body"],
        genome.in_words(run.champion.genome),
        drawn["gait"],
        drawn["distance"],
        _confirmed(run),
    )


def _confirmed(run: Subject) -> Html:
    """Say how much of the champion's fitness is left when it walks again, if that can be found out here."""
    if run.champion.verdict != "ok":
        return Html("")
    with suppress(RunFileError):  # of a fitness of the user's own, a run file knows the name only
        return confirm(run.champion.genome, run.settings).table()
    return Html("")


def _descent(run: Subject, drawn: Mapping[str, Html]) -> Html:
    rows = [
        ["…", f"{skipped} more", "", ""] if skipped else [one.individual, one.born, fitness, one.operators]
        for one, fitness, skipped in summary.line_of_descent(run.records, run.champion.individual)
    ]
    columns = ["robot", "generation", "fitness", "made by selection > crossover > mutation"]
    caption = "Its line of descent, through the fitter parent of each"
    return join(drawn["family"], table(caption, columns, rows, numbers=(1, 2)))


def _again(run: Subject, versions: Mapping[str, str], files: bool) -> Html:
    own = own_functions(run.settings)
    note = f"The functions {', '.join(own)} are somebody's own: their code belongs above this." if own else ""
    return join(
        tag("p", "With the same versions, this gives the same table to the last digit, on any number of cores."),
        tag("p", note) if note else "",
        code(as_python(run.settings, run.records)),
        facts("Made with", versions.items()),
        tag("p", "Beside this page lies ", tag("a", "records.csv", href="records.csv"), ROWS, FILES if files else MORE),
    )


def _facts(path: Path | None) -> dict[str, str]:
    """Tell the versions: those that the run file knows of, or those of this machine."""
    if path and path.exists():
        whose, made_with = store.read_facts(path)
        return made_with | whose
    return dict(provenance.current_facts())


def _walk(rollout: Rollout) -> pd.DataFrame:
    """Write a walk as a table: a row for each tick, times in s, lengths in m, work in J."""
    columns: dict[str, Any] = {"time": rollout.time, **dict(zip(("x", "y", "z"), rollout.com.T, strict=True))}
    columns |= {"on_ground": rollout.on_ground.astype(int), "sink": rollout.sink, "work": rollout.work}
    if rollout.load.size:
        columns |= dict(zip(("load_x", "load_y", "load_z"), rollout.load.T, strict=True))
    return pd.DataFrame(columns)
