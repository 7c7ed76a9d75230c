"""The stage: what is to be seen of recorded walks, and the numbers that move it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkerlab.cameras import aim
from walkerlab.choices import Camera
from walkerlab.genes import Floats
from walkerlab.ground import height, slope
from walkerlab.rollout import Rollout
from walkerlab.scene import Scene
from walkerlab.shapes import rotate, surfaces
from walkerlab.viewer import meshes
from walkerlab.viewer.tracks import FINEST, Tracks, before_it_broke, follow

MARKS = 30  # metres along the way that are marked
SEEN = 1e-3  # m, to which cameras and centres of mass are rounded


@dataclass(frozen=True, eq=False)
class Walk:
    """One recorded walk on the stage.

    Attributes:
        label: by which it is told from the others.
        scene: its compiled world, with scenery.
        rollout: with its poses.
        colour: that the robot is painted in, or None for its natural ones.
        lane: how far to the left of the others' way it is shown [m].
        loose: whether what lies about is shown, as it moved it.
    """

    label: str
    scene: Scene
    rollout: Rollout
    colour: meshes.RGB | None = None
    lane: float = 0.0
    loose: bool = True


@dataclass(frozen=True, eq=False)
class Stage:
    """What the player needs.

    Attributes:
        plot: the K3D plot with all meshes in it.
        things: the ids of the meshes that move.
        channels: (c, n) eight for each thing as in ``Tracks.places``, six for each camera (eye and target), three for
            the centre of mass of each walk.
        finest: (c,) to what each is rounded.
        ups: which way is up for each camera.
        seconds: how long the longest walk is.
    """

    plot: Any
    things: list[int]
    channels: Floats
    finest: Floats
    ups: dict[Camera, tuple[float, float, float]]
    seconds: float

    def strike(self) -> None:
        """Close it: a notebook would keep all meshes as the widgets that they are."""
        for one in (*self.plot.objects, self.plot):
            one.close()


def set_up(walks: list[Walk], name: str) -> Stage:
    """Build the stage for one walk, or for several at once on the ground of the first."""
    first = walks[0]
    recorded = [before_it_broke(walk.rollout.poses) for walk in walks]
    time = np.arange(max(2, *map(len, recorded))) * (first.rollout.time[1] - first.rollout.time[0])
    plot = meshes.empty_plot(first.scene, name)
    for mesh in meshes.scenery(first.scene, list(surfaces(first.scene.model))):
        plot += mesh
    terrain, lanes = first.scene.settings.terrain, [walk.lane for walk in walks]
    plot += meshes.lines(terrain, lanes, np.zeros(1), *meshes.START)
    plot += meshes.lines(terrain, lanes, np.arange(1.0, MARKS + 1), *meshes.METRE)
    things, channels = list[int](), list[Floats]()
    for walk, poses in zip(walks, recorded, strict=True):
        for mesh, track in _cast(walk, follow(walk.scene, poses)):
            plot += mesh
            if track is not None:
                things.append(mesh.id)
                channels.append(_lasting(track, len(time)).T)
                channels[-1][1] += walk.lane
    aside = np.array([(0, walk.lane, 0) for walk in walks])
    paths = np.array([_lasting(np.nan_to_num(walk.rollout.com), len(time)) for walk in walks]) + aside[:, np.newaxis]
    loads = [
        _lasting(walk.rollout.load, len(time)) + side
        for walk, side in zip(walks, aside, strict=True)
        if walk.scene.rope
    ]
    size = max(walk.scene.phenotype.body_length for walk in walks)
    around, pitch = np.array([*paths, *loads]), slope(first.scene.settings.terrain)
    shots = {camera: aim(camera, time, around, size, pitch) for camera in Camera}
    for shot in shots.values():
        channels += [shot.eye.T, shot.target.T]
    channels += [path.T for path in paths]
    return Stage(
        plot=plot,
        things=things,
        channels=np.concatenate(channels),
        finest=np.array(len(things) * FINEST + (SEEN,) * (6 * len(Camera) + 3 * len(walks))),
        ups={camera: shot.up for camera, shot in shots.items()},
        seconds=float(time[-1]),
    )


def _cast(walk: Walk, tracks: Tracks) -> Iterator[tuple[Any, Floats | None]]:
    """Yield each mesh of a walk with its track, (n, 8), or None if it stays where it is: bodies, shadows, rope."""
    model, roots = walk.scene.model, walk.scene.roots
    for body in range(1, model.nbody):
        parts = [one for one in surfaces(model) if one.body == body]
        if not parts or not (walk.loose or model.body_rootid[body] in roots):
            continue
        if walk.colour and model.body_rootid[body] == 1 and "pack" not in model.body(body).name:
            parts = [meshes.tinted(one, walk.colour) for one in parts]
        mesh = meshes.mesh(parts, name=f"{walk.label}: {model.body(body).name}")
        if body in tracks.moving:
            yield mesh, tracks.places[tracks.moving.index(body)]
        else:
            yield meshes.placed(mesh, tracks.still[body]), None
    for number, segment in enumerate(walk.scene.phenotype.segments, start=1):
        trunk = tracks.moving.index(int(model.geom(f"walker/trunk{number}").bodyid[0]))
        yield meshes.shadow(segment.length), _below(walk.scene, tracks.places[trunk], segment.length)
    if len(tracks.rope):
        yield meshes.rope(walk.scene), tracks.rope


def _below(scene: Scene, place: Floats, length: float) -> Floats:
    """Follow the spot of ground below a segment's middle, turned with it and laid along the slope."""
    terrain, turns = scene.settings.terrain, place[:, 3:7]
    x, y, _ = (place[:, :3] + rotate(turns, np.array([-length / 2, 0, 0]))).T
    ahead = rotate(turns, np.array([1.0, 0, 0]))
    yaw, pitch = np.arctan2(ahead[:, 1], ahead[:, 0]) / 2, -slope(terrain) / 2
    lean = [-math.sin(pitch) * np.sin(yaw), math.sin(pitch) * np.cos(yaw)]
    turned = [math.cos(pitch) * np.cos(yaw), *lean, math.cos(pitch) * np.sin(yaw)]
    return np.stack([x, y, height(terrain, x, y) + meshes.LIFT, *turned, np.ones_like(x)], axis=1)


def _lasting(track: Floats, moments: int) -> Floats:
    """Hold the last row of a track that ends too soon, and cut one that goes on too long."""
    return track[np.minimum(np.arange(moments), len(track) - 1)]
