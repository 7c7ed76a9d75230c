"""The microscope: a widget that shows which gene came from which parent, and what an operator changed."""

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import traitlets

from walkerlab.analysis.inheritance import Birth, parent_letter
from walkerlab.analysis.mating import AnyGenome, mate, mutate
from walkerlab.evolution.births import explain_birth
from walkerlab.evolution.run import Run
from walkerlab.ga.user_functions import OperatorError
from walkerlab.genome.genome import Genome
from walkerlab.runfile.opening import RunFileError
from walkerlab.runfile.records import find_champion
from walkerlab.settings.choices import Choice, Crossover, Mutation
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name, pluralize
from walkerlab.system.randomness import random_stream
from walkerlab.text.templates import Markup, render
from walkerlab.view.inheritance import describe_birth, parent_colour
from walkerlab.view.plots.tables import format_value, unit_of
from walkerlab.view.sketch.births import draw_birth
from walkerlab.view.sketch.svg import hex_colour
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.genome_words import genome_lines
from walkerlab.widgets.listing import sort_robots

CROSS = "cross"
MUTATE = "mutate"
EXPLAIN = "explain"


class Microscope(Component):
    """One crossing, one mutation, or one birth of a run, shown gene by gene on the bodies and in the genome text.

    Attributes:
        mode: ``cross``, ``mutate``, or ``explain``, which explains how a robot of the run was made.
        generation: Generation whose robots can be chosen as parents.
        first: Number of the first parent, or of the robot that is mutated.
        second: Number of the second parent.
        crossover: Name of the crossover operator.
        mutation: Name of the mutation operator.
        rate: Mutation rate.
        robot: Number of the robot whose birth is explained.
        birth: Birth that is shown; None if there is an error.
        fault: Why there is no birth; "" if there is one.
    """

    title = "microscope"
    _esm = load_script("microscope")
    _css = load_style("microscope")
    mode = traitlets.Enum([CROSS, MUTATE, EXPLAIN], CROSS).tag(sync=True)
    generation = traitlets.Int(0).tag(sync=True)
    first = traitlets.Int(0).tag(sync=True)
    second = traitlets.Int(0).tag(sync=True)
    crossover = traitlets.Unicode("").tag(sync=True)
    mutation = traitlets.Unicode("").tag(sync=True)
    rate = traitlets.Float(0.05, min=0.0, max=1.0).tag(sync=True)
    robot = traitlets.Int(0).tag(sync=True)
    choices = traitlets.Dict().tag(sync=True)  # modes, generations, robots, crossovers and mutations to choose from
    shown = traitlets.Dict().tag(sync=True)  # drawings, sentence and words of the birth
    fault = traitlets.Unicode("").tag(sync=True)

    def __init__(self, source: Run | Sequence[AnyGenome] | None = None, settings: Settings | None = None) -> None:
        """Create the widget.

        Args:
            source: Run whose robots are parents, or two or more genomes; two random robots if None.
            settings: Settings with the operators and the limits; those of the run, or the defaults, if None.
        """
        super().__init__()
        self._lock = threading.RLock()
        self._run = source if isinstance(source, Run) else None
        self._settings = settings or (self._run.settings if self._run else Settings())
        self._n_repetitions = 0
        self.birth: Birth | None = None
        self._genomes: dict[int, Any] = {}
        robot = self._settings.robot
        if not isinstance(source, Run):
            streams = (random_stream(0, "population", 0, i) for i in range(2))
            given = list(source) if source is not None else [Genome.random(robot, rng=rng) for rng in streams]
            if len(given) < 2:
                raise ValueError(f"source must contain at least two genomes, the parents; it has {len(given)}")
            self._genomes = {i + 1: Genome.of(one).within(robot) for i, one in enumerate(given)}
        self._crossovers = _named_operators(Crossover, self._settings.algorithm.crossover)
        self._mutations = _named_operators(Mutation, self._settings.algorithm.mutation)
        with self._lock, self.hold_trait_notifications():
            if self._run:
                champion = find_champion(self._run.records)
                self.robot = champion.individual
                self.generation = int(self._run.records.generation.max())
            self.crossover = next(iter(self._crossovers))
            self.mutation = next(iter(self._mutations))
            self.rate = self._settings.algorithm.mutation_rate
            self._list_robots()
        self.observe(self._change_generation, "generation")
        self.observe(self._redraw, ["mode", "first", "second", "crossover", "mutation", "rate", "robot"])
        self.on_msg(self._handle_message)
        self._redraw()

    def again(self) -> None:
        """Apply the operator again, with different random numbers."""
        with self._lock:
            self._n_repetitions += 1
            self._redraw()

    def snapshot(self) -> Markup:
        """Return the drawings, the sentence and the genome as static HTML."""
        with self._lock:
            shown = self.shown
            figures = [
                (svg_image_html(figure["picture"]), f"{figure['letter']} {figure['name']}".strip())
                for figure in shown.get("figures", [])
            ]
            return render(
                "widgets/microscope.html",
                fault=self.fault,
                figures=figures,
                operators=shown.get("operators", ""),
                sentence=shown.get("sentence", ""),
                lines=shown.get("lines", []),
            )

    def _list_robots(self) -> None:
        """List the robots of the generation; select the fittest, and the one that differs from it in the most genes."""
        labels: dict[int, str] = {number: f"genome {number}" for number in self._genomes}
        self._n_generations = 0
        if self._run:
            records = self._run.records
            self._n_generations = int(records.generation.max()) + 1
            table = sort_robots(records.loc[records.generation == self.generation, :], "fitness")
            unit = unit_of(records, "fitness")
            self._genomes = dict(zip(table.individual.tolist(), table.genome.tolist(), strict=True))
            labels = {
                number: f"robot {number}, {format_value(fitness, unit) if verdict == 'ok' else verdict}"
                for number, fitness, verdict in zip(table.individual, table.fitness, table.verdict, strict=True)
            }
            self._fitness: dict[int, float] = dict(zip(table.individual.tolist(), table.fitness.tolist(), strict=True))
        else:
            self._fitness = dict.fromkeys(self._genomes, 0.0)
        numbers = list(self._genomes)
        self.choices = {
            "robots": [{"value": number, "label": label} for number, label in labels.items()],
            "n_generations": self._n_generations,
            "crossovers": list(self._crossovers),
            "mutations": list(self._mutations),
        }
        values = [Genome.of(genome).values for genome in self._genomes.values()]
        n_different = [int((one != values[0]).sum()) for one in values]
        self.first = numbers[0]
        self.second = numbers[int(np.argmax(n_different))]

    def _change_generation(self, _: object = None) -> None:
        with self._lock, self.hold_trait_notifications():
            if self._run and 0 <= self.generation < self._n_generations:
                self._list_robots()

    def _redraw(self, _: object = None) -> None:
        with self._lock, self.hold_sync():
            try:
                self.birth = self._make_birth()
                self.fault = ""
                self.shown = _describe(self.birth, self._settings)
            except (OperatorError, RunFileError, ValueError, KeyError) as error:
                self.birth = None
                self.fault = str(error)
                self.shown = {}

    def _make_birth(self) -> Birth:
        rng = random_stream(self._n_repetitions, "analysis", 0)
        if self.mode == EXPLAIN:
            if not self._run:
                raise ValueError("These genomes have no run. Create the microscope with a run to explain a birth.")
            return explain_birth(self._run, self.robot)
        settings = self._settings.with_(mutation_rate=self.rate)
        if self.mode == MUTATE:
            settings = settings.with_(mutation=self._mutations[self.mutation])
            return mutate(_Parent(self.first, self._genomes[self.first], self._run), settings, rng=rng)
        settings = settings.with_(crossover=self._crossovers[self.crossover])
        numbers = [self.first, self.second, *(one for one in self._genomes if one not in (self.first, self.second))]
        parents = [_Parent(number, self._genomes[number], self._run) for number in numbers]
        fitness = [self._fitness[number] for number in numbers]
        return mate(parents[0], parents[1], settings, rng=rng, others=parents[2:], fitness=fitness)

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        if message == "again":
            self.again()


