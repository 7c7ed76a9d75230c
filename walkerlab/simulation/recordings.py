"""Quantities that walks record on request: joints, orientation and contact forces."""

from collections.abc import Mapping

import numpy as np

from walkerlab.ga.genes import Floats
from walkerlab.genome.phenotype import Phenotype
from walkerlab.settings.choices import Recording
from walkerlab.settings.settings import Settings
from walkerlab.world.assembly import measures_forces
from walkerlab.world.entities.walker import list_joints, list_legs
from walkerlab.world.geometry import rotate
from walkerlab.world.scene import FREE_JOINT_SIZE, ORIENTATION, ROTATION, Scene

JOINT_POSITIONS = FREE_JOINT_SIZE  # index of the first joint in the generalised positions
JOINT_VELOCITIES = ROTATION.stop  # in the generalised velocities


class RecordedQuantities:
    """Base of walks: the quantities that were recorded on request, as properties.

    Attributes:
        recorded: Recorded quantities by name.
        phenotype: The robot that walked.
    """

    recorded: Mapping[str, Floats]
    phenotype: Phenotype

    @property
    def joint_angles(self) -> Floats:
        """Angle of each joint, rad, shape (n, n_joints), in the order of ``joint_names``; recorded on request.

        At positive angles, the leg or shank is swung forward, the rear of the segment is up (``pitch``) or to the right
        (``yaw``).
        """
        return self._find(Recording.joint_angles)

    @property
    def joint_velocities(self) -> Floats:
        """Angular velocity of each joint, rad/s, shape (n, n_joints); recorded on request."""
        return self._find(Recording.joint_velocities)

    @property
    def orientation(self) -> Floats:
        """Rotation matrix of the first segment, shape (n, 3, 3); recorded on request.

        Its columns are the directions forward, left and up of the segment, as vectors in the world.
        """
        return self._find(Recording.orientation)

    @property
    def contact_forces(self) -> Floats:
        """Force of the ground on each leg, N, shape (n, n_legs, 3), in the order of ``leg_names``; recorded on request.

        The components are forward, left and up. Ground means everything that cannot move, such as stairs.
        """
        return self._find(Recording.contact_forces)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Name of each joint as in the MJCF model: side, joint and number of the segment, such as ``left_hip1``."""
        return tuple(list_joints(self.phenotype.plan))

    @property
    def leg_names(self) -> tuple[str, ...]:
        """Name of each leg: its side, and its segment counted from the front, such as ``left 1``."""
        return tuple(f"{side} {number}" for number, side in list_legs(self.phenotype.plan))

    def _find(self, quantity: Recording) -> Floats:
        if quantity.name not in self.recorded:
            raise AttributeError(
                f"this walk has no {quantity.name}, which are recorded on request only: add "
                f"record=[{quantity.name!r}] to wl.simulate or, for an evolution, to settings.with_"
            )
        return self.recorded[quantity.name]


def requested_quantities(settings: Settings) -> set[Recording]:
    """Return the quantities that walks record on request."""
    record = settings.simulation.record
    return {*(record if isinstance(record, tuple) else (record,))} - {Recording.none}


def record_quantities(scene: Scene, positions: Floats, velocities: Floats, readings: Floats) -> dict[str, Floats]:
    """Return the quantities that the settings request, by name.

    Args:
        scene: Compiled scene.
        positions: Generalised positions of each sample, shape (n, nq).
        velocities: Generalised velocities of each sample, shape (n, nv).
        readings: Sensor readings of each sample, shape (n, n_sensor).
    """
    requested = requested_quantities(scene.settings)
    plan = scene.phenotype.plan
    n_joints = len(list_joints(plan))
    quantities: dict[Recording, Floats] = {
        Recording.joint_angles: positions[:, JOINT_POSITIONS : JOINT_POSITIONS + n_joints],
        Recording.joint_velocities: velocities[:, JOINT_VELOCITIES : JOINT_VELOCITIES + n_joints],
    }
    if Recording.orientation in requested:
        quaternions = positions[:, ORIENTATION]
        quantities[Recording.orientation] = np.stack([rotate(quaternions, axis) for axis in np.eye(3)], axis=2)
    if measures_forces(scene.settings):
        n_legs = len(list_legs(plan))
        of_legs_on_ground = readings[:, readings.shape[1] - 3 * n_legs :]
        quantities[Recording.contact_forces] = -of_legs_on_ground.reshape(-1, n_legs, 3)
    return {quantity.name: np.array(quantities[quantity]) for quantity in sorted(requested)}
