"""Fast compilation: one compiled model per body plan and terrain, into which each robot is written.

    body plan, loads, terrain  -- compiled once ------------------------->  model of the whole world
    phenotype                  -- compiled without terrain: robot model ->  its values are copied into that model

This way the ground is not compiled again for each robot, however many pieces and obstacles are on it.
"""

import copy
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.phenotype import Phenotype
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import Terrain
from walkerlab.world.assembly import (
    ROBOT_BODY,
    cache_per_thread,
    composer_arguments,
    measures_forces,
    nominal_spec,
    write_individual,
)
from walkerlab.world.entities.walker import BodyPlan


def assemble_model(phenotype: Phenotype, settings: Settings) -> mujoco.MjModel:
    """Return a new compiled model, equal to that of ``describe_world`` without scenery, but faster to compute."""
    return copy.copy(assemble_in_place(phenotype, settings)[0])


def assemble_in_place(phenotype: Phenotype, settings: Settings) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Write a robot into the compiled model of its body plan, which saves the allocation of a model and its data.

    Returns:
        The model, and data that must be reset before use. Both are overwritten by the next call in the same thread
        for a robot with the same body plan.
    """
    world = _compiled_world(*composer_arguments(phenotype, settings.robot), settings.terrain, measures_forces(settings))
    write_individual(world.robot_spec, phenotype, settings.robot)
    world.model.opt.timestep = settings.simulation.timestep
    _copy_robot(world.robot_spec.compile(), world)
    return world.model, world.data


OBJECT_TYPES = ("body", "jnt", "dof", "geom", "site", "actuator", "tendon")
"""Prefixes of the arrays of a model that have a row per object, as in ``body_mass`` and ``dof_armature``."""

DERIVED_FLAGS = ("sameframe", "simple", "simplenum")
"""Integer arrays that depend on sizes: which frames coincide, and which inertias are diagonal."""


@lru_cache(maxsize=1)
def _individual_arrays() -> tuple[tuple[str, str], ...]:
    """Return name and object type of each array of a model whose values can differ between individuals."""
    model = mujoco.MjSpec().compile()
    arrays = ((name, *name.partition("_")[::2], getattr(model, name)) for name in dir(model))
    return tuple(
        (name, object_type)
        for name, object_type, field, array in arrays
        if object_type in OBJECT_TYPES and (field in DERIVED_FLAGS or _is_real(array))
    )


def _is_real(array: object) -> bool:
    return isinstance(array, np.ndarray) and array.dtype.kind == "f"


@dataclass(frozen=True, eq=False)
class _CompiledWorld:
    """The compiled world of one body plan and terrain, into which robots are written.

    Attributes:
        robot_spec: Specification of the robot on a bare plane.
        model: Compiled model of the whole world.
        data: Data of that model.
        rows: For each array to copy: its name, the robot's first row in the model compiled from ``robot_spec``, and
            the view of the robot's rows in ``model``.
        other_mass: Mass of everything but the robot, kg.
        other_inertia: Contribution of everything but the robot to the mean inertia.
        dof_share: Share of the degrees of freedom that belong to the robot.
    """

    robot_spec: mujoco.MjSpec
    model: mujoco.MjModel
    data: mujoco.MjData
    rows: tuple[tuple[str, int, Floats], ...]
    other_mass: float
    other_inertia: float
    dof_share: float


@cache_per_thread
def _compiled_world(
    plan: BodyPlan, carry_weight: float, drag_weight: float, terrain: Terrain, forces: bool
) -> _CompiledWorld:
    """Compile the world of a body plan, with the robot in nominal sizes.

    In every array the robot's rows come after the rows of the world body and before the rows of the obstacles.
    """
    robot_spec = nominal_spec(plan, carry_weight, drag_weight, Terrain())
    robot = robot_spec.compile()
    model = nominal_spec(plan, carry_weight, drag_weight, terrain, forces=forces).compile()
    robot_start = _first_robot_rows(robot)
    model_start = _first_robot_rows(model)
    rows: list[tuple[str, int, Floats]] = []
    for name, object_type in _individual_arrays():
        start = robot_start.get(object_type, 0)
        target = model_start.get(object_type, 0)
        n_rows = len(getattr(robot, name)) - start
        rows.append((name, start, getattr(model, name)[target : target + n_rows]))
    start, target = robot.body_bvhadr[ROBOT_BODY], model.body_bvhadr[ROBOT_BODY]
    n_boxes = len(robot.bvh_aabb) - start
    rows.append(("bvh_aabb", start, model.bvh_aabb[target : target + n_boxes]))  # bounding boxes for collisions
    dof_share = robot.nv / model.nv
    return _CompiledWorld(
        robot_spec=robot_spec,
        model=model,
        data=mujoco.MjData(model),
        rows=tuple(rows),
        other_mass=model.body_subtreemass[0] - robot.body_subtreemass[0],
        other_inertia=model.stat.meaninertia - robot.stat.meaninertia * dof_share,
        dof_share=dof_share,
    )


def _first_robot_rows(model: mujoco.MjModel) -> dict[str, int]:
    """Return the robot's first row in the arrays of each object type; 0 if not listed."""
    return {"body": ROBOT_BODY, "geom": int(model.body_geomnum[0])}


def _copy_robot(robot: mujoco.MjModel, world: _CompiledWorld) -> None:
    """Copy the values of a robot that was compiled without terrain into the model of the whole world."""
    for name, start, rows in world.rows:
        rows[:] = getattr(robot, name)[start:]
    world.model.body_subtreemass[0] = robot.body_subtreemass[0] + world.other_mass
    world.model.stat.meaninertia = robot.stat.meaninertia * world.dof_share + world.other_inertia
