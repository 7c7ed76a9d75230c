"""The walker: a chain of segments, each with a pair of two-joint legs or none, grown from a body plan.

A body plan says only which segments have legs. Every measure here is nominal: the scene writes each individual's
own into the compiled plan, so that one plan serves all robots of its kind.
"""

from dm_control import composer, mjcf

BodyPlan = tuple[bool, ...]
"""For each grown segment from the front, whether it has a pair of legs."""

SIDES = ("left", "right")
UNSEEN = (0, 0, 0, 0)
TRUNK = (0.90, 0.62, 0.00, 1)
LIMB = {"left": (0.00, 0.45, 0.70, 1), "right": (0.34, 0.71, 0.91, 1)}  # the nearer in side view is the right one


class Walker(composer.Entity):
    r"""A chain of segments along -x from the nose at the origin, each with a pair of two-joint legs or none.

                 seg3    seg2    seg1
               (======)o(======)o(======)  -> x
                  /        /        /          hip
                  \        \        \          knee

    Capsule bodies; hip and knee turn in the fore-and-aft plane, positive forward, each driven by a servo that holds
    an angle with limited torque; the spine bends passively, like a stiff spring.
    """

    def _build(self, plan: BodyPlan, name: str = "walker") -> None:
        self._mjcf_root = mjcf.RootElement(model=name)
        default = self._mjcf_root.default
        default.geom.type = "capsule"
        default.geom.priority = 0
        default.joint.limited = "false"
        default.position.dampratio = 1
        default.position.kp = 1
        segment = self._mjcf_root.worldbody  # the first segment: what the walker is attached by is its own body
        for number, legged in enumerate(plan, start=1):
            segment = self._grow_segment(segment, number, legged)
            if number == (1 + len(plan)) // 2:
                self.back = segment.add("site", name="back", rgba=UNSEEN)
        self.hitch = segment.add("site", name="hitch", rgba=UNSEEN)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The model, with nominal measures."""
        return self._mjcf_root

    def _grow_segment(self, parent: mjcf.Element, number: int, legged: bool) -> mjcf.Element:
        segment = parent
        if number > 1:
            segment = parent.add("body", name=f"seg{number}", pos=(0, 0, 0))
            segment.add("joint", name=f"pitch{number}", axis=(0, 1, 0))
            segment.add("joint", name=f"yaw{number}", axis=(0, 0, 1))
        segment.add("geom", name=f"trunk{number}", size=[0.05], fromto=(0, 0, 0, -0.3, 0, 0), mass=1, rgba=TRUNK)
        if legged:
            for side in SIDES:
                self._grow_leg(segment, number, side)
        return segment

    def _grow_leg(self, segment: mjcf.Element, number: int, side: str) -> None:
        limb = segment
        for bone, joint in (("thigh", "hip"), ("shank", "knee")):
            limb = limb.add("body", name=f"{side}_{bone}{number}", pos=(0, 0, -0.1))
            hinge = limb.add("joint", name=f"{side}_{joint}{number}", axis=(0, -1, 0), armature=0.001)
            limb.add(
                "geom",
                name=f"{side}_{bone}{number}",
                size=[0.02],
                fromto=(0, 0, 0, 0, 0, -0.1),
                mass=0.1,
                rgba=LIMB[side],
            )
            self._mjcf_root.actuator.add("position", name=f"{side}_{joint}{number}", joint=hinge, forcerange=(-1, 1))


def generate_robot(plan: BodyPlan) -> Walker:
    """Grow the robot of this body plan, in nominal measures."""
    if not isinstance(plan, tuple | list):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(
            "plan must say for each segment whether it has legs, such as (True, False, True); got a "
            f"{type(plan).__name__}. The robot of a genome is built by wl.compile_scene(genome, settings)"
        )
    return Walker(plan)
