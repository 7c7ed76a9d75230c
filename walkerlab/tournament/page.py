"""The page of a league, and its leaderboard in a notebook.

The page contains the final as a replay in a sandboxed frame. Its security policy allows only the scripts of that
replay, each named by its hash, so that no text of an entry can run as a script.
"""

import base64
import hashlib
import re
from collections.abc import Sequence
from typing import Any

from walkerlab.runfile import provenance
from walkerlab.settings.glossary import glossary
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.fitness import name_and_unit
from walkerlab.simulation.robustness import N_NUDGES
from walkerlab.text.numbers import format_fixed_column
from walkerlab.text.templates import Markup, render
from walkerlab.tournament.entries import SkippedEntry
from walkerlab.tournament.scores import Standing
from walkerlab.tournament.seals import Seal
from walkerlab.tournament.strips import draw_strip, largest_result
from walkerlab.tournament.wording import describe_verdict
from walkerlab.view.replay import Replay
from walkerlab.view.replay.preview import draw_preview
from walkerlab.view.sketch import draw_robot, draw_world
from walkerlab.view.snapshots import image_html, svg_image_html

MEDALS = {1: "gold", 2: "silver", 3: "bronze"}
BODY_SIZE = (140, 64)  # pixels
BODY_SPAN = 1.9  # m; width of a drawing, so that all bodies have the same scale
WORLD_SIZE = (640, 240)  # pixels
SCRIPT = re.compile(r"<script[^>]*>(.*?)</script>", re.DOTALL)


def league_html(standings: Sequence[Standing], skipped: Sequence[SkippedEntry], grounds: Sequence[Settings]) -> Markup:
    """Return the leaderboard as a notebook shows it.

    Args:
        standings: The entries, the best first.
        skipped: Files that take no part.
        grounds: Settings of each round.
    """
    return render("tournament/league.html", **_leaderboard(standings, skipped, grounds))


def page_html(
    standings: Sequence[Standing],
    skipped: Sequence[SkippedEntry],
    grounds: Sequence[Settings],
    seal: Seal | None,
    final: Replay,
) -> Markup:
    """Return the complete page.

    Args:
        standings: The entries, the best first.
        skipped: Files that take no part.
        grounds: Settings of each round.
        seal: Seal of the settings; None if they were not sealed.
        final: Replay of the final.
    """
    player = final.page
    names = ", ".join(walk.label for walk in final.walks)
    return render(
        "tournament/page.html",
        **_leaderboard(standings, skipped, grounds),
        title="Class tournament",
        n_finalists=len(final.walks),
        n_nudges=N_NUDGES,
        player=player,
        policy=_policy(player),
        final_picture=image_html("image/png", draw_preview(final.walks, final.settings), f"The final: {names}"),
        world=svg_image_html(draw_world(grounds[-1], size=WORLD_SIZE)),
        domains=[glossary(domain) for _, domain in grounds[0]],
        python=grounds[0].as_python(),
        seeds=[settings.terrain.seed for settings in grounds],
        seal=seal,
        versions=provenance.current_facts().items(),
    )


def _leaderboard(
    standings: Sequence[Standing], skipped: Sequence[SkippedEntry], grounds: Sequence[Settings]
) -> dict[str, Any]:
    """Return the values that the page and the notebook share."""
    name, unit = name_and_unit(grounds[0].algorithm.fitness)
    largest = largest_result(standings)
    return {
        "rows": [_row(standing, largest, unit) for standing in standings],
        "largest": f"{largest:.1f} {unit}".rstrip(),
        "skipped": skipped,
        "measure": name,
        "unit": unit,
        "n_rounds": len(grounds),
        "summary": f"{pluralize(len(standings), 'robot')}, {pluralize(len(grounds), 'round')}"
        + (f"; {pluralize(len(skipped), 'file')} not valid" if skipped else ""),
    }


def _row(standing: Standing, largest: float, unit: str) -> dict[str, Any]:
    """Return the values of one row of the leaderboard; robots with a score of 0 have no medal.

    Args:
        standing: The entry.
        largest: Value at the right end of the line of walks.
        unit: Unit of the scores.
    """
    drawing = draw_robot(standing.entry.genome, size=BODY_SIZE, span=BODY_SPAN)
    return {
        "rank": standing.rank,
        "medal": MEDALS.get(standing.rank, "") if float(standing.score_text) > 0 else "",
        "name": standing.entry.name,
        "score": f"{standing.score_text} {unit}".rstrip(),
        "rounds": format_fixed_column((result.score for result in standing.rounds), 2),
        "walks": svg_image_html(draw_strip(standing, largest, unit)),
        "verdict": describe_verdict(standing),
        "body": svg_image_html(drawing),
        "genome": str(standing.entry.genome),
    }


def _policy(player: str) -> str:
    """Return the security policy of the page: scripts only with the hash of one in the replay.

    The player compiles its library from text, which requires ``unsafe-eval``; this runs no text of the page itself.
    """
    scripts = [script.replace("\r\n", "\n").encode() for script in SCRIPT.findall(player)]
    hashes = [base64.b64encode(hashlib.sha256(script).digest()).decode() for script in scripts]
    allowed = " ".join(f"'sha256-{one}'" for one in hashes)
    return (
        f"default-src 'none'; script-src 'unsafe-eval' {allowed}; style-src 'unsafe-inline'; "
        "img-src data: blob:; worker-src blob:; connect-src data: blob:; font-src data:"
    )
