"""Call user functions with a time limit, and explain every error that they raise."""

import inspect
import sys
import traceback
from collections.abc import Callable, Iterable
from dataclasses import FrozenInstanceError, dataclass
from functools import partial
from typing import Any, cast

import numpy as np

from walkerlab.system.errors import WalkerlabError
from walkerlab.system.time_limit import (
    LIMIT_VARIABLE,
    TimeLimitExceeded,
    call_with_limit,
    effective_limit,
    raised_in_call,
)

RUN_TIME_LIMIT = 60.0  # s for one call in a run
CHECK_TIME_LIMIT = 10.0  # s for one call in a check before the run

THREAD_ADVICE = (
    "User functions are called in a separate thread, so that one that never returns can be stopped. Open an object "
    "that belongs to one thread, such as an SQLite connection, within the function. Calls that only the main thread "
    f"may make, such as signal.alarm, are not possible. The time limit is os.environ[{LIMIT_VARIABLE!r}], in seconds."
)

RANDOM_MODULE = "random"
"""Module of Python's shared random generator; unless it has already been imported, its state is not read."""


class OperatorError(WalkerlabError, ValueError):
    """A user function does not do what its slot requires; the message names it and explains how to fix it.

    Attributes:
        problem: Which function, what it must do, and what it did.
        fix: How to fix it; may be empty.
        context: When it happened, such as ``while making generation 4``; empty if unknown.
        robot_index: For a fitness function, index of the robot among those given.
        genome: For a fitness function, genome of that robot, or None.
    """

    def __init__(self, problem: str, fix: str = "") -> None:
        """Create the error; ``context``, ``robot_index`` and ``genome`` are set where they are known."""
        super().__init__(problem, fix)
        self.problem = problem
        self.fix = fix
        self.context = ""
        self.robot_index = 0
        self.genome: object = None

    def __str__(self) -> str:
        """Return one message: the problem, when it happened, and the fix."""
        context = f", {self.context}" if self.context else ""
        return f"{self.problem}{context}. {self.fix}".rstrip()


@dataclass(frozen=True)
class Slot:
    """A setting that accepts a user function, with the advice for functions that do not work there.

    Attributes:
        kind: Kind of function, such as ``mutation``.
        signature: How the function is called.
        copy_example: Statement that copies an argument.
        advice: Advice for a function that raises an exception.
        repeatability_advice: Advice for a function whose results differ from call to call.
    """

    kind: str
    signature: str
    copy_example: str
    advice: str = "It must work on every population."
    repeatability_advice: str = (
        "Draw all random numbers from rng, as in rng.random(), rng.integers(n), rng.normal() or rng.choice(n)."
    )

    def label(self, function: Callable[..., object]) -> str:
        """Return the kind and the name of a function in this slot, for a message."""
        return f"{self.kind} {name_of(function)!r}"


def name_of(operator: Callable[..., object]) -> str:
    """Return the name of a function, even if ``functools.partial`` has bound its parameters."""
    function = _unwrap_partial(operator)
    return getattr(function, "__name__", type(function).__name__)


def call_in_slot(slot: Slot, function: Callable[..., object], call: Callable[[], Any], time_limit: float) -> Any:
    """Call the function in a slot; if it is a user function, limit its time and check its use of random numbers.

    Args:
        slot: Slot of the function.
        function: Function in the slot.
        call: Calls the function; it must give the same result if called twice.
        time_limit: Time limit of one call, s, unless the environment variable WALKERLAB_PATIENCE sets another.

    Returns:
        What the function returned.

    Raises:
        OperatorError: If the function raises an exception, does not return in time, modifies its arguments, or its
            result depends on a random generator that is shared with other code.
    """
    if _is_ours(function):
        return _call_and_explain(slot, function, call)
    attempt = partial(_call_and_explain, slot, function, partial(call_with_limit, call, effective_limit(time_limit)))
    before = _shared_random_states()
    result = attempt()
    used = {name for name, state in _shared_random_states().items() if state != before.get(name)}
    if used and not _are_equal(result, attempt()):  # equal if other threads, such as those of Dask, drew from it
        raise OperatorError(
            f"{slot.label(function)} used {' and '.join(sorted(used))}, shared with all other Python code",
            f"A run with it would not be reproducible. {slot.repeatability_advice}",
        )
    return result


