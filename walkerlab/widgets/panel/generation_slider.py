"""A slider that selects the generation whose robots are shown."""

import traitlets

from walkerlab.text.templates import Markup, render
from walkerlab.widgets.component import Component, load_script, load_style

LATEST = -1


class GenerationSlider(Component):
    """A slider over the completed generations of a run; it follows the latest one until the user moves it.

    Attributes:
        n_generations: Number of completed generations.
        selected: Number of the selected generation; -1 for the latest.
    """

    title = "generation"
    _esm = load_script("panel/generation_slider")
    _css = load_style("panel/generation_slider")
    n_generations = traitlets.Int(0).tag(sync=True)
    selected = traitlets.Int(LATEST).tag(sync=True)

    @property
    def generation(self) -> int | None:
        """Number of the selected generation; None for the latest."""
        return self.selected if 0 <= self.selected < self.n_generations else None

    def snapshot(self) -> Markup:
        """Return a sentence about the generation that is shown."""
        latest = self.n_generations - 1
        number = latest if self.generation is None else self.generation
        return render("widgets/panel/generation_slider.html", n_generations=self.n_generations, generation=number)
