"""Export of one robot and its world as MJCF, which MuJoCo loads without walkerlab."""

import ctypes
import json
import math
import re
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from xml.etree import ElementTree

import mujoco
import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.genome import Genome
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.simulation.starts import count_settling_steps
from walkerlab.system.files import folder_path, write_text
from walkerlab.world.assembly import ROBOT_BODY
from walkerlab.world.cameras import CAMERA_VIEWS, MIN_SIZE
from walkerlab.world.scene import CONTROL_RATE, RAMP_TIME, Scene, compile_scene, control_steps, describe_scene

FORBIDDEN_CHARACTERS = set('/\\:*?"<>|')
"""Characters that separate folders, or that some operating systems do not allow in file names."""

EXACT_DIGITS = 17
"""Significant digits that represent every double exactly; MuJoCo writes 6 by default."""

REPLAY_SCRIPT = """from pathlib import Path
import mujoco
import numpy as np
here = Path(__file__).parent
model = mujoco.MjModel.from_xml_path(str(here / "NAME.xml"))
data = mujoco.MjData(model)
steps, targets = np.split(np.loadtxt(here / "NAME_controls.csv", delimiter=",", skiprows=1), [1], axis=1)
mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
mujoco.mj_step(model, data, int(model.numeric("settle_steps").data[0]))  # the robot settles at rest
forward = []  # m, position of the centre of mass before each step
for step in range(int(steps[-1, 0]) + 1):
    data.ctrl[:] = targets[np.searchsorted(steps[:, 0], step, side="right") - 1]
    mujoco.mj_step(model, data)
    forward.append(data.sensor("com").data[0])
print(f"walked {forward[-1] - forward[0]:.6f} m")
"""
"""Script that repeats the walk of an exported robot."""

NEW_ATTRIBUTES = {"texture": "class", "general": "input"}
"""Attribute of each element that MuJoCo 3.17 writes and older versions reject; the model does not depend on them."""


def export_mjcf(
    genome: Genome | str, settings: Settings, folder: str | Path, name: str = "walker", *, replay: bool = False
) -> Path:
    """Write one individual and its world as MJCF, which MuJoCo 3.9 to 3.17 loads and simulates without walkerlab.

    Numbers are stored at full precision, so MuJoCo compiles the file to the same model that walkerlab simulates. To
    repeat the walk of ``simulate``, read the arrays under ``<custom>`` (``model.numeric("gait_phase").data``) and:

    1. reset to the keyframe ``start``, which holds the initial pose and the servo targets at rest;
    2. call ``mj_step`` ``settle_steps`` times;
    3. before each further step ``k`` = 0, 1, 2, ... set
       ``ctrl = gait_offset + min(t / gait_ramp, 1) * gait_amplitude * sin(angle + gait_phase)``, where
       ``t = floor(k * timestep * control_rate + 1e-9) / control_rate`` and, with
       ``p = (gait_frequency * t + gait_leg_phase / (2 * pi) + 1 / 4) % 1`` and ``d = gait_duty``,
       ``angle = pi * (p / (1 - d) if p < 1 - d else 1 + (p - (1 - d)) / d) - pi / 2``.

    The sensor ``com`` measures the centre of mass before each step. The custom text ``genome`` holds the genome.

    MuJoCo 3.11 changed the integration of free bodies and stops Newton's method earlier, so walks in 3.9 and 3.10 may
    differ: with a sledge, from the first contact; without one, only in the few walks that are sensitive to small
    differences.

    Args:
        genome: Genome or its text; repaired to be within the robot limits.
        settings: Settings of terrain, robot and simulation.
        folder: Folder of the file; created if it does not exist.
        name: Name of the file, without extension.
        replay: Whether to add cameras, and to write beside the file the servo targets of the whole walk as
            ``NAME_controls.csv``, and ``NAME_replay.py``, a short script that repeats the walk with mujoco and numpy.

    Returns:
        The path of the file.

    Raises:
        GenomeError: If the text is not a valid genome.
        ValueError: If the name is not a valid file name.
    """
    if not name.isprintable() or not name.strip(" .") or set(name) & FORBIDDEN_CHARACTERS:
        raise ValueError(
            f"name is {name!r}; it must be a file name without a folder and without any of "
            f"{' '.join(sorted(FORBIDDEN_CHARACTERS))}. Pass the folder in the argument folder."
        )
    path = folder_path(folder) / f"{name}.xml"
    text = format_mjcf(genome, settings, name, cameras=replay)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)
    if replay:
        write_text(path.with_name(f"{name}_controls.csv"), _format_controls(compile_scene(genome, settings)))
        script = REPLAY_SCRIPT.replace("NAME", json.dumps(name)[1:-1])
        write_text(path.with_name(f"{name}_replay.py"), script)
    return path


def _format_controls(scene: Scene) -> str:
    """Return the servo targets as CSV: a row for each physics step at which they change, and one for the last step."""
    timestep = scene.settings.simulation.timestep
    n_steps = round(scene.settings.simulation.duration / timestep) + 1
    controls = scene.controls(n_steps)
    steps = [*control_steps(n_steps, timestep)[0].tolist(), n_steps - 1]
    names = [scene.model.actuator(i).name for i in range(scene.model.nu)]
    rows = [",".join(map(repr, [step, *controls[step].tolist()])) for step in steps]
    return "\n".join([",".join(["step", *names]), *rows, ""])


