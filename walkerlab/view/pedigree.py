"""The line of descent of a robot, with the genes that changed from each robot to the next."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from walkerlab.analysis.inheritance import gene_widths, shortest_change
from walkerlab.ga.genes import Genes
from walkerlab.genome.features import (
    BODY_FEATURES,
    LEG_FEATURES,
    SEGMENT_FEATURES,
    TRUNK_FEATURES,
    build_genes,
    find_leg_sources,
    is_expressed,
)
from walkerlab.genome.frozen import BODY
from walkerlab.genome.genome import Genome
from walkerlab.runfile.records import birth_rows, find_champion, fitter_line, parent_numbers, select_lineage
from walkerlab.runfile.tables import require_table
from walkerlab.settings.choices import Feature
from walkerlab.settings.robot import Robot
from walkerlab.settings.values import pluralize
from walkerlab.view.inheritance import format_gene


@dataclass(frozen=True)
class GeneChange:
    """A gene that differs between two robots of a line.

    Attributes:
        gene: Name of the gene.
        before: Value of the earlier robot.
        after: Value of the later robot.
        share: Change as a share of the gene's range in the default limits; the shorter way around for a cyclic gene.
        is_expressed: Whether the gene has an effect on one of the two robots.
        is_inherited: Whether the value is that of the other parent of the later robot.
    """

    gene: str
    before: float
    after: float
    share: float
    is_expressed: bool
    is_inherited: bool


@dataclass(frozen=True)
class Step:
    """A robot of a line of descent, and what distinguishes it from the robot before it.

    Attributes:
        individual: Number of the robot.
        born: Generation in which it was born.
        fitness: Its fitness.
        verdict: Verdict on its walk.
        genome: Text of its genome.
        other_parent: Fittest of its parents outside the line; None if there is none in the table.
        n_births: Number of births since the robot before it: more than 1 if robots in between are left out.
        n_generations: Number of generations since the birth of the robot before it; 0 for the first.
        changes: All genes that differ from the robot before it; the largest visible changes first.
    """

    individual: int
    born: int
    fitness: float
    verdict: str
    genome: str
    other_parent: int | None
    n_births: int
    n_generations: int
    changes: tuple[GeneChange, ...]


def trace_line(records: Any, individual: int | None = None, max_robots: int | None = None) -> list[Step]:
    """Trace the line of descent of a robot through the fitter parent of each, oldest first.

    A robot that looks and walks exactly like the robot before it, because no gene with an effect differs, is left out.
    If the line is still longer than ``max_robots``, the robots whose fitness differs least from that of the robot
    before are left out, too.

    Args:
        records: Table of a run, or the run.
        individual: Number of the robot; the champion if None.
        max_robots: Maximum number of robots; all if None.

    Returns:
        A step for each robot; the first and the last robot of the line are always included.

    Raises:
        ValueError: If the table is empty or has no such individual, or ``max_robots`` is less than 2.
    """
    if max_robots is not None and max_robots < 2:
        raise ValueError(f"max_robots is {max_robots}; it must be 2 or more, for the first and the last robot")
    table = require_table(records, "individual", "born", "parents", "fitness", "verdict", "genome")
    number = find_champion(table).individual if individual is None else individual
    select_lineage(table, number)  # raises an error if there is no such robot
    births = birth_rows(table)
    line = fitter_line(births, number)[::-1]
    texts: dict[int, str] = {one: births.genome[one] for one in line}
    fitness: dict[int, float] = {one: float(births.fitness[one]) for one in line}
    genes = genes_of_text(texts[line[0]])
    kept = [0]
    for i in range(1, len(line)):
        is_last = i == len(line) - 1
        if is_last or any(change.is_expressed for change in compare(texts[line[kept[-1]]], texts[line[i]], genes)):
            kept.append(i)
    if max_robots is not None:
        kept = _leave_out(kept, [fitness[one] for one in line], max_robots)
    steps: list[Step] = []
    for position, i in enumerate(kept):
        one = line[i]
        before = line[kept[position - 1]] if position else None
        parents = [parent for parent in parent_numbers(births.parents[one]) if parent in births.index]
        others = [parent for parent in parents if not (i and parent == line[i - 1])] if i else []
        other = max(others, key=lambda parent: float(births.fitness[parent])) if others else None
        n_births = i - kept[position - 1] if position else 0
        donor = str(births.genome[other]) if other is not None and n_births == 1 else None
        steps.append(
            Step(
                individual=one,
                born=int(births.born[one]),
                fitness=fitness[one],
                verdict=str(births.verdict[one]),
                genome=texts[one],
                other_parent=other,
                n_births=n_births,
                n_generations=int(births.born[one] - births.born[before]) if before is not None else 0,
                changes=compare(texts[before], texts[one], genes, donor) if before is not None else (),
            )
        )
    return steps


def compare(before: str, after: str, genes: Genes, donor: str | None = None) -> tuple[GeneChange, ...]:
    """Return all genes that differ between two genomes; the largest changes of genes with an effect come first.

    Args:
        before: Text of the earlier genome.
        after: Text of the later genome.
        genes: Gene table.
        donor: Text of the genome from which changed genes may come.
    """
    old, new = Genome.parse(before).values, Genome.parse(after).values
    given = Genome.parse(donor).values if donor is not None else np.full(len(new), np.nan)
    shares = shortest_change(old, new, genes) / gene_widths(genes)
    visible = np.logical_or(*is_expressed(np.stack([old, new])))
    changes = [
        GeneChange(
            gene=genes.names[j],
            before=float(old[j]),
            after=float(new[j]),
            share=float(shares[j]),
            is_expressed=bool(visible[j]),
            is_inherited=bool(given[j] == new[j]),
        )
        for j in np.flatnonzero(old != new).tolist()
    ]
    return tuple(sorted(changes, key=lambda one: (not one.is_expressed, -abs(one.share))))


def genes_of_text(genome: str) -> Genes:
    """Return the gene table of the default limits for genomes of this length."""
    n_parts = (len(Genome.parse(genome).values) - len(BODY_FEATURES)) // len(SEGMENT_FEATURES)
    return build_genes(Robot(segments=(1, n_parts), legs=(2, 2 * n_parts)))


def lineage_changes(records: Any, individual: int | None = None, max_robots: int | None = None) -> pd.DataFrame:
    """Return the genes that changed along the line of descent of a robot: a row for each gene and step.

    Args:
        records: Table of a run, or the run.
        individual: Number of the robot; the champion if None.
        max_robots: Maximum number of robots in the line; all if None.

    Returns:
        Table with the columns ``individual`` and ``born`` (later robot of the step, and its generation), ``gene``,
        ``before``, ``after``, ``change`` (as a share of the gene's range), ``expressed`` (whether the gene has an
        effect) and ``from_other_parent`` (whether the value is that of the other parent).

    Raises:
        ValueError: If the table is empty or has no such individual.
    """
    rows = [
        (step.individual, step.born, one.gene, one.before, one.after, one.share, one.is_expressed, one.is_inherited)
        for step in trace_line(records, individual, max_robots)
        for one in step.changes
    ]
    columns = ["individual", "born", "gene", "before", "after", "change", "expressed", "from_other_parent"]
    return pd.DataFrame(rows, columns=columns)


def _leave_out(kept: list[int], fitness: Sequence[float], max_robots: int) -> list[int]:
    """Leave out the robots whose fitness differs least from that of the robot before; keep both ends of the line."""
    kept = list(kept)
    while len(kept) > max_robots:
        gains = [abs(fitness[kept[i]] - fitness[kept[i - 1]]) for i in range(1, len(kept) - 1)]
        gains = [gain if np.isfinite(gain) else 0.0 for gain in gains]
        del kept[1 + int(np.argmin(gains))]
    return kept


def changed_parts(step: Step, genes: Genes) -> frozenset[str]:
    """Return the trunks and legs that are new, or whose size, mass or force changed, named as in ``PartPaint``."""
    values = Genome.parse(step.genome).values
    sources = find_leg_sources(genes.parts(values[np.newaxis]))[0].tolist()
    visible = [one.gene.partition(".") for one in step.changes if one.is_expressed and "." in one.gene]
    trunks = {f"trunk{segment.removeprefix('seg')}" for segment, _, name in visible if Feature[name] in TRUNK_FEATURES}
    legs = {
        int(segment.removeprefix("seg")) - 1 for segment, _, name in visible if Feature[name] in BODY & {*LEG_FEATURES}
    }
    n_before = next((int(one.before) for one in step.changes if one.gene == "segments"), len(sources))
    new = {f"{part}{i + 1}" for i in range(n_before, len(sources)) for part in ("trunk", "legs")}
    return frozenset(trunks | new | {f"legs{i + 1}" for i, source in enumerate(sources) if source in legs})


def describe_step(step: Step, genes: Genes, max_length: int) -> tuple[str, str]:
    """Describe how a robot differs from the one before it in the line, in two lines of text.

    Only genes with an effect on one of the two robots are counted and named, the largest change first.

    Args:
        step: Step to describe.
        genes: Gene table.
        max_length: Maximum length of a line, in characters.
    """
    if not step.n_generations:
        return "the first robot of the line", ""
    visible = [one for one in step.changes if one.is_expressed]
    if not visible:
        return "changed: no gene with an effect", ""
    inherited = [one for one in visible if one.is_inherited]
    changed = [one for one in visible if not one.is_inherited]
    if step.n_births > 1:
        first = f"changed in {step.n_births} births: {pluralize(len(visible), 'gene')}"
    else:
        counts = [f"from robot {step.other_parent}: {pluralize(len(inherited), 'gene')}"] if inherited else []
        counts += [f"mutated: {pluralize(len(changed), 'gene')}"] if changed else []
        first = "; ".join(counts)
    second = ""
    for n, one in enumerate(visible):
        j = genes.names.index(one.gene)
        unit = f" {genes.units[j]}" if genes.units[j] not in ("", "pair") else ""
        name = one.gene.replace("_", " ").replace(".", " ")
        text = f"{name} {format_gene(genes, j, one.before)} → {format_gene(genes, j, one.after)}{unit}"
        left = len(visible) - n - 1
        end = f", and {left} more" if left else ""
        joined = f"{second}, {text}" if second else text
        if second and len(joined) + len(end) > max_length:
            return first, f"{second}, and {left + 1} more"
        second = joined
    return first, second
