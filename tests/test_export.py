"""What is taken elsewhere is what walked here."""

import subprocess
import sys

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.randomness import stream
from walkerlab.settings import Structure

GENOME = wl.Genome.random(wl.Robot(), rng=stream(4, "check"))


WORLDS = [{"structure": structure} for structure in Structure]
WORLDS += [{"carry_weight": 1, "drag_weight": 2, "wind": (1, 0, 0)}, {"texture": "sand", "obstacle": "rock", "seed": 3}]


@pytest.mark.parametrize("world", WORLDS, ids=str)
def test_plain_mujoco_walks_the_exported_robot_as_we_do(world, tmp_path):
    settings = wl.Settings().with_(**world)
    scene = wl.compile_scene(GENOME, settings)
    model = mujoco.MjModel.from_xml_path(str(wl.export_mjcf(GENOME, settings, tmp_path / "new")))
    ours, theirs = mujoco.MjData(scene.model), mujoco.MjData(model)
    scene.place(ours)
    ours.ctrl[:] = scene.rest
    mujoco.mj_resetDataKeyframe(model, theirs, 0)
    np.testing.assert_allclose(theirs.qpos, ours.qpos, rtol=1e-5, atol=1e-6)
    for control in scene.controls(400):  # 2 s; the file holds six digits, so they part slowly
        ours.ctrl[:], theirs.ctrl[:] = control, control
        mujoco.mj_step(scene.model, ours)
        mujoco.mj_step(model, theirs)
    np.testing.assert_allclose(theirs.qpos[:3], ours.qpos[:3], atol=0.01)


def test_the_file_holds_the_gene_and_needs_no_walkerlab(tmp_path):
    path = wl.export_mjcf(str(GENOME), wl.Settings(), tmp_path, name="fido")
    assert path == tmp_path / "fido.xml"
    script = (
        "import sys, mujoco; m = mujoco.MjModel.from_xml_path(sys.argv[1]); "
        "print(bytes(m.text_data).decode().rstrip('\\0')); assert 'dm_control' not in sys.modules"
    )
    told = subprocess.run([sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True).stdout
    assert wl.Genome.parse(told) == GENOME
