"""Entries of a league: genomes from the files of a folder, which anyone in a class may have written.

Files are only read, and never followed to other places. A file that is not one genome within the limits is listed with
the reason, and takes no part.
"""

import os
import shutil
import stat
import tempfile
import unicodedata
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

from walkerlab.evolution.loading import load
from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES
from walkerlab.genome.genome import Genome
from walkerlab.genome.repair_notes import describe_repairs
from walkerlab.genome.text import MAX_TEXT_LENGTH, GenomeError
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import pluralize, truncate
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import absolute_path, display_path
from walkerlab.text.escape import printable

RUN_SUFFIX = ".walk"
TEXT_SUFFIXES = ("", ".txt", ".genome")
MAX_TEXT_BYTES = 4 * MAX_TEXT_LENGTH  # of a text file; a character takes at most four bytes in UTF-8
MAX_RUN_BYTES = 200_000_000  # of a run file; a run of 6,000 robots takes about 5 MB
MAX_FILES = 1000  # maximum number of files that are read
MAX_NAME_LENGTH = 40  # characters; longer names are shortened
MAX_REASONS = 2  # maximum number of values beyond the limits that are named for an entry
IGNORED_NAMES = ("thumbs.db", "desktop.ini")  # files of operating systems, like those that begin with a full stop


@dataclass(frozen=True)
class Entry:
    """A genome that takes part.

    Attributes:
        name: Name of the file without its ending, with control characters escaped; names that several entries have are
            numbered.
        genome: Genome within the robot limits.
    """

    name: str
    genome: Genome


@dataclass(frozen=True)
class SkippedEntry:
    """A file that takes no part.

    Attributes:
        file: Name of the file, with control characters escaped.
        reason: Why it takes no part.
    """

    file: str
    reason: str


class EntryError(WalkerlabError, ValueError):
    """A file that is not an entry; the message is the reason."""


def read_entries(given: Any, robot: Robot) -> tuple[list[Entry], list[SkippedEntry]]:
    """Read the entries of a league; the result does not depend on the order of the files.

    Args:
        given: Folder, or genomes by name, or a list of genomes. Each genome is a Genome, its text, an individual or a
            run (its champion).
        robot: Limits of the robots.

    Returns:
        Entries in the order of their names, and the files that take no part.

    Raises:
        TypeError: If ``given`` is something else.
        ValueError: If the folder does not exist.
    """
    if isinstance(given, str | os.PathLike) and not _is_genome_text(given):
        files: dict[str, Any] = dict(_find_files(absolute_path(cast(Any, given), "folder")))
    elif isinstance(given, Mapping):
        files = {str(name): genome for name, genome in cast(Mapping[Any, Any], given).items()}
    elif isinstance(given, Sequence) and not isinstance(given, str):
        files = {f"robot {number}": genome for number, genome in enumerate(cast(Sequence[Any], given), start=1)}
    else:
        raise TypeError("a league takes a folder, or genomes by name, as in wl.league({'Ada': genome}, settings)")
    found: list[Entry] = []
    skipped: list[SkippedEntry] = []
    for file in sorted(files, key=lambda file: (_comparable(file), file)):
        source = files[file]
        is_file = isinstance(source, Path)
        try:
            name = _entry_name(Path(file).stem if is_file else file)
            genome = _read_file(source) if is_file else _genome_of(source)
            found.append(Entry(name, _require_within(genome, robot)))
        except EntryError as error:
            skipped.append(SkippedEntry(truncate(printable(file)), printable(error)))
    return list(_number_names(found)), skipped


def _number_names(entries: Sequence[Entry]) -> Iterator[Entry]:
    """Yield entries with a number after each name that several have, so that no one can take the name of another."""
    totals = Counter(_comparable(entry.name) for entry in entries)
    numbers: Counter[str] = Counter()
    for entry in entries:
        key = _comparable(entry.name)
        numbers[key] += 1
        yield replace(entry, name=f"{entry.name} ({numbers[key]})") if totals[key] > 1 else entry


def _is_genome_text(given: object) -> bool:
    """Return whether a value is the text of a genome, given by mistake in place of a folder."""
    if not (isinstance(given, str) and given.lstrip().startswith(("wl1 ", "wl2 "))):
        return False
    raise TypeError("this is a single genome; a league takes a folder, or genomes by name: {'Ada': genome}")


