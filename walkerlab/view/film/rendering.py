"""Rendering of the frames of a film; runs in a process that has an OpenGL context."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats
from walkerlab.simulation.fitness import poorest_walk
from walkerlab.simulation.rollout import Rollout
from walkerlab.view.film.captions import CaptionOverlay, Picture
from walkerlab.view.film.job import Clip, Job
from walkerlab.world.cameras import FIELD_OF_VIEW, aim_camera
from walkerlab.world.geometry import n_valid_poses
from walkerlab.world.heights import slope
from walkerlab.world.scene import Scene, compile_scene

MIN_ASPECT_RATIO = 4 / 3  # width over height; for narrower pictures, the camera moves farther away
MIN_DURATION = 1.0  # s; the shortest walk that settings allow
WORLD_BODY = 0  # index of the body that contains the ground and the texture pieces
VISIBLE_GROUP = 0  # group of geoms that are drawn
HIDDEN_GROUP = 5  # group of geoms that are not drawn
MAX_PIECE_DISTANCE = 12.0  # m from the camera; in software rendering, farther texture pieces are not drawn

SHADOW_RANGE = 2.5  # distance from the robot within which there are shadows, over the distance of the camera
MAX_FINE_PIECES = 100  # texture pieces; if there are more, software rendering draws all shapes with fewer corners

FINE_SHAPES = {"numslices": 48, "numstacks": 20}
"""Corners of round shapes; with fewer, shadow specks appear on limbs."""
COARSE_SHAPES = {"numslices": 10, "numstacks": 6}
SOFTWARE_QUALITY = {"shadowsize": 2048}
"""Lower quality for software rendering; the difference is invisible at the size of a notebook's output."""


def render_frames(job: Job, *, software: bool) -> Iterator[Picture]:
    """Yield the frames of a film.

    Args:
        job: Film to render.
        software: Whether OpenGL renders in software; reduces the quality.
    """
    for clip in job.clips:
        overlay = CaptionOverlay(clip, job)
        for picture in _render_clip(clip, job, software=software):
            yield overlay.draw_on(picture)


def _render_clip(clip: Clip, job: Job, *, software: bool) -> Iterator[Picture]:
    """Simulate the walk of a clip and yield its frames without caption."""
    settings = job.settings
    if settings.simulation.n_starts == 1:  # with several starts, only the complete walks show which one is the poorest
        settings = settings.with_(duration=min(settings.simulation.duration, max(MIN_DURATION, clip.seconds)))
    scene = compile_scene(clip.genome, settings, scenery=True)
    rollout = freeze_when_diverged(scene, poorest_walk(clip.genome, settings))
    times = np.arange(job.count_frames(clip)) / job.fps
    width, height = job.size
    aspect_ratio = width / height
    model = scene.model
    data = mujoco.MjData(model)
    model.vis.global_.offwidth = width
    model.vis.global_.offheight = height
    model.vis.global_.fovy = FIELD_OF_VIEW
    cameras = cameras_at(times, scene, rollout, aspect_ratio)
    pieces = TexturePieces(scene, aspect_ratio, software=software)
    quality = COARSE_SHAPES if software and len(pieces) > MAX_FINE_PIECES else FINE_SHAPES
    if software:
        quality = quality | SOFTWARE_QUALITY
    for name, value in quality.items():
        setattr(model.vis.quality, name, value)
    model.vis.map.shadowclip = SHADOW_RANGE * max(camera.distance for camera in cameras) / model.stat.extent
    with mujoco.Renderer(model, height, width) as renderer:
        for time, camera in zip(times.tolist(), cameras, strict=True):
            data.qpos[:] = interpolate_pose(model, rollout.time, rollout.poses, time)
            _update_positions(model, data)
            pieces.hide_outside(camera)
            renderer.update_scene(data, camera)
            yield renderer.render()


