"""Markdown tables of the results of ``benchmarks.walkers``: of one folder, and of several folders side by side."""

import json
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from scipy.stats import wilcoxon

FORMATS = {
    "body lengths/s": "{:.2f}",
    "distance": "{:.1f}",
    "stairs climbed": "{:.0f}",
    "kept at dt/4": "{:.0%}",
    "kept from other starts": "{:.0%}",
    "contact by feet": "{:.0%}",
}
"""Format of the figures of each measure; distances are in m."""


def read_folder(folder: Path) -> pd.DataFrame:
    """Return the results in a folder: one row for each ground, method, budget and seed.

    Raises:
        ValueError: If the folder holds no results.
    """
    rows = []
    for path in sorted(folder.glob("*/*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        champions = document.pop("champions")
        rows += [{**document, "budget": int(budget), **measures} for budget, measures in champions.items()]
    if not rows:
        raise ValueError(f"{folder} holds no results; create some with: python -m benchmarks.walkers run --folder …")
    table = pd.DataFrame(rows)
    numbers = ["fitness", *FORMATS]
    table[numbers] = table[numbers].astype(float)
    return table


def describe_folder(folder: Path) -> str:
    """Return Markdown tables of the medians and quartiles of each ground, method and number of evaluations."""
    table = read_folder(folder)
    lines = [_describe_origin(table)]
    for ground, of_ground in table.groupby("ground", sort=False):
        measures = [name for name in FORMATS if of_ground[name].notna().any()]
        lines += ["", f"### {ground}", "", *_header(["method", "evaluations", "seeds", *map(_title, measures)])]
        for (budget, method), group in of_ground.groupby(["budget", "method"], sort=True):
            figures = [_quartiles(group[name], FORMATS[name]) for name in measures]
            lines.append(_row([method, f"{budget:,}", len(group), *figures]))
        lines += ["", *_describe_wins(of_ground)]
    return "\n".join(lines)


def compare_folders(folders: Sequence[Path]) -> str:
    """Return Markdown tables that compare the results of several folders with those of the first one.

    Differences are paired by seed. Only seeds that both folders have are compared.
    """
    tables = {folder.name or str(folder): read_folder(folder) for folder in folders}
    first, *others = tables
    lines = [f"{name}: {_describe_origin(table)}  " for name, table in tables.items()]
    columns = ["method", "evaluations", "measure", first]
    for name in others:
        columns += [name, f"{name} − {first}", "better"]
    for ground in dict.fromkeys(pd.concat(tables.values()).ground):
        lines += ["", f"### {ground}", "", *_header(columns)]
        reference = tables[first][tables[first].ground == ground]
        for (budget, method), group in reference.groupby(["budget", "method"], sort=True):
            for measure in (name for name in FORMATS if group[name].notna().any()):
                cells = [method, f"{budget:,}", _title(measure), _quartiles(group[measure], FORMATS[measure])]
                for name in others:
                    other = tables[name]
                    other = other[(other.ground == ground) & (other.budget == budget) & (other.method == method)]
                    cells += _compare(group, other, measure)
                lines.append(_row(cells))
    return "\n".join(lines)


def _compare(reference: pd.DataFrame, other: pd.DataFrame, measure: str) -> list[str]:
    """Return the quartiles of another folder, the median difference and the number of seeds that are better."""
    if other.empty:
        return ["", "", ""]
    joined = reference.set_index("seed")[measure].to_frame("reference")
    joined = joined.join(other.set_index("seed")[measure].rename("other"), how="inner").dropna()
    differences = joined.other - joined.reference
    median = FORMATS[measure].replace("{:", "{:+").format(differences.median()) if len(joined) else ""
    significance = f", p = {wilcoxon(differences).pvalue:.2g}" if (differences != 0).any() else ""
    better = f"{(differences > 0).sum()} of {len(joined)}{significance}"
    return [_quartiles(other[measure], FORMATS[measure]), median, better]


def _describe_origin(table: pd.DataFrame) -> str:
    """Return a sentence with the machines and the versions of the source that the results come from."""
    machines = ", ".join(sorted(set(table.machine)))
    sources = ", ".join(sorted(set(table.source)))
    return f"Measured on {machines}; source {sources}. Figures are the median and, in parentheses, the quartiles."


def _describe_wins(table: pd.DataFrame) -> list[str]:
    """Return a sentence for each number of evaluations and each other search that evolution is compared with."""
    lines = []
    counted = table.fillna({"fitness": float("-inf")})
    fitness = counted.pivot(index=["budget", "seed"], columns="method", values="fitness")
    if "evolution" not in fitness:
        return lines
    for budget, group in fitness.groupby("budget"):
        for method in (name for name in ("random", "cma") if name in group):
            both = group[["evolution", method]].dropna()
            wins = (both.evolution > both[method]).sum()
            lines.append(
                f"- {budget:,} evaluations: evolution is better than {method} for {wins} of {len(both)} seeds."
            )
    return lines


def _title(measure: str) -> str:
    return "distance [m]" if measure == "distance" else measure


def _quartiles(values: pd.Series, form: str) -> str:
    """Format the median and the quartiles of a measure."""
    low, median, high = (form.format(values.quantile(share)) for share in (0.25, 0.5, 0.75))
    return f"{median} ({low}–{high})" if len(values) else ""


def _header(columns: Sequence[str]) -> list[str]:
    return [_row(columns), _row(["---"] * len(columns))]


def _row(cells: Sequence[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"
