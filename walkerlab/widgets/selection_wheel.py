"""The roulette wheel of a selection operator, redrawn when the operator or its pressure changes."""

import io
import threading
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count
from typing import Any

import numpy as np
import traitlets
from numpy.typing import ArrayLike

from walkerlab.analysis import selection_probabilities
from walkerlab.ga import selection as operators
from walkerlab.ga.genes import Floats
from walkerlab.genome.breeding import select_from_population
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Selection
from walkerlab.settings.values import function_name, pluralize
from walkerlab.text.html import inline_svg
from walkerlab.text.templates import Markup
from walkerlab.view import plots
from walkerlab.view.plots.appearance import StyledFigure, walkerlab_style
from walkerlab.view.plots.tables import require_table
from walkerlab.view.snapshots import svg_image_html
from walkerlab.widgets.component import Component, load_script, load_style

PICTURE_SIZE = (9.6, 4.9)  # inches
WHEEL_POSITION = (0.01, 0.36, 0.45, 0.58)  # left, bottom, width, height; fixed, which is faster than a computed layout
BARS_POSITION = (0.53, 0.36, 0.46, 0.56)
EXAMPLE_SIZE = 20  # number of individuals of the example
PARAMETERS: dict[str, dict[str, Any]] = {
    "tournament": {"keyword": "size", "label": "tournament size", "low": 1, "high": 12, "step": 1},
    "rank": {"keyword": "pressure", "label": "chance of the fittest (1 = average)", "low": 1, "high": 2, "step": 0.05},
}
"""Parameter of each operator that has one: its keyword, label and range."""

DEFAULTS = {"tournament": 3.0, "rank": 1.8}
_picture_ids = count()  # shared by all drawings, because IDs must be unique on a page


class SelectionWheel(Component):
    """The probabilities of selection as a roulette wheel and as bars, with a menu of operators and a slider.

    A button spins the wheel once for each parent and marks how often each individual was selected.

    Attributes:
        selection: Name of the operator.
        parameters: Value of the parameter of each operator that has one, keyed by the name of the operator.
        picture: Drawing, as SVG.
        words: Result of the last spin; "" before the first.
    """

    title = "selection wheel"
    _esm = load_script("selection_wheel")
    _css = load_style("selection_wheel")
    selection = traitlets.Unicode("gradient").tag(sync=True)
    parameters = traitlets.Dict(DEFAULTS).tag(sync=True)
    options = traitlets.List().tag(sync=True)
    picture = traitlets.Unicode("").tag(sync=True)
    words = traitlets.Unicode("").tag(sync=True)

    def __init__(self, fitness: Any = None, functions: Sequence[Callable[..., Any]] = ()) -> None:
        """Create the widget.

        Args:
            fitness: Fitness of each individual, shape (n,); or a run or its table, for the last generation; if None, an
                example of 20 individuals.
            functions: Selection functions that are offered in addition to those of walkerlab.

        Raises:
            ValueError: If ``fitness`` is empty or contains NaN or +inf.
            OperatorError: If a function breaks a rule of selection functions.
        """
        self._lock = threading.RLock()
        self._fitness = _read_fitness(fitness)
        self._functions = {function_name(function): function for function in functions}
        self._n_spins = 0
        for function in functions:
            selection_probabilities(self._fitness, function)  # reports an error before anything is displayed
        super().__init__(options=[*map(_describe, Selection), *({"name": name} for name in self._functions)])
        self.observe(self._redraw, ["selection", "parameters"])
        self.on_msg(self._handle_message)
        self._redraw()

    def spin(self) -> None:
        """Select as many parents as there are individuals, and mark how often each was selected."""
        with self._lock:
            self._n_spins += 1
            algorithm = Algorithm(selection=self._operator(), seed=self._n_spins)
            n = len(self._fitness)
            selected = select_from_population(self._fitness, n, algorithm, generation=1)
            copies = np.bincount(selected, minlength=n)
            best = int(np.argmax(self._fitness))
            self.words = (
                f"{pluralize(n, 'parent')} selected: {int((copies > 0).sum())} of {n} individuals at least once, the "
                f"fittest {pluralize(int(copies[best]), 'time')}."
            )
            self._draw(copies)

    def snapshot(self) -> Markup:
        """Return the drawing as static HTML."""
        return svg_image_html(self.picture)

    def _operator(self) -> Any:
        """Return the selected operator with its parameter; the default if the name is unknown."""
        name = self.selection
        if name in self._functions:
            return self._functions[name]
        if name not in Selection.__members__:
            return Selection.gradient
        if name not in PARAMETERS:
            return Selection[name]
        declared = PARAMETERS[name]
        value: Any = self.parameters.get(name, DEFAULTS[name])
        number = float(value) if isinstance(value, int | float) else DEFAULTS[name]  # a browser may send anything
        number = min(max(number, declared["low"]), declared["high"])
        bound: Any = {declared["keyword"]: round(number) if declared["step"] == 1 else number}
        return partial(getattr(operators, name), **bound)

    def _redraw(self, _: object = None) -> None:
        with self._lock:
            self.words = ""
            self._draw()

    def _draw(self, copies: Any = None) -> None:
        """Draw the wheel and the bars, with a dot for each individual's share of the selected parents.

        Args:
            copies: How often each individual was selected, shape (n,); no dots if None.
        """
        table = selection_probabilities(self._fitness, self._operator())
        with walkerlab_style():
            figure = StyledFigure(figsize=PICTURE_SIZE, facecolor="white")
            wheel, bars = map(figure.add_axes, (WHEEL_POSITION, BARS_POSITION))
        plots.roulette_wheel(table, wheel)
        plots.selection_by_rank(table, bars)
        if copies is not None:
            dots: dict[str, Any] = {"ls": "", "marker": "o", "ms": 5, "mfc": "white", "mec": "black", "zorder": 3}
            bars.plot(table["rank"], 100 * copies / copies.sum(), **dots, label="share of the parents in this spin")
            bars.set_ylim(top=max(bars.get_ylim()[1], 125 * copies.max() / copies.sum()))
            bars.legend(frameon=False, fontsize=9, loc="upper right")
        file = io.StringIO()
        figure.savefig(file, format="svg")
        alt = f"{plots.alt_text(wheel)} {self.words}".strip()
        self.picture = inline_svg(file.getvalue(), f"wheel{next(_picture_ids)}", alt)

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        """Spin the wheel if the browser requests it."""
        if message == "spin":
            self.spin()


def _describe(member: Selection) -> dict[str, Any]:
    """Return what the browser needs to know about an operator."""
    return {"name": member.name, "about": member.about, "parameter": PARAMETERS.get(member.name)}


def _read_fitness(given: ArrayLike | Any) -> Floats:
    """Return the fitness of each individual, from a row of numbers, a table or a run."""
    if given is None:
        return np.linspace(0, 1, EXAMPLE_SIZE) ** 2
    if hasattr(given, "records") or hasattr(given, "columns"):
        table = require_table(given, "fitness")
        return table.fitness[table.generation == table.generation.max()].to_numpy(dtype=np.float64)
    return np.asarray(given, dtype=np.float64)
