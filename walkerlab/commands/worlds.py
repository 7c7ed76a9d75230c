"""Script that draws the picture of the worlds in README: one robot in twelve worlds.

    MUJOCO_GL=egl python -m walkerlab.commands.worlds data/worlds.png

Requires OpenGL that renders without a screen; ``walkerlab doctor`` reports whether it is available.
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
from walkerlab.system.files import file_path, replace_atomically
from walkerlab.world.assembly import ROBOT_BODY
from walkerlab.world.heights import ground_height, slope
from walkerlab.world.scene import POSITION, Scene, compile_scene

WALKER_GENOME = (
    "wl2 segments=3"
    + 3 * " | seg length=0.26 mass=2 legs own length=0.42 force=14"
    + " | gait frequency=1.2 lag=0 duty=0.5"
    + " | step hip amplitude=0.3 phase=0 offset=0.35 knee amplitude=0.3 phase=1.2 offset=-0.7 stride=3.14"
    + " | step hip amplitude=0.3 phase=3.14 offset=0.35 knee amplitude=0.3 phase=1.2 offset=-0.7 stride=3.14"
    + " | step hip amplitude=0.3 phase=0 offset=0.35 knee amplitude=0.3 phase=1.2 offset=-0.7 stride=3.14"
)
TILE_SIZE = (480, 320)  # pixels, width and height
START_SHIFT = 2.8  # m by which the robot is moved forward
WALK_TIME = 0.9  # s
N_COLOURS = 96  # of the picture, for a file under 200 kB

WORLDS: dict[str, dict[str, Any]] = {
    "The default: a sports floor": {},
    "Marble": {"texture": "marble"},
    "Ice with boxes": {"texture": "ice", "obstacle": "box", "obstacle_size": 0.22, "obstacle_density": 0.5},
    "Wooden stairs": {"structure": "stairs", "texture": "wood", "step_height": 0.1, "step_depth": 0.5},
    "Concrete with trenches": {"structure": "gaps", "texture": "concrete", "gap_width": 0.3, "gap_distance": 1.0},
    "Grassy hills": {"structure": "rough", "texture": "grass", "hill_height": 0.6, "hill_length": 2.2},
    "Sand with lumps and balls": {
        "texture": "sand", "texture_density": 0.15, "texture_size": 0.1,
        "obstacle": "ball", "obstacle_size": 0.25, "obstacle_density": 0.4, "terrain_seed": 4,
    },
    "Coarse gravel with rocks": {
        "texture": "gravel", "texture_density": 0.4, "texture_size": 0.12,
        "obstacle": "rock", "obstacle_size": 0.3, "obstacle_density": 0.4,
    },
    "Uphill on mud, with logs": {
        "structure": "incline", "incline": 12, "texture": "mud",
        "obstacle": "log", "obstacle_size": 0.2, "obstacle_density": 0.6,
    },
    "Snowy stairs with cylinders": {
        "structure": "stairs", "step_depth": 0.8, "texture": "snow",
        "obstacle": "cylinder", "obstacle_size": 0.2, "obstacle_density": 0.5, "terrain_seed": 4,
    },
    "Mars, with a pack and a sledge": {"carry_weight": 3, "drag_weight": 8, "gravity": "mars"},
    "Downhill on the moon, in wind": {
        "structure": "incline", "incline": -10, "texture": "concrete", "gravity": "moon", "wind": (6, 3, 0),
        "obstacle": "ball", "obstacle_size": 0.25, "obstacle_density": 0.5, "terrain_seed": 4,
    },
}  # fmt: skip
"""Settings of each world that differ from the defaults, keyed by caption."""


def simulate_in_world(scene: Scene) -> mujoco.MjData:
    """Move the robot and its sledge into the middle of the world, and simulate a short walk."""
    model = scene.model
    terrain = scene.settings.terrain
    data = mujoco.MjData(model)
    scene.place(data)
    mujoco.mj_kinematics(model, data)
    offsets = np.linspace(-1, 0)  # m from the front of the robot
    for root in scene.roots:
        start = model.jnt_qposadr[model.body_jntadr[root]]
        rise = np.max(ground_height(terrain, offsets + START_SHIFT) - ground_height(terrain, offsets))
        data.qpos[start:][POSITION] += (START_SHIFT, 0, rise)
    for control in scene.controls(round(WALK_TIME / model.opt.timestep)):
        data.ctrl[:] = control
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    return data


def render_tile(settings: Settings) -> NDArray[np.uint8]:
    """Render the robot in the middle of one world, with antialiasing.

    Returns:
        The image, shape (height, width, 3).
    """
    scene = compile_scene(WALKER_GENOME, settings, scenery=True)
    model = scene.model
    data = simulate_in_world(scene)
    camera = mujoco.MjvCamera()
    width, n_rows = TILE_SIZE
    pitch = slope(settings.terrain)
    back = 0.9 if settings.robot.drag_weight else 0.0  # m, to show the sledge
    camera.lookat[:] = data.subtree_com[ROBOT_BODY] + np.array([0.5 - back, 0.2, 0.5 * math.tan(pitch)])
    camera.distance = 2.5 + 0.5 * back
    camera.azimuth = 60
    camera.elevation = -16
    model.vis.global_.offwidth = 2 * width
    model.vis.global_.offheight = 2 * n_rows
    with mujoco.Renderer(model, 2 * n_rows, 2 * width) as renderer:
        renderer.update_scene(data, camera)
        image: Any = renderer.render()
    return image.reshape(n_rows, 2, width, 2, 3).mean(axis=(1, 3)).astype(np.uint8)


def draw_worlds(path: str) -> None:
    """Draw all worlds and save them as PNG, with few colours for a small file."""
    figure = Figure(figsize=(16, 9.75), dpi=80, facecolor="white")
    grid = figure.subplots(
        3, 4, gridspec_kw={"left": 0.01, "right": 0.99, "top": 0.99, "bottom": 0.07, "wspace": 0.03, "hspace": 0.16}
    )
    for axes, (caption, changes) in zip(grid.flat, WORLDS.items(), strict=True):
        axes.imshow(render_tile(Settings().with_(**changes)), interpolation="lanczos")
        axes.set_axis_off()
        text = "  ".join(f"{name}={value}".replace(" ", "") for name, value in changes.items()) or "default settings"
        axes.text(0, -0.025, caption, transform=axes.transAxes, va="top", fontsize=11, weight="bold", color="0.15")
        axes.text(
            0, -0.095, fill(text, 70, break_on_hyphens=False), transform=axes.transAxes, va="top",
            fontsize=7, color="0.35", linespacing=1.4,
        )  # fmt: skip
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3])
    image = image.quantize(N_COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    with replace_atomically(file_path(path)) as temporary:
        image.save(temporary, "PNG", optimize=True)


if __name__ == "__main__":
    draw_worlds(sys.argv[1])
