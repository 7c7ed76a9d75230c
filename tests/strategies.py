"""What hypothesis draws from: limits that can hold together, genomes, and settings of every kind."""

import math

import numpy as np
from hypothesis import strategies as st

from walkerlab.genome.features import BODY_FEATURES, SEGMENT_FEATURES, build_genes
from walkerlab.genome.genome import Genome
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.fields import OneOf, Quantity
from walkerlab.settings.model import SettingsError
from walkerlab.settings.proportions import MAX_TRUNK_MASS, MIN_TRUNK_MASS
from walkerlab.settings.robot import LIGHT_SHARE, MASS_MARGIN, Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain


def numbers(low, high):
    """Ends, round numbers and any others between two numbers."""
    round_ones = st.integers(math.ceil(low * 1000), math.floor(high * 1000)).map(lambda thousands: thousands / 1000)
    return st.sampled_from([low, high]) | round_ones | st.floats(low, high)


def pairs(declared):
    """(min, max) within a declared range, often the same number twice."""
    inside = numbers(declared.low, declared.high)
    return inside.map(lambda x: (x, x)) | st.tuples(inside, inside).map(sorted).map(tuple)


@st.composite
def robots(draw):
    """Limits that at least one robot obeys: that robot is drawn first, and each limit is drawn around it."""
    declared = Robot.declared()
    n_segments = draw(st.integers(1, 8))
    n_pairs = draw(st.integers(1, n_segments))
    shortest = draw(numbers(0.05, min(2.0, 8.0 / n_segments)))
    longest = draw(st.just(shortest) | numbers(shortest, 2.0))
    share = draw(st.floats(0, 1))
    length = min(8.0, n_segments * (shortest + share * (longest - shortest)))
    weight = draw(pairs(declared["weight"]))
    heaviest = MASS_MARGIN * MAX_TRUNK_MASS * length**3 / n_segments**2 * (1 - 1e-9)
    lightest = MIN_TRUNK_MASS / LIGHT_SHARE * length * min(longest, length) ** 2 * (1 + 1e-9)
    least_legs, most_legs = draw(st.integers(1, n_pairs)), draw(st.integers(n_pairs, 8))
    return Robot(
        weight=(min(weight[0], heaviest), max(weight[1], lightest)),
        body_length=draw(st.just((length, length)) | st.tuples(numbers(0.05, length), numbers(length, 8.0))),
        segments=(draw(st.integers(1, n_segments)), draw(st.integers(n_segments, 8))),
        segment_length=(shortest, longest),
        legs=(max(2, 2 * least_legs - draw(st.integers(0, 1))), min(16, 2 * most_legs + draw(st.integers(0, 1)))),
        leg_force=draw(pairs(declared["leg_force"])),
    )


@st.composite
def tables(draw, robot, n=6):
    """(n, n_genes) of finite numbers: within the ranges, at their ends, near them, far off, and anything at all."""
    genes = build_genes(robot)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    width = genes.high - genes.low
    inside = genes.low + width * rng.random((n, len(genes)))
    near = genes.low + width * rng.normal(0.5, 1.0, (n, len(genes)))
    far = rng.normal(0, 1, (n, len(genes))) * 10.0 ** rng.integers(-12, 12, (n, len(genes)))
    wild = np.resize(draw(st.lists(finite, min_size=1, max_size=8)), (n, len(genes)))
    kinds = [inside, near, far, wild, np.broadcast_to(genes.low, inside.shape), np.broadcast_to(genes.high, near.shape)]
    among = draw(st.lists(st.integers(0, len(kinds) - 1), min_size=1, max_size=4))
    return np.choose(rng.choice(among, (n, len(genes))), kinds)


finite = st.floats(allow_nan=False, allow_infinity=False)


def count_genes(n_segments):
    """Return the number of genes of a genome that describes this many segments."""
    return len(BODY_FEATURES) + len(SEGMENT_FEATURES) * n_segments


@st.composite
def genomes(draw, max_parts=8):
    """Any finite numbers, of any number of segments, as no repair would leave them."""
    n_genes = count_genes(draw(st.integers(1, max_parts)))
    some = draw(st.lists(finite, min_size=1, max_size=n_genes))
    return Genome(np.resize(some, n_genes))


def values(declared):
    """What a declared setting accepts, as plain data or members."""
    match declared:
        case OneOf(several=True):
            return st.sampled_from(declared.choices) | st.lists(st.sampled_from(declared.choices), min_size=1)
        case OneOf():
            return st.sampled_from(declared.choices)
        case Quantity(whole=True, components=()):
            return st.integers(declared.low, declared.high)
        case Quantity(components=()):
            return numbers(declared.low, declared.high)
        case Quantity():
            return st.tuples(*[numbers(declared.low, declared.high)] * len(declared.components))


def domains(kind):
    return st.fixed_dictionaries({name: values(declared) for name, declared in kind.declared().items()})


algorithms = domains(Algorithm).map(
    lambda drawn: Algorithm(**drawn | {"n_elites": drawn["n_elites"] % drawn["population_size"]})
)


def _bare_if_need_be(drawn):
    """Strew what was drawn, or nothing if it is more than a ground can hold."""
    try:
        return Terrain(**drawn)
    except SettingsError:
        return Terrain(**drawn | {"texture_density": 0.0, "obstacle": "none"})


terrains = domains(Terrain).map(_bare_if_need_be)

all_settings = st.builds(
    Settings,
    terrain=terrains,
    robot=robots(),
    algorithm=algorithms,
    simulation=domains(Simulation).map(lambda drawn: Simulation(**drawn)),
)
