"""The compiled world: robots of one body plan walk on one stage, one after the other.

    body plan, loads, terrain  --described, compiled once--------->  the stage: ground, pieces, obstacles, a robot
    phenotype                  --described, compiled alone-------->  a robot  --its rows-->  the stage

So nothing of the ground is compiled again for each robot, however much lies on it.
"""

import copy
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from walkerlab.assembly import each_thread_its_own, nominal, plan_of, write_measures
from walkerlab.entities.walker import BodyPlan
from walkerlab.genes import Floats
from walkerlab.phenotype import Phenotype
from walkerlab.settings import Settings, Terrain


def assemble(phenotype: Phenotype, settings: Settings) -> mujoco.MjModel:
    """Compile one world: what ``describe`` without scenery would compile to, but quicker."""
    return copy.copy(stage(phenotype, settings)[0])


def stage(phenotype: Phenotype, settings: Settings) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Compile one world where others of its body plan have walked, which spares making room for it and its state.

    Returns:
        The model, and a state to be started anew: good until this thread's next robot of the same body plan.
    """
    here = _stage(*plan_of(phenotype, settings.robot), settings.terrain)
    write_measures(here.alone, phenotype, settings.robot)
    here.model.opt.timestep = settings.simulation.timestep
    _transplant(here.alone.compile(), here)
    return here.model, here.data


KINDS = ("body", "jnt", "dof", "geom", "site", "actuator", "tendon")
"""Of what a model has rows, as its arrays are called: ``body_mass``, ``dof_armature``."""

FLAGS = ("sameframe", "simple", "simplenum")
"""Whole numbers that follow from measures: which frames coincide, and which inertias are diagonal."""


@lru_cache(maxsize=1)
def _measured() -> tuple[tuple[str, str], ...]:
    """Name every array of a model that holds measures of something, or follows from them, and of what kind."""
    model = mujoco.MjSpec().compile()
    arrays = ((name, *name.partition("_")[::2], getattr(model, name)) for name in dir(model))
    return tuple((name, kind) for name, kind, of, it in arrays if kind in KINDS and (of in FLAGS or _is_real(it)))


def _is_real(array: object) -> bool:
    return isinstance(array, np.ndarray) and array.dtype.kind == "f"


@dataclass(frozen=True, eq=False)
class _Stage:
    """One world in which robots of one body plan walk, one after the other.

    Attributes:
        alone: the robot on a bare plane, described.
        model: the world with the robot in it, compiled.
        data: its state.
        rows: for each array with measures, which rows of the robot that is compiled alone go where in the model's.
        mass: of what else there is in the world, kg.
        inertia: what else there is adds so much to the mean inertia.
        share: of the degrees of freedom are the robot's.
    """

    alone: mujoco.MjSpec
    model: mujoco.MjModel
    data: mujoco.MjData
    rows: tuple[tuple[str, int, Floats], ...]
    mass: float
    inertia: float
    share: float


@each_thread_its_own
def _stage(plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain) -> _Stage:
    """Set a stage, the robot on it in nominal measures.

    A robot comes first in a model: after what is of the world itself, and before what lies about in it.
    """
    alone = nominal(plan, carry_weight, drag_weight, Terrain())
    robot, model = alone.compile(), nominal(plan, carry_weight, drag_weight, terrain).compile()
    here = {"body": 1, "geom": int(robot.body_geomnum[0])}
    there = {"body": 1, "geom": int(model.body_geomnum[0])}
    ends = {name: there.get(kind, 0) - here.get(kind, 0) + len(getattr(robot, name)) for name, kind in _measured()}
    places = [(name, here.get(kind, 0), slice(there.get(kind, 0), ends[name])) for name, kind in _measured()]
    boxes, box = robot.body_bvhadr[1], model.body_bvhadr[1]  # by which contacts are looked for
    places.append(("bvh_aabb", boxes, slice(box, box + len(robot.bvh_aabb) - boxes)))
    share = robot.nv / model.nv
    return _Stage(
        alone=alone,
        model=model,
        data=mujoco.MjData(model),
        rows=tuple((name, start, getattr(model, name)[place]) for name, start, place in places),
        mass=model.body_subtreemass[0] - robot.body_subtreemass[0],
        inertia=model.stat.meaninertia - robot.stat.meaninertia * share,
        share=share,
    )


def _transplant(robot: mujoco.MjModel, stage: _Stage) -> None:
    """Write the rows of a robot that was compiled alone into the world of a stage."""
    for name, start, rows in stage.rows:
        rows[:] = getattr(robot, name)[start:]
    stage.model.body_subtreemass[0] = robot.body_subtreemass[0] + stage.mass
    stage.model.stat.meaninertia = robot.stat.meaninertia * stage.share + stage.inertia
