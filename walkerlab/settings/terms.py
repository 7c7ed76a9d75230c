"""The terms of the field, each explained in a sentence: the only source of tooltips that explain a word."""

TERMS = {
    "gene": "One number of a genome, such as the length of a segment.",
    "genome": "All numbers that a robot inherits: its body and its gait.",
    "population": "All robots of one generation.",
    "generation": "One round of the genetic algorithm: all robots walk, and the fitter ones have children.",
    "fitness": "How good a robot is; evolution increases it. Higher is better.",
    "champion": "The robot with the highest fitness.",
    "operator": "One step of the genetic algorithm: selection, crossover or mutation.",
    "selection": "The operator that chooses parents; fitter robots are chosen more often.",
    "crossover": "The operator that combines the genomes of parents in a child.",
    "mutation": "The operator that changes some genes of a child at random.",
    "elite": "One of the best robots, which survives unchanged in the next generation.",
    "gait": "How the legs move: the rhythm, and the swing of each joint.",
    "phase": "When a movement happens within a stride, as an angle; 6.28 rad is a whole stride.",
    "verdict": "Whether a walk counts, or why it does not.",
    "N·m": "Newton metre, the unit of torque: a force of 1 N at the end of a lever of 1 m.",
    "seed": "Number from which all random numbers follow: the same seed gives the same result.",
}
"""Sentence about each term."""


def explain_term(name: str) -> str:
    """Return the sentence about the term that a setting or a column is named after; "" if there is none.

    Args:
        name: Name of a setting or column, such as ``n_elites``, or a unit.
    """
    word = name.removeprefix("n_")
    return TERMS.get(word) or TERMS.get(word.removesuffix("s"), "")
