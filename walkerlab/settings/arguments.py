"""Checks of arguments that public functions share: each error names the value, what is allowed, and how to fix it."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.model import Domain
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import brief


def require_settings(given: object) -> Settings:
    """Return settings if they are a ``Settings``.

    Raises:
        TypeError: If they are not; the message suggests the fix for what is given instead.
    """
    if isinstance(given, Settings):
        return given
    if isinstance(given, type) and issubclass(given, Settings):
        fix = "Call the class: wl.Settings()."
    elif isinstance(given, Domain):
        name = type(given).__name__
        fix = f"A {name} is one part of them: wl.Settings({name.lower()}=…)."
    elif isinstance(given, dict):
        fix = "Single settings are changed by name: wl.Settings().with_(seed=3)."
    elif isinstance(given, str | Path):
        fix = "Those of a run file are wl.load(path).settings."
    elif hasattr(given, "settings"):
        fix = "Those of a run are run.settings."
    elif hasattr(given, "genome") or hasattr(given, "n_parts"):
        fix = "The genome comes first, and then the settings."
    else:
        fix = "The defaults are wl.Settings()."
    raise TypeError(f"settings must be a Settings, as in wl.Settings().with_(duration=4); got {brief(given)}. {fix}")


def require_algorithm(given: object) -> Algorithm:
    """Return the algorithm's settings if they are an ``Algorithm``.

    Raises:
        TypeError: If they are not.
    """
    if isinstance(given, Algorithm):
        return given
    raise TypeError(
        f"algorithm must be an Algorithm, such as settings.algorithm; got a {type(given).__name__}: {brief(given)}"
    )


def require_generator(given: object) -> Generator:
    """Return a random generator of numpy.

    Raises:
        TypeError: If it is anything else, such as a seed.
    """
    if isinstance(given, Generator):
        return given
    seed = given if isinstance(given, int) and not isinstance(given, bool) else 0
    raise TypeError(
        f"rng must be a numpy random Generator; got {brief(given)}. Make one from a seed: np.random.default_rng({seed})"
    )


def require_count(given: Any, name: str, about: str, *, low: int = 1) -> int:
    """Return a whole number of at least ``low``.

    Raises:
        TypeError: If it is not a whole number.
        ValueError: If it is too low.
    """
    is_whole = isinstance(given, int | np.integer) and not isinstance(given, bool)
    if not is_whole or given < low:
        kind = ValueError if is_whole else TypeError
        raise kind(f"{name} is {brief(given)}; it must be a whole number, {low} or more. It is {about}.")
    return int(given)
