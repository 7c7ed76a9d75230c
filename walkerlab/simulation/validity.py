"""Validity of walks: the recorded trace, the guards that check it, and the verdict.

Evolution exploits every weakness of a simulation. Each guard is one entry of ``GUARD_FUNCTIONS``: a function of the
trace that returns the reason why the walk does not count, or "".
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.genome.features import FREQUENCY_RANGE
from walkerlab.genome.phenotype import Phenotype
from walkerlab.settings.choices import Guard, Structure
from walkerlab.settings.settings import Settings
from walkerlab.world.heights import arena_bounds, ground_height, slope

MAX_START_OVERLAP = 0.001  # m; maximum penetration of another body at the start
MAX_REST_SPEED = 0.05  # m/s; maximum speed after settling, and of a robot that stands still (0.4 m in a walk of 8 s)
MAX_DRIVE_FREQUENCY = 1.1 * FREQUENCY_RANGE[1]  # Hz; maximum for servo targets, slightly above gait frequencies
MAX_RISE = 0.5  # body lengths; maximum rise of the centre of mass above its height at rest; gallops reach 0.15
MIN_HEIGHT = 0.4  # minimum height of the centre of mass, as a share of its height at rest; gaits stay at 0.6 or more
MAX_TIME_DOWN = 0.5  # s; maximum time below that height, because a robot that gets up again has not fallen
MAX_SINK = 0.05  # m; maximum depth of a segment in the ground; a landing foot of radius 0.02 sinks by 0.02 at most
MAX_SLEDGE_SINK = 0.1  # m; maximum depth of the sledge's middle; a crest between its runners may reach up to 0.06
MAX_ROPE_STRETCH = 1.1  # maximum length of the rope, as a share of its length at rest
MAX_OVERTURNED_TIME = 0.5  # s; maximum total time with the back below the horizon; champions tilt by at most 50°
MIN_LEVEL_SHARE = 1 / 3  # minimum share of the speed that remains without a push; walkers keep half, except on ice
MAX_LOAD_LEAD = 0.0  # m; maximum distance of the sledge ahead of the robot

UNSTABLE = "unstable"
REJECTED = "rejected"
VERDICTS = (
    {
        "ok": "The walk counts, because no rule was broken; crawling on the belly is allowed.",
        UNSTABLE: "The simulation diverged: MuJoCo gave a warning, or a value was not finite.",
    }
    | {guard.name.replace("_", " "): f"{guard.about[0].upper()}{guard.about[1:]}." for guard in Guard if guard}
    | {REJECTED: "The fitness function returned -inf or None, which excludes the robot."}
)
"""Description of each verdict; ``judge`` returns all but ``fragile`` and the last."""


@dataclass(frozen=True, eq=False)
class Trace:
    """Quantities recorded during one walk, after the body has settled: one sample per control step.

    Attributes:
        time: Time since the gait began, s, shape (n,).
        com: Centre of mass, m, shape (n, 3); x forward, y left, z up.
        up: Unit vector that points up from the back of the middle segment, shape (n, 3).
        on_ground: Whether any part of the body touched something other than itself, shape (n,).
        sink: Greatest depth of a body part in the ground, m, shape (n,).
        work: Work of the legs since the start, J, shape (n,); forward and backward motion both count.
        load: Position of the sledge, m, shape (n, 3); (0, 3) without a sledge.
        rope: Distance between the ends of the rope, as a share of the rope's length, shape (n,); (0,) without a sledge.
        phenotype: The robot that walked.
        settled: Time that the body took to come to rest before the walk, s.
        creep: Speed of the body at the end of settling, m/s.
        overlap: Greatest penetration of another body at the start, m.
        drive: Frequency of the servo target that reversed its direction most often, Hz.
        warnings: Number of warnings that MuJoCo gave.
        level_speed: Mean forward speed of the robot in the same world without a push, m/s; NaN if it was not measured,
            because nothing pushes the robot forward, it stood still, or another guard found a fault.
    """

    time: Floats
    com: Floats
    up: Floats
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
    level_speed: float

    @property
    def mean_speed(self) -> float:
        """Mean forward speed of the whole walk, in m/s."""
        return float((self.com[-1, 0] - self.com[0, 0]) / self.time[-1])


def judge(trace: Trace, settings: Settings) -> tuple[str, str]:
    """Return the verdict of a walk: the first guard that rejects it, except those in the setting ``forgive``.

    Returns:
        A key of ``VERDICTS``, and the reason with the measured value and the limit; "" if the verdict is ``ok``.
    """
    if trace.warnings:
        return UNSTABLE, f"MuJoCo gave {trace.warnings} warning{'s' if trace.warnings > 1 else ''}"
    positions = np.concatenate([trace.com, trace.load], axis=1) if trace.load.size else trace.com
    is_finite = np.isfinite(positions).all(axis=1)
    if not is_finite.all():
        return UNSTABLE, f"at {trace.time[int(np.argmin(is_finite))]:.2f} s a value was not finite"
    forgiven = forgiven_guards(settings)
    for guard, find_fault in GUARD_FUNCTIONS.items():
        if guard not in forgiven and (reason := find_fault(trace, settings)):
            return guard.name.replace("_", " "), reason
    return "ok", ""


def forgiven_guards(settings: Settings) -> tuple[Guard, ...]:
    """Return the guards that are off."""
    forgive = settings.simulation.forgive
    return forgive if isinstance(forgive, tuple) else (forgive,)


def _bad_start(trace: Trace, _: Settings) -> str:
    if trace.overlap <= MAX_START_OVERLAP:
        return ""
    return f"at the start it was {trace.overlap:.3f} m deep in another body; {MAX_START_OVERLAP:g} m is allowed"


def _restless(trace: Trace, _: Settings) -> str:
    if trace.creep <= MAX_REST_SPEED:
        return ""
    moving = f"after {trace.settled:g} s without drive it still moved at {trace.creep:.2f} m/s"
    return f"{moving}; {MAX_REST_SPEED:g} m/s is allowed"


def _jittering(trace: Trace, _: Settings) -> str:
    # The growing amplitude and the end of the record can each add half a cycle to those counted.
    limit = MAX_DRIVE_FREQUENCY + 1 / float(trace.time[-1])
    return f"a joint was driven at {trace.drive:.1f} Hz; {limit:.1f} Hz is allowed" if trace.drive > limit else ""


def _too_fast(trace: Trace, settings: Settings) -> str:
    limit = settings.simulation.max_speed
    speed = np.linalg.norm(np.diff(trace.com, axis=0), axis=1) / np.diff(trace.time) / trace.phenotype.body_length
    return _describe_excess(
        trace.time[1:], speed, limit, "it moved at {:.1f} body lengths/s; {:g} body lengths/s is allowed"
    )


def _too_high(trace: Trace, settings: Settings) -> str:
    com_height = _com_height(trace, settings, np.max)
    rise = (com_height - com_height[0]) / trace.phenotype.body_length
    text = "its centre of mass was {:.2f} body lengths higher than at rest; {:g} body lengths is allowed"
    return _describe_excess(trace.time, rise, MAX_RISE, text)


def _sunk(trace: Trace, _: Settings) -> str:
    return _describe_excess(
        trace.time, trace.sink, MAX_SINK, "a part of it was {:.3f} m deep in the ground; {:g} m is allowed"
    )


def _airborne(trace: Trace, settings: Settings) -> str:
    limit = settings.simulation.max_airborne
    start, duration = _longest_period(trace.time, ~trace.on_ground)
    if duration <= limit:
        return ""
    return f"from {start:.2f} s on it was off the ground for {duration:.2f} s; {limit:g} s is allowed"


def _fell(trace: Trace, settings: Settings) -> str:
    com_height = _com_height(trace, settings, np.median)
    is_down = (com_height < MIN_HEIGHT * com_height[0]) & (com_height[0] > 0)
    start, duration = _longest_period(trace.time, is_down)
    if duration <= MAX_TIME_DOWN:
        return ""
    low = f"its centre of mass was below {MIN_HEIGHT:.0%} of its height at rest"
    return f"from {start:.2f} s on {low} for {duration:.2f} s; {MAX_TIME_DOWN:g} s is allowed"


def _out_of_arena(trace: Trace, settings: Settings) -> str:
    low, high = arena_bounds(settings.terrain)
    outside = np.max(np.maximum(low - trace.com[:, :2], trace.com[:, :2] - high), axis=1)
    return _describe_excess(trace.time, outside, 0.0, "it was {:.2f} m outside the arena; {:g} m is allowed")


def _load_lost(trace: Trace, settings: Settings) -> str:
    if not trace.load.size:
        return ""
    lead = trace.load[:, 0] - trace.com[:, 0]
    depth = ground_height(settings.terrain, trace.load[:, 0], trace.load[:, 1]) - trace.load[:, 2]
    checks = (
        (trace.rope, MAX_ROPE_STRETCH, "the rope was stretched to {:.2f} times its length; {:g} times is allowed"),
        (lead, MAX_LOAD_LEAD, "the sledge was {:.2f} m ahead of the robot; {:g} m is allowed"),
        (depth, MAX_SLEDGE_SINK, "the sledge was {:.2f} m deep in the ground; {:g} m is allowed"),
    )
    reasons = (_describe_excess(trace.time, values, limit, text) for values, limit, text in checks)
    return next(filter(None, reasons), "")


def _overturned(trace: Trace, settings: Settings) -> str:
    pitch = slope(settings.terrain)
    upward = trace.up @ [-math.sin(pitch), 0.0, math.cos(pitch)]
    duration = float(np.diff(trace.time) @ (upward[1:] < 0))
    if duration <= MAX_OVERTURNED_TIME:
        return ""
    return f"for {duration:.2f} s in total it was on its back; {MAX_OVERTURNED_TIME:g} s is allowed"


def _carried(trace: Trace, _: Settings) -> str:
    least = MIN_LEVEL_SHARE * trace.mean_speed
    if trace.mean_speed <= MAX_REST_SPEED or not trace.level_speed < least:
        return ""
    level = f"on level ground in still air it moved at {trace.level_speed:.2f} m/s"
    return f"it moved at {trace.mean_speed:.2f} m/s, and {level}; {least:.2f} m/s or more is required"


GUARD_FUNCTIONS: dict[Guard, Callable[[Trace, Settings], str]] = {
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
    Guard.overturned: _overturned,
    Guard.carried: _carried,
}
"""Function of each guard, in the order in which they are checked."""


def _describe_excess(time: Floats, values: Floats, limit: float, text: str) -> str:
    """Describe the greatest value if it exceeds a limit.

    Args:
        time: Time of each value, s, shape (n,).
        values: Measured values, shape (n,).
        limit: Greatest value allowed.
        text: Format string for the greatest value and the limit.

    Returns:
        The time and the text, or "" if the limit is not exceeded.
    """
    worst = int(np.argmax(values))
    if values[worst] <= limit:
        return ""
    return f"at {time[worst]:.2f} s " + text.format(float(values[worst]), limit)


def _com_height(trace: Trace, settings: Settings, reduce: Callable[..., Floats]) -> Floats:
    """Return the height of the centre of mass above the ground below the robot at each sample [m], shape (n,).

    On a plane, it is measured at right angles to the ground.

    Args:
        trace: Recorded walk.
        settings: Settings with the terrain.
        reduce: Function such as ``np.median`` that reduces the heights of the ground along the body to one height.
    """
    if settings.terrain.structure == Structure.gaps:  # above the surface between the trenches
        return trace.com[:, 2]
    offset = trace.phenotype.body_length / 2 * np.linspace(-1, 1, 5)[:, np.newaxis]
    x, y = np.broadcast_arrays(trace.com[:, 0] + offset, trace.com[:, 1])
    ground = reduce(ground_height(settings.terrain, x, y), axis=0)
    return (trace.com[:, 2] - ground) * math.cos(slope(settings.terrain))


def _longest_period(time: Floats, holds: NDArray[np.bool_]) -> tuple[float, float]:
    """Find the longest period in which a condition holds.

    Args:
        time: Time of each sample, s, shape (n,).
        holds: Whether the condition holds in each sample, shape (n,).

    Returns:
        Start and duration of the period [s]; it ends no later than the last sample. NaN and 0 if there is no such
        period.
    """
    edges = np.flatnonzero(np.diff(holds, prepend=False, append=False))
    starts = edges[::2]
    ends = np.minimum(edges[1::2], len(time) - 1)
    if not len(starts):
        return math.nan, 0.0
    durations = time[ends] - time[starts]
    longest = int(np.argmax(durations))
    return float(time[starts[longest]]), float(durations[longest])
