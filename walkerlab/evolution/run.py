"""A run: its settings and its table, in memory or in a run file."""

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pandas as pd

from walkerlab.evolution.stages import Stage
from walkerlab.runfile import records
from walkerlab.runfile.history import Founder
from walkerlab.runfile.records import Individual, copy_table
from walkerlab.settings.choices import Camera, Fitness
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.simulation import fitness
from walkerlab.simulation.robustness import N_NUDGES, Confirmation, confirm
from walkerlab.system.files import display_path
from walkerlab.system.readonly import ReadOnlyProperties
from walkerlab.text.numbers import with_unit

if TYPE_CHECKING:
    from walkerlab.view.replay import Replay


class RunProperties(ReadOnlyProperties):
    """Base of classes with the settings and the file of a run."""

    _settings: Settings
    _path: Path | None

    @property
    def settings(self) -> Settings:
        """Settings of the run; if they were changed, those of its last stage."""
        return self._settings

    @property
    def path(self) -> Path | None:
        """Run file, or None."""
        return self._path


class Run(RunProperties):
    """The generations that an evolution has produced so far; read-only."""

    INSTEAD: ClassVar = {
        "settings": "The run was made with them. To evolve with other settings, start a new run: "
        "wl.evolve(run.settings.with_(...)).",
        "records": "They contain what was measured. Change a copy: table = run.records.",
        "path": "The run is stored there. Copy that file to store the run elsewhere.",
    }

    def __init__(
        self,
        settings: Settings,
        records: pd.DataFrame | Callable[[], pd.DataFrame],
        path: Path | None = None,
        rated_since: int = 0,
        stop_reason: str = "",
        stages: tuple[Stage, ...] = (),
        founders: tuple[Founder, ...] = (),
    ) -> None:
        """Combine settings and a table.

        Args:
            settings: Complete settings of the run.
            records: Tidy table, or a function that returns it, called on first use.
            path: Run file, or None.
            rated_since: First generation rated by the current fitness function; earlier ones have no champion.
            stop_reason: Condition of ``stop`` that ended the run; "" if none did.
            stages: Stages of the run; a single one with ``settings`` if empty.
            founders: Genomes given for generation 0.
        """
        self._settings = settings
        self._path = path
        self._rated_since = rated_since
        self._stop_reason = stop_reason
        self._stages = stages or (Stage(0, settings),)
        self._founders = founders
        self._source = copy_table(records) if isinstance(records, pd.DataFrame) else records

    @property
    def rated_since(self) -> int:
        """First generation rated by the current fitness function; 0 unless ``resume(rerate=True)`` took new ratings."""
        return self._rated_since

    @property
    def stop_reason(self) -> str:
        """Condition of ``stop`` that ended the run, such as ``2 generations had no fitter robot``; "" if none did."""
        return self._stop_reason

    @property
    def stages(self) -> tuple[Stage, ...]:
        """Stages of the run: each has ``.first``, its first generation, ``.settings`` and ``.changes``."""
        return self._stages

    @property
    def founders(self) -> tuple[Founder, ...]:
        """Genomes that were given for generation 0, in the order of its first individuals."""
        return self._founders

    @property
    def records(self) -> pd.DataFrame:
        """Copy of the tidy table; ``.attrs`` holds the units and the name of the fitness."""
        return copy_table(self._table)

    @cached_property
    def _table(self) -> pd.DataFrame:
        table = self._source if isinstance(self._source, pd.DataFrame) else self._source()
        records.name_fitness(table, *fitness.name_and_unit(self.settings.algorithm.fitness))
        if self._rated_since:
            table.attrs["rated_since"] = self._rated_since
        if changes := {stage.first: str(stage) for stage in self._stages[1:]}:
            table.attrs["stages"] = changes
            table.attrs["fitness_since"] = max(
                (stage.first for stage in self._stages if "fitness" in stage.changes), default=0
            )
        self._source = table
        return table

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the run with its table."""
        return Run, (
            self.settings,
            self.records,
            self.path,
            self._rated_since,
            self._stop_reason,
            self._stages,
            self._founders,
        )

    def __repr__(self) -> str:
        """Summarise the run in a line."""
        file = f", in {display_path(self.path)}" if self.path else ""
        if self._table.empty:
            return f"Run(no generation is complete yet{file})"
        name, unit = fitness.name_and_unit(self.settings.algorithm.fitness)
        best = self.champion
        result = f"{name} {with_unit(best.fitness, unit)}" if best.verdict == "ok" else "its walk does not count"
        size = self.settings.algorithm.population_size
        stopped = f"; stopped because {self._stop_reason}" if self._stop_reason else ""
        return (
            f"Run({self.n_generations} generations of {size} robots; champion: robot {best.individual} of "
            f"generation {best.generation}, {result}{stopped}{file})"
        )

    def _repr_html_(self) -> str:
        from walkerlab.view import report  # here because it is slow to import

        return report.run_html(self.settings, self.records, self.path)

    def replay(self, *generations: int, camera: Camera | str | int | None = None) -> "Replay":
        """Show the champion walking, or race the champions of several generations.

        Args:
            *generations: Generations whose champions race, counted from the end if negative; if none are given, the
                champion of the run walks alone.
            camera: Side, front, top, chase or orbit; if None, the camera in the settings.

        Raises:
            TypeError: If a generation is not a whole number.
            ValueError: If the run has no such generation, or no generation is complete yet.
        """
        from walkerlab.view.replay import replay

        if not generations:
            return replay(self.champion, self.settings, camera=camera)
        for number in generations:
            if not isinstance(number, int | np.integer) or isinstance(number, bool):  # pyright: ignore[reportUnnecessaryIsInstance]
                raise TypeError(
                    f"{short_repr(number)} is not the number of a generation; generations are whole numbers from 0 to "
                    f"{self.n_generations - 1}, or negative to count from the end, as in run.replay(0, -1)"
                )
        generations = tuple(n + self.n_generations if n < 0 else n for n in generations)
        tables: dict[int, pd.DataFrame] = {
            number: self._table.loc[self._table.generation == number, :] for number in generations
        }
        if missing := [number for number, table in tables.items() if table.empty]:
            raise ValueError(f"there is no generation {missing[0]!r}; this run has 0 to {self.n_generations - 1}")
        best = {f"generation {number}": records.find_champion(table) for number, table in tables.items()}
        return replay(best, self.settings, camera=camera)

    def save_report(self, folder: str | Path) -> Path:
        """Write a report of the run: a self-contained page, every picture and every table.

        Args:
            folder: Folder for ``report.html``, ``replay.html``, ``records.csv``, ``pictures`` (each as SVG, PDF and
                PNG) and ``tables``; created if it does not exist. An earlier report there is replaced.

        Returns:
            Path of ``report.html``.

        Raises:
            ValueError: If no generation is complete yet.
            OSError: If a file cannot be written.
        """
        from walkerlab.view import report

        return report.save_report(self.settings, self.records, folder, self.path)

    @property
    def champion(self) -> Individual:
        """Fittest robot of all generations that the current fitness function has rated."""
        return records.find_champion(self._table)

    def confirm(
        self, n_nudges: int = N_NUDGES, fitness: Fitness | str | Callable[..., Any] | None = None
    ) -> Confirmation:
        """Simulate the champion again at a quarter of the timestep and from other starts, and compare its fitness.

        Args:
            n_nudges: Number of other starts, each slightly different.
            fitness: Fitness that rates the walks; if None, the fitness of the run. A loaded run contains no user
                functions.

        Raises:
            RunFileError: If the run was loaded, was made with a user function, and ``fitness`` is None.
        """
        return confirm(self.champion.genome, self.settings, n_nudges, fitness)

    def lineage(self, individual: int) -> pd.DataFrame:
        """Return the rows of an individual and its ancestors, youngest first, with the operators that made each.

        Args:
            individual: Number of the individual in the run.

        Raises:
            ValueError: If the run has no such individual.
        """
        return records.select_lineage(self._table, individual)

    @property
    def n_generations(self) -> int:
        """Number of generations that are done."""
        return int(self._table.generation.nunique())
