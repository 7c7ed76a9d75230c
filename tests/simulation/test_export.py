"""An exported file holds exact numbers, and older versions of MuJoCo can load it."""

import json
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

import walkerlab as wl
from benchmarks import plain_walk
from walkerlab.genome.features import BODY_FEATURES, DUTY_RANGE
from walkerlab.settings.choices import Feature, Obstacle, Structure
from walkerlab.simulation.export import _exact_xml
from walkerlab.simulation.rollout import simulate_walk
from walkerlab.system.randomness import random_stream
from walkerlab.world.scene import describe_scene

GENOME = wl.Genome.random(wl.Robot(), rng=random_stream(4, "check"))

WORLDS = [{"structure": structure} for structure in Structure]
WORLDS += [{"obstacle": obstacle, "structure": "incline", "seed": 3} for obstacle in Obstacle if obstacle]
WORLDS += [{"carry_weight": 1, "drag_weight": 2, "wind": (1, 0, 0)}, {"texture": "gravel", "timestep": 0.003}]

SCHEMA = Path(__file__).parents[1] / "kept" / "mjcf_3.9.txt"


def export(world, folder, name="walker", genome=GENOME):
    return wl.export_mjcf(genome, wl.Settings().with_(**world), folder, name)


def with_duty(duty):
    """Return GENOME with another duty: 0.5 makes the motion of each joint a sine."""
    values = GENOME.values.copy()
    values[BODY_FEATURES.index(Feature.duty)] = duty
    return wl.Genome(values)


ADDED = re.compile(r"_|n(names|text|numeric|key|buffer)|(name|text|numeric|key)_|names|paths|\w+_nameadr|signature")
"""Fields of a model for names, keyframes, texts, numbers and memory, which differ between the file and the scene."""

WITHOUT_EFFECT = {"actuator_ctrlspec"}  # only names the input of an actuator


def fields(model):
    """Return all numbers of a model apart from the fields above."""
    owners = {"": model, "opt.": model.opt, "stat.": model.stat}
    owners |= {f"{name}.": getattr(model.vis, name) for name in ("map", "scale", "rgba", "headlight", "global_")}
    names = [(owner, name) for owner, of in owners.items() for name in dir(of) if not ADDED.match(name)]
    values = {owner + name: getattr(owners[owner], name) for owner, name in names if name not in WITHOUT_EFFECT}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray | int | float)}


@pytest.mark.parametrize("world", WORLDS, ids=str)
def test_the_file_compiles_to_the_same_model_bit_for_bit(world, tmp_path):
    written = fields(describe_scene(GENOME, wl.Settings().with_(**world), scenery=True)[1].model)
    read = fields(mujoco.MjModel.from_xml_path(str(export(world, tmp_path))))
    assert len(read) > 400
    assert [name for name in written if not np.array_equal(written[name], read[name])] == []


def test_plain_mujoco_repeats_the_walk_without_walkerlab(tmp_path):
    worlds = [
        ({}, 0.5),
        ({}, DUTY_RANGE[0]),
        ({"structure": "stairs", "obstacle": "rock"}, DUTY_RANGE[1]),
        ({"drag_weight": 1, "timestep": 0.004}, 0.6),
    ]
    files = [
        str(export(world, tmp_path / "new", str(number), with_duty(duty)))
        for number, (world, duty) in enumerate(worlds)
    ]
    script = Path(plain_walk.__file__)
    assert "walkerlab" not in script.read_text(encoding="utf-8").partition('"""\n\n')[2]
    command = [sys.executable, script, "1", *files]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    distances = [
        wl.simulate(with_duty(duty), wl.Settings().with_(duration=1, **world)).distance for world, duty in worlds
    ]
    assert [json.loads(line)["distance"] for line in lines] == pytest.approx(distances, abs=1e-6)
    assert abs(distances[0] - distances[1]) > 1e-3, "precondition of this test: the duty changes the walk"


def test_the_file_holds_the_start_the_gait_and_the_genome(tmp_path):
    model = mujoco.MjModel.from_xml_path(str(export({"structure": "incline"}, tmp_path)))
    scene = wl.compile_scene(GENOME, wl.Settings().with_(structure="incline"))
    np.testing.assert_array_equal(model.key("start").qpos, scene.start)
    np.testing.assert_array_equal(model.key("start").ctrl, scene.rest)
    np.testing.assert_array_equal([model.numeric(f"gait_{name}").data for name in scene.gait._fields], scene.gait)
    assert model.numeric("gait_frequency").data.item() == scene.phenotype.frequency
    assert model.numeric("gait_duty").data.item() == scene.phenotype.duty
    assert (
        model.numeric("settle_steps").data.item() == simulate_walk(scene).settled / scene.settings.simulation.timestep
    )
    assert wl.Genome.parse(bytes(model.text_data).decode().rstrip("\0")) == GENOME


def test_older_versions_know_every_attribute(tmp_path):
    """``python benchmarks/mujoco_versions.py`` loads the file in each version."""
    known = {"worldbody": set()}
    element = ""
    for line in SCHEMA.read_text(encoding="utf-8").splitlines():
        if name := line[:30].split():
            element = name[0].removeprefix("(world)")
        known.setdefault(element, set()).update(line[30:].split())
    everything = {"structure": "rough", "texture": "gravel", "obstacle": "rock", "carry_weight": 1, "drag_weight": 1}
    root = ElementTree.parse(export(everything, tmp_path)).getroot()
    assert {(one.tag, key) for one in root.iter() for key in one.attrib if key not in known[one.tag]} == set()


@hypothesis_settings(max_examples=50)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, allow_subnormal=False), min_size=1, max_size=20))
def test_every_number_is_read_exactly_as_written(numbers):
    spec = mujoco.MjSpec()
    spec.modelname = "1.50000000000000000"
    spec.add_numeric(name="numbers", data=numbers, size=len(numbers))
    spec.compile()
    text = _exact_xml(spec)
    assert mujoco.MjModel.from_xml_string(text).numeric("numbers").data.tolist() == numbers
    assert ElementTree.fromstring(text).get("model") == spec.modelname


def test_the_precision_of_mujoco_is_restored_after_an_export(tmp_path):
    spec = mujoco.MjSpec()
    spec.add_numeric(name="third", data=[1 / 3], size=1)
    spec.compile()
    export({}, tmp_path)
    assert 'data="0.333333"' in spec.to_xml()


def test_the_file_has_the_given_name(tmp_path):
    path = wl.export_mjcf(str(GENOME), wl.Settings(), tmp_path / "Größe", name="fido & <2>".replace("<2>", "Ω"))
    assert path == tmp_path / "Größe" / "fido & Ω.xml"
    assert ElementTree.parse(path).getroot().get("model") == "fido & Ω"


@pytest.mark.parametrize("world", [{}, {"structure": "stairs", "drag_weight": 1, "timestep": 0.003}], ids=str)
def test_the_exported_script_repeats_the_walk_without_walkerlab(world, tmp_path):
    settings = wl.Settings().with_(duration=1, **world)
    path = wl.export_mjcf(GENOME, settings, tmp_path, "my walker", replay=True)
    script = tmp_path / "my walker_replay.py"
    assert "walkerlab" not in script.read_text(encoding="utf-8")
    printed = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True).stdout
    distance = float(printed.removeprefix("walked ").removesuffix(" m\n"))
    assert distance == pytest.approx(wl.simulate(GENOME, settings).distance, abs=1e-6)
    model = mujoco.MjModel.from_xml_path(str(path))
    assert [model.camera(i).name for i in range(model.ncam)] == ["side", "front", "top", "chase"]
