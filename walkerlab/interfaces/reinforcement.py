"""Environments for Gymnasium, if it is installed."""

from collections.abc import Callable
from typing import Any

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings


def gym_env(
    genome: Genome | str,
    settings: Settings,
    *,
    reward: Callable[[Any], float] | None = None,
    render_mode: str | None = None,
) -> Any:
    """Return the environment of ``wl.environment`` for Gymnasium.

    It is also registered as ``walkerlab/Walker-v0`` once ``walkerlab.interfaces.gymnasium_env`` is imported. Actions
    are servo targets divided by π rad. An episode is truncated after the duration in the settings.
    ``info["distance"]`` is the distance so far [m].

    Args:
        genome: Genome or its text; repaired to be within the robot limits.
        settings: Settings of terrain, robot, fitness and simulation.
        reward: As for ``wl.environment``.
        render_mode: ``"rgb_array"`` for pictures from ``render()``, which require OpenGL; or None.

    Raises:
        GenomeError: If the text is not a valid genome.
        ModuleNotFoundError: If Gymnasium is not installed.
        TypeError: If ``settings`` is not a ``Settings``, or ``reward`` is not a function.
        ValueError: If the fitness is a function of your own, and ``reward`` is None; or if there is no such render
            mode.
    """
    try:
        from walkerlab.interfaces.gymnasium_env import WalkerEnv
    except ModuleNotFoundError as error:
        if error.name != "gymnasium":
            raise
        raise ModuleNotFoundError(
            'gym_env requires Gymnasium, which is not installed; install it: pip install "walkerlab[ecosystem]"'
        ) from None
    return WalkerEnv(genome, settings, reward, render_mode)
