"""With what a run is made: all that a number in its table may depend on, beside the settings."""

import ast
import inspect
import json
import platform
from collections.abc import Callable, Mapping
from functools import cache, partial
from hashlib import sha256
from importlib.metadata import version
from textwrap import dedent
from types import FunctionType, MethodType
from typing import Any

from walkerlab.settings.binding import plain_copy, written
from walkerlab.text.html import printable

DIGEST_DIGITS = 16
MAX_DEPTH = 8  # functions that hold functions
RATED_SINCE = "fitness rated since generation"
UNKNOWN = "unknown"  # in place of a digest
PACKAGES = ("walkerlab", "mujoco", "dm-control", "numpy")


@cache
def here() -> Mapping[str, str]:
    """Name the versions, the system, its mathematical library and the processor's features, as they are here."""
    import numpy as np

    kinds = np.show_config(mode="dicts")["SIMD Extensions"]  # type: ignore[index]
    return {
        **{name: version(name) for name in PACKAGES},
        "python": platform.python_version(),
        "system": platform.system(),
        "libc": " ".join(platform.libc_ver()).strip(),
        "processor": " ".join([platform.machine(), *kinds["baseline"], *kinds["found"]]),
    }


def differences(then: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Say in words what is not as it was, as in ``mujoco 3.17.0 (here 3.18.0)``; nothing if all that is known is."""
    return ", ".join(
        f"{name} {printable(then[name])} (here {value})"
        for name, value in now.items()
        if then.get(name, value) != value
    )


def rated_since(facts: Mapping[str, str], n_generations: int) -> int:
    """Return the first generation whose numbers are of the current fitness function.

    Raises:
        ValueError: If the facts name no generation of the run.
    """
    since = int(facts.get(RATED_SINCE, "0"))
    if not 0 <= since < max(1, n_generations):
        raise ValueError(f"its {RATED_SINCE} is {since}")
    return since


def source_digest(function: Callable[..., Any]) -> str | None:
    """Return a digest of a function's source without comments, and of the plain values that it holds.

    These are its defaults, what it encloses, and the attributes of an object that is called. Global names that it uses
    are not followed.

    Returns:
        Hexadecimal digits, or None if there is no source, or it holds what cannot be written.
    """
    try:
        return sha256(json.dumps(_described(function)).encode(errors="replace")).hexdigest()[:DIGEST_DIGITS]
    except (OSError, TypeError, ValueError, SyntaxError, RecursionError):
        return None


def _described(value: Any, depth: int = 0) -> Any:
    """Describe a function, or a value that it holds, as JSON data."""
    if depth > MAX_DEPTH:
        raise ValueError("functions within functions")
    match value:
        case FunctionType():
            cells = [cell.cell_contents for cell in value.__closure__ or ()]
            keywords = value.__kwdefaults__ or {}
            held = [*(value.__defaults__ or ()), *cells, *keywords.values()]
            return [_normalised(inspect.getsource(value.__code__)), *(_described(one, depth + 1) for one in held)]
        case MethodType():
            return [_described(value.__func__, depth + 1), _described(value.__self__, depth + 1)]
        case partial():
            return _described(value.func, depth + 1)  # what it binds is in the settings
        case type():
            return _normalised(inspect.getsource(value))
        case _ if callable(value) or hasattr(value, "__dict__"):
            return [_described(type(value), depth + 1), written(plain_copy(vars(value)))]
        case _:
            return written(plain_copy(value))


def _normalised(source: str) -> str:
    """Return source without comments and layout; of the line that a lambda is in, the lambda alone."""
    tree = ast.parse(dedent(source))
    lambdas = [node for node in ast.walk(tree) if isinstance(node, ast.Lambda)]
    if lambdas and not isinstance(tree.body[0], ast.FunctionDef | ast.ClassDef):
        [tree] = lambdas  # or which of them it is, nobody knows
    return ast.unparse(tree)
