"""One world, compiled: a genome and the settings become an ``MjModel`` and the controls that drive it."""

import math
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from walkerlab.arguments import require_settings
from walkerlab.assembly import describe
from walkerlab.genes import Floats, Indices
from walkerlab.genome import Genome
from walkerlab.ground import slope
from walkerlab.layout import PIECE_HEIGHT
from walkerlab.phenotype import Phenotype, express
from walkerlab.settings import Settings
from walkerlab.staging import assemble, stage

CONTROL_RATE = 50.0  # Hz, at which servos take a new target
RAMP = 0.5  # s, over which a gait swells from rest to its full swing
CLEARANCE = 0.005  # m, between the ground and the lowest point of a robot at the start
SLACK = 0.01  # m by which the rope is not quite taut at the start
ROPE_ENDS = ("walker/hitch", "sledge/ring")


@dataclass(frozen=True)
class Scene:
    """One compiled world.

    Attributes:
        model: ready for ``mj_step``; actuators in the order of ``controls``, the robot's body 1 and what hangs on it.
        genome: the genome it was built from, within the limits.
        phenotype: the robot in it.
        settings: of the world that it is in.
    """

    model: mujoco.MjModel
    genome: Genome
    phenotype: Phenotype
    settings: Settings

    @property
    def roots(self) -> list[int]:
        """The bodies by which robot and sledge hang in the world."""
        return [1, self.model.body("sledge/").id] if self.rope else [1]

    @property
    def rope(self) -> float:
        """The length of the rope on which a sledge is dragged, in m; 0 without one."""
        return float(self.model.tendon_range[0, 1]) if self.settings.robot.drag_weight else 0.0

    @property
    def own(self) -> NDArray[np.bool_]:
        """(ngeom,) whether a geom is part of the robot, its pack included."""
        return self.model.body_rootid[self.model.geom_bodyid] == 1

    def controls(self, n_steps: int) -> Floats:
        """Compute the servo targets of the whole walk; the gait needs no feedback.

        Returns:
            (n_steps, nu) in rad, a new value ``CONTROL_RATE`` times a second.
        """
        amplitude, phase, offset = self.gait
        first, tick = ticks(n_steps, self.settings.simulation.timestep)
        time = np.arange(len(first))[:, np.newaxis] / CONTROL_RATE
        swell = np.minimum(time / RAMP, 1.0)
        wave = offset + swell * amplitude * np.sin(math.tau * self.phenotype.frequency * time + phase)
        return wave[tick]

    def place(self, data: mujoco.MjData, nudge: Floats | None = None) -> None:
        """Stand the robot at the start in its pose of rest: belly along the slope, just clear of what lies below it.

        Its foremost point is at x = 0, before all that lies on the ground; its sledge is behind it, the rope all but
        taut.

        Args:
            data: to be written into.
            nudge: (nv,) small turns and shifts to start a little differently, in the model's degrees of freedom.
        """
        model, terrain, pitch = self.model, self.settings.terrain, slope(self.settings.terrain)
        data.qpos[model.jnt_qposadr[model.actuator_trnid[:, 0]]] = self.rest
        along_slope = [math.cos(pitch / 2), 0, -math.sin(pitch / 2), 0]
        data.qpos[3:7] = along_slope
        if nudge is not None:
            mujoco.mj_integratePos(model, data.qpos, nudge, 1.0)
        mujoco.mj_kinematics(model, data)
        forward, up = np.array([[math.cos(pitch), 0, math.sin(pitch)], [-math.sin(pitch), 0, math.cos(pitch)]])
        ends, radii = self._capsules(data)
        stones = PIECE_HEIGHT * terrain.texture_size * bool(terrain.n_pieces)
        data.qpos[:3] += (CLEARANCE + stones - np.min(ends @ up - radii[:, np.newaxis])) * up
        data.qpos[:3] -= max(0.0, np.max(ends @ forward + radii[:, np.newaxis])) * forward
        if self.rope:
            mujoco.mj_kinematics(model, data)
            sledge, (hitch, ring) = model.body("sledge/").jntadr[0], (model.site(name) for name in ROPE_ENDS)
            tail = data.site_xpos[hitch.id]
            drop = tail @ up - stones - CLEARANCE - ring.pos[2]
            back = math.sqrt(max(0.0, self.rope**2 - drop**2)) - SLACK  # a bent body of 8 m may hold its tail too high
            place = (tail @ forward - back - ring.pos[0]) * forward + (stones + CLEARANCE) * up
            place[1] = tail[1]
            start = model.jnt_qposadr[sledge]
            data.qpos[start : start + 7] = [*place, *along_slope]

    def _capsules(self, data: mujoco.MjData) -> tuple[Floats, Floats]:
        """Return the (n, 2, 3) ends of the axis and the (n,) radius of each capsule of the robot, in m."""
        model = self.model
        limbs = self.own & (model.geom_type == int(mujoco.mjtGeom.mjGEOM_CAPSULE))
        half = data.geom_xmat[limbs].reshape(-1, 3, 3)[:, :, 2] * model.geom_size[limbs, 1, np.newaxis]
        ends = np.stack([data.geom_xpos[limbs] - half, data.geom_xpos[limbs] + half], axis=1)
        return ends, model.geom_size[limbs, 0].copy()

    @property
    def start(self) -> Floats:
        """(nq,) pose in which it starts to settle."""
        data = mujoco.MjData(self.model)
        self.place(data)
        return data.qpos.copy()

    @property
    def rest(self) -> Floats:
        """(nu,) servo targets of the body at rest."""
        return self.gait[2]

    @property
    def gait(self) -> tuple[Floats, Floats, Floats]:
        """Amplitude, phase and offset of each servo's sine, (nu,) each [rad]; ``controls`` adds the start."""
        rows = [
            (swing.amplitude, swing.phase - lag, swing.offset)
            for segment in self.phenotype.segments
            if (legs := segment.legs)
            for lag in (0.0, legs.stride)
            for swing in (legs.hip, legs.knee)
        ]
        amplitude, phase, offset = np.array(rows, dtype=np.float64).reshape(-1, 3).T
        return amplitude, phase, offset


