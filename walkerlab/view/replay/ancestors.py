"""A race of the ancestors of a robot."""

from typing import Any

import numpy as np

from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.view.pedigree import trace_line
from walkerlab.view.replay.page import Replay, replay

N_ANCESTORS = 4


def race_ancestors(
    run: Any,
    individual: int | None = None,
    *,
    n: int = N_ANCESTORS,
    settings: Settings | None = None,
    camera: Camera | str | int | None = None,
) -> Replay:
    """Show robots of one line of descent walking side by side: the first ancestor, some others, and the robot itself.

    Args:
        run: Run, or its table.
        individual: Number of the last robot; the champion if None.
        n: Number of robots, evenly spaced along the line; fewer if the line is shorter.
        settings: Settings of the world; those of the run, or the defaults for a table, if None.
        camera: Side, front, top, chase or orbit; if None, the camera in the settings.

    Raises:
        ValueError: If ``n`` is less than 1, or the run has no such individual.
    """
    if n < 1:
        raise ValueError(f"n is {n}; it must be 1 or more. It is the number of robots in the race.")
    steps = trace_line(run, individual)
    if n == 1:
        chosen = [steps[-1]]
    else:
        chosen = [steps[i] for i in np.unique(np.linspace(0, len(steps) - 1, n).round().astype(int)).tolist()]
    robots = {f"generation {step.born}: robot {step.individual}": step.genome for step in chosen}
    return replay(robots, settings or getattr(run, "settings", None), camera=camera)
