"""Results of a league in words, as the table and the page show them."""

import math

from walkerlab.simulation.robustness import Confirmation
from walkerlab.simulation.validity import VERDICTS
from walkerlab.tournament.scores import Standing

MIN_KEPT = 0.5  # share of the fitness at a quarter of the timestep, below which the verdict mentions it


def describe_verdict(standing: Standing) -> str:
    """Describe in words how the walks of an entry were judged."""
    n_walks = sum(len(result.confirmation.nudged) for result in standing.rounds)
    n_counted = sum(result.n_counted for result in standing.rounds)
    fault = next((result.evaluation for result in standing.rounds if result.evaluation.verdict != "ok"), None)
    reason = ""
    if fault:
        about = VERDICTS.get(fault.verdict, "").rstrip(".")
        reason = f" From the exact start: {fault.verdict} ({about[:1].lower()}{about[1:]}; {fault.reason})."
    elif n_counted < n_walks:
        verdicts = [verdict for result in standing.rounds for verdict in result.confirmation.verdicts[1:]]
        reason = f" The others: {', '.join(sorted({verdict for verdict in verdicts if verdict != 'ok'}))}."
    doubts = [_describe_doubt(result.confirmation) for result in standing.rounds]
    doubt = next((doubt for doubt in doubts if doubt), "")
    if n_counted == n_walks:
        return f"All {n_walks} walks count.{reason}{doubt}"
    return f"{n_counted} of {n_walks} walks count.{reason}{doubt}"


def _describe_doubt(confirmation: Confirmation) -> str:
    """Return a sentence if most of the fitness is lost at a finer timestep: it may rest on simulation errors."""
    if not (confirmation.fitness > 0 and confirmation.kept_finer < MIN_KEPT):
        return ""
    if not math.isfinite(confirmation.finer):
        return " At a finer time step, its walk does not count."
    return f" At a finer time step, {confirmation.kept_finer:.0%} of the result remains."
