"""The animation of recorded walks: a K3D plot with all meshes, and how its meshes and cameras move over time."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from anywidget import AnyWidget

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Camera
from walkerlab.simulation.rollout import Rollout
from walkerlab.view.replay import meshes
from walkerlab.view.replay.footprints import Footprints, make_footprints
from walkerlab.view.replay.shadows import bone_ends, shadow_transforms
from walkerlab.view.replay.tracks import TRANSFORM_RESOLUTION, Tracks, frame_times, track_bodies
from walkerlab.world.assembly import ROBOT_BODY
from walkerlab.world.cameras import aim_camera
from walkerlab.world.geometry import PLANE_EXTENT, Surface, visible_surfaces
from walkerlab.world.heights import ground_height, slope
from walkerlab.world.scene import Scene

MIN_MARKED_DISTANCE = 10  # m
MARKED_BEYOND_WALKS = 5  # m; the distance marks continue this far beyond the farthest walk
MAX_MARKED_DISTANCE = 200  # m
POINT_RESOLUTION = 1e-3  # m, resolution of cameras and centres of mass


@dataclass(frozen=True, eq=False)
class Walk:
    """One recorded walk of a replay.

    Attributes:
        label: Name of the walk.
        scene: Compiled scene, with scenery.
        rollout: Rollout with its poses.
        colour: Colour of the robot, or None for its natural colours.
        lane: Distance to the left [m] by which the walk is moved.
        reach: Greatest distance of the robot's surface to either side at the start [m].
        shows_obstacles: Whether the loose obstacles are shown, as this robot moved them.
    """

    label: str
    scene: Scene
    rollout: Rollout
    colour: meshes.RGB | None = None
    lane: float = 0.0
    reach: float = 0.0
    shows_obstacles: bool = True


@dataclass(frozen=True, eq=False)
class Animation:
    """What the player requires.

    Attributes:
        plot: K3D plot with all meshes.
        mesh_ids: K3D's identifiers of the meshes that move.
        channels: Values over time, shape (c, n): eight for each mesh (as in ``Tracks.transforms``), six for each camera
            (eye and target), three for the centre of mass of each walk.
        resolution: Unit to which each channel is rounded, shape (c,).
        up_directions: Direction that is up in the picture of each camera.
        duration: Duration of the longest walk [s].
        marks: Positions of the distance marks on the ground, on the right side of all lanes [m], shape (k, 3).
        shadow_ids: K3D's identifiers of the shadows, which must not darken each other.
        footprints: Meshes of footprints, and the time of each print.
    """

    plot: Any
    mesh_ids: list[int]
    channels: Floats
    resolution: Floats
    up_directions: dict[Camera, tuple[float, float, float]]
    duration: float
    marks: Floats
    shadow_ids: list[int] = field(default_factory=list[int])
    footprints: list[Footprints] = field(default_factory=list[Footprints])

    def close(self) -> None:
        """Close the plot and its meshes, which are widgets; a notebook would keep them in memory."""
        for widget in (*self.plot.objects, self.plot):
            widget.layout.close()
            AnyWidget.close(widget)  # the method of K3D's plot closes only the outputs


def build_animation(walks: list[Walk], name: str) -> Animation:
    """Build the animation of one walk, or of several at the same time on the ground of the first.

    Args:
        walks: Walks to show, at least one.
        name: Title of the plot.
    """
    first = walks[0].scene
    terrain = first.settings.terrain
    time = frame_times(max(float(walk.rollout.time[-1]) for walk in walks))
    tracks = [track_bodies(walk.scene, walk.rollout) for walk in walks]
    paths: list[Floats] = []
    load_paths: list[Floats] = []
    for walk, track in zip(walks, tracks, strict=True):
        offset = np.array([0, walk.lane, 0])
        paths.append(_match_length(track.com, len(time)) + offset)
        if len(track.load):
            load_paths.append(_match_length(track.load, len(time)) + offset)
    plot = meshes.create_plot(first, name)
    far = float(np.abs(paths).max()) + PLANE_EXTENT
    for mesh in meshes.ground_meshes(first, visible_surfaces(first.model, bodies=False, far=far)):
        plot += mesh
    extent = lateral_extent(walks)
    distances = _marked_distances(paths)
    plot += meshes.line_mesh(terrain, extent, distances[:1], meshes.START_LINE)
    plot += meshes.line_mesh(terrain, extent, distances[1:], meshes.METRE_LINE)
    mesh_ids: list[int] = []
    shadow_ids: list[int] = []
    footprints: list[Footprints] = []
    channels: list[Floats] = []
    for walk, track in zip(walks, tracks, strict=True):
        for mesh, transforms in _walk_meshes(walk, track):
            plot += mesh
            if transforms is not None:
                mesh_ids.append(mesh.id)
                channels.append(_match_length(transforms, len(time)).T)
                channels[-1][1] += walk.lane
                if mesh.name == meshes.SHADOW_NAME:
                    shadow_ids.append(mesh.id)
        if found := make_footprints(walk.scene, walk.rollout, walk.lane, walk.colour):
            plot += found.mesh
            footprints.append(found)
    size = max(walk.scene.phenotype.body_length for walk in walks)
    followed = np.array([*paths, *load_paths])
    camera_tracks = {camera: aim_camera(camera, time, followed, size, slope(terrain)) for camera in Camera}
    for camera_track in camera_tracks.values():
        channels += [camera_track.eye.T, camera_track.target.T]
    channels += [path.T for path in paths]
    mark_y = np.full_like(distances, extent[0] - meshes.LINE_OVERHANG)
    return Animation(
        plot=plot,
        mesh_ids=mesh_ids,
        channels=np.concatenate(channels),
        resolution=np.array(
            len(mesh_ids) * TRANSFORM_RESOLUTION + (POINT_RESOLUTION,) * (6 * len(Camera) + 3 * len(walks))
        ),
        up_directions={camera: camera_track.up for camera, camera_track in camera_tracks.items()},
        duration=float(time[-1]),
        marks=np.stack(
            [distances, mark_y, ground_height(terrain, distances, mark_y) + meshes.GROUND_CLEARANCE], axis=1
        ),
        shadow_ids=shadow_ids,
        footprints=footprints,
    )


def lateral_extent(walks: list[Walk]) -> tuple[float, float]:
    """Return the right and the left edge of all lanes along y [m]."""
    return min(walk.lane - walk.reach for walk in walks), max(walk.lane + walk.reach for walk in walks)


def _marked_distances(paths: list[Floats]) -> Floats:
    """Return the whole metres along x that are marked, from the start to beyond the farthest walk.

    Args:
        paths: Centre of mass of each walk over time [m], shape (n, 3) each.
    """
    farthest = max(float(path[:, 0].max()) for path in paths)
    return np.arange(0.0, min(max(MIN_MARKED_DISTANCE, farthest + MARKED_BEYOND_WALKS), MAX_MARKED_DISTANCE))


def _walk_meshes(walk: Walk, tracks: Tracks) -> Iterator[tuple[Any, Floats | None]]:
    """Yield the meshes of a walk: bodies, shadows and rope.

    Yields:
        Each mesh with its transforms over time, (n, 8), or with None if it does not move.
    """
    model = walk.scene.model
    surfaces_of: defaultdict[int, list[Surface]] = defaultdict(list)
    for surface in visible_surfaces(model, bodies=True):
        surfaces_of[surface.body].append(surface)
    for body in range(1, model.nbody):  # all bodies except the world
        root = model.body_rootid[body]
        members = surfaces_of[body]
        if not members or not (walk.shows_obstacles or root in walk.scene.roots):
            continue
        if walk.colour and root == ROBOT_BODY and "pack" not in model.body(body).name:
            members = [meshes.tint_surface(surface, walk.colour) for surface in members]
        mesh = meshes.surface_mesh(members, name=f"{walk.label}: {model.body(body).name}")
        if body in tracks.moving_bodies:
            yield mesh, tracks.transforms[tracks.moving_bodies.index(body)]
        else:
            yield meshes.place_mesh(mesh, tracks.start[body]), None
    for geom, ends in bone_ends(walk.scene, tracks):
        yield meshes.bone_shadow_mesh(float(model.geom_size[geom, 0])), shadow_transforms(walk.scene, ends, geom)
    if len(tracks.rope):
        yield meshes.rope_mesh(walk.scene), tracks.rope


def _match_length(track: Floats, n_times: int) -> Floats:
    """Repeat the last row of a track that is too short, or cut a track that is too long."""
    return track[np.minimum(np.arange(n_times), len(track) - 1)]
