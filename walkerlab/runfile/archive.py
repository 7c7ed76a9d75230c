"""Generations of a run that is being evolved: stored in a file, and indexed by genome.

Only a hash of each genome is held in memory, so a run of any length fits, whether or not it has a run file. The
index finds earlier evaluations, so that no genome is simulated twice.
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
from walkerlab.runfile.history import History
from walkerlab.runfile.records import EvaluationRow, concatenate_tables, copy_table


class Archive:
    """Generations of a run that is being evolved."""

    def __init__(self, file: store.RunFile, run_id: str) -> None:
        """Use a run file, without an index of its generations.

        Args:
            file: Path of the run file, or a temporary one.
            run_id: Id of the run that the file must contain.
        """
        self._file = file
        self._run_id = run_id
        self._index: list[NDArray[np.int64]] = []  # (3, n) each: hash (ascending), generation of birth, individual
        self._table = concatenate_tables([])
        self._lock = Lock()

    @classmethod
    def create(cls, settings: dict[str, Any], path: Path | None = None, history: History = store.NO_HISTORY) -> Self:
        """Create the run file, with the settings and without generations.

        Args:
            settings: Settings as plain data.
            path: Run file to create; if None, a temporary one that is deleted with the archive.
            history: Genomes given for generation 0.

        Raises:
            RunFileError: If ``path`` exists already or cannot be created.
        """
        file = path or store.open_temporary()
        archive = cls(file, store.create(file, settings, history))
        if not isinstance(file, Path):
            weakref.finalize(archive, file.close)
        return archive

    @classmethod
    def resume(cls, path: Path, table: pd.DataFrame, settings: dict[str, Any], history: History | None = None) -> Self:
        """Continue a run file.

        Args:
            path: Run file.
            table: Generations of the run whose evaluations may be reused; only their index is kept in memory.
            settings: Settings of the further generations, as plain data.
            history: History of the run; if None, the history in the file stays unchanged.

        Raises:
            RunFileError: If the file cannot be written.
        """
        archive = cls(path, store.prepare_resume(path, settings, history))
        archive._add_to_index(table)
        return archive

    def add(self, generation: pd.DataFrame, functions: Mapping[str, str] = {}) -> None:
        """Store a generation.

        Args:
            generation: Tidy table of the generation.
            functions: Facts about the user functions that produced it.

        Raises:
            RunFileError: If it cannot be written, or the file was changed in the meantime.
        """
        with self._lock:
            store.append(self._file, generation, self._run_id, functions)
            self._add_to_index(generation)

    def save(self) -> Path:
        """Return the path of the run file; a temporary file is first copied to one with a name.

        Raises:
            RunFileError: If the file no longer contains this run, or no file can be created.
        """
        with self._lock:
            if not isinstance(self._file, Path):
                self._file = store.save_temporary(self._file)
            store.require_run(self._file, self._run_id)
            return self._file

    def table(self, n_generations: int) -> pd.DataFrame:
        """Return the table of the first generations, as a copy; each generation is read from the file once.

        Args:
            n_generations: Number of generations, at most those that are stored.
        """
        with self._lock:
            n_read = 0 if self._table.empty else int(self._table.generation.iloc[-1]) + 1
            if n_read < n_generations:
                new = store.read_generations(self._file, self._run_id, n_read, n_generations)
                self._table = concatenate_tables([self._table, new])
            end = int(self._table.generation.searchsorted(n_generations))
            return copy_table(self._table.iloc[:end])

    def find(self, genomes: Collection[str]) -> dict[str, EvaluationRow]:
        """Return the stored evaluations of genomes, keyed by genome text; genomes without one are left out.

        Args:
            genomes: Texts of the genomes.
        """
        hashes = np.fromiter(map(hash, genomes), np.int64, len(genomes))
        births: list[list[int]] = []
        for block in self._index:
            found = block.take(block[0].searchsorted(hashes), axis=1, mode="clip")
            births += found[1:, found[0] == hashes].T.tolist()
        with self._lock:
            rows = store.read_births(self._file, self._run_id, EvaluationRow._fields, births) if births else []
        # Another genome may have the same hash; its row is then returned under its own text.
        return {walked.genome: walked for walked in map(EvaluationRow._make, rows)}

    def _add_to_index(self, table: pd.DataFrame) -> None:
        """Index the individuals born in these generations; blocks of similar size are merged, so that few remain."""
        born = table.loc[table.born == table.generation, ["genome", "generation", "individual"]]
        if born.empty:
            return
        self._index.append(_sort_by_hash(np.array([list(map(hash, born.genome)), born.generation, born.individual])))
        while len(self._index) > 1 and self._index[-1].size >= self._index[-2].size:
            self._index[-2:] = [_sort_by_hash(np.concatenate(self._index[-2:], axis=1))]


def _sort_by_hash(block: NDArray[np.int64]) -> NDArray[np.int64]:
    """Sort the columns of a (3, n) block by hash."""
    return block[:, block[0].argsort(kind="stable")]
