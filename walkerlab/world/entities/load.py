"""Loads of a robot: a pack fixed on its back, and a sledge that it drags on a rope."""

from typing import Any

from dm_control import composer, mjcf

from walkerlab.world.materials import TRANSPARENT

PACK_DENSITY = 400.0  # kg/m³
CARGO_DENSITY = 600.0  # kg/m³, density of the box on the sledge
RUNNER_RADIUS = 0.02  # m
PACK_COLOUR = (0.60, 0.20, 0.15, 1)
SLEDGE_COLOUR = (0.45, 0.30, 0.18, 1)
ROPE_COLOUR = (0.85, 0.75, 0.50, 1)


class Pack(composer.Entity):
    """A box of a given weight [kg]; its origin is the centre of its underside."""

    def _build(self, weight: float, name: str = "pack") -> None:
        self._mjcf_root = mjcf.RootElement(model=name)
        edge = (weight / PACK_DENSITY) ** (1 / 3)
        size = (0.6 * edge, 0.5 * edge, edge / 2.4)
        self._mjcf_root.worldbody.add(
            "geom", name="box", type="box", size=size, pos=(0, 0, size[2]), mass=weight, rgba=PACK_COLOUR
        )

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """MJCF model of the load."""
        return self._mjcf_root


class Sledge(composer.Entity):
    r"""A box on two runners that are bent up in front; its origin is between the runners, on the ground.

    +-----------+
    |   cargo   |______ rope
    +-----------+
    `‾‾‾‾‾‾‾‾‾‾‾‾/   -> x
    """

    def _build(self, weight: float, name: str = "sledge") -> None:
        self._mjcf_root = mjcf.RootElement(model=name)
        body = self._mjcf_root.worldbody
        half = half_sledge_length(weight)
        half_width = 0.6 * half
        half_height = weight / CARGO_DENSITY / (8 * half * half_width)
        body.add(
            "geom", name="cargo", type="box", size=(half, half_width, half_height),
            pos=(0, 0, 3 * RUNNER_RADIUS + half_height), mass=0.9 * weight, rgba=SLEDGE_COLOUR,
        )  # fmt: skip
        for side, y in (("left", half_width), ("right", -half_width)):
            tail = (-half, y, RUNNER_RADIUS)
            bend = (half, y, RUNNER_RADIUS)
            tip = (half + 4 * RUNNER_RADIUS, y, 5 * RUNNER_RADIUS)
            for section, ends, mass_share in (("runner", (*tail, *bend), 0.04), ("nose", (*bend, *tip), 0.01)):
                body.add(
                    "geom", name=f"{side}_{section}", type="capsule", size=[RUNNER_RADIUS], fromto=ends,
                    mass=mass_share * weight, rgba=SLEDGE_COLOUR,
                )  # fmt: skip
        self.ring = body.add("site", name="ring", pos=(half, 0, 3 * RUNNER_RADIUS), rgba=TRANSPARENT)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """MJCF model of the load."""
        return self._mjcf_root


def half_sledge_length(weight: float) -> float:
    """Return half the length [m] of a sledge of the given weight [kg]."""
    return 0.5 * (weight / CARGO_DENSITY / 0.3) ** (1 / 3)


def add_rope(root: Any, hitch: Any, ring: Any) -> None:
    """Add a rope between a site of the robot and a site of the sledge; it pulls when taut and never pushes."""
    rope = root.tendon.add("spatial", name="rope", limited="true", range=(0, 1), width=0.006, rgba=ROPE_COLOUR)
    rope.add("site", site=hitch)
    rope.add("site", site=ring)
