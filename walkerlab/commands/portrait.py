"""Script that draws the first picture of README: several moments of a champion's walk, and the fitness curve.

    MUJOCO_GL=egl python -m walkerlab.commands.portrait RUN-FILE data/champion.png

Requires OpenGL that renders without a screen; ``walkerlab doctor`` reports whether it is available.
"""

import sys
from typing import Any

import mujoco
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from walkerlab.evolution.loading import load
from walkerlab.evolution.run import Run
from walkerlab.simulation.rollout import simulate
from walkerlab.system.files import file_path, replace_atomically
from walkerlab.text.numbers import with_unit
from walkerlab.view import plots
from walkerlab.view.plots.style import add_legend
from walkerlab.world.scene import compile_scene

IMAGE_SIZE = (1500, 620)  # pixels, width and height
SHOWN_TIMES = np.linspace(0.2, 0.43, 4)  # shares of the duration of the walk


def render_moments(run: Run) -> NDArray[np.uint8]:
    """Render the champion of a run at several moments of one walk.

    Returns:
        The image, shape (height, width, 3).
    """
    genome = run.champion.genome
    settings = run.settings
    scene = compile_scene(genome, settings, scenery=True)
    rollout = simulate(genome, settings)
    model = scene.model
    width, height = IMAGE_SIZE
    model.vis.global_.offwidth = width
    model.vis.global_.offheight = height
    data = mujoco.MjData(model)
    camera = mujoco.MjvCamera()
    option = mujoco.MjvOption()
    moments = (SHOWN_TIMES * (len(rollout.time) - 1)).astype(int)
    camera.lookat[:] = rollout.com[moments].mean(axis=0) + np.array([-0.2, 0, 0.05])
    camera.distance = 0.53 * np.ptp(rollout.com[moments, 0]) + 0.2 + 0.7 * scene.phenotype.body_length
    camera.azimuth = 78
    camera.elevation = -16
    with mujoco.Renderer(model, height, width) as renderer:
        rendered_scene: Any = renderer.scene
        for moment in moments[::-1]:
            data.qpos[:] = rollout.poses[moment]
            mujoco.mj_forward(model, data)
            if moment == moments[-1]:
                renderer.update_scene(data, camera)
            else:
                mujoco.mjv_addGeoms(
                    model, data, option, mujoco.MjvPerturb(), mujoco.mjtCatBit.mjCAT_DYNAMIC, rendered_scene
                )
        return renderer.render()


def draw_champion(run: Run, path: str) -> None:
    """Draw moments of the champion's walk and the fitness curve, and save them as PNG."""
    figure = Figure(figsize=(10, 3.2), layout="constrained", facecolor="white")
    walk_axes, curve_axes = figure.subplots(1, 2, width_ratios=[2, 1])
    walk_axes.imshow(render_moments(run))
    walk_axes.set_axis_off()
    distance = simulate(run.champion.genome, run.settings, poses=False).distance
    walk_axes.set_title(
        f"{with_unit(distance, 'm')} in {run.settings.simulation.duration:g} s: four moments of the walk", fontsize=9
    )
    plots.fitness_curve(run.records, curve_axes)
    add_legend(curve_axes, n_columns=1)  # the Axes are narrow
    with replace_atomically(file_path(path)) as temporary:
        figure.savefig(temporary, dpi=120, format="png")


if __name__ == "__main__":
    draw_champion(load(sys.argv[1]), sys.argv[2])
