"""Pictures: of the tidy table, of a walk, and of a robot. Each draws on the Axes that it is given."""

from walkerlab.plots.bodies import stride as stride
from walkerlab.plots.curves import fitness_curve as fitness_curve
from walkerlab.plots.style import save as save
