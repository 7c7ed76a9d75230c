"""Checks of the arguments of ``evolve`` and ``Evolution``."""

from typing import Any

from walkerlab.settings.settings import Settings
from walkerlab.settings.values import code_text, did_you_mean


def reject_unknown_arguments(function: str, unknown: dict[str, Any]) -> None:
    """Raise a TypeError for unknown arguments; if one is a setting, the message shows where to put it.

    Args:
        function: Name of the function that was called, ``evolve`` or ``Evolution``.
        unknown: Arguments that it does not have, keyed by name.
    """
    for name, value in unknown.items():
        if name in Settings.field_locations():
            call = f"wl.{function}(wl.Settings().with_({name}={code_text(value)}))"
            raise TypeError(f"{name!r} is a setting, not an argument of {function}. Use: {call}")
        more = ("progress", "on_generation") if function == "evolve" else ("on_walks",)
        known = ("settings", "path", "executor", *more, "population", "stop")
        raise TypeError(f"{function} has no argument {name!r}; it has {', '.join(known)}.{did_you_mean(name, known)}")
