"""What a robot carries and drags: a pack fixed on its back, and a sledge on a rope."""

from typing import Any

from dm_control import composer, mjcf

PACK = 400.0  # kg/m³ of what is carried
CARGO = 600.0  # kg/m³ of what is dragged
RUNNER = 0.02  # m, radius of a sledge's runners
UNSEEN = (0, 0, 0, 0)
CLOTH = (0.60, 0.20, 0.15, 1)
PLANK = (0.45, 0.30, 0.18, 1)
HEMP = (0.85, 0.75, 0.50, 1)


class Pack(composer.Entity):
    """A box that weighs what is to be carried; its origin is the middle of its underside."""

    def _build(self, weight: float, name: str = "pack") -> None:
        self._mjcf_root = mjcf.RootElement(model=name)
        edge = (weight / PACK) ** (1 / 3)
        size = (0.6 * edge, 0.5 * edge, edge / 2.4)
        self._mjcf_root.worldbody.add(
            "geom", name="box", type="box", size=size, pos=(0, 0, size[2]), mass=weight, rgba=CLOTH
        )

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The model."""
        return self._mjcf_root


class Sledge(composer.Entity):
    r"""A box on two runners that are bent up in front; its origin lies between them, on the ground.

    +-----------+
    |   cargo   |______ rope
    +-----------+
    `‾‾‾‾‾‾‾‾‾‾‾‾/   -> x
    """

    def _build(self, weight: float, name: str = "sledge") -> None:
        self._mjcf_root = mjcf.RootElement(model=name)
        self.half = half_length(weight)
        body, half, wide = self._mjcf_root.worldbody, self.half, 0.6 * self.half
        rise = weight / CARGO / (8 * half * wide)  # half the cargo's height
        body.add(
            "geom", name="cargo", type="box", size=(half, wide, rise), pos=(0, 0, 3 * RUNNER + rise),
            mass=0.9 * weight, rgba=PLANK,
        )  # fmt: skip
        for side, y in (("left", wide), ("right", -wide)):
            tail, bend, tip = (-half, y, RUNNER), (half, y, RUNNER), (half + 4 * RUNNER, y, 5 * RUNNER)
            for part, ends, share in (("runner", (*tail, *bend), 0.04), ("nose", (*bend, *tip), 0.01)):
                body.add(
                    "geom", name=f"{side}_{part}", type="capsule", size=[RUNNER], fromto=ends, mass=share * weight,
                    rgba=PLANK,
                )  # fmt: skip
        self.ring = body.add("site", name="ring", pos=(half, 0, 3 * RUNNER), rgba=UNSEEN)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The model."""
        return self._mjcf_root


def half_length(weight: float) -> float:
    """Return half the length [m] of the sledge for a weight [kg]."""
    return 0.5 * (weight / CARGO / 0.3) ** (1 / 3)


def tie(root: Any, hitch: Any, ring: Any) -> None:
    """Run a rope from a site of the robot to one of the sledge: it holds when it is taut, and does nothing else."""
    rope = root.tendon.add("spatial", name="rope", limited="true", range=(0, 1), width=0.006, rgba=HEMP)
    rope.add("site", site=hitch)
    rope.add("site", site=ring)