@lru_cache(maxsize=16)
def ticks(n_steps: int, timestep: float) -> tuple[Indices, Indices]:
    """Lay the gait's clock over the steps of the physics.

    Returns:
        The first step of each tick, (n_ticks,), and the tick of each step, (n_steps,).
    """
    tick = np.floor(np.arange(n_steps) * timestep * CONTROL_RATE + 1e-9).astype(np.intp)
    return np.unique(tick, return_index=True)[1], tick


def compile_scene(genome: Genome | str | Floats, settings: Settings, *, scenery: bool = False) -> Scene:
    """Build the world in which one individual walks.

    Args:
        genome: a genome, its text or its (n_genes,) values; brought within the robot limits first.
        settings: of terrain, robot and simulation.
        scenery: whether to add sky, chequered ground and a sun, which cost more to compile than the rest.

    Raises:
        GenomeError: if a text is no genome.
        ValueError: if values are no genome.
        TypeError: If ``settings`` are not a ``Settings``.
    """
    if scenery:
        return describe_scene(genome, settings, scenery=True)[1]
    own = Genome.of(genome)
    return scene_of(own.within(require_settings(settings).robot), settings)


def describe_scene(genome: Genome | str | Floats, settings: Settings, *, scenery: bool) -> tuple[mujoco.MjSpec, Scene]:
    """Build the same world, and hand out its description too; it is good until this thread's next scene."""
    own = Genome.of(genome)
    own = own.within(require_settings(settings).robot)
    phenotype = express(own)
    spec = describe(phenotype, settings, scenery=scenery)
    return spec, Scene(spec.compile(), own, phenotype, settings)


def scene_of(genome: Genome, settings: Settings) -> Scene:
    """Build the world of a genome that is known to be within the limits."""
    phenotype = express(genome)
    return Scene(assemble(phenotype, settings), genome, phenotype, settings)


def scene_on_stage(genome: Genome, settings: Settings) -> tuple[Scene, mujoco.MjData]:
    """Build the same world where others have walked before, which is quicker, and hand out its state too.

    Both are good until this thread's next robot of the same body plan.
    """
    phenotype = express(genome)
    model, data = stage(phenotype, settings)
    return Scene(model, genome, phenotype, settings), data
