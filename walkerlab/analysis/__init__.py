"""Why a run improved: selection, variation, credit, ancestry and landscapes, as numbers and tables."""
