"""Random generators that are identified by purpose and address, not by the order of draws.

Two runs that differ in one operator draw the same numbers everywhere else, and neither the number of workers nor the
order in which they finish can change a result.
"""

from numpy.random import Generator, SeedSequence, default_rng

PURPOSES = (
    "population",
    "selection",
    "crossover",
    "mutation",
    "perturbation",
    "terrain",
    "check",
    "search",
    "analysis",
)
"""Purposes of random numbers. Results depend on their order: append, never reorder."""


def random_stream(seed: int, purpose: str, *address: int) -> Generator:
    """Return the random generator for a purpose and an address.

    Args:
        seed: Seed of the run, 0 or more.
        purpose: One of ``PURPOSES``.
        *address: Numbers that distinguish this stream from others with the same purpose, such as generation, position
            of the operator and child; each 0 or more.

    Raises:
        ValueError: If the purpose is not in ``PURPOSES``.
    """
    return default_rng(SeedSequence(seed, spawn_key=(PURPOSES.index(purpose), *address)))
