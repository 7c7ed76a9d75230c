"""Export of one robot and its world as MJCF, which MuJoCo loads without walkerlab."""

import ctypes
import re
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from xml.etree import ElementTree

import mujoco

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.simulation.starts import count_settling_steps
from walkerlab.system.files import folder_path, write_text
from walkerlab.world.scene import CONTROL_RATE, RAMP_TIME, Scene, describe_scene

NOT_IN_A_NAME = set('/\\:*?"<>|')
"""What some system does not have in the name of a file, or takes for a folder."""

EXACT_DIGITS = 17
"""Significant digits with which every double is read back as the same number; MuJoCo writes 6 by default."""

UNKNOWN_TO_OLDER = {"texture": "class", "general": "input"}
"""Attributes, by element, that MuJoCo 3.17 writes and versions from 3.9 on reject; without them a world is the same."""


def export_mjcf(genome: Genome | str, settings: Settings, folder: str | Path, name: str = "walker") -> Path:
    """Write one individual's world as MJCF, which MuJoCo 3.9 to 3.17 loads and steps without walkerlab.

    All numbers are exact: the model that MuJoCo compiles from the file equals the one that walkerlab steps. To repeat
    the walk of ``simulate``, read the arrays under ``<custom>`` (``model.numeric("gait_phase").data``) and:

    1. reset to the keyframe ``start``, which holds the pose at the start and the servo targets at rest;
    2. call ``mj_step`` as often as ``settle_steps`` says;
    3. before each further step ``k`` = 0, 1, 2, ... set
       ``ctrl = gait_offset + min(t / gait_ramp, 1) * gait_amplitude * sin(2 * pi * gait_frequency * t + gait_phase)``,
       where ``t = floor(k * timestep * control_rate + 1e-9) / control_rate``.

    The sensor ``com`` reads the centre of mass before each step. The custom text ``genome`` holds the gene.

    Args:
        genome: a genome or its text; brought within the robot limits first.
        settings: of terrain, robot and simulation.
        folder: where to write; made if need be.
        name: of the file, without its ending.

    Returns:
        The path of the file.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if the name is no plain file name.
    """
    if not name.isprintable() or not name.strip(" .") or set(name) & NOT_IN_A_NAME:
        raise ValueError(f"the name {name!r} is no plain file name; the folder is given apart")
    path = folder_path(folder) / f"{name}.xml"
    spec, scene = describe_scene(genome, settings, scenery=True)
    spec = spec.copy()
    spec.modelname = name
    _add_walk(spec, scene)
    text = _exact_xml(spec)
    mujoco.MjModel.from_xml_string(text)  # fails here rather than wherever the file is taken
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)
    return path


def _add_walk(spec: mujoco.MjSpec, scene: Scene) -> None:
    """Add the start and the gait of a scene to its description."""
    start = mujoco.MjData(scene.model)
    scene.place(start)
    amplitude, phase, offset = scene.gait
    spec.add_key(name="start", qpos=start.qpos, ctrl=scene.rest)
    spec.add_text(name="genome", data=str(scene.genome))
    for name, values in {
        "settle_steps": [count_settling_steps(scene)],
        "control_rate": [CONTROL_RATE],
        "gait_ramp": [RAMP_TIME],
        "gait_frequency": [scene.phenotype.frequency],
        "gait_amplitude": amplitude,
        "gait_phase": phase,
        "gait_offset": offset,
    }.items():
        spec.add_numeric(name=name, data=values, size=len(values))


def _exact_xml(spec: mujoco.MjSpec) -> str:
    """Write a description as MJCF that compiles to the same model, bit for bit, and that older versions read."""
    with _exact_numbers():
        root = ElementTree.fromstring(spec.to_xml())
    for element in root.iter():
        element.attrib.pop(UNKNOWN_TO_OLDER.get(element.tag, ""), None)
        if element.tag == "geom" and "mesh" in element.attrib:  # MuJoCo turns these into the inertial frame and back
            geom = spec.geom(element.attrib["name"])
            element.attrib |= {"pos": _joined(geom.pos), "quat": _joined(geom.quat)}
        for key, value in element.items():
            element.set(key, _LONG_NUMBER.sub(lambda found: repr(float(found[0])), value))
    root.set("model", spec.modelname)
    return ElementTree.tostring(root, encoding="unicode")


def _joined(vector: Floats) -> str:
    return " ".join(map(repr, vector.tolist()))


_LONG_NUMBER = re.compile(r"\d+\.\d{12,}(e[-+]\d+)?", re.ASCII)


@contextmanager
def _exact_numbers() -> Generator[None]:
    """Have MuJoCo write all digits of numbers; it has this switch for its own tests and only in C."""
    windows = sys.platform == "win32"
    path = Path(mujoco.__file__).with_name("mujoco.dll") if windows else mujoco._functions.__file__
    library = ctypes.CDLL(str(path))
    with _PRECISION:
        before = library._mjPRIVATE__get_xml_precision()
        library._mjPRIVATE__set_xml_precision(EXACT_DIGITS)
        try:
            yield
        finally:
            library._mjPRIVATE__set_xml_precision(before)


_PRECISION = Lock()
"""Held while the number of digits, which MuJoCo has for the whole process, is changed."""