class _Parent:
    """A parent: its genome, and its number if it belongs to a run."""

    def __init__(self, number: int, genome: Any, run: Run | None) -> None:
        self.genome = genome
        if run:
            self.individual = number


def _named_operators(
    choice: type[Choice], setting: Any
) -> dict[str, Choice | Callable[..., Any] | tuple[Choice | Callable[..., Any], ...]]:
    """Return the operators of the settings, keyed by name, followed by all others of their kind."""
    current = setting if isinstance(setting, tuple) else (setting,)
    name = "+".join(one.name if isinstance(one, Choice) else function_name(one) for one in current)
    return {name: setting} | {one.name: one for one in choice if one.name != name}


def _describe(birth: Birth, settings: Settings) -> dict[str, Any]:
    """Return what the browser shows about a birth."""
    *parents, child = draw_birth(birth, settings)
    letters = [parent_letter(i) if len(birth.names) > 1 else "" for i in range(len(parents))]
    figures = [
        {"picture": picture, "letter": letter, "name": name, "colour": hex_colour(parent_colour(i))}
        for i, (picture, letter, name) in enumerate(zip(parents, letters, birth.names, strict=False))
    ]
    figures.append({"picture": child, "letter": "", "name": birth.name, "colour": ""})
    n_more = len(birth.names) - len(parents)
    return {
        "figures": figures,
        "operators": ", ".join(birth.operators),
        "sentence": describe_birth(birth) + (f" {pluralize(n_more, 'more parent')} contributed." if n_more else ""),
        "lines": genome_lines(birth),
        "is_exact": birth.is_exact,
    }
