"""Conditions under which a run stops before its last generation; the run file records the one that was met."""

import math
import re
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from walkerlab.settings.values import number_text, pluralize, short_repr
from walkerlab.system.errors import WalkerlabError

SECONDS_PER_UNIT = {"s": 1.0, "min": 60.0, "h": 3600.0}
_DURATION = re.compile(r"(?:\d+(?:\.\d*)?\s*(?:s|min|h)\s*)+")
_PART = re.compile(r"(\d+(?:\.\d*)?)\s*(s|min|h)")


class StopError(WalkerlabError, ValueError):
    """A condition of ``Stop`` that is not allowed."""


@dataclass(frozen=True, kw_only=True)
class Stop:
    """Conditions under which a run stops; the first that is met after a generation stops it.

    Whole generations are evolved, so a run that is resumed has the same table as an uninterrupted one. Time and
    patience count from the call of ``evolve`` or ``resume``.

    Attributes:
        after: Time after which no further generation begins, in seconds or as a string such as ``"10min"`` or
            ``"1h 30min"``; None for no limit.
        target: Fitness at which the run stops; None for no target.
        patience: Number of generations without a fitter robot after which the run stops; None for no limit.

    Raises:
        StopError: If no condition is given, or a value is not allowed.
    """

    after: float | str | None = None
    target: float | None = None
    patience: int | None = None

    def __post_init__(self) -> None:
        """Check the values, and convert ``after`` to seconds."""
        if self.after is None and self.target is None and self.patience is None:
            raise StopError('Stop has no condition; give one: Stop(after="10min"), Stop(target=8) or Stop(patience=20)')
        if self.after is not None:
            object.__setattr__(self, "after", _parse_seconds(self.after))
        if self.target is not None and not (_is_number(self.target) and math.isfinite(self.target)):
            raise StopError(f"Stop.target is {short_repr(self.target)}; it must be a finite fitness")
        if self.patience is not None and not (
            _is_number(self.patience) and self.patience >= 1 and self.patience == int(self.patience)
        ):
            raise StopError(
                f"Stop.patience is {short_repr(self.patience)}; it must be a whole number of generations, 1 or more"
            )


@dataclass(frozen=True)
class Improvement:
    """Course of the best fitness of a run.

    Attributes:
        best: Best fitness so far.
        n_generations_since: Number of generations of this call since the best fitness was found.
    """

    best: float = -math.inf
    n_generations_since: int = 0

    def after(self, best_of_generation: float) -> Self:
        """Return the course after one more generation."""
        if best_of_generation > self.best:
            return replace(self, best=best_of_generation, n_generations_since=0)
        return replace(self, n_generations_since=self.n_generations_since + 1)


def find_stop_reason(stop: Stop | None, improvement: Improvement, seconds: float) -> str:
    """Return the condition that is met, as text; "" if the run continues.

    Args:
        stop: Conditions, or None.
        improvement: Course of the best fitness.
        seconds: Time since the call, in seconds.
    """
    if stop is None:
        return ""
    if stop.target is not None and improvement.best >= stop.target:
        return f"the best fitness reached the target {number_text(stop.target)}"
    if stop.patience is not None and improvement.n_generations_since >= stop.patience:
        return f"{pluralize(stop.patience, 'generation')} had no fitter robot"
    if isinstance(stop.after, float) and seconds >= stop.after:
        return f"the time limit of {_duration_text(stop.after)} was reached"
    return ""


def require_stop(given: object) -> Stop | None:
    """Return an argument that must be a ``Stop`` or None.

    Raises:
        TypeError: If it is not.
    """
    if given is None or isinstance(given, Stop):
        return given
    raise TypeError(
        f'stop must be a Stop, as in stop=wl.Stop(after="10min", target=8, patience=20); got {short_repr(given)}'
    )


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _parse_seconds(given: float | str) -> float:
    """Return a time in seconds.

    Raises:
        StopError: If it is not a time above 0.
    """
    seconds = math.nan
    if isinstance(given, str):
        if _DURATION.fullmatch(given.strip()):
            seconds = sum(float(number) * SECONDS_PER_UNIT[unit] for number, unit in _PART.findall(given))
    elif _is_number(given):
        seconds = float(given)
    if not 0 < seconds < math.inf:
        raise StopError(
            f"Stop.after is {short_repr(given)}; it must be a time above 0, such as '90s', '10min' or '1h 30min', "
            "or a number of seconds"
        )
    return seconds


def _duration_text(seconds: float) -> str:
    """Write a time in the largest unit in which it is not below 1: ``90 s``, ``10 min``, ``1.5 h``."""
    unit = next((unit for unit in ("h", "min") if seconds >= SECONDS_PER_UNIT[unit]), "s")
    return f"{seconds / SECONDS_PER_UNIT[unit]:.6g} {unit}"
