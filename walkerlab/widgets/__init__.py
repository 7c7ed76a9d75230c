"""The panel and its components, each of which can also be used alone in a notebook cell."""

from walkerlab.widgets.curve import Curve as Curve
from walkerlab.widgets.editor import Editor as Editor
from walkerlab.widgets.form import Form as Form
from walkerlab.widgets.lab import Lab as Lab
from walkerlab.widgets.playground import Playground as Playground
from walkerlab.widgets.population import Population as Population
from walkerlab.widgets.world import World as World

__all__ = ["Curve", "Editor", "Form", "Lab", "Playground", "Population", "World"]
