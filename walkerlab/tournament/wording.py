"""Results of a league in words, as the table and the page show them."""

from walkerlab.simulation.validity import VERDICTS
from walkerlab.tournament.scores import Standing


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
    if n_counted == n_walks:
        return f"All {n_walks} walks count.{reason}"
    return f"{n_counted} of {n_walks} walks count.{reason}"
