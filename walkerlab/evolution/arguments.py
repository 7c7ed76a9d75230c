"""Checks of the arguments of ``evolve`` and ``Evolution``."""

from typing import Any

from walkerlab.settings.settings import Settings
from walkerlab.settings.values import code_text, did_you_mean


def reject_unknown_arguments(function: str, unknown: dict[str, Any]) -> None:
    """Raise a TypeError if there are arguments of unknown names; for a setting, it says where that belongs.

    Args:
        function: Name of the function that was called, ``evolve`` or ``Evolution``.
        unknown: Arguments that it does not have, by name.
    """
    for name, value in unknown.items():
        if name in Settings.field_locations():
            call = f"wl.{function}(wl.Settings().with_({name}={code_text(value)}))"
            raise TypeError(f"{function} has no argument {name!r}, which is a setting: {call}")
        more = ("progress", "on_generation") if function == "evolve" else ("on_walks",)
        known = ("settings", "path", "executor", *more, "population", "stop")
        raise TypeError(f"{function} has no argument {name!r}; it has {', '.join(known)}.{did_you_mean(name, known)}")
