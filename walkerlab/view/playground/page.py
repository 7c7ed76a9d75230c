"""The playground: one HTML file in which MuJoCo, compiled to WebAssembly, simulates robots live in the browser.

The page is K3D's snapshot of the ground and of one mesh of each kind, with the scripts in this folder. The
scripts receive the data of ``payload.page_data`` and ``drawing.draw_robots``, and the compressed files of MuJoCo.
"""

import gzip
import json
from base64 import b64encode
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from walkerlab.settings.settings import Settings
from walkerlab.text.templates import render
from walkerlab.view.pages import complete_snapshot
from walkerlab.view.playground.drawing import draw_robots
from walkerlab.view.playground.payload import page_data, physics_script
from walkerlab.view.playground.vendor import FILES, encoded_file
from walkerlab.view.replay.animation import Walk
from walkerlab.view.replay.page import TRUNK_COLOUR
from walkerlab.view.replay.walkers import simulate_walks
from walkerlab.view.sketch.svg import hex_colour

SCRIPT_FOLDER = Path(__file__).parent
SCRIPTS = ("view", "push", "controls", "playground")
"""Scripts of the page, after those of the physics; the last script starts the page."""

MAX_ROBOTS = 4


def prepare_walks(walkers: Any, settings: Settings) -> tuple[Walk, ...]:
    """Return the robots of a playground, with labels, colours, lanes, and the walks that Python simulates.

    Args:
        walkers: Genome, its text, an individual, or a run (its champion); or up to four of these, as a list or a dict
            with labels as keys.
        settings: Settings of terrain, robot and simulation.

    Raises:
        GenomeError: If a string is not a valid genome.
        TypeError: If ``walkers`` contains anything else.
        ValueError: If there is no robot, or there are more than four.
    """
    walks = simulate_walks(walkers, settings)
    if len(walks) > MAX_ROBOTS:
        raise ValueError(f"a playground shows at most {MAX_ROBOTS} robots; got {len(walks)}")
    return walks


def build_page(walks: Sequence[Walk], settings: Settings) -> str:
    """Return the page of one robot, or of a race of several, as HTML.

    Args:
        walks: Robots, from ``prepare_walks``.
        settings: Settings of terrain, robot and simulation.
    """
    title = f"{walks[0].label}, live" if len(walks) == 1 else f"Race of {len(walks)} robots, live"
    plot, drawing = draw_robots(walks, title)
    page = page_data([walk.scene.genome for walk in walks], settings) | {
        "robots": [_describe_robot(walk) for walk in walks],
        "camera": settings.simulation.camera.name,
        "drawing": drawing.data,
    }
    scripts = [(SCRIPT_FOLDER / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    # base64 contains no "<", and the scripts contain no text from outside, so that nothing can close the script element
    code = f"startPlayground(K3DInstance, {json.dumps(_compress(page))}, loading);"
    html: str = plot.get_snapshot(additional_js_code=code)
    drawing.close(plot)
    files = json.dumps({name: encoded_file(name) for name in FILES})
    start = f"const loading = loadMujoco({files});"  # at the same time as K3D
    script = "\n".join([physics_script(), *scripts, start])
    head = render("view/playground/head.html", title=title)
    body = render("view/playground/playground.html", title=title)
    return complete_snapshot(html, head, f"{body}\n<script>\n{script}\n</script>")


def _describe_robot(walk: Walk) -> dict[str, Any]:
    return {
        "label": walk.label,
        "colour": hex_colour(walk.colour) if walk.colour else TRUNK_COLOUR,
        "genome": walk.scene.genome.values.tolist(),
    }


def _compress(data: dict[str, Any]) -> str:
    """Return JSON data as base64 of gzip."""
    text = json.dumps(data, allow_nan=False)
    return b64encode(gzip.compress(text.encode("utf-8"), 9, mtime=0)).decode("ascii")