def format_mjcf(
    genome: Genome | str, settings: Settings, name: str, *, only_physics: bool = False, cameras: bool = False
) -> str:
    """Return one individual and its world as MJCF; see ``export_mjcf``.

    Args:
        genome: Genome or its text; repaired to be within the robot limits.
        settings: Settings of terrain, robot and simulation.
        name: Name of the model.
        only_physics: Whether to omit visual-only geometry and the arrays with the gait.
        cameras: Whether to add cameras that follow the robot.

    Raises:
        GenomeError: If the text is not a valid genome.
    """
    spec, scene = describe_scene(genome, settings, scenery=not only_physics)
    spec = spec.copy()
    spec.modelname = name
    if not only_physics:
        _add_walk(spec, scene)
    if cameras:
        _add_cameras(spec, scene)
    text = _exact_xml(spec)
    mujoco.MjModel.from_xml_string(text)  # raises an error here if the file cannot be loaded
    return text


def _add_walk(spec: mujoco.MjSpec, scene: Scene) -> None:
    """Add the initial state and the gait of a scene to its description."""
    start = mujoco.MjData(scene.model)
    scene.place(start)
    gait = scene.gait
    spec.add_key(name="start", qpos=start.qpos, ctrl=scene.rest)
    spec.add_text(name="genome", data=str(scene.genome))
    for name, values in {
        "settle_steps": [count_settling_steps(scene)],
        "control_rate": [CONTROL_RATE],
        "gait_ramp": [RAMP_TIME],
        "gait_frequency": [scene.phenotype.frequency],
        "gait_duty": [scene.phenotype.duty],
        "gait_amplitude": gait.amplitude,
        "gait_leg_phase": gait.leg_phase,
        "gait_phase": gait.phase,
        "gait_offset": gait.offset,
    }.items():
        spec.add_numeric(name=name, data=values, size=len(values))


def _add_cameras(spec: mujoco.MjSpec, scene: Scene) -> None:
    """Add cameras that follow the robot, placed like those of a replay."""
    model = scene.model
    body = spec.body(model.body(ROBOT_BODY).name)
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    centre = data.subtree_com[ROBOT_BODY] - data.xpos[ROBOT_BODY]  # the offset from the centre of mass stays constant
    for camera, (azimuth, elevation, distance) in CAMERA_VIEWS.items():
        if camera is Camera.orbit:
            continue
        a, e = math.radians(azimuth), math.radians(elevation)
        forward = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
        right = np.array([math.sin(a), -math.cos(a), 0.0])
        rotation = np.column_stack([right, np.cross(right, forward), -forward])
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, rotation.ravel())
        offset = distance * max(scene.phenotype.body_length, MIN_SIZE)
        body.add_camera(
            name=camera.name,
            pos=centre - offset * forward,
            quat=quaternion,
            mode=mujoco.mjtCamLight.mjCAMLIGHT_TRACKCOM,
        )


def _exact_xml(spec: mujoco.MjSpec) -> str:
    """Write a description as MJCF that older versions can read and that compiles to the same model bit for bit."""
    with _exact_numbers():
        root = ElementTree.fromstring(spec.to_xml())
    for element in root.iter():
        element.attrib.pop(NEW_ATTRIBUTES.get(element.tag, ""), None)
        if element.tag == "geom" and "mesh" in element.attrib:  # MuJoCo converts these to the inertial frame and back
            geom = spec.geom(element.attrib["name"])
            element.attrib |= {"pos": _join_numbers(geom.pos), "quat": _join_numbers(geom.quat)}
        if element.tag == "geom" and "name" in element.attrib:  # MuJoCo omits a mass close to that from the density
            mass = spec.geom(element.attrib["name"]).mass
            element.attrib |= {"mass": repr(float(mass))} if math.isfinite(mass) else {}
        for key, value in element.items():
            element.set(key, _LONG_NUMBER.sub(lambda found: repr(float(found[0])), value))
    root.set("model", spec.modelname)
    return ElementTree.tostring(root, encoding="unicode")


def _join_numbers(vector: Floats) -> str:
    return " ".join(map(repr, vector.tolist()))


_LONG_NUMBER = re.compile(r"\d+\.\d{12,}(e[-+]\d+)?", re.ASCII)


@contextmanager
def _exact_numbers() -> Generator[None]:
    """Within the block, make MuJoCo write all digits of numbers; only its internal C interface allows this."""
    is_windows = sys.platform == "win32"
    path = Path(mujoco.__file__).with_name("mujoco.dll") if is_windows else mujoco._functions.__file__
    library = ctypes.CDLL(str(path))
    with _precision_lock:
        previous = library._mjPRIVATE__get_xml_precision()
        library._mjPRIVATE__set_xml_precision(EXACT_DIGITS)
        try:
            yield
        finally:
            library._mjPRIVATE__set_xml_precision(previous)


_precision_lock = Lock()
"""Held while the number of digits, a global variable of MuJoCo, is changed."""
