"""Why a run improved: selection, variation, credit, ancestry and landscapes, as numbers and tables."""

from walkerlab.analysis.comparison import compare_with_parents as compare_with_parents
from walkerlab.analysis.credit import operator_credit as operator_credit
from walkerlab.analysis.distance import aligned_distances as aligned_distances
from walkerlab.analysis.distance import aligned_diversity as aligned_diversity
from walkerlab.analysis.inheritance import Birth as Birth
from walkerlab.analysis.landscape import landscape as landscape
from walkerlab.analysis.mating import mate as mate
from walkerlab.analysis.mating import mutate as mutate
from walkerlab.analysis.onemax import evolve_onemax as evolve_onemax
from walkerlab.analysis.onemax import onemax_times as onemax_times
from walkerlab.analysis.price import price_equation as price_equation
from walkerlab.analysis.rescoring import rescore as rescore
from walkerlab.analysis.selection import follow_takeover as follow_takeover
from walkerlab.analysis.selection import measure_selection as measure_selection
from walkerlab.analysis.selection import selection_probabilities as selection_probabilities
