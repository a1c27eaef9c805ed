"""Sizes of quadratures and tables, by the accuracy asked for."""

from typing import NamedTuple


class Quality(NamedTuple):
    """How finely the simulator looks. All static: each set of sizes is one compiled program.

    Attributes:
        view_nodes: Light along a line of sight, each lit stretch.
        column_altitudes: Table of columns towards the sun.
        column_angles: The same, in the sun's zenith angle.
        levels: Altitudes at which the light field is kept for the higher orders.
        field_nodes: Light along a ray that ends at a level.
        up: Directions above the horizontal, at a level.
        limb: Directions between the horizontal and the horizon.
        down: Directions below the horizon.
        azimuths: Azimuths in half a turn.
        sun_azimuths: Of these, as many at which the first order is integrated.
        degree: Highest degree of the spherical harmonics.
        sun_offsets_deg: Sun zeniths at which the field is kept, from the observer's [degree].
        orders: How many orders `orders=None` computes before the geometric tail.
    """

    view_nodes: int
    column_altitudes: int
    column_angles: int
    levels: int
    field_nodes: int
    up: int
    limb: int
    down: int
    azimuths: int
    sun_azimuths: int
    degree: int
    sun_offsets_deg: tuple[float, ...]
    orders: int


# Where the field changes fast along a line of sight more suns are kept than by a quality's offsets:
# under a low or set sun, and when the sun is not known before compiling.
LOW_SUN_OFFSETS_DEG = (-8.0, -5.0, -3.0, -1.5, 0.0, 1.5, 3.0, 5.0, 8.0)
# From high up one sees air and ground under suns of their own.
ALL_SUNS_DEG = (
    *(0.0, 12.0, 24.0, 36.0, 47.0, 57.0, 65.0, 71.0, 76.0, 80.0, 83.0, 85.0, 87.0, 88.5, 90.0),
    *(91.5, 93.0, 94.5, 96.0, 98.0, 100.0, 103.0, 107.0, 112.0),
)

QUALITIES = {
    "draft": Quality(32, 64, 48, 10, 12, 10, 3, 4, 16, 3, 14, (-3.0, 0.0, 3.0), 5),
    "default": Quality(48, 128, 64, 16, 16, 18, 4, 10, 28, 3, 26, (-3.0, 0.0, 3.0), 8),
    "high": Quality(
        64, 256, 128, 28, 24, 28, 6, 10, 48, 4, 44, (-8.0, -3.0, -1.0, 0.0, 1.0, 3.0, 8.0), 12
    ),
}
