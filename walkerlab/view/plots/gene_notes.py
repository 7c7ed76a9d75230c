"""What each gene describes, in a few words, for headings and captions."""

from collections.abc import Iterable

from walkerlab.settings.choices import Feature

GENE_NOTES = {
    Feature.segments: "how many",
    Feature.frequency: "strides per second",
    Feature.lag: "delay from each leg pair to the next one behind",
    Feature.duty: "part of a stride in which legs push backward",
    Feature.length: "of the trunk",
    Feature.mass: "of trunk and legs",
    Feature.legs: "one pair or none",
    Feature.repeat: "copies the legs in front, or has its own",
    Feature.leg_length: "thigh and shank",
    Feature.leg_force: "greatest torque",
    Feature.hip_amplitude: "how far the thigh swings",
    Feature.hip_phase: "when in a stride the thigh swings forward",
    Feature.hip_offset: "middle of the thigh's swing",
    Feature.knee_amplitude: "how far the shank swings",
    Feature.knee_phase: "how far the shank is ahead of the thigh",
    Feature.knee_offset: "middle of the shank's swing",
    Feature.stride: "delay from left leg to right leg",
}
"""What each feature describes; shorter than ``Feature.about``, to fit in a heading."""

STRIDE_ANGLE = "6.28 rad is one whole stride"
"""How to read the features that are delays within a stride."""

STRIDE_FEATURES = (Feature.lag, Feature.hip_phase, Feature.knee_phase, Feature.stride)
"""Features that are delays within a stride."""

PLAIN_FEATURES = (Feature.segments, Feature.length, Feature.mass, Feature.leg_length)
"""Features whose names need no explanation outside a table."""

EXPLAINED_FEATURES = tuple(each for each in GENE_NOTES if each not in PLAIN_FEATURES)
"""All other features."""


def explain_genes(features: Iterable[Feature]) -> str:
    """Return a sentence that explains genes: ``Genes: lag = delay …; duty = part …``; "" if there are none."""
    features = tuple(features)
    notes = [f"{each.name.replace('_', ' ')} = {GENE_NOTES[each]}" for each in features]
    notes += [STRIDE_ANGLE] if any(each in STRIDE_FEATURES for each in features) else []
    return f"Genes: {'; '.join(notes)}." if notes else ""
