"""Where a film is drawn: in a process of its own, which has a GL."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.cameras import FIELD_OF_VIEW, aim_camera
from walkerlab.cinema.job import Act, Job
from walkerlab.cinema.titles import Picture, Titles
from walkerlab.fitness import poorest_walk
from walkerlab.genes import Floats
from walkerlab.ground import slope
from walkerlab.rollout import Rollout
from walkerlab.scene import Scene, compile_scene
from walkerlab.shapes import n_valid_poses

SHAPE = 4 / 3  # width over height of a picture in which a camera's distance is right; from narrower ones it steps back
SHORTEST = 1.0  # s of a walk that settings allow
HIDDEN = 5  # group of geoms that are not drawn
FAR = 12.0  # m, from where the pieces of a texture are left out of a sketch

SHADOWS = 2.5  # how far from the robot there are shadows, over the distance of the camera
CROWD = 100  # pieces of a texture, from which on they are drawn with fewer corners

ROUND, ROUNDISH = {"numslices": 48, "numstacks": 20}, {"numslices": 10, "numstacks": 6}
"""How many corners what is round has; with few, a limb throws specks of shadow on itself."""
SKETCH = {"shadowsize": 2048}
"""What is less fine where a processor does the work of a graphics card; at the size of a notebook nobody sees it."""


def frames(job: Job, *, sketch: bool) -> Iterator[Picture]:
    """Draw a film, frame by frame.

    Args:
        job: what is to be seen.
        sketch: whether to draw less finely, as for a processor that does the work of a graphics card.
    """
    for act in job.acts:
        titles = Titles(act, job)
        for picture in _act(act, job, sketch=sketch):
            yield titles.over(picture)


def _act(act: Act, job: Job, *, sketch: bool) -> Iterator[Picture]:
    """Let a robot walk as it is recorded to, and draw that."""
    settings = job.settings
    if settings.simulation.n_starts == 1:  # of several, only the whole walks tell which is the poorest
        settings = settings.with_(duration=min(settings.simulation.duration, max(SHORTEST, act.seconds)))
    scene = compile_scene(act.genome, settings, scenery=True)
    rollout = lasting(scene, poorest_walk(act.genome, settings))
    moments = np.arange(job.frames_of(act)) / job.fps
    (width, height), model, data = job.size, scene.model, mujoco.MjData(scene.model)
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    model.vis.global_.fovy = FIELD_OF_VIEW
    cameras, pieces = cameras_at(moments, scene, rollout, width / height), Pieces(scene, width / height, sketch=sketch)
    quality = (ROUNDISH if sketch and len(pieces) > CROWD else ROUND) | (SKETCH if sketch else {})
    for name, value in quality.items():
        setattr(model.vis.quality, name, value)
    model.vis.map.shadowclip = SHADOWS * max(camera.distance for camera in cameras) / model.stat.extent
    with mujoco.Renderer(model, height, width) as renderer:
        for moment, camera in zip(moments.tolist(), cameras, strict=True):
            data.qpos[:] = pose_at(model, rollout.time, rollout.poses, moment)
            _pose(model, data)
            pieces.show(camera)
            renderer.update_scene(data, camera)
            yield renderer.render()


def _pose(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Put everything where a pose says: bodies, the light that follows them, and the rope; nothing is simulated."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)
    mujoco.mj_tendon(model, data)


def pose_at(model: mujoco.MjModel, time: Floats, poses: Floats, moment: float) -> Floats:
    """Return the pose at a moment: a recorded one if there is one, or else one on the way between two.

    Args:
        model: whose poses they are.
        time: (n,) of the poses [s].
        poses: (n, nq).
        moment: that is asked for [s]; after the last pose, it stays.

    Returns:
        (nq,) whose quaternions have length 1.
    """
    before = int(np.searchsorted(time, moment + 1e-9, side="right")) - 1
    if before + 1 == len(time) or moment - time[before] < 1e-6:
        return poses[before]
    way, pose = np.empty(model.nv), poses[before].copy()
    mujoco.mj_differentiatePos(model, way, time[before + 1] - time[before], pose, poses[before + 1])
    mujoco.mj_integratePos(model, pose, way, moment - time[before])
    return pose


def lasting(scene: Scene, rollout: Rollout) -> Rollout:
    """Hold the last moment of a walk before its numbers ran away, if they did; the start, if there was none."""
    n = n_valid_poses(scene, rollout.poses)
    if n == len(rollout.poses):
        return rollout
    poses, com, load = (rollout.poses[:n], rollout.com[:n], rollout.load[:n]) if n else _start(scene)
    held = np.minimum(np.arange(len(rollout.time)), max(n, 1) - 1)
    return replace(rollout, poses=poses[held], com=com[held], load=load[held] if scene.rope_length else rollout.load)


def _start(scene: Scene) -> tuple[Floats, Floats, Floats]:
    """Return the pose of the start, (1, nq), and where robot and load are in it, (1, 3) each."""
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start
    _pose(scene.model, data)
    robot, load = data.subtree_com[[scene.roots[0], scene.roots[-1]]]
    return data.qpos[np.newaxis], robot[np.newaxis], load[np.newaxis]


def cameras_at(moments: Floats, scene: Scene, rollout: Rollout, shape: float) -> list[Any]:
    """Aim the camera that the settings ask for, as a replay does, at each of n moments.

    Args:
        moments: (n,) s.
        scene: in which the robot walks.
        rollout: of its walk, whose numbers did not run away.
        shape: width over height of the picture.

    Returns:
        An ``mjvCamera`` for each moment.
    """
    paths = [rollout.com, *([rollout.load] if len(rollout.load) else [])]  # its sledge is in the picture as well
    simulation, pitch = scene.settings.simulation, slope(scene.settings.terrain)
    shot = aim_camera(simulation.camera, rollout.time, np.array(paths), scene.phenotype.body_length, pitch)
    rows = np.column_stack([shot.target, shot.distance, shot.azimuth, shot.elevation])
    cameras: list[Any] = []
    for row in np.column_stack([np.interp(moments, rollout.time, column) for column in rows.T]):
        cameras.append(camera := mujoco.MjvCamera())
        camera.lookat[:], camera.distance = row[:3], row[3] * max(1.0, SHAPE / shape)
        camera.azimuth, camera.elevation = row[4:]
    return cameras


class Pieces:
    """The pieces of a texture, thousands of them, of which only those in the picture are drawn."""

    def __init__(self, scene: Scene, shape: float, *, sketch: bool) -> None:
        model = scene.model
        is_piece = (model.geom_bodyid == 0) & (model.geom_type == int(mujoco.mjtGeom.mjGEOM_SPHERE))
        self._model, self._shape, self._far = model, shape, FAR if sketch else math.inf
        self._which: NDArray[np.intp] = np.flatnonzero(is_piece)
        self._places, self._radii = model.geom_pos[is_piece], model.geom_size[is_piece, 0]

    def __len__(self) -> int:
        """How many there are."""
        return len(self._which)

    def show(self, camera: Any) -> None:
        """Hide those that are beside, above, below or behind the picture, or too far away."""
        azimuth, elevation = math.radians(camera.azimuth), math.radians(camera.elevation)
        right = np.array([math.sin(azimuth), -math.cos(azimuth), 0])
        level = np.array([math.cos(azimuth), math.sin(azimuth), 0])
        ahead = math.cos(elevation) * level + math.sin(elevation) * np.array([0, 0, 1])
        away, half = self._places - (camera.lookat - camera.distance * ahead), math.tan(math.radians(FIELD_OF_VIEW / 2))
        depth, room = away @ ahead, 1.5 * self._radii  # more than 1: the sides of the view are aslant
        hidden = (depth < 0) | (depth > self._far)
        hidden |= np.abs(away @ right) > half * self._shape * depth + room * max(1.0, self._shape)
        hidden |= np.abs(away @ np.cross(right, ahead)) > half * depth + room
        self._model.geom_group[self._which] = np.where(hidden, HIDDEN, 0)
