"""A run: its settings and its table, from memory or from a run file."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from walkerlab import fitness, records, store
from walkerlab.algorithm import ROOMS
from walkerlab.quantity import Choice
from walkerlab.records import Individual
from walkerlab.settings import Fitness, Settings
from walkerlab.store import RunFileError

Function = Callable[..., Any]

_OURS = {"fitness": fitness} | {kind.__name__.lower(): room for kind, room in ROOMS.items()}
"""Each slot that can hold a function, and the room of our own functions for it."""


@dataclass(frozen=True, eq=False)
class Run:
    """What an evolution has brought forth so far.

    Attributes:
        settings: from which it was made.
        records: the tidy table; the units are in ``records.attrs["units"]``.
        path: its run file, or None.
    """

    settings: Settings
    records: pd.DataFrame
    path: Path | None = None

    def __post_init__(self) -> None:
        """Write on the table what its fitness is."""
        records.name_fitness(self.records, *fitness.label(self.settings.algorithm.fitness))

    @property
    def champion(self) -> Individual:
        """The fittest robot of all generations."""
        return records.champion(self.records)

    def lineage(self, individual: int) -> pd.DataFrame:
        """Return the rows of an individual and its ancestors, youngest first, with the operators behind each."""
        return records.lineage(self.records, individual)

    @property
    def n_generations(self) -> int:
        """How many generations have walked."""
        return int(self.records.generation.nunique())


def load(path: str | Path, **functions: Any) -> Run:
    """Read a run from its file.

    Args:
        path: the run file.
        **functions: the user's own functions, by slot (``mutation=my_mutation``), if the run shall go on; to look at
            it they are not needed.

    Raises:
        RunFileError: if there is no such file, or it is not a run.
    """
    path = Path(path)
    _, plain, table = store.read(path)
    algorithm = plain["algorithm"]
    for slot in _OURS:
        algorithm[slot] = functions.get(slot) or _restored(algorithm[slot], slot)
    return Run(Settings(**plain), table, path)


def missing_functions(settings: Settings) -> dict[str, str]:
    """Name the user's own functions that a run file could not give back, by slot."""
    slots = {slot: getattr(settings.algorithm, slot) for slot in _OURS}
    return {
        slot: function.__name__
        for slot, value in slots.items()
        for function in (value if isinstance(value, tuple) else (value,))
        if isinstance(function, _Missing)
    }


def _restored(written: Any, slot: str) -> Any:
    """Turn what a file says of a slot into operators: a file holds names and numbers, never code."""
    match written:
        case list():
            return [_restored(one, slot) for one in written]
        case {"function": str(function), "with": dict(keywords)}:
            home, _, name = function.rpartition(".")
            ours = _OURS[slot]
            if home != ours.__name__ or name not in _choices(slot):
                return _Missing(name, slot)
            return partial(getattr(ours, name), **keywords) if keywords else getattr(ours, name)
        case _:
            return written


def _choices(slot: str) -> set[str]:
    kinds: dict[str, type[Choice]] = {kind.__name__.lower(): kind for kind in (Fitness, *ROOMS)}
    return set(kinds[slot].__members__)


class _Missing:
    """Stands for a function of the user's own, of which the file knows the name only."""

    def __init__(self, name: str, slot: str) -> None:
        self.__name__ = name
        self.slot = slot

    def __call__(self, *_: object, **__: object) -> Any:
        raise RunFileError(
            f"this run was made with your own function {self.__name__!r} for Algorithm.{self.slot}, and a run file "
            f"holds no code. Give it back: resume(path, {self.slot}={self.__name__})"
        )
