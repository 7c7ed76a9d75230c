"""A statement of a lesson about what a run shows, and the measure that tests it."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache

import walkerlab as wl


@dataclass(frozen=True)
class Claim:
    """A statement that is measured with several seeds.

    Attributes:
        id: Number of the lesson and a letter: "03.a".
        text: The sentence of the lesson.
        measure: Function of a seed that returns a figure; above 0 means that the statement holds for this seed.
        unit: Unit of the figure.
        needed: Number of seeds, out of 5, for which the statement must hold.
    """

    id: str
    text: str
    measure: Callable[[int], float]
    unit: str = ""
    needed: int = 4


@cache
def evolve_here(settings: wl.Settings) -> wl.Run:
    """Evolve on one core of this process, and remember the run, so that several claims can use it.

    Args:
        settings: Complete settings of the run.
    """
    with ThreadPoolExecutor(1) as executor:
        return wl.evolve(settings, executor=executor, progress=False)
