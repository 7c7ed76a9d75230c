"""Materials of the ground: friction and colours.

Friction is that of rubber in a simple model: one coefficient for sliding, and two lengths for a body 4 cm wide. On soft
ground the body sinks in and touches with a larger patch, which resists turning; a rolling body has to climb out of the
dent that it makes. Torsional and rolling friction act on obstacles only. Robots have sliding friction only, which is
faster to compute; the torsional friction of a foot would be a torque of at most 6 mm times its load.

    sliding                  µ
    torsional [m]            ⅔ · µ · a, with a the radius of the patch: √(2·R·d − d²) at a depth d, 1 cm on hard ground
    rolling [m]              c · R, with c the rolling resistance and R the radius of the rolling body, 2 cm for a foot

Published values of µ and c for tyres and soles differ by a third or more; those below lie within the published range.
"""

from dataclasses import dataclass

from walkerlab.settings.choices import Texture

RGB = tuple[float, float, float]

FOOT_RADIUS = 0.02  # m
TRANSPARENT = (0, 0, 0, 0)  # RGBA of sites that are not drawn


@dataclass(frozen=True)
class Material:
    """Friction and colours of one kind of ground.

    Attributes:
        sliding: Friction coefficient µ.
        patch_radius: Radius of the contact patch of a foot, m.
        rolling: Rolling resistance c.
        light: Colour of the light squares of the chequer pattern.
        dark: Colour of the dark squares.
        piece: Colour of the texture pieces.
        speckle: Colour of the speckles.
        speckle_share: Share of the ground that is speckled, 0 to 1.
        source: Source of the values.
    """

    sliding: float
    patch_radius: float
    rolling: float
    light: RGB
    dark: RGB
    piece: RGB
    speckle: RGB
    speckle_share: float
    source: str

    def friction(self, radius: float = FOOT_RADIUS) -> tuple[float, float, float]:
        """Return sliding, torsional [m] and rolling [m] friction for a body that rolls on the given radius [m]."""
        return self.sliding, 2 / 3 * self.sliding * self.patch_radius, self.rolling * radius


_ROLLING_SOURCE = "c: The Engineering Toolbox, Rolling Resistance"

MATERIALS: dict[Texture, Material] = {
    Texture.rubber: Material(
        0.90, 0.010, 0.02, (0.87, 0.88, 0.84), (0.79, 0.81, 0.77), (0.55, 0.58, 0.56), (0.70, 0.72, 0.68), 0.02,
        "µ: chosen, above rubber on dry concrete; c: chosen, above a hard road",
    ),
    Texture.marble: Material(
        0.50, 0.010, 0.010, (0.93, 0.90, 0.87), (0.55, 0.51, 0.52), (0.45, 0.40, 0.42), (0.78, 0.74, 0.73), 0.03,
        "µ: chosen near the 0.5 asked of a dry stone floor (Khaday et al., Coatings 11, 2021, 1254); "
        f"{_ROLLING_SOURCE} (hard and smooth)",
    ),
    Texture.ice: Material(
        0.10, 0.010, 0.010, (0.72, 0.88, 0.94), (0.63, 0.82, 0.90), (0.95, 0.99, 1.00), (0.93, 0.98, 1.00), 0.05,
        "µ: Noon, Engineering Analysis of Vehicular Accidents, 1994 (0.10 to 0.15); Navin et al., SAE, 1996 (0.09); "
        "c: chosen, as hard and smooth",
    ),
    Texture.wood: Material(
        0.70, 0.010, 0.010, (0.84, 0.71, 0.53), (0.73, 0.58, 0.41), (0.45, 0.29, 0.17), (0.66, 0.50, 0.34), 0.12,
        "µ: OpenStax College Physics, table 5.1 (shoes on wood, kinetic); c: chosen, as hard and smooth",
    ),
    Texture.concrete: Material(
        0.75, 0.010, 0.015, (0.66, 0.66, 0.65), (0.60, 0.60, 0.59), (0.46, 0.46, 0.46), (0.48, 0.48, 0.49), 0.15,
        "µ: Noon 1994 (dry, 0.75); Serway & Beichner, Physics, 5th ed., table 5.2 (kinetic, 0.8); "
        f"{_ROLLING_SOURCE} (0.01 to 0.015)",
    ),
    Texture.grass: Material(
        0.45, 0.013, 0.07, (0.50, 0.68, 0.38), (0.35, 0.55, 0.31), (0.20, 0.40, 0.24), (0.54, 0.70, 0.38), 0.20,
        "µ: chosen between wet grass (Noon 1994, 0.2) and dry earth (Wong, Theory of Ground Vehicles, 0.68); "
        f"{_ROLLING_SOURCE} (0.04 to 0.08)",
    ),
    Texture.sand: Material(
        0.40, 0.017, 0.20, (0.93, 0.83, 0.62), (0.87, 0.76, 0.55), (0.72, 0.55, 0.34), (0.80, 0.67, 0.46), 0.20,
        f"µ: Caterpillar Performance Handbook (rubber on wet sand 0.4, dry 0.2); {_ROLLING_SOURCE} (0.2 to 0.4, loose)",
    ),
    Texture.gravel: Material(
        0.55, 0.013, 0.06, (0.52, 0.48, 0.47), (0.45, 0.41, 0.41), (0.69, 0.66, 0.63), (0.33, 0.31, 0.32), 0.30,
        "µ: Wong, Theory of Ground Vehicles (0.6 at its peak, 0.55 sliding); c: Marks' Standard Handbook (loose)",
    ),
    Texture.mud: Material(
        0.30, 0.020, 0.15, (0.47, 0.36, 0.27), (0.40, 0.30, 0.22), (0.58, 0.47, 0.35), (0.31, 0.23, 0.17), 0.18,
        "µ: chosen within 0.15 to 0.40 (Caterpillar Performance Handbook: wet clay 0.4); "
        "c: Caterpillar Performance Handbook (10 to 20 % on a soft, muddy road)",
    ),
    Texture.snow: Material(
        0.20, 0.017, 0.07, (0.97, 0.98, 1.00), (0.86, 0.90, 0.97), (0.76, 0.83, 0.93), (0.78, 0.85, 0.95), 0.05,
        "µ: Noon 1994 (0.20 to 0.25); Wong, Theory of Ground Vehicles (packed, 0.2); "
        "c: ERDC/CRREL TR-01-16, table 11 (mostly 0.05 to 0.08)",
    ),
}  # fmt: skip
"""Material of each texture. "Chosen" marks an estimate without a measurement, and the values between which it lies."""
