"""All chance, by address: a stream is named by what it is for, never by who drew before it.

Two runs that differ in one operator draw the same numbers everywhere else, and neither the number of
workers nor the order in which they finish can change a result.
"""

from numpy.random import Generator, SeedSequence, default_rng

PURPOSES = ("population", "selection", "crossover", "mutation", "perturbation", "terrain", "check")
"""What chance is spent on. The order is part of every recorded run: append, never reorder."""


def stream(seed: int, purpose: str, *address: int) -> Generator:
    """Return the generator that stands at one address.

    Args:
        seed: a run's seed, 0 or more.
        purpose: one of ``PURPOSES``.
        *address: whatever tells this draw from its neighbours (generation, place in a list, child), each 0 or more.

    Raises:
        ValueError: if the purpose is not in the table.
    """
    return default_rng(SeedSequence(seed, spawn_key=(PURPOSES.index(purpose), *address)))
