"""Descriptions of the genes for the sliders of the editor: groups, names, units, ranges and meanings."""

from typing import Any

from walkerlab.genome.features import BODY_FEATURES, LEG_FEATURES, gene_table, gene_words
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot

LEG_SHAPE = (Feature.legs, Feature.repeat, Feature.leg_length, Feature.leg_force)


def describe_genes(robot: Robot) -> list[dict[str, Any]]:
    """Describe each gene as plain data for the browser, in the order of the genes in a genome.

    Args:
        robot: Limits of the robot.

    Returns:
        ``name``, ``label``, ``group`` (the whole robot, or a segment), ``section`` within the group (body, legs or
        gait), ``unit``, ``low``, ``high``, ``kind`` and ``meaning`` of each gene, as in ``gene_table``.
    """
    return [_describe_gene(row) for row in gene_table(robot).to_dict("records")]


def _describe_gene(row: dict[Any, Any]) -> dict[str, Any]:
    group, label = gene_words(row["gene"])
    feature = Feature[row["gene"].rpartition(".")[2]]
    return {
        "name": row["gene"],
        "label": label,
        "group": group,
        "section": _section_of(feature),
        "unit": row["unit"] if row["kind"] != "count" else "",
        "low": float(row["low"]),
        "high": float(row["high"]),
        "kind": row["kind"],
        "meaning": row["meaning"],
    }


def _section_of(feature: Feature) -> str:
    if feature in LEG_SHAPE:
        return "legs"
    is_of_gait = feature in LEG_FEATURES or (feature in BODY_FEATURES and feature != Feature.segments)
    return "gait" if is_of_gait else "body"
