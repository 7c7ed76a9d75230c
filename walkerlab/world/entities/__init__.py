"""Composer entities: ground, walker and loads, built once for each terrain and body plan.

dm_control is imported only here and in ``export``. Entities depend only on their arguments and draw no random numbers.
"""

import warnings

try:
    with warnings.catch_warnings():  # dm_control warns on import if the computer has no display
        warnings.simplefilter("ignore")
        from dm_control import composer as composer
        from dm_control import mjcf as mjcf
        from dm_control.composer.observation import observable as observable
        from dm_control.mujoco.wrapper import MjModel as WrappedModel
except ModuleNotFoundError as error:
    if error.name != "dm_control":
        raise
    raise ModuleNotFoundError(
        "walkerlab requires dm_control, which pip does not install with it on Python 3.13 and newer. Install it with: "
        "python -m pip install --no-deps dm-control",
        name="dm_control",
    ) from None

from walkerlab.world.entities.load import Pack, Sledge, add_rope
from walkerlab.world.entities.terrain import Ground, generate_terrain
from walkerlab.world.entities.walker import Walker, generate_robot

__all__ = ["Ground", "Pack", "Sledge", "Walker", "WrappedModel", "add_rope", "generate_robot", "generate_terrain"]
