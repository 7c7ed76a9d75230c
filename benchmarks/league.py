"""Measure how long a class tournament takes, and whether its result depends on the order of the files or the workers.

    python -m benchmarks.league [--entries 30] [--rounds 1] [--folder FOLDER] [--structure flat]

The folder gets a genome for each student, from a short run, and, among them, files that a league must skip: empty,
binary, oversized, linked, with a typing error, beyond the limits, with two genomes, or with HTML. One name is HTML,
too. The page is written beside the folder.
"""

import argparse
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import mkdtemp
from time import perf_counter

import walkerlab as wl

NAMES = (
    *("Ada", "Bo", "Chen", "Dilnoza", "Emil", "Fatima", "Göran", "Hana", "Ines", "Jun", "Kwame", "Lea", "Mateo"),
    *("Nia", "Oskar", "Priya", "Qiu", "Rosa", "Samir", "Tuva", "Uche", "Vera", "Wiebke-Charlotte von Hohenberg"),
    *("Ximena", "Yusuf", "Zoë"),
)
HTML_NAME = "<b onclick=alert(1)>Bobby"
N_INVALID = 8


def write_entries(folder: Path, n_entries: int, settings: wl.Settings) -> None:
    """Write the files of a class: valid entries from a short run, and ``N_INVALID`` that are not.

    Args:
        folder: Empty folder.
        n_entries: Number of files.
        settings: Settings under which the robots evolve.
    """
    run = wl.evolve(settings.with_(population_size=24, generations=10), progress=False)
    ranked = run.records.sort_values("fitness", ascending=False).drop_duplicates("genome").genome
    genomes = ranked.iloc[:: max(1, len(ranked) // n_entries)].tolist()
    for number in range(n_entries - N_INVALID):
        name = (HTML_NAME, *NAMES)[number] if number <= len(NAMES) else f"Student {number}"
        (folder / f"{name}.txt").write_text(genomes[number], encoding="utf-8")
    sound = genomes[0]
    invalid = {
        "empty.txt": b"",
        "photo.txt": b"\x89PNG\r\n\x1a\n\0\0",
        "huge.txt": b" " * 10_000_000,
        "typo.txt": sound.replace("duty", "duly").encode(),
        "giant.txt": re.sub(r"mass=[\d.]+", "mass=400", sound).encode(),
        "two.txt": f"{sound}\n{sound}".encode(),
        "script.txt": b"<script>alert(1)</script>",
    }
    for name, content in invalid.items():
        (folder / name).write_bytes(content)
    (folder / "link.txt").symlink_to(folder / "Ada.txt")


def main() -> None:
    """Parse the arguments, hold the league twice and print the times and whether both tables are equal."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--entries", type=int, default=30)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--folder", type=Path, help="empty folder for the entries; a temporary one by default")
    parser.add_argument("--structure", default="flat")
    arguments = parser.parse_args()
    folder = arguments.folder or Path(mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    settings = wl.Settings().with_(structure=arguments.structure)
    write_entries(folder, arguments.entries, settings)
    start = perf_counter()
    result = wl.league(folder, settings, rounds=arguments.rounds, progress=False)
    walked = perf_counter()
    page = result.save(folder.with_suffix(".html"))
    saved = perf_counter()
    entries = {standing.entry.name: standing.entry.genome for standing in reversed(result.standings)}
    with ThreadPoolExecutor(1) as executor:
        again = wl.league(entries, settings, rounds=arguments.rounds, executor=executor, progress=False)
    print(result)
    print(result.table.drop(columns=["genome"]).to_string(index=False))
    for one in result.skipped:
        print(f"not valid: {one.file}: {one.reason}")
    print(f"walks: {walked - start:.1f} s; page: {saved - walked:.1f} s, {page.stat().st_size / 1e6:.1f} MB: {page}")
    print(f"same table in another order, on one thread: {again.table.equals(result.table)}")


if __name__ == "__main__":
    main()
