"""A run: its settings and its table, from memory or from a run file."""

import builtins
import json
import unicodedata
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pandas as pd

from walkerlab.breeding import ROOMS, in_turn
from walkerlab.ga.user_functions import name_of
from walkerlab.readonly import ReadOnlyProperties
from walkerlab.runfile import provenance, records, store
from walkerlab.runfile.missing_functions import Missing, MissingFitness, remember_walks, typed_name
from walkerlab.runfile.records import Individual, copy_of
from walkerlab.runfile.store import DamagedError, RunFileError
from walkerlab.settings import binding, choices
from walkerlab.settings.choices import Camera, Choice, Fitness
from walkerlab.settings.model import MAX_JSON, STORED_MODULES, SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import brief, function_name
from walkerlab.simulation import fitness
from walkerlab.simulation.robustness import N_NUDGES, Confirmation, confirm
from walkerlab.system import file_sets
from walkerlab.system.files import shown
from walkerlab.text.numbers import with_unit

if TYPE_CHECKING:
    from walkerlab.view.replay import Replay

_OURS = {"fitness": fitness} | {kind.__name__.lower(): room for kind, room in ROOMS.items()}
"""Each slot that can hold a function, and the room of our own functions for it."""


class Run(ReadOnlyProperties):
    """What an evolution has brought forth so far; none of it can be changed."""

    INSTEAD: ClassVar = {
        "settings": "They are those that the run was made with. To evolve with other settings, start a new run: "
        "wl.evolve(run.settings.with_(...)).",
        "records": "They are what was measured. Change a copy: table = run.records.",
        "path": "It is where the run is stored. Copy that file to store the run elsewhere.",
    }

    def __init__(
        self,
        settings: Settings,
        records: pd.DataFrame | Callable[[], pd.DataFrame],
        path: Path | None = None,
        rated_since: int = 0,
    ) -> None:
        """Put it together.

        Args:
            settings: from which it was made.
            records: the tidy table, or what reads it when it is first asked for.
            path: its run file, or None.
            rated_since: First generation whose fitness is of the current function; the champion is sought from there.
        """
        self._settings, self._path, self._rated_since = settings, path, rated_since
        self._given = copy_of(records) if isinstance(records, pd.DataFrame) else records

    @property
    def settings(self) -> Settings:
        """The settings that it was made with."""
        return self._settings

    @property
    def path(self) -> Path | None:
        """Its run file, or None."""
        return self._path

    @property
    def rated_since(self) -> int:
        """The first generation whose fitness is of the current function; 0 unless the run was rated anew."""
        return self._rated_since

    @property
    def records(self) -> pd.DataFrame:
        """A copy of the tidy table; its units, and what its fitness is, are in ``.attrs``."""
        return copy_of(self._table)

    @cached_property
    def _table(self) -> pd.DataFrame:
        table = self._given if isinstance(self._given, pd.DataFrame) else self._given()
        records.name_fitness(table, *fitness.label(self.settings.algorithm.fitness))
        if self._rated_since:
            table.attrs["rated_since"] = self._rated_since
        self._given = table
        return table

    def __reduce__(self) -> tuple[Any, ...]:
        """Let it be sent elsewhere, with its table."""
        return Run, (self.settings, self.records, self.path, self._rated_since)

    def __repr__(self) -> str:
        """Say in a line what has come of it."""
        if self._table.empty:
            return f"Run(no generation is done yet{f', in {shown(self.path)}' if self.path else ''})"
        name, unit = fitness.label(self.settings.algorithm.fitness)
        best, kept = self.champion, f", in {shown(self.path)}" if self.path else ""
        reached = f"{name} {with_unit(best.fitness, unit)}" if best.verdict == "ok" else "its walk does not count"
        size = self.settings.algorithm.population_size
        return (
            f"Run({self.n_generations} generations of {size} robots; champion: robot {best.individual} of "
            f"generation {best.generation}, {reached}{kept})"
        )

    def _repr_html_(self) -> str:
        from walkerlab.view import report  # which draws, and drawing takes its time to load

        return report.panel(self.settings, self.records, self.path)

    def replay(self, *generations: int, camera: Camera | str | int | None = None) -> "Replay":
        """Show the champion walking, or race the champions of several generations.

        Args:
            generations: whose champions race, counted from the end if negative; the champion of all walks alone if
                none is named.
            camera: side, front, top, chase or orbit; that of the settings if None.

        Raises:
            ValueError: if there is no such generation, or none is done yet.
        """
        from walkerlab.view.replay import replay

        if not generations:
            return replay(self.champion, self.settings, camera=camera)
        for number in generations:
            if not isinstance(number, int | np.integer) or isinstance(number, bool):  # pyright: ignore[reportUnnecessaryIsInstance]
                raise TypeError(
                    f"{brief(number)} is not the number of a generation; give whole numbers, 0 to "
                    f"{self.n_generations - 1}, as in run.replay(0, -1)"
                )
        generations = tuple(n + self.n_generations if n < 0 else n for n in generations)
        tables: dict[int, pd.DataFrame] = {
            number: self._table.loc[self._table.generation == number, :] for number in generations
        }
        if missing := [number for number, table in tables.items() if table.empty]:
            raise ValueError(f"there is no generation {missing[0]!r}: this run has 0 to {self.n_generations - 1}")
        best = {f"generation {number}": records.champion(table) for number, table in tables.items()}
        return replay(best, self.settings, camera=camera)

    def save_report(self, folder: str | Path) -> Path:
        """Write all that there is to see of the run: a page that stands alone, every picture and every table.

        Args:
            folder: where to write ``report.html``, ``replay.html``, ``records.csv``, ``pictures`` (each as SVG, PDF and
                PNG) and ``tables``; made if need be. What is there of an earlier report is replaced.

        Returns:
            The path of ``report.html``.

        Raises:
            ValueError: if no generation is done yet.
            OSError: if a file cannot be written.
        """
        from walkerlab.view import report

        return report.save(self.settings, self.records, folder, self.path)

    @property
    def champion(self) -> Individual:
        """The fittest robot of all generations; if the run was rated anew, of those since."""
        return records.champion(self._table)

    def confirm(
        self, n_nudges: int = N_NUDGES, fitness: Fitness | str | Callable[..., Any] | None = None
    ) -> Confirmation:
        """Let the champion walk again at a quarter of the timestep and from other starts, and say what it keeps.

        Args:
            n_nudges: how many other starts, each a little different.
            fitness: by which the walks are rated; that of the run if None. A loaded run has lost its own function.

        Raises:
            RunFileError: if the run was loaded, and has lost its own fitness function.
        """
        return confirm(self.champion.genome, self.settings, n_nudges, fitness)

    def lineage(self, individual: int) -> pd.DataFrame:
        """Return the rows of an individual and its ancestors, youngest first, with the operators behind each."""
        return records.lineage(self._table, individual)

    @property
    def n_generations(self) -> int:
        """How many generations have walked."""
        return int(self._table.generation.nunique())


