"""Starts of a walk: small displacements, overlap with other bodies, and settling before the gait starts."""

import math

import mujoco
import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.simulation.stepping import STATE_PARTS, positions_in, simulate_steps, warnings_counted_not_printed
from walkerlab.system.randomness import random_stream
from walkerlab.world.assembly import ROBOT_BODY, Sensor
from walkerlab.world.scene import ROTATION, TRANSLATION, Scene

SETTLE_CHUNK = 0.25  # s between two checks that the body is at rest
MAX_SETTLE_TIME = 3.0  # s after which the walk starts even if the body is not at rest
REST_SPEED = 0.02  # m/s; speed of the centre of mass below which the body is at rest
MIN_REST_TIME = 1.0  # s below that speed after which a body is at rest without stable support, as on a round belly
MIN_SUPPORT_MARGIN = 0.005  # m; minimum distance from the centre of mass to the edge of the support polygon
N_MARGIN_DIRECTIONS = 16  # horizontal directions in which that distance is measured

# Standard deviations of the displacement of a start.
NUDGE_SHIFT = 0.02  # m sideways
NUDGE_TURN = 0.03  # rad, rotation of the body about each axis
NUDGE_BEND = 0.03  # rad, angle of each joint


def draw_nudge(scene: Scene, start: int) -> Floats | None:
    """Draw the small displacements of a start from the terrain's seed and the number of the start.

    Returns:
        Displacements of the robot's degrees of freedom, shape (nv,); None for start 0, which is not displaced.
    """
    if not start:
        return None
    model = scene.model
    scale = np.where(model.body_rootid[model.dof_bodyid] == ROBOT_BODY, NUDGE_BEND, 0.0)
    scale[TRANSLATION] = (0, NUDGE_SHIFT, 0)
    scale[ROTATION] = NUDGE_TURN
    return scale * random_stream(scene.settings.terrain.seed, "perturbation", start).standard_normal(model.nv)


def start_overlap(scene: Scene, data: mujoco.MjData) -> float:
    """Return how deeply [m] the robot or its sledge penetrates anything at the start, apart from itself."""
    mujoco.mj_fwdPosition(scene.model, data)
    roots = scene.model.body_rootid[scene.model.geom_bodyid[data.contact.geom]]
    is_relevant = (roots[:, 0] != roots[:, 1]) & np.isin(roots, scene.roots).any(axis=1)
    return float(np.max(-data.contact.dist, where=is_relevant, initial=0.0))


def settle(scene: Scene, data: mujoco.MjData) -> tuple[Floats, float, float]:
    """Hold the rest pose until the body is at rest: slow, and on stable support or slow for some time.

    A body that balances on an edge is slow at first and topples later. Without this check it would topple during the
    walk, and the distance covered by its fall would count.

    Returns:
        The state reached, shape (1, n_state); the time that it took [s]; the speed at its end [m/s].
    """
    model = scene.model
    timestep = scene.settings.simulation.timestep
    state = np.empty((1, mujoco.mj_stateSize(model, STATE_PARTS)))
    mujoco.mj_getState(model, data, state[0], STATE_PARTS)
    n_steps = round(SETTLE_CHUNK / timestep)
    hold = np.tile(scene.rest, (1, n_steps, 1))
    settled = 0.0
    rest_time = 0.0
    speed = math.inf
    while settled < MAX_SETTLE_TIME and rest_time < MIN_REST_TIME and not sum(data.warning.number):
        states, sensors = simulate_steps(model, data, state, hold)
        state = states[:, -1].copy()
        com = sensors[0, :, Sensor.COM]
        settled += SETTLE_CHUNK
        middle = n_steps // 2
        speed = float(np.linalg.norm(com[-1] - com[middle])) / ((n_steps - 1 - middle) * timestep)
        rest_time = rest_time + SETTLE_CHUNK if speed <= REST_SPEED else 0.0
        if rest_time and _support_margin(scene, data, state) >= MIN_SUPPORT_MARGIN:
            break
    return state, settled, speed


def _support_margin(scene: Scene, data: mujoco.MjData, state: Floats) -> float:
    """Return the distance from the centre of mass to the nearest edge of the support polygon [m].

    The polygon is the convex hull of the points where the robot touches anything else, seen in the direction of
    gravity. The distance is negative if the centre of mass is outside, and -inf without contact.
    """
    model = scene.model
    mujoco.mj_setState(model, data, state[0], STATE_PARTS)
    mujoco.mj_fwdPosition(model, data)
    is_outer = scene.is_robot_geom[data.contact.geom].sum(axis=1) == 1
    gravity = model.opt.gravity
    if not (is_outer.any() and gravity.any()):
        return -math.inf
    points = data.contact.pos[is_outer] - data.subtree_com[ROBOT_BODY]
    sideways = np.linalg.svd(gravity[np.newaxis])[2][1:]  # two directions at right angles to gravity
    angle = np.arange(N_MARGIN_DIRECTIONS) * math.tau / N_MARGIN_DIRECTIONS
    directions = np.stack([np.cos(angle), np.sin(angle)])
    return float((points @ sideways.T @ directions).max(axis=0).min())


def count_settling_steps(scene: Scene) -> int:
    """Return the number of steps for which ``simulate_walk`` holds the rest pose before the gait starts."""
    data = mujoco.MjData(scene.model)
    with warnings_counted_not_printed():
        scene.place(data)
        _, settled, _ = settle(scene, data)
    return round(settled / SETTLE_CHUNK) * round(SETTLE_CHUNK / scene.settings.simulation.timestep)


def settled_pose(scene: Scene) -> Floats:
    """Return the pose in which the robot stands after settling and from which its walk begins, shape (nq,).

    It is the first pose that ``simulate_walk`` records, computed in the same way. If the physics becomes unstable, it
    is the pose in which the robot starts to settle.
    """
    data = mujoco.MjData(scene.model)
    with warnings_counted_not_printed():
        scene.place(data)
        state, _, _ = settle(scene, data)
    pose = positions_in(scene.model, state)[0]
    return pose.copy() if np.isfinite(pose).all() else scene.start
