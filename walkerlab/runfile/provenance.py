"""Provenance of a run: everything that its numbers may depend on, besides the settings."""

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

from walkerlab.settings.binding import plain_copy, to_json_data
from walkerlab.text.escape import printable

DIGEST_DIGITS = 16
MAX_DEPTH = 8  # maximum nesting of functions within functions
RATED_SINCE = "fitness rated since generation"
STOPPED = "stopped because"  # recorded with the generation after which a condition stopped the run
UNKNOWN_SOURCE = "unknown"  # stands in place of a digest
RECORDED_PACKAGES = ("walkerlab", "mujoco", "dm-control", "numpy")


@cache
def current_facts() -> Mapping[str, str]:
    """Return the versions of packages, the system, its C library and the features of the processor, keyed by name."""
    import numpy as np

    features = np.show_config(mode="dicts")["SIMD Extensions"]  # type: ignore[index]
    return {
        **{name: version(name) for name in RECORDED_PACKAGES},
        "python": platform.python_version(),
        "system": platform.system(),
        "libc": " ".join(platform.libc_ver()).strip(),
        "processor": " ".join([platform.machine(), *features["baseline"], *features["found"]]),
    }


def describe_differences(recorded: Mapping[str, str], current: Mapping[str, str]) -> str:
    """List the facts that differ, as in ``mujoco 3.17.0 (here 3.18.0)``; "" if there are none.

    Args:
        recorded: Facts in a run file; facts that it lacks are not compared.
        current: Facts to compare with.
    """
    return ", ".join(
        f"{name} {printable(recorded[name])} (here {value})"
        for name, value in current.items()
        if recorded.get(name, value) != value
    )


def rated_since(facts: Mapping[str, str], n_generations: int) -> int:
    """Return the first generation rated by the current fitness function.

    Args:
        facts: Provenance of the last generation.
        n_generations: Number of generations of the run.

    Raises:
        ValueError: If the facts name a generation that the run does not have.
    """
    since = int(facts.get(RATED_SINCE, "0"))
    if not 0 <= since < max(1, n_generations):
        raise ValueError(f"its {RATED_SINCE} is {since}")
    return since


def source_digest(function: Callable[..., Any]) -> str | None:
    """Return a digest of a function's source without comments, and of the plain values stored in it.

    These values are its defaults, its closure, and the attributes of a callable object. Global names are not followed.

    Returns:
        Hexadecimal digits, or None if there is no source, or a value cannot be written as JSON.
    """
    try:
        return sha256(json.dumps(_describe_value(function)).encode(errors="replace")).hexdigest()[:DIGEST_DIGITS]
    except (OSError, TypeError, ValueError, SyntaxError, RecursionError):
        return None


def _describe_value(value: Any, depth: int = 0) -> Any:
    """Describe a function, or a value stored in it, as JSON data."""
    if depth > MAX_DEPTH:
        raise ValueError("too many functions within functions")
    match value:
        case FunctionType():
            cells = [cell.cell_contents for cell in value.__closure__ or ()]
            keywords = value.__kwdefaults__ or {}
            held = [*(value.__defaults__ or ()), *cells, *keywords.values()]
            return [
                _normalise_source(inspect.getsource(value.__code__)),
                *(_describe_value(item, depth + 1) for item in held),
            ]
        case MethodType():
            return [_describe_value(value.__func__, depth + 1), _describe_value(value.__self__, depth + 1)]
        case partial():
            return _describe_value(value.func, depth + 1)  # the bound arguments are in the settings
        case type():
            return _normalise_source(inspect.getsource(value))
        case _ if callable(value) or hasattr(value, "__dict__"):
            return [_describe_value(type(value), depth + 1), to_json_data(plain_copy(vars(value)))]
        case _:
            return to_json_data(plain_copy(value))


def _normalise_source(source: str) -> str:
    """Return source without comments and layout; for a lambda, the source of the lambda instead of its whole line.

    Raises:
        ValueError: If the line has several lambdas.
    """
    tree = ast.parse(dedent(source))
    lambdas = [node for node in ast.walk(tree) if isinstance(node, ast.Lambda)]
    if lambdas and not isinstance(tree.body[0], ast.FunctionDef | ast.ClassDef):
        [tree] = lambdas  # with several, it is unknown which one is meant
    return ast.unparse(tree)
