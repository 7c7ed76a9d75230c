"""Script that writes the glossary of the lessons: ``python -m walkerlab.lessons.glossary notebooks/glossary.md``.

Terms of the panel's tooltips come from ``walkerlab/settings/terms.py``.
"""

import sys

from walkerlab.settings.terms import TERMS
from walkerlab.system.files import file_path, write_text

HEADING = "# Glossary"
UNITS = ("N·m",)  # explained in tooltips only
MORE_TERMS = {
    "body length": "The distance from the front of the first segment to the end of the last, in m.",
    "cluster": "Several computers that share the work of one program.",
    "confirmation": "A second test of a champion, at a smaller timestep and from other starts.",
    "convergence": "The state in which all robots of a generation have become similar.",
    "cheat": "A walk that wins by a fault of the simulation or of the rules, not by walking.",
    "digest": "A short number computed from a text: the same text gives the same number, any other text another one.",
    "diversity": "How different the genomes of a generation are.",
    "duty factor": "The share of a stride in which a foot is on the ground.",
    "elites": "The best robots of a generation, which are copied unchanged into the next one.",
    "evaluation": "One walk of one robot, which gives its fitness.",
    "executor": "The part of a program that distributes tasks, such as walks, to cores or computers.",
    "friction": "The force that keeps a foot from sliding; ice has little of it, rubber much.",
    "guard": "A rule under which a walk does not count, for instance because the robot jumped.",
    "local optimum": "A genome that no small change improves, although better genomes exist.",
    "median": "The middle value: half of the values are smaller, half are larger.",
    "mutation rate": "The probability with which a gene mutates.",
    "mutation scale": "The size of the change when a gene mutates, as a share of its range.",
    "offspring": "The children of a generation.",
    "p-value": "The probability of a difference at least as large as the measured one if only chance acted.",
    "parent": "A robot that selection has chosen; its genome goes into its children.",
    "pedigree": "A drawing of a robot with its ancestors.",
    "phenotype": "The body and the gait that a genome produces.",
    "quartile": "A quarter of the values is below the lower quartile, and a quarter is above the upper quartile.",
    "random search": "Trying random genomes without selection, crossover or mutation; the standard of comparison.",
    "seal": "A choice that is kept secret but cannot be changed: its digest is published before, the choice after.",
    "segment": "One part of a robot's body; it can have a pair of legs.",
    "selection pressure": "How much more often fit robots become parents than others.",
    "settings": "All numbers and choices of a run: ground, robots, algorithm and simulation.",
    "significance": "A difference is significant if it is too large to be a likely result of chance.",
    "stride": "One complete cycle of the legs.",
    "takeover": "The copies of the best genome fill the whole population.",
    "timestep": "The short time by which the simulation advances at once, in s.",
    "torque": "The turning force of a joint, in N·m.",
    "tournament": "A selection in which a few random robots are compared, and the fittest becomes a parent.",
}
"""Explanation of each term that the panel does not need, as a sentence."""


def glossary_text() -> str:
    """Return the glossary in Markdown: a heading and a sentence for each term, so that a lesson can link to a term."""
    terms = {name: about for name, about in (TERMS | MORE_TERMS).items() if name not in UNITS}
    parts = [HEADING, "The terms of the lessons, in alphabetical order."]
    parts += [f"## {name}\n\n{terms[name]}" for name in sorted(terms)]
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    write_text(file_path(sys.argv[1]), glossary_text())
