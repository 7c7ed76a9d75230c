"""A function of the user's own, called with care: whatever it does wrong is said in words."""

import inspect
import sys
import traceback
from collections.abc import Callable, Iterable
from dataclasses import FrozenInstanceError, dataclass
from functools import partial
from typing import Any, cast

import numpy as np

from walkerlab.errors import Fault
from walkerlab.system.time_limit import (
    LIMIT_VARIABLE,
    TimeLimitExceeded,
    call_with_limit,
    effective_limit,
    raised_in_call,
)

IN_A_RUN, IN_A_CHECK = 60.0, 10.0  # s that one call may take

THREAD_ADVICE = (
    "User functions are called in a separate thread, so that one that never returns can be stopped. An object that "
    "belongs to one thread, such as an SQLite connection, must be opened within the function; what only the main "
    f"thread may do, such as signal.alarm, is not possible. The limit in seconds is os.environ[{LIMIT_VARIABLE!r}]."
)

SHARED = {"np.random": "numpy.random", "random": "random"}
"""The sources of chance that everybody draws from, and the modules that they are."""


class OperatorError(Fault, ValueError):
    """A function of the user's own does not do what its slot needs; it says which, what is expected, and the mend.

    Attributes:
        fault: which function, what it must do, and what it did.
        mend: what to do about it.
        where: when it was, as in ``while making generation 4``; "" if nobody knows.
        place: of a fitness, which of the robots given it was.
        genome: of a fitness, that robot's.
    """

    genome: object

    def __init__(self, fault: str, mend: str = "") -> None:
        super().__init__(fault, mend)
        self.fault, self.mend, self.where, self.place, self.genome = fault, mend, "", 0, None

    def __str__(self) -> str:
        when = f", {self.where}" if self.where else ""
        return f"{self.fault}{when}. {self.mend}".rstrip()


@dataclass(frozen=True)
class Slot:
    """What can be filled with a function of the user's own, and what is said of one that fills it badly.

    Attributes:
        kind: e.g. ``mutation``.
        signature: how it is called.
        copy: how it would take a copy of what it is given.
        advice: for one that raises something.
        chance: where its chance comes from.
    """

    kind: str
    signature: str
    copy: str
    advice: str = "It must work on every population."
    chance: str = (
        "Let all its chance come from rng, as in rng.random(), rng.integers(n), rng.normal() or rng.choice(n)."
    )

    def who(self, function: Callable[..., object]) -> str:
        """Name a function in this slot."""
        return f"{self.kind} {name_of(function)!r}"


def name_of(operator: Callable[..., object]) -> str:
    """Name a function as its author did, also where ``functools.partial`` has bound its parameters."""
    function = _unbound(operator)
    return getattr(function, "__name__", type(function).__name__)


def ask(slot: Slot, function: Callable[..., object], call: Callable[[], Any], seconds: float) -> Any:
    """Call what fills a slot; one of the user's own for so long and no longer, and not unwatched.

    Args:
        slot: which it fills.
        function: what fills it.
        call: calls it; may be made twice, and must be the same each time.
        seconds: that a call may take, if WALKERLAB_PATIENCE does not say otherwise.

    Raises:
        OperatorError: if it raises anything, does not return, writes into what it is given, or its answer
            depends on a source of chance that it shares with others.
    """
    if _is_ours(function):
        return _in_words(slot, function, call)
    attempt = partial(_in_words, slot, function, partial(call_with_limit, call, effective_limit(seconds)))
    before = _shared_chance()
    answer = attempt()
    used = {name for name, state in _shared_chance().items() if state != before.get(name)}
    if used and not _alike(answer, attempt()):  # or others drew from it, as the threads of Dask do
        raise OperatorError(
            f"{slot.who(function)} used {' and '.join(sorted(used))}, which all of Python shares",
            f"So no run could be repeated. {slot.chance}",
        )
    return answer


def portrait(answer: object) -> str:
    """Describe a wrong answer in a few words."""
    if answer is None:
        return "nothing (None)"
    if shape := getattr(answer, "shape", None):
        return f"an array of shape {shape}, {getattr(answer, 'dtype', '')}"
    return f"a {type(answer).__name__}: {answer!r:.60}"


def _in_words(slot: Slot, function: Callable[..., object], call: Callable[[], Any]) -> Any:
    who = slot.who(function)
    try:
        return call()
    except TimeLimitExceeded as error:
        stays = "" if error.is_stopped else " It could not be stopped, and goes on until Python is restarted."
        raise OperatorError(
            f"{who} had not returned after {error.seconds:g} s{_line_of(error, function)}",
            "Is there a loop that never ends? "
            f"If it needs longer: os.environ[{LIMIT_VARIABLE!r}] = '600' before the run.{stays}",
        ) from error
    except Fault:  # which has its words
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and not raised_in_call(error):
            raise  # Ctrl-C
        line = _line_of(error, function)
        if isinstance(error, FrozenInstanceError) or "read-only" in str(error):
            raise OperatorError(
                f"{who} must leave what it is given as it was; it wrote into what is read-only{line}",
                f"Let it work on a copy, as in {slot.copy}; +=, sort and shuffle write in place.",
            ) from error
        says_all = isinstance(error, NameError | MemoryError | RecursionError) or not isinstance(error, Exception)
        advice = THREAD_ADVICE if "thread" in str(error) else "" if says_all else slot.advice
        raise OperatorError(f"{who} raised {type(error).__name__}: {error}{line}", advice) from error


def _alike(one: Any, other: Any) -> bool:
    """Say whether two answers are the same, be they numbers, arrays or pairs of arrays."""
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        pairs = cast(Iterable[tuple[Any, Any]], zip(one, other, strict=False))
        return len(one) == len(other) and all(_alike(*pair) for pair in pairs)
    try:
        return np.array_equal(one, other, equal_nan=True)
    except TypeError:  # of what is no number something else is said
        return True


def _shared_chance() -> dict[str, object]:
    """Return the state of each."""
    _, keys, *rest = np.random.get_state()  # noqa: NPY002  # not drawn from, looked at
    states: dict[str, object] = {"np.random": (np.asarray(keys).tobytes(), rest)}
    if python := sys.modules.get(SHARED["random"]):
        states["random"] = python.getstate()
    return states


def _is_ours(function: Callable[..., object]) -> bool:
    home: dict[str, object] = getattr(_unbound(function), "__globals__", {})
    return str(home.get("__name__")).partition(".")[0] == __name__.partition(".")[0]


def _line_of(error: BaseException, function: Callable[..., object]) -> str:
    """Say in which line of a function an error was, counted as in its file or notebook cell."""
    own = getattr(inspect.unwrap(_unbound(function)), "__code__", None)
    lines = [line for frame, line in traceback.walk_tb(error.__traceback__) if frame.f_code is own]
    return f" (line {lines[-1]})" if lines else ""


def _unbound(function: Callable[..., object]) -> Callable[..., object]:
    while isinstance(function, partial):
        function = function.func
    return function
