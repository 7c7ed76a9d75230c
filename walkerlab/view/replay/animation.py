"""The stage: what is to be seen of recorded walks, and the numbers that move it."""

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from anywidget import AnyWidget

from walkerlab.ga.genes import Floats
from walkerlab.settings.choices import Camera
from walkerlab.simulation.rollout import Rollout
from walkerlab.view.replay import meshes
from walkerlab.view.replay.tracks import FINEST, Tracks, follow, moments
from walkerlab.world.cameras import aim_camera
from walkerlab.world.geometry import PLANE_EXTENT, Surface, rotate, surfaces
from walkerlab.world.heights import height, slope
from walkerlab.world.scene import Scene

MOST_MARKS = 200  # metres along the way that are marked at most
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
        reach: how far the robot reaches to either side at the start [m].
        loose: whether what lies about is shown, as it moved it.
    """

    label: str
    scene: Scene
    rollout: Rollout
    colour: meshes.RGB | None = None
    lane: float = 0.0
    reach: float = 0.0
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
        marks: (k, 3) where the metres along the way are numbered: on the near side of all lanes [m].
    """

    plot: Any
    things: list[int]
    channels: Floats
    finest: Floats
    ups: dict[Camera, tuple[float, float, float]]
    seconds: float
    marks: Floats

    def strike(self) -> None:
        """Close it: a notebook would keep all meshes as the widgets that they are."""
        for one in (*self.plot.objects, self.plot):
            one.layout.close()
            AnyWidget.close(one)  # K3D's own closes but the outputs of a plot


def set_up(walks: list[Walk], name: str) -> Stage:
    """Build the stage for one walk, or for several at once on the ground of the first."""
    first = walks[0].scene
    terrain, time = first.settings.terrain, moments(max(float(walk.rollout.time[-1]) for walk in walks))
    tracks = [follow(walk.scene, walk.rollout) for walk in walks]
    aside = [np.array([0, walk.lane, 0]) for walk in walks]
    paths = [_lasting(track.com, len(time)) + lane for track, lane in zip(tracks, aside, strict=True)]
    loads = [
        _lasting(track.load, len(time)) + lane for track, lane in zip(tracks, aside, strict=True) if len(track.load)
    ]
    far = float(np.abs(paths).max())
    plot = meshes.empty_plot(first, name)
    for mesh in meshes.scenery(first, surfaces(first.model, bodies=False, far=far + PLANE_EXTENT)):
        plot += mesh
    edges, metres = edges_of(walks), _metres(paths)
    plot += meshes.lines(terrain, edges, metres[:1], *meshes.START)
    plot += meshes.lines(terrain, edges, metres[1:], *meshes.METRE)
    beside = np.full_like(metres, edges[0] - meshes.BESIDE)
    things, channels = list[int](), list[Floats]()
    for walk, track in zip(walks, tracks, strict=True):
        for mesh, places in _cast(walk, track):
            plot += mesh
            if places is not None:
                things.append(mesh.id)
                channels.append(_lasting(places, len(time)).T)
                channels[-1][1] += walk.lane
    size = max(walk.scene.phenotype.body_length for walk in walks)
    shots = {camera: aim_camera(camera, time, np.array([*paths, *loads]), size, slope(terrain)) for camera in Camera}
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
        marks=np.stack([metres, beside, height(terrain, metres, beside) + meshes.LIFT], axis=1),
    )


def edges_of(walks: list[Walk]) -> tuple[float, float]:
    """Return from where to where across the way [m] the walks need room."""
    return min(walk.lane - walk.reach for walk in walks), max(walk.lane + walk.reach for walk in walks)


def _metres(paths: list[Floats]) -> Floats:
    """Return the metres along the way that are marked: from the start to beyond the farthest that anyone comes."""
    return np.arange(0.0, min(max(10, max(float(path[:, 0].max()) for path in paths) + 5), MOST_MARKS))


def _cast(walk: Walk, tracks: Tracks) -> Iterator[tuple[Any, Floats | None]]:
    """Yield each mesh of a walk with its track, (n, 8), or None if it stays where it is: bodies, shadows, rope."""
    model, roots = walk.scene.model, walk.scene.roots
    parts_of = defaultdict[int, list[Surface]](list)
    for one in surfaces(model, bodies=True):
        parts_of[one.body].append(one)
    for body in range(1, model.nbody):
        parts = parts_of[body]
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
        yield meshes.shadow(segment.length), below(walk.scene, tracks.places[trunk], segment.length)
    if len(tracks.rope):
        yield meshes.rope(walk.scene), tracks.rope


def below(scene: Scene, place: Floats, length: float) -> Floats:
    """Follow the spot of ground below a segment's middle, turned with it and laid along the slope."""
    terrain, turns = scene.settings.terrain, place[:, 3:7]
    x, y, _ = (place[:, :3] + rotate(turns, np.array([-length / 2, 0, 0]))).T
    ahead = rotate(turns, np.array([1.0, 0, 0]))
    yaw, pitch = np.arctan2(ahead[:, 1], ahead[:, 0]) / 2, -slope(terrain) / 2
    lean = [math.sin(pitch) * np.sin(yaw), math.sin(pitch) * np.cos(yaw)]
    turned = [math.cos(pitch) * np.cos(yaw), *lean, math.cos(pitch) * np.sin(yaw)]
    return np.stack([x, y, height(terrain, x, y) + meshes.LIFT, *turned, np.ones_like(x)], axis=1)


def _lasting(track: Floats, moments: int) -> Floats:
    """Hold the last row of a track that ends too soon, and cut one that goes on too long."""
    return track[np.minimum(np.arange(moments), len(track) - 1)]
