"""Plots of the table of a run, of a walk, and of a robot. Each function draws on the given Axes and returns it."""

from walkerlab.view.plots.ancestry import family_tree as family_tree
from walkerlab.view.plots.births import birth as birth
from walkerlab.view.plots.bodies import body as body
from walkerlab.view.plots.bodies import stride as stride
from walkerlab.view.plots.comparison import best_of_each_run as best_of_each_run
from walkerlab.view.plots.convergence import onemax as onemax
from walkerlab.view.plots.convergence import takeover as takeover
from walkerlab.view.plots.counts import verdicts as verdicts
from walkerlab.view.plots.curves import fitness_curve as fitness_curve
from walkerlab.view.plots.curves import trait as trait
from walkerlab.view.plots.genomes import diversity as diversity
from walkerlab.view.plots.genomes import genes as genes
from walkerlab.view.plots.improvement import improvement as improvement
from walkerlab.view.plots.improvement import operator_credit as operator_credit
from walkerlab.view.plots.landscape import landscape as landscape
from walkerlab.view.plots.pedigree import pedigree as pedigree
from walkerlab.view.plots.rescoring import rescoring as rescoring
from walkerlab.view.plots.selection import roulette_wheel as roulette_wheel
from walkerlab.view.plots.selection import selection_by_rank as selection_by_rank
from walkerlab.view.plots.selection import selection_pressure as selection_pressure
from walkerlab.view.plots.style import alt_text as alt_text
from walkerlab.view.plots.style import save as save
from walkerlab.view.plots.variation import before_after as before_after
from walkerlab.view.plots.walks import distance_over_time as distance_over_time
from walkerlab.view.plots.walks import gait as gait
