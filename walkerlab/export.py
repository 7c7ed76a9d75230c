"""A robot taken elsewhere: MJCF that any MuJoCo opens."""

from pathlib import Path

import mujoco

from walkerlab.files import folder_path, write_text
from walkerlab.genome import Genome
from walkerlab.scene import describe_scene
from walkerlab.settings import Settings

NOT_IN_A_NAME = set('/\\:*?"<>|')
"""What some system does not have in the name of a file, or takes for a folder."""


def export_mjcf(genome: Genome | str, settings: Settings, folder: str | Path, name: str = "walker") -> Path:
    """Write one individual's world as MJCF, which plain ``mujoco.MjModel.from_xml_path`` loads.

    The keyframe ``start`` holds its pose at the start and the servo targets at rest; the custom text ``genome`` holds
    its gene, from which ``walkerlab`` computes the controls of its gait.

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
    start = mujoco.MjData(scene.model)
    scene.place(start)
    spec = spec.copy()
    spec.modelname = name
    spec.add_text(name="genome", data=str(scene.genome))
    spec.add_key(name="start", qpos=start.qpos, ctrl=scene.rest)
    xml = spec.to_xml()
    mujoco.MjModel.from_xml_string(xml)  # or it is not written
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, xml)
    return path
