"""Meshes of a playground: the ground, and one mesh of each kind of part, which the page copies as needed."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkerlab.settings.choices import Camera
from walkerlab.view.replay import meshes
from walkerlab.view.replay.animation import Animation, Walk, lateral_extent
from walkerlab.world import cameras
from walkerlab.world.assembly import ROBOT_BODY
from walkerlab.world.geometry import UNIT_BALL, Surface, visible_surfaces
from walkerlab.world.heights import ground_height
from walkerlab.world.scene import ROPE_ENDS

GROUND_EXTENT = 120.0  # m to each side to which a plane is drawn
MARKED_DISTANCE = 60  # m


@dataclass(frozen=True, eq=False)
class Drawing:
    """Description of the meshes of a plot.

    Attributes:
        data: Identifiers of the meshes and constants of cameras and marks, as JSON values.
    """

    data: dict[str, Any]

    @staticmethod
    def close(plot: Any) -> None:
        """Close the plot and its meshes, which are widgets; a notebook would keep them in memory."""
        empty = np.empty((0, 0))
        Animation(plot, [], empty, empty, {}, 0.0, empty).close()


def draw_robots(walks: Sequence[Walk], title: str) -> tuple[Any, Drawing]:
    """Create a K3D plot of the ground and of the parts of these robots.

    Args:
        walks: Walks of the robots, at least one; only their scenes, colours and lanes are used.
        title: Title of the plot.
    """
    scene = walks[0].scene
    terrain = scene.settings.terrain
    plot = meshes.create_plot(scene, title)

    def add(mesh: Any) -> int:
        nonlocal plot
        plot += mesh
        return mesh.id

    ground = [
        add(mesh)
        for mesh in meshes.ground_meshes(scene, visible_surfaces(scene.model, bodies=False, far=GROUND_EXTENT))
    ]
    extent = lateral_extent(list(walks))
    distances = np.arange(0.0, MARKED_DISTANCE + 1)
    ground.append(add(meshes.line_mesh(terrain, extent, distances[:1], meshes.START_LINE)))
    ground.append(add(meshes.line_mesh(terrain, extent, distances[1:], meshes.METRE_LINE)))
    robots: list[dict[str, Any]] = []
    for number, walk in enumerate(walks):
        parts = {name: add(mesh) for name, mesh in _part_meshes(walk).items()}
        bodies = {name: add(mesh) for name, mesh in _body_meshes(walk, with_obstacles=number == 0).items()}
        robots.append({"parts": parts, "bodies": bodies, "lane": walk.lane})
    mark_y = np.full_like(distances, extent[0] - meshes.LINE_OVERHANG)
    data: dict[str, Any] = {
        "ground": ground,
        "robots": robots,
        "ball": UNIT_BALL.ravel().tolist(),
        "shadow_clearance": meshes.GROUND_CLEARANCE,
        "rope_ends": ROPE_ENDS,
        "marks": np.stack([distances, mark_y, ground_height(terrain, distances, mark_y)], axis=1).tolist(),
        "cameras": {camera.name: cameras.CAMERA_VIEWS[camera] for camera in Camera},
        "camera_constants": {
            "min_size": cameras.MIN_SIZE,
            "distance_per_spread": cameras.DISTANCE_PER_SPREAD,
            "elevation_per_width": cameras.ELEVATION_PER_WIDTH,
            "max_width": cameras.MAX_WIDTH,
            "straight_down": cameras.STRAIGHT_DOWN,
            "orbit_speed": cameras.ORBIT_SPEED,
            "smoothing_time": cameras.SMOOTHING_TIME,
        },
    }
    return plot, Drawing(data)


def _part_meshes(walk: Walk) -> dict[str, Any]:
    """Return a mesh of each kind of part, keyed by name: a trunk, a left and a right bone, a shadow and a rope."""
    model = walk.scene.model
    names = ["trunk1"]
    for number, has_legs in enumerate(walk.scene.phenotype.plan, start=1):
        if has_legs:
            names += [f"left_thigh{number}", f"right_thigh{number}"]
            break
    surfaces = _surfaces_of_bodies(walk)
    parts: dict[str, Any] = {}
    for kind, name in zip(("trunk", "left", "right"), names, strict=True):
        surface = surfaces[int(model.geom(f"walker/{name}").bodyid[0])][0]
        parts[kind] = meshes.surface_mesh([_tint(surface, walk)], name=f"{walk.label}: {kind}")
    parts["shadow"] = meshes.shadow_mesh(1.0)
    if walk.scene.rope_length:
        parts["rope"] = meshes.rope_mesh(walk.scene)
    return parts


def _body_meshes(walk: Walk, *, with_obstacles: bool) -> dict[str, Any]:
    """Return the mesh of each body whose shape does not depend on genes, keyed by name: loads and obstacles."""
    model = walk.scene.model
    found: dict[str, Any] = {}
    for body, members in _surfaces_of_bodies(walk).items():
        name: str = model.body(body).name
        is_limb = model.body_rootid[body] == ROBOT_BODY and "pack" not in name
        if not is_limb and (with_obstacles or model.body_rootid[body] in walk.scene.roots):
            found[name] = meshes.surface_mesh(members, name=f"{walk.label}: {name}")
    return found


def _surfaces_of_bodies(walk: Walk) -> dict[int, list[Surface]]:
    surfaces: defaultdict[int, list[Surface]] = defaultdict(list)
    for surface in visible_surfaces(walk.scene.model, bodies=True):
        surfaces[surface.body].append(surface)
    return surfaces


def _tint(surface: Surface, walk: Walk) -> Surface:
    return meshes.tint_surface(surface, walk.colour) if walk.colour else surface