def load(path: str | Path) -> Run:
    """Read a run from its file; functions of the user's own are known by name only, which is enough to look at it.

    ``run.confirm(fitness=my_function)`` and ``resume`` need a function of the user's own again.

    Args:
        path: the run file, or the folder with it.

    Raises:
        RunFileError: if there is no such file, it is not a run, or it is damaged.
    """
    path = store.locate(path)
    file_sets.restore(path.parent)
    plain, table = store.read(path)
    facts = store.read_facts(path)[1]
    try:
        records.check(table)
        settings = _settings_of(plain)
        since = provenance.rated_since(facts, int(table.generation.nunique()))
    except (TypeError, KeyError, ValueError, RecursionError) as error:
        raise DamagedError(path, str(error)) from error
    sizes = table.groupby("generation").size()
    if sizes.to_dict() != dict.fromkeys(range(len(sizes)), settings.algorithm.population_size):
        raise DamagedError(path, "robots are missing from its table, or there are too many")
    remember_walks(settings, table)
    return Run(settings, table, path, since)


def _settings_of(plain: dict[str, Any]) -> Settings:
    """Restore settings from plain data."""
    algorithm = plain["algorithm"]
    restored = {slot: _restored(algorithm[slot], slot) for slot in _OURS}
    parts: dict[str, Any] = {**plain, "algorithm": {**algorithm, **restored}}
    return Settings(**parts)


def check_storable(settings: Settings) -> None:
    """Check that a run file with these settings can be written and loaded again.

    Raises:
        SettingsError: If the name of a function or of its arguments cannot be stored, or there is too much to store.
    """
    plain = json.loads(json.dumps(settings.model_dump()))
    faults: list[str] = []
    for slot in _OURS:
        try:
            _restored(plain["algorithm"][slot], slot)
        except (ValueError, RecursionError) as error:
            faults.append(f"Algorithm.{slot} cannot be stored in a run file: {error}. Rename it.")
    if not faults and (length := len(json.dumps(plain))) > MAX_JSON:
        faults.append(
            f"these settings take {length} characters to store, with the arguments bound to functions; a run file "
            f"takes {MAX_JSON}. Use fewer functions, or keep large data in the function or in a global variable."
        )
    if faults:
        raise SettingsError("\n".join(faults))


def rescue(path: str | Path, to: str | Path) -> Run:
    """Save what is whole of a damaged run, its generations before the damage, as a run of its own.

    Args:
        path: the damaged run file, or the folder with it; it is left as it is.
        to: the run file to be made.

    Returns:
        The new run, which ``resume(to)`` continues; with no generation if only the settings could be saved.

    Raises:
        RunFileError: if nothing can be saved, or there is a file at ``to``, or none can be made there.
    """
    path, to = store.locate(path), store.new_path(to)
    store.rescue(path, to)
    try:
        return load(to)
    except DamagedError as error:  # as it was sealed already
        to.unlink()
        raise RunFileError(f"nothing can be saved of {shown(path)}: {error.what}.") from error


