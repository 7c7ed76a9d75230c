"""What a run has brought forth so far: all of it in a file, and of each genome a hash that says where it is there.

So a run does not outgrow the memory, whether anybody keeps its file or not, and no genome need walk twice.
"""

import weakref
from collections.abc import Collection, Mapping
from pathlib import Path
from threading import Lock
from typing import Any, Self

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from walkerlab.runfile import store
from walkerlab.runfile.records import Walked, copy_of, join


class Archive:
    """The generations of a run that goes on."""

    def __init__(self, file: store.File, run_id: str) -> None:
        """Use a run file, of whose generations none is known yet."""
        self._file, self._id = file, run_id
        self._known = list[NDArray[np.int64]]()  # (3, n) each: hash, ascending; generation of birth; number
        self._table, self._lock = join([]), Lock()

    @classmethod
    def create(cls, settings: dict[str, Any], path: Path | None = None) -> Self:
        """Create the run file, with the settings and no generation.

        Args:
            settings: Settings as plain data.
            path: Run file; if None, one without a name that is gone with the archive.

        Raises:
            RunFileError: if something exists at ``path``, or nothing can be written there.
        """
        file = path or store.passing()
        archive = cls(file, store.create(file, settings))
        if not isinstance(file, Path):
            weakref.finalize(archive, file.close)
        return archive

    @classmethod
    def of(cls, path: Path, table: pd.DataFrame, settings: dict[str, Any]) -> Self:
        """Take up a run file, to go on with it under these settings, plain data; its table is not kept."""
        archive = cls(path, store.go_on(path, settings))
        archive._remember(table)
        return archive

    def add(self, generation: pd.DataFrame, functions: Mapping[str, str] = {}) -> None:
        """Store a generation, with facts about the functions that it was made with."""
        with self._lock:
            store.append(self._file, generation, self._id, functions)
            self._remember(generation)

    def keep(self) -> Path:
        """Return the file that it is in; what would go with the archive is kept in one from now on.

        Raises:
            RunFileError: if it is there no more, or none can be made.
        """
        with self._lock:
            if not isinstance(self._file, Path):
                self._file = store.keep(self._file)
            store.require(self._file, self._id)
            return self._file

    def table(self, n_generations: int) -> pd.DataFrame:
        """Return the table of the first so many generations, the caller's own; what was read once is not read again."""
        with self._lock:
            n_read = 0 if self._table.empty else int(self._table.generation.iloc[-1]) + 1
            if n_read < n_generations:
                self._table = join([self._table, store.read_generations(self._file, self._id, n_read, n_generations)])
            end = int(self._table.generation.searchsorted(n_generations))
            return copy_of(self._table.iloc[:end])

    def find(self, genomes: Collection[str]) -> dict[str, Walked]:
        """Return what is known of these genomes, by their texts; of most, nothing."""
        hashes = np.fromiter(map(hash, genomes), np.int64, len(genomes))
        births = list[list[int]]()
        for known in self._known:
            found = known.take(known[0].searchsorted(hashes), axis=1, mode="clip")
            births += found[1:, found[0] == hashes].T.tolist()
        with self._lock:
            rows = store.read_births(self._file, self._id, Walked._fields, births) if births else []
        return {one.genome: one for one in map(Walked._make, rows)}  # of two with the same hash, the one it is

    def _remember(self, table: pd.DataFrame) -> None:
        """Lay down the hashes of those born in these generations; what is as large is merged, so that parts are few."""
        born = table.loc[table.born == table.generation, ["genome", "generation", "individual"]]
        if born.empty:
            return
        self._known.append(_sorted(np.array([list(map(hash, born.genome)), born.generation, born.individual])))
        while len(self._known) > 1 and self._known[-1].size >= self._known[-2].size:
            self._known[-2:] = [_sorted(np.concatenate(self._known[-2:], axis=1))]


def _sorted(known: NDArray[np.int64]) -> NDArray[np.int64]:
    return known[:, known[0].argsort(kind="stable")]
