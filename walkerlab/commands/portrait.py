"""The picture at the head of README: a champion caught in its stride, beside the curve that led to it.

    MUJOCO_GL=egl python -m walkerlab.commands.portrait RUN-FILE data/champion.png

Needs a GL that draws without a screen: ``walkerlab doctor`` says whether there is one.
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
from walkerlab.system.files import file_path, replacing
from walkerlab.text.numbers import with_unit
from walkerlab.view import plots
from walkerlab.world.scene import compile_scene

SIZE = (1500, 620)  # pixels
MOMENTS = np.linspace(0.1, 0.5, 4)  # of the walk, as shares


def strobe(run: Run) -> NDArray[np.uint8]:
    """Draw a run's champion at several moments of one walk, in one picture of (height, width, 3)."""
    genome, settings = run.champion.genome, run.settings
    scene, rollout = compile_scene(genome, settings, scenery=True), simulate(genome, settings)
    model, (width, height) = scene.model, SIZE
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    data, camera, option = mujoco.MjData(model), mujoco.MjvCamera(), mujoco.MjvOption()
    moments = (MOMENTS * (len(rollout.time) - 1)).astype(int)
    camera.lookat[:] = rollout.com[moments].mean(axis=0) + np.array([-0.2, 0, 0.05])
    camera.distance = 0.53 * np.ptp(rollout.com[moments, 0]) + 0.2 + 0.7 * scene.phenotype.body_length
    camera.azimuth, camera.elevation = 78, -16
    with mujoco.Renderer(model, height, width) as renderer:
        drawn: Any = renderer.scene
        for moment in moments[::-1]:
            data.qpos[:] = rollout.poses[moment]
            mujoco.mj_forward(model, data)
            if moment == moments[-1]:
                renderer.update_scene(data, camera)
            else:
                mujoco.mjv_addGeoms(model, data, option, mujoco.MjvPerturb(), mujoco.mjtCatBit.mjCAT_DYNAMIC, drawn)
        return renderer.render()


def portrait(run: Run, path: str) -> None:
    """Save the picture."""
    figure = Figure(figsize=(10, 3.2), layout="constrained", facecolor="white")
    walk, curve = figure.subplots(1, 2, width_ratios=[2, 1])
    image = strobe(run)
    walk.imshow(image)
    walk.set_axis_off()
    metres = simulate(run.champion.genome, run.settings, poses=False).distance
    walk.set_title(
        f"{with_unit(metres, 'm')} in {run.settings.simulation.duration:g} s: four moments on the way", fontsize=9
    )
    plots.fitness_curve(run.records, curve)
    with replacing(file_path(path)) as part:
        figure.savefig(part, dpi=120, format="png")


if __name__ == "__main__":
    portrait(load(sys.argv[1]), sys.argv[2])
