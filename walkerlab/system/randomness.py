"""Random generators that are identified by purpose and address, not by the order of draws.

Two runs that differ in one operator draw the same numbers everywhere else, and neither the number of workers nor the
order in which they finish can change a result.
"""

from hashlib import sha256
from unicodedata import normalize

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

N_NAMED_SEEDS = 1_000_000  # so many that two students of a class rarely share one


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


def seed_of_name(name: str) -> int:
    """Return a seed made from a name: the same name gives the same seed on every computer.

    Upper and lower case, and spaces around the name, make no difference.
    """
    text = normalize("NFKC", " ".join(name.split())).casefold()
    return int.from_bytes(sha256(text.encode()).digest()[:8], "big") % N_NAMED_SEEDS
