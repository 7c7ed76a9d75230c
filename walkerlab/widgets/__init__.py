"""The panel and its components, each of which can also be used alone in a notebook cell."""

from walkerlab.widgets.clickable_plot import ClickablePlot as ClickablePlot
from walkerlab.widgets.curve import Curve as Curve
from walkerlab.widgets.editor import Editor as Editor
from walkerlab.widgets.form import Form as Form
from walkerlab.widgets.interactive import Interactive as Interactive
from walkerlab.widgets.landscape import Landscape as Landscape
from walkerlab.widgets.microscope import Microscope as Microscope
from walkerlab.widgets.panel.lab import Lab as Lab
from walkerlab.widgets.plain import slider as slider
from walkerlab.widgets.plain import sliders as sliders
from walkerlab.widgets.playground import Playground as Playground
from walkerlab.widgets.population import Population as Population
from walkerlab.widgets.selection_wheel import SelectionWheel as SelectionWheel
from walkerlab.widgets.world import World as World

__all__ = [
    "ClickablePlot",
    "Curve",
    "Editor",
    "Form",
    "Interactive",
    "Lab",
    "Landscape",
    "Microscope",
    "Playground",
    "Population",
    "SelectionWheel",
    "World",
    "slider",
    "sliders",
]