def _find_files(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the name and the path of each file of a folder."""
    if not folder.is_dir():
        raise ValueError(f"there is no folder {display_path(folder)}; give the folder that contains the genomes")
    paths = [path for path in folder.iterdir() if path.name[0] != "." and path.name.lower() not in IGNORED_NAMES]
    if len(paths) > MAX_FILES:
        raise ValueError(f"{display_path(folder)} contains {len(paths)} files; a league takes at most {MAX_FILES}")
    yield from ((path.name, path) for path in paths)


def _comparable(name: str) -> str:
    """Return a form of a name that is the same for names that look alike or differ only in capital letters."""
    return unicodedata.normalize("NFKC", name).casefold()


def _entry_name(stem: str) -> str:
    """Return the name of an entry as it is shown.

    Raises:
        EntryError: If it is empty.
    """
    name = printable(unicodedata.normalize("NFC", stem.strip()))
    if not name:
        raise EntryError("its name is empty")
    return name if len(name) <= MAX_NAME_LENGTH else f"{name[: MAX_NAME_LENGTH - 1]}…"


def _genome_of(given: Any) -> Genome:
    """Return a genome that was given as an object or a text.

    Raises:
        EntryError: If a text is not a genome.
    """
    given = getattr(given, "champion", given)
    try:
        return Genome.of(getattr(given, "genome", given))
    except GenomeError as error:
        raise EntryError(_first_line(error)) from error


def _read_file(path: Path) -> Genome:
    """Read the genome in a text file, or the champion of a run file.

    Raises:
        EntryError: If the file is not one genome.
    """
    suffix = path.suffix.lower()
    try:
        facts = path.lstat()
        if stat.S_ISLNK(facts.st_mode):
            raise EntryError("it is a link; hand in the file itself")
        if stat.S_ISDIR(facts.st_mode):
            raise EntryError("it is a folder; hand in the run.walk inside it, or a genome as a text file")
        if not stat.S_ISREG(facts.st_mode):
            raise EntryError("it is not a regular file")
        if suffix not in (*TEXT_SUFFIXES, RUN_SUFFIX):
            raise EntryError("its name must end in .txt (a genome) or .walk (a run)")
        limit = MAX_RUN_BYTES if suffix == RUN_SUFFIX else MAX_TEXT_BYTES
        if facts.st_size > limit:
            raise EntryError(f"it has {facts.st_size:,} bytes; at most {limit:,} are allowed")
        if not facts.st_size:
            raise EntryError("it is empty")
        return _read_champion(path) if suffix == RUN_SUFFIX else _read_text(path)
    except OSError as error:
        raise EntryError(f"it cannot be read: {error.strerror or error}") from error


def _read_text(path: Path) -> Genome:
    """Read a text file with one genome, on one line or several."""
    with path.open("rb") as file:
        data = file.read(MAX_TEXT_BYTES + 1)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise EntryError("it is text in UTF-16; save it as UTF-8")
    if b"\0" in data:
        raise EntryError("it contains binary data, not text")
    try:
        text = data.decode("utf-8-sig").strip()
    except UnicodeDecodeError:
        raise EntryError("it is not text in UTF-8") from None
    if not text:
        raise EntryError("it is empty")
    n_genomes = sum(line.lstrip().startswith(("wl1 ", "wl2 ")) for line in text.splitlines())
    if n_genomes > 1:
        raise EntryError(f"it contains {pluralize(n_genomes, 'genome')}; hand in one")
    return _genome_of(text)


def _read_champion(path: Path) -> Genome:
    """Return the champion of a run file, which is read from a copy, so that no file beside it is used or changed."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a run of version 0.1 has genomes that can walk
        copy = Path(folder) / f"entry{RUN_SUFFIX}"
        shutil.copyfile(path, copy, follow_symlinks=False)
        try:
            return Genome.of(load(copy).champion.genome)
        except (WalkerlabError, ValueError) as error:
            raise EntryError(
                _first_line(error).replace(display_path(copy), "it").partition(" The generations")[0]
            ) from error


def _require_within(genome: Genome, robot: Robot) -> Genome:
    """Return a genome, rounded as every genome is, if it is within the limits.

    Segments that it describes beyond the limits may be ignored if they are not expressed.

    Raises:
        EntryError: If a value that has an effect is beyond the limits; the message names it.
    """
    n_parts = min(genome.n_parts, robot.segments[1])
    is_expressed_within = genome.values[0] <= n_parts
    kept = (
        Genome(genome.values[: len(BODY_FEATURES) + n_parts * len(SEGMENT_FEATURES)]) if is_expressed_within else genome
    )
    if repairs := describe_repairs(kept, robot):
        shown = "; ".join(each.fault for each in repairs[:MAX_REASONS])
        more = f", and {len(repairs) - MAX_REASONS} more" if len(repairs) > MAX_REASONS else ""
        raise EntryError(f"it is beyond the limits of the robots: {shown}{more}")
    return kept.within(robot)


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0]
