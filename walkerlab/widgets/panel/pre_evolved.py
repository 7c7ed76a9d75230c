"""The walker that the panel shows before the first run, evolved by ``python -m walkerlab.commands.walker``."""

import json
from dataclasses import dataclass
from functools import cache

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.system.package_files import find_package_file

FILE = "data/walker.json"


@dataclass(frozen=True)
class PreEvolvedWalker:
    """The champion of a run with the default settings.

    Attributes:
        genome: Its genome.
        settings: Settings of its run.
        n_trials: Number of robots that walked in its run.
        distance: Distance of its walk, m.
    """

    genome: Genome
    settings: Settings
    n_trials: int
    distance: float


@cache
def load_pre_evolved_walker() -> PreEvolvedWalker:
    """Read the walker."""
    walker = json.loads(find_package_file(FILE).read_text(encoding="utf-8"))
    settings = Settings().with_(**walker["settings"])
    return PreEvolvedWalker(Genome.parse(walker["genome"]), settings, walker["n_trials"], walker["distance"])
