"""The fast compilation gives the same model as compiling the whole specification."""

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.system.randomness import random_stream
from walkerlab.world.scene import describe_scene, scene_of

ROUNDED = {"body_subtreemass", "body_invweight0", "dof_invweight0", "tendon_invweight0", "actuator_acc0"}
"""Arrays that are summed in another order or solved for; they differ by rounding errors only."""

WORLDS = {
    "bare": wl.Settings(),
    "stairs": wl.Settings().with_(structure="stairs"),
    "rough with pack": wl.Settings().with_(structure="rough", carry_weight=3),
    "gravel, rocks, pack and sledge": wl.Settings().with_(
        texture="gravel", texture_density=0.05, obstacle="rock", carry_weight=3, drag_weight=5, wind=(3, 0, 0)
    ),
}


@pytest.mark.parametrize("world", WORLDS)
def test_the_assembled_model_equals_the_compiled_specification(world):
    settings = WORLDS[world]
    for i in range(4):
        genome = wl.Genome.random(settings.robot, rng=random_stream(1, "check", i))
        quick, full = scene_of(genome, settings).model, describe_scene(genome, settings, scenery=False)[1].model
        for name, array in arrays(full).items():
            tolerance = 1e-12 if name in ROUNDED else 0.0
            np.testing.assert_allclose(arrays(quick)[name], array, rtol=tolerance, atol=0, err_msg=name)
        assert quick.names == full.names
        assert quick.stat.meaninertia == pytest.approx(full.stat.meaninertia, rel=1e-12)


def arrays(model):
    """Return every array of a model and of its options, and the sizes of the model."""
    return {
        name: value
        for part in (model, model.opt)
        for name in dir(part)
        if isinstance(value := getattr(part, name), np.ndarray) and value.size
    } | {name: np.array(getattr(model, name)) for name in ("nq", "nv", "nu", "nbody", "ngeom", "nsensor", "ntendon")}


def test_a_reused_model_does_not_depend_on_the_previous_robot():
    settings = WORLDS["gravel, rocks, pack and sledge"]
    first, other = (wl.Genome.random(settings.robot, rng=random_stream(1, "check", i)) for i in range(2))
    before = arrays(scene_of(first, settings).model)
    scene_of(other, settings)
    for name, array in arrays(scene_of(first, settings).model).items():
        np.testing.assert_array_equal(array, before[name], err_msg=name)