def _update_positions(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Compute the positions of bodies, lights and the rope from the pose, without simulating a step."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)
    mujoco.mj_tendon(model, data)


def interpolate_pose(model: mujoco.MjModel, times: Floats, poses: Floats, time: float) -> Floats:
    """Return the pose at a time, interpolated between the recorded poses before and after it.

    Args:
        model: Model of the poses.
        times: Time of each pose [s], ascending, shape (n,).
        poses: Recorded poses, shape (n, nq).
        time: Time of the pose [s]; if it is after the last recorded pose, the last pose is returned.

    Returns:
        Pose with unit quaternions, shape (nq,).
    """
    before = int(np.searchsorted(times, time + 1e-9, side="right")) - 1
    if before + 1 == len(times) or time - times[before] < 1e-6:
        return poses[before]
    velocity = np.empty(model.nv)
    pose = poses[before].copy()
    mujoco.mj_differentiatePos(model, velocity, times[before + 1] - times[before], pose, poses[before + 1])
    mujoco.mj_integratePos(model, pose, velocity, time - times[before])
    return pose


def freeze_when_diverged(scene: Scene, rollout: Rollout) -> Rollout:
    """Repeat the last valid pose from the moment at which a simulation diverged; the start if no pose is valid."""
    n = n_valid_poses(scene, rollout.poses)
    if n == len(rollout.poses):
        return rollout
    poses, com, load = (rollout.poses[:n], rollout.com[:n], rollout.load[:n]) if n else _starting_state(scene)
    shown = np.minimum(np.arange(len(rollout.time)), max(n, 1) - 1)
    return replace(rollout, poses=poses[shown], com=com[shown], load=load[shown] if scene.rope_length else rollout.load)


def _starting_state(scene: Scene) -> tuple[Floats, Floats, Floats]:
    """Return the starting pose, shape (1, nq), and its centres of mass of robot and load, shape (1, 3) each."""
    data = mujoco.MjData(scene.model)
    data.qpos[:] = scene.start
    _update_positions(scene.model, data)
    robot, load = data.subtree_com[[scene.roots[0], scene.roots[-1]]]
    return data.qpos[np.newaxis], robot[np.newaxis], load[np.newaxis]


def cameras_at(times: Floats, scene: Scene, rollout: Rollout, aspect_ratio: float) -> list[Any]:
    """Aim the camera of the settings at the robot, in the same way as in a replay.

    Args:
        times: Times of the frames [s], shape (n,).
        scene: Compiled world with the robot.
        rollout: Recorded walk with finite values only.
        aspect_ratio: Width of the picture over its height.

    Returns:
        An ``mjvCamera`` for each time.
    """
    paths = [rollout.com, *([rollout.load] if len(rollout.load) else [])]
    simulation = scene.settings.simulation
    pitch = slope(scene.settings.terrain)
    shot = aim_camera(simulation.camera, rollout.time, np.array(paths), scene.phenotype.body_length, pitch)
    recorded = np.column_stack([shot.target, shot.distance, shot.azimuth, shot.elevation])
    at_frames = np.column_stack([np.interp(times, rollout.time, column) for column in recorded.T])
    cameras: list[Any] = []
    for *target, distance, azimuth, elevation in at_frames.tolist():
        camera: Any = mujoco.MjvCamera()
        camera.lookat[:] = target
        camera.distance = distance * max(1.0, MIN_ASPECT_RATIO / aspect_ratio)
        camera.azimuth = azimuth
        camera.elevation = elevation
        cameras.append(camera)
    return cameras


class TexturePieces:
    """Texture pieces, possibly thousands; only the visible ones are drawn.

    Args:
        scene: Compiled world with the pieces.
        aspect_ratio: Width of the picture over its height.
        software: Whether OpenGL renders in software; hides distant pieces.
    """

    def __init__(self, scene: Scene, aspect_ratio: float, *, software: bool) -> None:
        model = scene.model
        is_piece = (model.geom_bodyid == WORLD_BODY) & (model.geom_type == int(mujoco.mjtGeom.mjGEOM_SPHERE))
        self._model = model
        self._aspect_ratio = aspect_ratio
        self._max_distance = MAX_PIECE_DISTANCE if software else math.inf
        self._geoms: NDArray[np.intp] = np.flatnonzero(is_piece)
        self._positions = model.geom_pos[is_piece]
        self._radii = model.geom_size[is_piece, 0]

    def __len__(self) -> int:
        """Return the number of pieces."""
        return len(self._geoms)

    def hide_outside(self, camera: Any) -> None:
        """Hide the pieces outside the camera's picture, behind the camera or too far away, and show the others."""
        azimuth, elevation = math.radians(camera.azimuth), math.radians(camera.elevation)
        right = np.array([math.sin(azimuth), -math.cos(azimuth), 0])
        level = np.array([math.cos(azimuth), math.sin(azimuth), 0])
        forward = math.cos(elevation) * level + math.sin(elevation) * np.array([0, 0, 1])
        up = np.cross(right, forward)
        from_camera = self._positions - (camera.lookat - camera.distance * forward)
        depth = from_camera @ forward
        half_height = math.tan(math.radians(FIELD_OF_VIEW / 2))  # half the height of the picture at a depth of 1
        margin = 1.5 * self._radii  # more than the radius, because the sides of the view are oblique
        is_hidden = (depth < 0) | (depth > self._max_distance)
        is_hidden |= np.abs(from_camera @ right) > half_height * self._aspect_ratio * depth + margin * max(
            1.0, self._aspect_ratio
        )
        is_hidden |= np.abs(from_camera @ up) > half_height * depth + margin
        self._model.geom_group[self._geoms] = np.where(is_hidden, HIDDEN_GROUP, VISIBLE_GROUP)
