"""Checks of arguments of public functions: each error shows the value, what is allowed and how to fix it."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.model import Domain
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr


def require_settings(given: object) -> Settings:
    """Return an argument that must be a ``Settings``.

    Raises:
        TypeError: If it is not; the message suggests a fix for the given type.
    """
    if isinstance(given, Settings):
        return given
    if isinstance(given, type) and issubclass(given, Settings):
        fix = "Call the class: wl.Settings()."
    elif isinstance(given, Domain):
        name = type(given).__name__
        fix = f"A {name} is one domain of the settings: wl.Settings({name.lower()}=…)."
    elif isinstance(given, dict):
        fix = "Change individual settings by name: wl.Settings().with_(seed=3)."
    elif isinstance(given, str | Path):
        fix = "The settings of a run file are wl.load(path).settings."
    elif hasattr(given, "settings"):
        fix = "The settings of a run are run.settings."
    elif hasattr(given, "genome") or hasattr(given, "n_parts"):
        fix = "The genome comes first, then the settings."
    else:
        fix = "The defaults are wl.Settings()."
    raise TypeError(
        f"settings must be a Settings, as in wl.Settings().with_(duration=4); got {short_repr(given)}. {fix}"
    )


def require_algorithm(given: object) -> Algorithm:
    """Return an argument that must be an ``Algorithm``.

    Raises:
        TypeError: If it is not.
    """
    if isinstance(given, Algorithm):
        return given
    raise TypeError(
        f"algorithm must be an Algorithm, such as settings.algorithm; got a {type(given).__name__}: {short_repr(given)}"
    )


def require_generator(given: object) -> Generator:
    """Return an argument that must be a numpy random generator.

    Raises:
        TypeError: If it is not, for example if it is a seed.
    """
    if isinstance(given, Generator):
        return given
    seed = given if isinstance(given, int) and not isinstance(given, bool) else 0
    raise TypeError(
        f"rng must be a numpy random Generator; got {short_repr(given)}. Make one from a seed: "
        f"np.random.default_rng({seed})"
    )


def require_count(given: Any, name: str, about: str, *, low: int = 1) -> int:
    """Return an argument that must be a whole number.

    Args:
        given: Value of the argument.
        name: Name of the argument.
        about: Meaning, as a noun phrase.
        low: Lowest value allowed.

    Raises:
        TypeError: If it is not a whole number.
        ValueError: If it is too low.
    """
    is_whole = isinstance(given, int | np.integer) and not isinstance(given, bool)
    if not is_whole or given < low:
        kind = ValueError if is_whole else TypeError
        raise kind(f"{name} is {short_repr(given)}; it must be a whole number, {low} or more. It is {about}.")
    return int(given)
