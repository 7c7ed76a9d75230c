"""Compiled scenes: the MuJoCo model of an individual in its world, and the controls that drive it."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.ga.genes import Floats, Indices
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import Phenotype, express, stride_angle
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.settings import Settings
from walkerlab.world.assembly import ROBOT_BODY, describe_world
from walkerlab.world.compilation import assemble_in_place, assemble_model
from walkerlab.world.heights import slope
from walkerlab.world.placement import PIECE_HEIGHT

CONTROL_RATE = 50.0  # Hz, rate of new servo targets
RAMP_TIME = 0.5  # s during which the amplitude of the gait grows from 0 to its full value
START_CLEARANCE = 0.005  # m between the robot and what is below it at the start
ROPE_SLACK = 0.01  # m by which the rope is slack at the start
ROPE_ENDS = ("walker/hitch", "sledge/ring")  # names of the sites

# Parts of the coordinates of a free joint; those of the robot come first in ``mjData.qpos``.
POSITION = slice(0, 3)
ORIENTATION = slice(3, 7)
FREE_JOINT_SIZE = 7

# Parts of the degrees of freedom of a free joint; those of the robot come first in ``mjData.qvel``.
TRANSLATION = slice(0, 3)
ROTATION = slice(3, 6)


@dataclass(frozen=True)
class Scene:
    """The compiled world of one individual.

    Attributes:
        model: Compiled model, ready for ``mj_step``; its actuators are in the order of ``controls``.
        genome: Genome of the robot, within the limits of the settings.
        phenotype: The robot that the genome expresses.
        settings: Settings of the world.
    """

    model: mujoco.MjModel
    genome: Genome
    phenotype: Phenotype
    settings: Settings

    @property
    def roots(self) -> list[int]:
        """Root bodies of the robot and, if there is one, of its sledge."""
        return [ROBOT_BODY, self.model.body("sledge/").id] if self.rope_length else [ROBOT_BODY]

    @property
    def rope_length(self) -> float:
        """Length of the rope to the sledge, in m; 0 without a sledge."""
        return float(self.model.tendon_range[0, 1]) if self.settings.robot.drag_weight else 0.0

    @property
    def is_robot_geom(self) -> NDArray[np.bool_]:
        """Whether each geom belongs to the robot, including its pack, shape (ngeom,)."""
        return self.model.body_rootid[self.model.geom_bodyid] == ROBOT_BODY

    def controls(self, n_steps: int) -> Floats:
        """Compute the servo targets of the whole walk; the gait uses no feedback.

        Returns:
            Targets [rad], shape (n_steps, nu); they change ``CONTROL_RATE`` times per second.
        """
        gait = self.gait
        first_steps, control_step = control_steps(n_steps, self.settings.simulation.timestep)
        time = np.arange(len(first_steps))[:, np.newaxis] / CONTROL_RATE
        ramp = np.minimum(time / RAMP_TIME, 1.0)
        strides = self.phenotype.frequency * time + gait.leg_phase / math.tau
        angle = stride_angle(strides, self.phenotype.duty)
        targets = gait.offset + ramp * gait.amplitude * np.sin(angle + gait.phase)
        return targets[control_step]

    def place(self, data: mujoco.MjData, nudge: Floats | None = None) -> None:
        """Place the robot at the start in its rest pose: parallel to the slope, just clear of what is below it.

        Its foremost point is at x = 0. A sledge is placed behind it, with the rope almost taut.

        Args:
            data: Data of the model; its positions are overwritten.
            nudge: Small displacements of the start in the model's degrees of freedom, shape (nv,).
        """
        model = self.model
        terrain = self.settings.terrain
        pitch = slope(terrain)
        data.qpos[model.jnt_qposadr[model.actuator_trnid[:, 0]]] = self.rest
        along_slope = [math.cos(pitch / 2), 0, -math.sin(pitch / 2), 0]
        data.qpos[ORIENTATION] = along_slope
        if nudge is not None:
            mujoco.mj_integratePos(model, data.qpos, nudge, 1.0)
        mujoco.mj_kinematics(model, data)
        forward = np.array([math.cos(pitch), 0, math.sin(pitch)])
        up = np.array([-math.sin(pitch), 0, math.cos(pitch)])
        ends, radii = self._capsules(data)
        pieces_top = PIECE_HEIGHT * terrain.texture_size if terrain.n_pieces else 0.0
        data.qpos[POSITION] += (START_CLEARANCE + pieces_top - np.min(ends @ up - radii[:, np.newaxis])) * up
        data.qpos[POSITION] -= max(0.0, np.max(ends @ forward + radii[:, np.newaxis])) * forward
        if self.rope_length:
            mujoco.mj_kinematics(model, data)
            hitch, ring = (model.site(name) for name in ROPE_ENDS)
            tail = data.site_xpos[hitch.id]
            drop = tail @ up - pieces_top - START_CLEARANCE - ring.pos[2]
            # The difference is negative if a long, bent body holds its tail higher than the rope is long.
            back = math.sqrt(max(0.0, self.rope_length**2 - drop**2)) - ROPE_SLACK
            position = (tail @ forward - back - ring.pos[0]) * forward + (pieces_top + START_CLEARANCE) * up
            position[1] = tail[1]
            start = model.jnt_qposadr[model.body("sledge/").jntadr[0]]
            data.qpos[start : start + FREE_JOINT_SIZE] = [*position, *along_slope]

    def _capsules(self, data: mujoco.MjData) -> tuple[Floats, Floats]:
        """Return the ends of the axis, (n, 2, 3), and the radius, (n,), of each capsule of the robot, in m."""
        model = self.model
        is_capsule = self.is_robot_geom & (model.geom_type == int(mujoco.mjtGeom.mjGEOM_CAPSULE))
        axes = data.geom_xmat[is_capsule].reshape(-1, 3, 3)[:, :, 2] * model.geom_size[is_capsule, 1, np.newaxis]
        ends = np.stack([data.geom_xpos[is_capsule] - axes, data.geom_xpos[is_capsule] + axes], axis=1)
        return ends, model.geom_size[is_capsule, 0].copy()

    @property
    def start(self) -> Floats:
        """Pose in which the robot starts to settle, shape (nq,)."""
        data = mujoco.MjData(self.model)
        self.place(data)
        return data.qpos.copy()

    @property
    def rest(self) -> Floats:
        """Servo targets of the rest pose [rad], shape (nu,)."""
        return self.gait.offset

    @property
    def gait(self) -> "Gait":
        """Motion of each servo; ``controls`` adds the ramp."""
        rows = [
            (swing.amplitude, legs.phase - behind, swing.phase, swing.offset)
            for segment in self.phenotype.segments
            if (legs := segment.legs)
            for behind in (0.0, legs.stride)
            for swing in (legs.hip, legs.knee)
        ]
        return Gait(*np.array(rows, dtype=np.float64).reshape(-1, 4).T)


class Gait(NamedTuple):
    """Motion of each servo: offset + amplitude · sin(stride_angle + phase), in rad; shape (nu,) each.

    Attributes:
        amplitude: Greatest deviation from the offset, rad.
        leg_phase: Phase of the leg in its stride when the gait begins, rad.
        phase: How far the joint is ahead of the stride of its leg, rad.
        offset: Target at rest, rad.
    """

    amplitude: Floats
    leg_phase: Floats
    phase: Floats
    offset: Floats


@lru_cache(maxsize=16)
def control_steps(n_steps: int, timestep: float) -> tuple[Indices, Indices]:
    """Divide physics steps into control steps, in each of which the servo targets are constant.

    Args:
        n_steps: Number of physics steps.
        timestep: Duration of a physics step [s].

    Returns:
        First physics step of each control step, shape (n_control_steps,), and control step of each physics step,
        shape (n_steps,).
    """
    control_step = np.floor(np.arange(n_steps) * timestep * CONTROL_RATE + 1e-9).astype(np.intp)
    return np.unique(control_step, return_index=True)[1], control_step


def compile_scene(genome: Genome | str | Floats, settings: Settings, *, scenery: bool = False) -> Scene:
    """Compile the world of one individual.

    Args:
        genome: Genome, its text or its values, shape (n_genes,); repaired to be within the robot limits.
        settings: Settings of terrain, robot and simulation.
        scenery: Whether to add visual-only geometry such as sky and sun, which takes longer to compile than the rest.

    Raises:
        GenomeError: If the text is not a valid genome.
        ValueError: If the values are not a valid genome.
        TypeError: If ``settings`` is not a ``Settings`` object.
    """
    if scenery:
        return describe_scene(genome, settings, scenery=True)[1]
    own = Genome.of(genome)
    return scene_of(own.within(require_settings(settings).robot), settings)


def describe_scene(genome: Genome | str | Floats, settings: Settings, *, scenery: bool) -> tuple[mujoco.MjSpec, Scene]:
    """Compile the world of one individual and return its specification as well.

    The specification is valid until the next call in the same thread. For the arguments see ``compile_scene``.
    """
    repaired = Genome.of(genome).within(require_settings(settings).robot)
    phenotype = express(repaired)
    spec = describe_world(phenotype, settings, scenery=scenery)
    return spec, Scene(spec.compile(), repaired, phenotype, settings)


def scene_of(genome: Genome, settings: Settings) -> Scene:
    """Compile the world of a genome that is already within the robot limits."""
    phenotype = express(genome)
    return Scene(assemble_model(phenotype, settings), genome, phenotype, settings)


def reusable_scene_of(genome: Genome, settings: Settings) -> tuple[Scene, mujoco.MjData]:
    """Return the same scene as ``scene_of`` in a reused model, which is faster, and the model's data.

    Both are overwritten by the next call in the same thread for a robot with the same body plan.
    """
    phenotype = express(genome)
    model, data = assemble_in_place(phenotype, settings)
    return Scene(model, genome, phenotype, settings), data
