"""The judge: what was recorded of a walk, and whether it counts. Evolution finds every hole; here they are closed.

Each guard is one row of ``GUARDS``: it looks at the record, and gives the reason why the walk does not count, or "".
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.genome.phenotype import Phenotype
from walkerlab.genome.repair import FREQUENCY_RANGE
from walkerlab.settings.choices import Guard, Structure
from walkerlab.settings.settings import Settings
from walkerlab.world.heights import arena_bounds, height

OVERLAP = 0.001  # m that a body may be inside another at the start
CREEP = 0.05  # m/s at which a body may still move when it has had its time to come to rest: 0.4 m of a walk of 8 s
BAND = 1.1 * FREQUENCY_RANGE[1]  # Hz, up to which legs may be driven: a little over the fastest gene
RISE = 0.5  # body lengths by which the centre of mass may rise above where it was at rest; gallops reach 0.15
DROP = 0.4  # of its height at rest, under which the centre of mass may not sink; gaits keep 0.6 and more
DOWN = 0.5  # s that it may be so low: whoever gets up again has not fallen
SINK = 0.05  # m that a part may be pushed into the ground; a foot's radius is some 0.02, and lands 0.02 deep at worst
SLEDGE_SINK = 0.1  # m that its middle may be in the ground: over a crest its runners straddle, its box is 0.06 m up
STRETCH = 1.1  # of its length, to which a rope may be drawn
AHEAD = 0.0  # m by which a load may be ahead of its robot

UNSTABLE = "unstable"
REJECTED = "rejected"
VERDICTS = (
    {
        "ok": "The walk counts.",
        UNSTABLE: "The physics broke down: MuJoCo warned, or a number was not finite.",
    }
    | {guard.name.replace("_", " "): f"{guard.about[0].upper()}{guard.about[1:]}." for guard in Guard if guard}
    | {REJECTED: "The fitness function returned -inf or None, which excludes the robot."}
)
"""Each verdict that a walk can get, in words for people; all but the last are given by ``judge``."""


@dataclass(frozen=True, eq=False)
class Trace:
    """What was recorded of one walk, from the moment the body has settled; a sample at each tick of the gait's clock.

    Attributes:
        time: (n,) s since the gait began.
        com: (n, 3) centre of mass, m; x forward, y left, z up.
        on_ground: (n,) whether any part of the body touched something that is not itself.
        sink: (n,) how deep its deepest part was in the ground, m.
        work: (n,) what the legs have done so far, forward and backward both counted, J.
        load: (n, 3) where the sledge is, m; (0, 3) without one.
        rope: (n,) the distance between the ends of its rope, as a part of the rope's length; (0,) without one.
        phenotype: the robot that walked.
        settled: s that the body was given to come to rest before the walk.
        creep: m/s at which it moved at the end of these.
        overlap: m that it was inside something at the start.
        drive: Hz, how often the fastest of its servo targets turned round and back.
        warnings: how many warnings MuJoCo gave.
    """

    time: Floats
    com: Floats
    on_ground: NDArray[np.bool_]
    sink: Floats
    work: Floats
    load: Floats
    rope: Floats
    phenotype: Phenotype
    settled: float
    creep: float
    overlap: float
    drive: float
    warnings: int


def judge(trace: Trace, settings: Settings) -> tuple[str, str]:
    """Name the first rule that a walk breaks.

    Returns:
        A key of ``VERDICTS``, and the reason with its figures: "" if the verdict is ``ok``.
    """
    if trace.warnings:
        return UNSTABLE, f"MuJoCo gave {trace.warnings} warning{'s' if trace.warnings > 1 else ''}"
    where = np.concatenate([trace.com, trace.load], axis=1) if trace.load.size else trace.com
    if not np.isfinite(where).all():
        when = trace.time[int(np.argmin(np.isfinite(where).all(axis=1)))]
        return UNSTABLE, f"at {when:.2f} s a number was not finite"
    forgiven = settings.simulation.forgive
    for guard, check in GUARDS.items():
        if guard not in (forgiven if isinstance(forgiven, tuple) else (forgiven,)) and (
            reason := check(trace, settings)
        ):
            return guard.name.replace("_", " "), reason
    return "ok", ""


def _bad_start(trace: Trace, _: Settings) -> str:
    inside = f"it started {trace.overlap:.3f} m deep in something; {OVERLAP:g} is allowed"
    return inside if trace.overlap > OVERLAP else ""


def _restless(trace: Trace, _: Settings) -> str:
    moving = f"after {trace.settled:g} s without drive it still moved at {trace.creep:.2f} m/s; {CREEP:g} is allowed"
    return moving if trace.creep > CREEP else ""


def _jittering(trace: Trace, _: Settings) -> str:
    allowed = BAND + 1 / float(trace.time[-1])  # the swell of a gait, and where its record ends, can add a cycle
    return f"a joint was driven at {trace.drive:.1f} Hz; {allowed:.1f} is allowed" if trace.drive > allowed else ""


def _too_fast(trace: Trace, settings: Settings) -> str:
    allowed = settings.simulation.max_speed
    speed = np.linalg.norm(np.diff(trace.com, axis=0), axis=1) / np.diff(trace.time) / trace.phenotype.body_length
    return _exceeds(trace.time[1:], speed, allowed, "it moved at {:.1f} body lengths/s; {:g} is allowed")


def _too_high(trace: Trace, settings: Settings) -> str:
    _, highest = _ground_near(trace, settings)
    above = trace.com[:, 2] - highest
    risen = (above - above[0]) / trace.phenotype.body_length
    said = "its centre of mass was {:.2f} body lengths higher than at rest; {:g} is allowed"
    return _exceeds(trace.time, risen, RISE, said)


def _sunk(trace: Trace, _: Settings) -> str:
    return _exceeds(trace.time, trace.sink, SINK, "a part of it was {:.3f} m deep in the ground; {:g} is allowed")


def _airborne(trace: Trace, settings: Settings) -> str:
    allowed = settings.simulation.max_airborne
    left, lasted = _longest(trace.time, ~trace.on_ground)
    said = f"from {left:.2f} s on it was off the ground for {lasted:.2f} s; {allowed:g} is allowed"
    return said if lasted > allowed else ""


def _fell(trace: Trace, settings: Settings) -> str:
    lowest, _ = _ground_near(trace, settings)
    above = trace.com[:, 2] - lowest
    since, lasted = _longest(trace.time, (above < DROP * above[0]) & (above[0] > 0))
    said = f"from {since:.2f} s on its centre of mass was under {DROP:.0%} of its height at rest for {lasted:.2f} s"
    return f"{said}; {DOWN:g} is allowed" if lasted > DOWN else ""


def _out_of_arena(trace: Trace, settings: Settings) -> str:
    low, high = arena_bounds(settings.terrain)
    outside = np.max(np.maximum(low - trace.com[:, :2], trace.com[:, :2] - high), axis=1)
    return _exceeds(trace.time, outside, 0.0, "it was {:.2f} m outside the ground that is built; {:g} is allowed")


def _load_lost(trace: Trace, settings: Settings) -> str:
    if not trace.load.size:
        return ""
    ahead = trace.load[:, 0] - trace.com[:, 0]
    below = height(settings.terrain, trace.load[:, 0], trace.load[:, 1]) - trace.load[:, 2]
    return (
        _exceeds(trace.time, trace.rope, STRETCH, "the rope was drawn to {:.2f} times its length; {:g} is allowed")
        or _exceeds(trace.time, ahead, AHEAD, "the sledge was {:.2f} m ahead of the robot; {:g} is allowed")
        or _exceeds(trace.time, below, SLEDGE_SINK, "the sledge was {:.2f} m deep in the ground; {:g} is allowed")
    )


GUARDS: dict[Guard, Callable[[Trace, Settings], str]] = {
    Guard.bad_start: _bad_start,
    Guard.restless: _restless,
    Guard.jittering: _jittering,
    Guard.too_fast: _too_fast,
    Guard.too_high: _too_high,
    Guard.sunk: _sunk,
    Guard.airborne: _airborne,
    Guard.fell: _fell,
    Guard.out_of_arena: _out_of_arena,
    Guard.load_lost: _load_lost,
}
"""Every guard, in the order in which they are asked."""


def _exceeds(time: Floats, value: Floats, allowed: float, said: str) -> str:
    """Say when a value was largest, how large, and what is allowed; nothing if it was never more than that."""
    worst = int(np.argmax(value))
    if value[worst] <= allowed:
        return ""
    return f"at {time[worst]:.2f} s " + said.format(float(value[worst]), allowed)


def _ground_near(trace: Trace, settings: Settings) -> tuple[Floats, Floats]:
    """Return the least and the greatest height of the ground under the robot, (n,) each [m]."""
    if settings.terrain.structure == Structure.gaps:  # of what there is to stand on: down in a trench is fallen
        return np.zeros(len(trace.time)), np.zeros(len(trace.time))
    reach = trace.phenotype.body_length / 2 * np.linspace(-1, 1, 5)[:, np.newaxis]
    heights = height(settings.terrain, trace.com[:, 0] + reach, trace.com[:, 1] + 0 * reach)
    return heights.min(axis=0), heights.max(axis=0)


def _longest(time: Floats, holds: NDArray[np.bool_]) -> tuple[float, float]:
    """Return when the longest time for which something holds began, and how long it lasted [s], to the end at most."""
    edges = np.flatnonzero(np.diff(holds, prepend=False, append=False))
    began, ended = edges[::2], np.minimum(edges[1::2], len(time) - 1)
    if not len(began):
        return math.nan, 0.0
    lasted = time[ended] - time[began]
    longest = int(np.argmax(lasted))
    return float(time[began[longest]]), float(lasted[longest])
