"""Pictures: of the tidy table, of a walk, and of a robot. Each draws on the Axes that it is given, and returns it."""

from walkerlab.plots.bodies import body as body
from walkerlab.plots.bodies import stride as stride
from walkerlab.plots.counts import verdicts as verdicts
from walkerlab.plots.curves import fitness_curve as fitness_curve
from walkerlab.plots.curves import trait as trait
from walkerlab.plots.family import family_tree as family_tree
from walkerlab.plots.genomes import diversity as diversity
from walkerlab.plots.genomes import genes as genes
from walkerlab.plots.style import alt_text as alt_text
from walkerlab.plots.style import save as save
from walkerlab.plots.walks import distance_over_time as distance_over_time
from walkerlab.plots.walks import gait as gait
