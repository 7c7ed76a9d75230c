"""Explanations of technical terms, which the panel shows as tooltips."""

TERMS = {
    "gene": "One number of a genome, such as the length of a segment.",
    "genome": "All genes of a robot: the numbers that determine its body and its gait.",
    "population": "All robots of one generation.",
    "generation": "One round of the genetic algorithm: all robots walk, and the fitter ones have children.",
    "fitness": "The number by which selection compares robots; higher is better.",
    "champion": "The robot with the highest fitness.",
    "operator": "One step of the genetic algorithm: selection, crossover or mutation.",
    "selection": "The operator that chooses parents; fitter robots are chosen more often.",
    "crossover": "The operator that combines the genomes of parents into the genome of a child.",
    "mutation": "The operator that changes some genes of a child at random.",
    "elite": "One of the best robots, which is copied unchanged into the next generation.",
    "gait": "How the legs move: the rhythm, and the swing of each joint.",
    "phase": "When a movement happens within a stride, as an angle; 6.28 rad is a whole stride.",
    "verdict": "Whether a walk counts, or why it does not.",
    "N·m": "Newton metre, the unit of torque: a force of 1 N at the end of a lever of 1 m.",
    "seed": "Number that determines all random numbers: the same seed gives the same result.",
}
"""Explanation of each term, as a sentence."""


def explain_term(name: str) -> str:
    """Return the explanation of the term in the name of a setting or a column; "" if there is none.

    Args:
        name: Name of a setting or column, such as ``n_elites``, or a unit.
    """
    word = name.removeprefix("n_")
    return TERMS.get(word) or TERMS.get(word.removesuffix("s"), "")
