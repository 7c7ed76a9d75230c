"""The picture of what can be set: one robot in twelve worlds.

    MUJOCO_GL=egl python -m walkerlab.commands.worlds data/worlds.png

Needs a GL that draws without a screen: ``walkerlab doctor`` says whether there is one.
"""

import math
import sys
from textwrap import fill
from typing import Any

import mujoco
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from walkerlab.settings.settings import Settings
from walkerlab.system.files import file_path, replacing
from walkerlab.world.heights import height, slope
from walkerlab.world.scene import Scene, compile_scene

GENOME = (
    "wl1 segments=3"
    + 3 * " | seg length=0.26 mass=2 legs length=0.42 force=14"
    + " | gait frequency=1.2"
    + " | step hip amplitude=0.3 phase=0 offset=0.35 knee amplitude=0.3 phase=1.2 offset=-0.7 stride=3.14"
    + " | step hip amplitude=0.3 phase=3.14 offset=0.35 knee amplitude=0.3 phase=1.2 offset=-0.7 stride=3.14"
    + " | step hip amplitude=0.3 phase=0 offset=0.35 knee amplitude=0.3 phase=1.2 offset=-0.7 stride=3.14"
)
TILE = (480, 320)  # pixels
ALONG = 2.8  # m along the way, where it stands
MOMENT = 1.3  # s into its walk
SHADES = 51  # of each colour: few enough for a small file

WORLDS: dict[str, dict[str, Any]] = {
    "The default: a sports floor": {},
    "Marble": {"texture": "marble"},
    "Ice, and boxes": {"texture": "ice", "obstacle": "box", "obstacle_size": 0.22, "obstacle_density": 0.5},
    "Wooden stairs": {"structure": "stairs", "texture": "wood", "step_height": 0.1, "step_depth": 0.5},
    "Concrete, and trenches": {"structure": "gaps", "texture": "concrete", "gap_width": 0.3, "gap_distance": 1.0},
    "Grassy hills": {"structure": "rough", "texture": "grass", "hill_height": 0.6, "hill_length": 2.2},
    "Sand with lumps, and balls": {
        "texture": "sand", "texture_density": 0.15, "texture_size": 0.1,
        "obstacle": "ball", "obstacle_size": 0.25, "obstacle_density": 0.4, "terrain_seed": 4,
    },
    "Coarse gravel, and rocks": {
        "texture": "gravel", "texture_density": 0.4, "texture_size": 0.12,
        "obstacle": "rock", "obstacle_size": 0.3, "obstacle_density": 0.4,
    },
    "Up a muddy slope, among logs": {
        "structure": "incline", "incline": 12, "texture": "mud",
        "obstacle": "log", "obstacle_size": 0.2, "obstacle_density": 0.6,
    },
    "Snowy steps, and tins": {
        "structure": "stairs", "step_depth": 0.8, "texture": "snow",
        "obstacle": "cylinder", "obstacle_size": 0.2, "obstacle_density": 0.5, "terrain_seed": 4,
    },
    "With a pack and a sledge, on Mars": {"carry_weight": 3, "drag_weight": 8, "gravity": "mars"},
    "Down a slope of the moon, in a wind": {
        "structure": "incline", "incline": -10, "texture": "concrete", "gravity": "moon", "wind": (6, 3, 0),
        "obstacle": "ball", "obstacle_size": 0.25, "obstacle_density": 0.5, "terrain_seed": 4,
    },
}  # fmt: skip
"""By caption, the settings that differ from the defaults."""


def stage(scene: Scene) -> mujoco.MjData:
    """Stand the robot, and what it drags, in the midst of its world, and let it walk for a moment."""
    model, terrain, data = scene.model, scene.settings.terrain, mujoco.MjData(scene.model)
    scene.place(data)
    mujoco.mj_kinematics(model, data)
    under = np.linspace(-1, 0)
    for root in scene.roots:
        start = model.jnt_qposadr[model.body_jntadr[root]]
        rise = np.max(height(terrain, under + ALONG) - height(terrain, under))
        data.qpos[start : start + 3] += (ALONG, 0, rise)
    for control in scene.controls(round(MOMENT / model.opt.timestep)):
        data.ctrl[:] = control
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    return data


def tile(settings: Settings) -> NDArray[np.uint8]:
    """Draw the robot in the midst of one world, in (height, width, 3)."""
    scene, (wide, high) = compile_scene(GENOME, settings, scenery=True), TILE
    model, data, camera = scene.model, stage(scene), mujoco.MjvCamera()
    pitch, back = slope(settings.terrain), 0.9 * bool(settings.robot.drag_weight)
    camera.lookat[:] = data.subtree_com[1] + np.array([0.5 - back, 0.2, 0.5 * math.tan(pitch)])
    camera.distance, camera.azimuth, camera.elevation = 2.5 + 0.5 * back, 60, -16
    model.vis.global_.offwidth, model.vis.global_.offheight = 2 * wide, 2 * high
    with mujoco.Renderer(model, 2 * high, 2 * wide) as renderer:
        renderer.update_scene(data, camera)
        image: Any = renderer.render()
    return image.reshape(high, 2, wide, 2, 3).mean(axis=(1, 3)).astype(np.uint8)


def poster(path: str) -> None:
    """Save the picture, of few enough colours to be a small file."""
    figure = Figure(figsize=(16, 9.75), dpi=100, facecolor="white")
    spots = figure.subplots(
        3, 4, gridspec_kw={"left": 0.01, "right": 0.99, "top": 0.99, "bottom": 0.07, "wspace": 0.03, "hspace": 0.16}
    )
    for axes, (caption, changes) in zip(spots.flat, WORLDS.items(), strict=True):
        axes.imshow(tile(Settings().with_(**changes)), interpolation="lanczos")
        axes.set_axis_off()
        told = "  ".join(f"{name}={value}".replace(" ", "") for name, value in changes.items()) or "nothing set"
        axes.text(0, -0.025, caption, transform=axes.transAxes, va="top", fontsize=11, weight="bold", color="0.15")
        axes.text(
            0, -0.095, fill(told, 70, break_on_hyphens=False), transform=axes.transAxes, va="top",
            fontsize=7, color="0.35", linespacing=1.4,
        )  # fmt: skip
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    shares = np.asarray(canvas.buffer_rgba())[:, :, :3] / 255
    shades = np.rint(np.rint(shares * SHADES) / SHADES * 255).astype(np.uint8)
    with replacing(file_path(path)) as part:
        Image.fromarray(shades).save(part, "PNG", optimize=True)


if __name__ == "__main__":
    poster(sys.argv[1])