def describe_error(error: BaseException) -> str:
    """Return the type of an error, and its message if it has one."""
    name = type(error).__name__
    return f"{name}: {error}" if str(error) else name


def describe_result(result: object) -> str:
    """Describe a wrong result briefly."""
    if result is None:
        return "nothing (None)"
    if shape := getattr(result, "shape", None):
        return f"an array of shape {shape}, {getattr(result, 'dtype', '')}"
    return f"a {type(result).__name__}: {result!r:.60}"


def _call_and_explain(slot: Slot, function: Callable[..., object], call: Callable[[], Any]) -> Any:
    """Call a function, and convert its exceptions to an OperatorError."""
    label = slot.label(function)
    try:
        return call()
    except TimeLimitExceeded as error:
        still_running = "" if error.is_stopped else " It could not be stopped, and runs until Python is restarted."
        raise OperatorError(
            f"{label} had not returned after {error.seconds:g} s{_line_of(error, function)}",
            "Check it for a loop that never ends. "
            f"If it needs more time, set os.environ[{LIMIT_VARIABLE!r}] = '600' before the run.{still_running}",
        ) from error
    except WalkerlabError:  # has an explanation already
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and not raised_in_call(error):
            raise  # Ctrl-C
        line = _line_of(error, function)
        if isinstance(error, FrozenInstanceError) or "read-only" in str(error):
            raise OperatorError(
                f"{label} must not modify its arguments, which are read-only; it tried to{line}",
                f"Work on a copy, as in {slot.copy_example}; +=, sort and shuffle modify an array in place.",
            ) from error
        is_self_explanatory = isinstance(error, NameError | MemoryError | RecursionError)
        if "thread" in str(error):
            advice = THREAD_ADVICE
        elif is_self_explanatory or not isinstance(error, Exception):
            advice = ""
        else:
            advice = slot.advice
        raise OperatorError(f"{label} raised {describe_error(error)}{line}", advice) from error


def _are_equal(one: Any, other: Any) -> bool:
    """Return whether two results are equal: numbers, arrays or sequences of arrays."""
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        pairs = cast(Iterable[tuple[Any, Any]], zip(one, other, strict=False))
        return len(one) == len(other) and all(_are_equal(*pair) for pair in pairs)
    try:
        return np.array_equal(one, other, equal_nan=True)
    except TypeError:  # not numbers: another check reports this
        return True


def _shared_random_states() -> dict[str, object]:
    """Return the state of each random generator that all code in the process shares, keyed by its name."""
    _, keys, *rest = np.random.get_state()  # noqa: NPY002  # only reads the state
    states: dict[str, object] = {"np.random": (np.asarray(keys).tobytes(), rest)}
    if module := sys.modules.get(RANDOM_MODULE):
        states[RANDOM_MODULE] = module.getstate()
    return states


def _is_ours(function: Callable[..., object]) -> bool:
    """Return whether a function is defined in walkerlab."""
    namespace: dict[str, object] = getattr(_unwrap_partial(function), "__globals__", {})
    return str(namespace.get("__name__")).partition(".")[0] == __name__.partition(".")[0]


def _line_of(error: BaseException, function: Callable[..., object]) -> str:
    """Return the line of a function at which an error was raised, numbered as in its file or cell, for a message."""
    code = getattr(inspect.unwrap(_unwrap_partial(function)), "__code__", None)
    lines = [line for frame, line in traceback.walk_tb(error.__traceback__) if frame.f_code is code]
    return f" (line {lines[-1]})" if lines else ""


def _unwrap_partial(function: Callable[..., object]) -> Callable[..., object]:
    """Return the function inside ``functools.partial`` objects."""
    while isinstance(function, partial):
        function = function.func
    return function
