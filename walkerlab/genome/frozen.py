"""Frozen genes: those that keep the value of one genome in every robot of a run."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import build_genes
from walkerlab.genome.repair import repair
from walkerlab.settings.choices import Feature, Frozen
from walkerlab.settings.robot import Robot

BODY = frozenset(
    (
        Feature.segments,
        Feature.length,
        Feature.mass,
        Feature.legs,
        Feature.repeat,
        Feature.leg_length,
        Feature.leg_force,
    )
)
"""Features of the body; all others are those of the gait."""


def frozen_features(frozen: Frozen | Sequence[Frozen]) -> frozenset[Feature]:
    """Return the features that a setting freezes, with those of ``body`` and ``gait``."""
    features: set[Feature] = set()
    for entry in (frozen,) if isinstance(frozen, Frozen) else frozen:
        match entry:
            case Frozen.none:
                pass
            case Frozen.body:
                features |= BODY
            case Frozen.gait:
                features |= set(Feature) - BODY
            case _:
                features.add(Feature[entry.name])
    return frozenset(features)


def repair_frozen(genomes: Floats, robot: Robot, features: frozenset[Feature], reference: Floats) -> Floats:
    """Return genomes within the limits, as ``repair`` does, whose frozen genes are those of a reference.

    If the limits and the frozen genes of a robot conflict, such as a frozen length and a new number of segments, the
    robot receives the whole body of the reference, and keeps its gait.

    Args:
        genomes: Genomes, shape (n, n_genes); not modified.
        robot: Limits of the robots.
        features: Frozen features.
        reference: Genome within the limits, shape (n_genes,).
    """
    is_frozen = _mask(features, robot)
    fixed = np.where(is_frozen, reference, genomes)
    repaired = repair(fixed, robot)
    excludes = (repaired[:, is_frozen] != fixed[:, is_frozen]).any(axis=1, keepdims=True)
    if not excludes.any():
        return repaired
    with_body = np.where(is_frozen | _mask(BODY, robot), reference, genomes)
    return np.where(excludes, repair(with_body, robot), repaired)


def _mask(features: frozenset[Feature], robot: Robot) -> NDArray[np.bool_]:
    """Return whether each gene belongs to one of the features, shape (n_genes,)."""
    genes = build_genes(robot)
    return np.array([name.rpartition(".")[2] in {feature.name for feature in features} for name in genes.names])
