"""The composer entities: what is built once for each kind of ground and each body plan.

dm_control is imported in this room (and in ``export``) only. No chance is spent here.
"""

import warnings

with warnings.catch_warnings():  # dm_control looks for a display while it is imported, and grumbles if there is none
    warnings.simplefilter("ignore")
    from dm_control import composer as composer
    from dm_control import mjcf as mjcf

from walkerlab.entities.load import Pack, Sledge, tie
from walkerlab.entities.terrain import Ground, generate_terrain
from walkerlab.entities.walker import Walker, generate_robot

__all__ = ["Ground", "Pack", "Sledge", "Walker", "generate_robot", "generate_terrain", "tie"]
