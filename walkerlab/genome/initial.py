"""Random genomes of the first generation: bodies that stand on their feet, and gaits that lift the foot as it swings.

If genes are drawn uniformly from their ranges, nine robots out of ten lie on their belly from the start. Here angles
and leg lengths are drawn so that most robots stand, and about half of them move forward. Everything else is
uniform.
"""

import math

import numpy as np
from numpy.random import Generator

from walkerlab.ga.genes import Floats, Genes
from walkerlab.genome.features import build_genes
from walkerlab.settings.robot import Robot

LEGS_PROBABILITY = 0.9  # probability that a segment has legs
REPEAT_PROBABILITY = 0.9  # probability that a segment repeats the legs and the step of those in front of it
LEG_LENGTH_SHARE = (0.2, 0.6)  # share of the range; long legs topple, and with short ones the belly touches the ground
LAG_RANGE = (math.pi / 2, 3 * math.pi / 2)  # rad, around half a turn, where neighbours step in turn
KNEE_BEND = (0.2, 0.9)  # rad, forward or backward
THIGH_TILT = 0.15  # rad, standard deviation of the thigh's angle around the angle that puts the foot below the hip
AMPLITUDE_RANGE = (0.2, 0.6)  # rad
LIFT_SPREAD = 0.5  # rad, standard deviation of the knee's phase around the phase that lifts the swinging foot
STRIDE_SPREAD = 0.3  # rad, standard deviation of the phase between left and right from 0 (bound) or π (trot)


def draw_genes(robot: Robot, rng: Generator) -> Floats:
    """Draw the genes of a robot of the first generation, before they are repaired.

    Args:
        robot: Limits of the robot.
        rng: Random number generator.

    Returns:
        Gene values, shape (n_genes,).
    """
    genes = build_genes(robot)
    drawn = rng.uniform(genes.low, genes.high)
    counts = rng.integers(genes.low.astype(int), genes.high.astype(int), endpoint=True)
    values = np.where(genes.is_count, counts, drawn)
    for feature, feature_values in _draw_standing_gait(genes, rng).items():
        values[genes.find(feature)] = feature_values
    return values


def _draw_standing_gait(genes: Genes, rng: Generator) -> dict[str, Floats | float]:
    """Draw the features whose uniform values seldom make a robot stand or walk; one value, or one for each segment."""
    n = genes.n_parts
    leg_length = genes.find("leg_length")
    low = genes.low[leg_length]
    high = genes.high[leg_length]
    direction = rng.choice([-1.0, 1.0], n)  # direction in which the knees bend
    knee_offset = direction * rng.uniform(*KNEE_BEND, n)
    return {
        "lag": rng.uniform(*LAG_RANGE),
        "legs": (rng.random(n) < LEGS_PROBABILITY).astype(np.float64),
        "repeat": (rng.random(n) < REPEAT_PROBABILITY).astype(np.float64),
        "leg_length": low + (high - low) * rng.uniform(*LEG_LENGTH_SHARE, n),
        "hip_amplitude": rng.uniform(*AMPLITUDE_RANGE, n),
        "hip_offset": -knee_offset / 2 + rng.normal(0.0, THIGH_TILT, n),
        "knee_amplitude": rng.uniform(*AMPLITUDE_RANGE, n),
        "knee_offset": knee_offset,
        "knee_phase": direction * math.pi / 2 + rng.normal(0.0, LIFT_SPREAD, n),
        "stride": math.pi * rng.integers(2, size=n) + rng.normal(0.0, STRIDE_SPREAD, n),
    }