def with_functions(run: Run, functions: dict[str, Any]) -> Run:
    """Give a loaded run the user's own functions back, so that it can go on as it began.

    Args:
        run: as loaded.
        functions: what fills each slot in which a function is missing.

    Raises:
        RunFileError: if one is still missing, or something else was given than the run was made with.
    """
    recorded = {slot: in_turn(getattr(run.settings.algorithm, slot)) for slot in _OURS}
    own = own_slots(run.settings)
    for slot in functions.keys() - own.keys():
        known = f"it was {_recipe(recorded[slot])}" if slot in recorded else f"there are {', '.join(recorded)}"
        raise RunFileError(
            f"{shown(run.path)} needs no {slot!r} given back: {known}. A resumed run goes on as it began."
        )
    settings = run.settings.with_(**functions)
    wrong = [
        f"{slot}={recipe}"
        for slot, recipe in own.items()
        if not _are_the_same(in_turn(getattr(settings.algorithm, slot)), recorded[slot], slot)
        or any(map(_is_missing, in_turn(getattr(settings.algorithm, slot))))
    ]
    if wrong:
        given = ", ".join(wrong)
        raise RunFileError(
            f"{shown(run.path)} was made with functions of somebody's own, and a run file holds no code. To go on with "
            "it, give them back under the same names, fixed or not: in Python, "
            f"wl.resume({shown(run.path)!r}, {given}). To look at it, none is needed."
        )
    return Run(settings, run.records, run.path, run.rated_since)


def own_slots(settings: Settings) -> dict[str, str]:
    """Name the slots that hold a function of the user's own, and write what fills each as Python."""
    filled = {slot: in_turn(getattr(settings.algorithm, slot)) for slot in _OURS}
    return {slot: _recipe(fill) for slot, fill in filled.items() if any(_is_own(one, slot) for one in fill)}


def _is_own(operator: Any, slot: str) -> bool:
    function = operator.func if isinstance(operator, partial) else operator
    return not isinstance(operator, Choice) and function is not getattr(_OURS[slot], function_name(function), None)


def _are_the_same(given: tuple[Any, ...], recorded: tuple[Any, ...], slot: str) -> bool:
    """Return whether operators are those that a run file names; a lambda has no name, so any function matches it."""

    def identity(operator: Any) -> tuple[bool, bool, str, str]:
        function, arguments = (
            (operator.func, binding.identity(operator)) if isinstance(operator, partial) else (operator, "")
        )
        name = operator.name if isinstance(operator, Choice) else name_of(function)
        return _is_own(operator, slot), isinstance(operator, Choice), name, arguments

    pairs = [(identity(one), identity(other)) for one, other in zip(given, recorded, strict=False)]
    return len(given) == len(recorded) and all(
        one == other or (other[2] == "<lambda>" and one == (*other[:2], one[2], other[3])) for one, other in pairs
    )


def _recipe(fill: tuple[Any, ...]) -> str:
    """Write what fills a slot as Python."""
    words = [repr(one.name) if isinstance(one, Choice) else typed_name(one) for one in fill]
    return words[0] if len(words) == 1 else f"[{', '.join(words)}]"


_CHOICES = {kind.__name__: kind for kind in Choice.__subclasses__() if kind.__module__ == choices.__name__}
_POWERS = {*dir(builtins), "exit", "quit", "get_ipython"}
"""What no operator is called, or the code that repeats a stranger's run would hand over to it what the file says."""


def _is_plain(name: str) -> bool:
    """Say whether Python takes a text for a name, and for this one."""
    return name.isidentifier() and unicodedata.normalize("NFKC", name) == name


def _restored(written: Any, slot: str) -> Any:
    """Turn what a file says of a slot into operators: a file holds names and numbers, never code."""
    match written:
        case list():
            return [_restored(one, slot) for one in written]
        case {"function": str(address), "with": dict(keywords), **rest}:
            home, _, name = address.rpartition(".")
            if name in _POWERS or not all(map(_is_plain, (name.replace("<lambda>", "function"), *keywords))):
                raise ValueError(
                    f"no function of a run is called {name!r:.60}, with {', '.join(keywords)!r:.60}; names must be "
                    "Python names other than those of Python's own functions"
                )
            ours = _OURS[slot]
            is_ours = home == STORED_MODULES.get(ours.__name__, ours.__name__) and name in _choices(slot)
            missing = MissingFitness if slot == "fitness" else Missing
            function = getattr(ours, name) if is_ours else missing(name, slot)
            arguments = [binding.restored(one, _CHOICES) for one in list[Any](rest.get("args", []))]
            keywords = {name: binding.restored(one, _CHOICES) for name, one in keywords.items()}
            return partial(function, *arguments, **keywords) if arguments or keywords else function
        case _:
            return written


def _choices(slot: str) -> set[str]:
    kinds: dict[str, type[Choice]] = {kind.__name__.lower(): kind for kind in (Fitness, *ROOMS)}
    return set(kinds[slot].__members__)


def _is_missing(operator: Any) -> bool:
    return isinstance(operator.func if isinstance(operator, partial) else operator, Missing)
