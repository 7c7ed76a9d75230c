"""The result of an experiment in plain sentences that never say more than its figures allow."""

from typing import Any

import numpy as np
import pandas as pd

from walkerlab.experiment.statistics import ALPHA, seeds_required
from walkerlab.settings.values import pluralize
from walkerlab.text.numbers import format_significant, with_unit

MAX_NAMED = 6  # clear differences that a sentence names


def describe(comparisons: pd.DataFrame, conditions: pd.DataFrame, n_seeds: int, name: str, unit: str) -> str:
    """Describe what an experiment has shown.

    Args:
        comparisons: Table of the pairs, as ``tabulate_comparisons`` returns it.
        conditions: Table of the conditions, as ``tabulate_conditions`` returns it.
        n_seeds: Number of seeds whose runs have all ended.
        name: Name of the fitness.
        unit: Unit of the fitness.
    """
    if not n_seeds:
        return "No seed has a complete set of runs yet, so nothing can be compared."
    if comparisons.empty:
        (best,) = conditions["best"].iloc[:1]
        return f"One condition: the median best {name} of {pluralize(n_seeds, 'run')} is {_value(best, unit)}."
    medians = dict(zip(conditions["condition"], conditions["best"], strict=True))
    rows: list[Any] = list(comparisons.itertuples())
    n_required = seeds_required(len(rows))
    if n_seeds < n_required:
        return _describe_too_few(rows, medians, n_seeds, n_required, unit)
    if len(rows) == 1:
        return _describe_pair(rows[0], medians, n_seeds, name, unit)
    return _describe_pairs(rows, medians, n_seeds, unit)


def is_clear(row: Any) -> bool:
    """Return whether the difference of a pair is significant, after the correction for all pairs."""
    return bool(row.p_corrected < ALPHA)


def _describe_too_few(rows: list[Any], medians: dict[str, float], n_seeds: int, n_required: int, unit: str) -> str:
    many = f" and {len(rows)} comparisons" if len(rows) > 1 else ""
    seen = ""
    if len(rows) == 1:
        row = rows[0]
        seen = (
            f"The medians are {_value(medians[row.a], unit)} ({row.a}) and {_value(medians[row.b], unit)} ({row.b}), "
            "but this may be due to chance: "
        )
    text = (
        f"{seen}with {pluralize(n_seeds, 'seed')}{many}, no difference of any size could have been found; at least "
        f"{n_required} seeds are required."
    )
    return text[0].upper() + text[1:]


def _describe_pair(row: Any, medians: dict[str, float], n_seeds: int, name: str, unit: str) -> str:
    better, worse = _in_order(row)
    n_better, n_worse = (row.a_better, row.b_better) if better == row.a else (row.b_better, row.a_better)
    if is_clear(row):
        conflict = ""
        if medians[better] < medians[worse]:
            conflict = ", although its median is lower, because it is often a little worse and seldom much better"
        return (
            f"{better} is better than {worse}{conflict}: its runs reach a median {name} of "
            f"{_value(medians[better], unit)}, those of {worse} {_value(medians[worse], unit)}, and it is better in "
            f"{n_better} of {pluralize(n_seeds, 'seed')}. If there were no difference, a result as clear as this would "
            f"occur in {_share(row.p_corrected)} of such experiments."
        )
    if not n_better and not n_worse:
        return f"{row.a} and {row.b} have the same result with each of {pluralize(n_seeds, 'seed')}."
    return (
        f"The runs show no difference between {row.a} and {row.b}: the medians are {_value(medians[row.a], unit)} and "
        f"{_value(medians[row.b], unit)}, and if there were no difference, a result like this would occur in "
        f"{_share(row.p_corrected)} of such experiments. This does not mean that they are equal. "
        f"{_limit([row], n_seeds, unit)}"
    )


def _describe_pairs(rows: list[Any], medians: dict[str, float], n_seeds: int, unit: str) -> str:
    clear = sorted(filter(is_clear, rows), key=lambda row: row.p_corrected)
    unclear = [row for row in rows if not is_clear(row)]
    sentences: list[str] = []
    if clear:
        named = "; ".join(
            f"{better} is better than {worse} ({_value(medians[better], unit)} against {_value(medians[worse], unit)})"
            for better, worse in map(_in_order, clear[:MAX_NAMED])
        )
        more = f"; and {len(clear) - MAX_NAMED} more, in the table" if len(clear) > MAX_NAMED else ""
        if unclear:
            verb = "differences are" if len(clear) > 1 else "difference is"
            count = f"{len(clear)} of {len(rows)} {verb}"
        else:
            count = f"All {len(rows)} differences are"
        sentences.append(
            f"{count} clear with {pluralize(n_seeds, 'seed')} (medians in parentheses): {named}{more}. If there were "
            f"no differences at all, even one clear difference would occur in at most {ALPHA:.0%} of such experiments."
        )
    if unclear:
        others = "The other one may" if len(unclear) == 1 else f"The other {len(unclear)} may"
        which = others if clear else f"None of {len(rows)} differences is clear: all may"
        sentences.append(f"{which} be due to chance, which does not mean that these conditions are equal.")
        sentences.append(_limit(unclear, n_seeds, unit))
    return " ".join(sentences)


def _limit(rows: list[Any], n_seeds: int, unit: str) -> str:
    """Say which differences the experiment would have missed."""
    limits = np.array([row.detectable for row in rows])
    if not np.isfinite(limits).all():
        return (
            f"How small a difference {pluralize(n_seeds, 'seed')} could have shown is unknown, because there are runs "
            "in which no walk counted."
        )
    low, high = limits.min(), limits.max()
    bound = f"about {_value(low, unit)}"
    if len(rows) > 1 and format_significant(low) != format_significant(high):
        bound = f"{_value(low, unit)} to {_value(high, unit)}, depending on the pair,"
    return (
        f"With {pluralize(n_seeds, 'seed')}, differences smaller than {bound} would be missed in more than one of five "
        "experiments."
    )


def _in_order(row: Any) -> tuple[str, str]:
    """Return the names of a pair, the better one first: by the effect size, then by the number of seeds."""
    is_a = (row.a_better - row.b_better, row.a12 - 0.5) >= (0, 0)
    return (row.a, row.b) if is_a else (row.b, row.a)


def _value(value: float, unit: str) -> str:
    return "no counted walk" if value == -np.inf else with_unit(float(value), unit)


def _share(p: float) -> str:
    """Write a p-value as a share of experiments."""
    if p < 0.001:
        return "fewer than 1 in 1000"
    if p > 0.995:
        return "practically all"
    percent = 100 * p
    return f"about {percent:.1f} %" if percent < 9.95 else f"about {percent:.0f} %"
