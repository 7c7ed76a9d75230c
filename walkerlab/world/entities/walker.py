"""The walker: a chain of segments, some with a pair of two-joint legs, built from a body plan.

A body plan states only which segments have legs. All sizes here are nominal: ``assembly`` writes each individual's
sizes into the finished model, so that one model serves all robots of a body plan.
"""

from dm_control import composer, mjcf

from walkerlab.world.materials import TRANSPARENT

BodyPlan = tuple[bool, ...]
"""For each segment from the front, whether it has a pair of legs."""

SIDES = ("left", "right")
TRUNK_COLOUR = (0.90, 0.62, 0.00, 1)
LEG_COLOURS = {"left": (0.00, 0.45, 0.70, 1), "right": (0.34, 0.71, 0.91, 1)}  # in side view the right leg is nearer


class Walker(composer.Entity):
    r"""A chain of segments along -x, with the front of the first at the origin, some with a pair of two-joint legs.

                 seg3    seg2    seg1
               (======)o(======)o(======)  -> x
                  /        /        /          hip
                  \        \        \          knee

    All bodies are capsules of one material, whose density determines their girth. Hip and knee rotate in the
    fore-and-aft plane, positive forward; each is driven by a position servo with limited torque. The joints of the
    spine are passive springs.
    """

    def _build(self, plan: BodyPlan, name: str = "walker") -> None:
        self._mjcf_root = mjcf.RootElement(model=name)
        default = self._mjcf_root.default
        default.geom.type = "capsule"
        default.geom.priority = 0
        default.joint.limited = "false"
        default.position.dampratio = 1
        default.position.kp = 1
        segment = self._mjcf_root.worldbody  # becomes the body of the first segment when the walker is attached
        for number, has_legs in enumerate(plan, start=1):
            segment = self._add_segment(segment, number, has_legs)
            if number == (1 + len(plan)) // 2:
                self.back = segment.add("site", name="back", rgba=TRANSPARENT)
        self.hitch = segment.add("site", name="hitch", rgba=TRANSPARENT)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The MJCF model, with nominal sizes."""
        return self._mjcf_root

    def _add_segment(self, parent: mjcf.Element, number: int, has_legs: bool) -> mjcf.Element:
        segment = parent
        if number > 1:
            segment = parent.add("body", name=f"seg{number}", pos=(0, 0, 0))
            segment.add("joint", name=f"pitch{number}", axis=(0, 1, 0))
            segment.add("joint", name=f"yaw{number}", axis=(0, 0, 1))
        segment.add("geom", name=f"trunk{number}", size=[0.05], fromto=(0, 0, 0, -0.3, 0, 0), mass=1, rgba=TRUNK_COLOUR)
        if has_legs:
            for side in SIDES:
                self._add_leg(segment, number, side)
        return segment

    def _add_leg(self, segment: mjcf.Element, number: int, side: str) -> None:
        parent = segment
        for bone, joint in (("thigh", "hip"), ("shank", "knee")):
            parent = parent.add("body", name=f"{side}_{bone}{number}", pos=(0, 0, -0.1))
            hinge = parent.add("joint", name=f"{side}_{joint}{number}", axis=(0, -1, 0), armature=0.001)
            parent.add(
                "geom",
                name=f"{side}_{bone}{number}",
                size=[0.02],
                fromto=(0, 0, 0, 0, 0, -0.1),
                mass=0.1,
                rgba=LEG_COLOURS[side],
            )
            self._mjcf_root.actuator.add("position", name=f"{side}_{joint}{number}", joint=hinge, forcerange=(-1, 1))


def list_legs(plan: BodyPlan) -> list[tuple[int, str]]:
    """Return the number of its segment, counted from 1, and the side of each leg, in the order of the actuators."""
    return [(number, side) for number, has_legs in enumerate(plan, start=1) if has_legs for side in SIDES]


def list_joints(plan: BodyPlan) -> list[str]:
    """Return the name of each joint, in the order of the model: ``left_hip1``, …, ``pitch2``, ``yaw2``, …."""
    names: list[str] = []
    for number, has_legs in enumerate(plan, start=1):
        names += [f"pitch{number}", f"yaw{number}"] if number > 1 else []
        names += [f"{side}_{joint}{number}" for side in SIDES if has_legs for joint in ("hip", "knee")]
    return names


def generate_robot(plan: BodyPlan) -> Walker:
    """Build the robot of a body plan, with nominal sizes."""
    if not isinstance(plan, tuple | list):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(
            "plan must say for each segment whether it has legs, such as (True, False, True); got a "
            f"{type(plan).__name__}. The robot of a genome is built by wl.compile_scene(genome, settings)"
        )
    return Walker(plan)
