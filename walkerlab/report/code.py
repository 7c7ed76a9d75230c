"""The code that repeats a run."""

from functools import partial
from typing import Any

from walkerlab.algorithm import in_turn
from walkerlab.quantity import function_name
from walkerlab.settings import Settings

STEPS = ("fitness", "selection", "crossover", "mutation")
OURS = ("walkerlab.fitness", "walkerlab.ga.")


def as_python(settings: Settings) -> str:
    """Write the code that repeats a run of these settings; a user's own functions are named, and not defined."""
    imports = {f"from {home} import {name}" for home, name in _functions(settings) if home.startswith(OURS)}
    imports |= {"from functools import partial"} if any(isinstance(one, partial) for one in _slots(settings)) else set()
    made = [f"settings = {settings.as_python()}", "run = wl.evolve(settings)"]
    return "\n".join([*sorted(imports), "import walkerlab as wl", "", *made])


def own_functions(settings: Settings) -> list[str]:
    """Name the functions of settings that are somebody's own."""
    return [name for home, name in _functions(settings) if not home.startswith(OURS)]


def _functions(settings: Settings) -> list[tuple[str, str]]:
    """Name the functions in the slots, each with the module that it is from."""
    inside = (one.func if isinstance(one, partial) else one for one in _slots(settings))
    return [(str(getattr(one, "__module__", "")), function_name(one)) for one in inside if callable(one)]


def _slots(settings: Settings) -> list[Any]:
    return [one for slot in STEPS for one in in_turn(getattr(settings.algorithm, slot))]
