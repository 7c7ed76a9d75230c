"""Why a run improved: selection, variation, credit, ancestry and landscapes, as numbers and tables."""

from walkerlab.analysis.comparison import compare_with_parents as compare_with_parents
from walkerlab.analysis.inheritance import Birth as Birth
from walkerlab.analysis.landscape import landscape as landscape
from walkerlab.analysis.mating import mate as mate
from walkerlab.analysis.mating import mutate as mutate
