"""Sizes of quadratures and tables, by the accuracy asked for."""

from typing import NamedTuple


class Directions(NamedTuple):
    """Directions over which light is summed at a level of the field.

    Attributes:
        up: Number of zenith angles above the horizontal.
        limb: Number of zenith angles between the horizontal and the horizon.
        down: Number of zenith angles below the horizon.
        azimuths: Number of azimuths in half a turn.
        degree: Highest degree of the spherical harmonics.
        modes: Highest azimuthal mode, cos(mφ), of the spherical harmonics.
    """

    up: int
    limb: int
    down: int
    azimuths: int
    degree: int
    modes: int


class Quality(NamedTuple):
    """How finely the simulator looks. All static: each set of sizes is one compiled program.

    Attributes:
        view_panels: Number of panels of three Gauss nodes on each sunlit stretch of a line of
            sight.
        view_kinks: Number of further panels there, one ending at each of the density's strongest
            kinks.
        column_angles: Number of zenith angles in the table of columns towards the sun.
        levels: Number of altitudes at which the light field is kept for the higher orders.
        field_panels: Number of panels of three Gauss nodes on a ray that ends at a level.
        field_kinks: Number of further panels there, likewise.
        first: Directions of the first order's field, as sharp as the phase functions.
        higher: Directions of the later orders' fields: each scattering smooths them. Neither its
            degree nor its modes may exceed those of `first`.
        sun_azimuths: Number of azimuths at which the first order is integrated along a ray.
        sun_offsets_deg: Sun zeniths at which the field is kept, from the observer's [degree]; more
            are kept under a low sun.
        sharpest: Highest degree of Legendre polynomials in which forward peaks are known.
        tolerance: Relative error of the sum of all orders.
    """

    view_panels: int
    view_kinks: int
    column_angles: int
    levels: int
    field_panels: int
    field_kinks: int
    first: Directions
    higher: Directions
    sun_azimuths: int
    sun_offsets_deg: tuple[float, ...]
    sharpest: int
    tolerance: float

    def at_sunset(self) -> "Quality":
        """Finer along rays, on which a low sun's light changes fast."""
        return self._replace(field_panels=self.field_panels + 3)

    def at_dusk(self) -> "Quality":
        """Finer where the shadow's edge and decades of brightness are in sight."""
        return self._replace(
            view_panels=self.view_panels * 3 // 2,
            levels=2 * self.levels - 4,
            field_panels=2 * self.field_panels + 2,
            sun_azimuths=3 * self.sun_azimuths,
        )


# Where the field changes fast along a line of sight at least so many suns are kept, whatever the
# quality: seen from the ground, under a sun up to 4° above the horizon (the second order is within
# 0.3 % of that with seventeen suns); and wherever the sun has set or is not known before compiling.
LOW_SUN_OFFSETS_DEG = (-4.0, -1.5, 0.0, 1.5, 4.0)
TWILIGHT_OFFSETS_DEG = tuple(1.5 * k for k in range(-6, 7))
# From high up one sees air and ground under suns of their own.
ALL_SUNS_DEG = (
    *(0.0, 12.0, 24.0, 36.0, 47.0, 57.0, 65.0, 71.0, 76.0, 80.0, 83.0, 85.0, 87.0, 88.5, 90.0),
    *(91.5, 93.0, 94.5, 96.0, 98.0, 100.0, 103.0, 107.0, 112.0),
)

QUALITIES = {
    "draft": Quality(
        view_panels=8,
        view_kinks=4,
        column_angles=48,
        levels=10,
        field_panels=3,
        field_kinks=4,
        first=Directions(up=10, limb=3, down=4, azimuths=1, degree=12, modes=12),
        higher=Directions(up=8, limb=2, down=5, azimuths=9, degree=8, modes=8),
        sun_azimuths=3,
        sun_offsets_deg=(-3.0, 0.0, 3.0),
        sharpest=64,
        tolerance=1e-5,
    ),
    "default": Quality(
        view_panels=11,
        view_kinks=6,
        column_angles=64,
        levels=16,
        field_panels=3,
        field_kinks=4,
        first=Directions(up=18, limb=4, down=8, azimuths=1, degree=20, modes=20),
        higher=Directions(up=10, limb=3, down=8, azimuths=20, degree=20, modes=18),
        sun_azimuths=3,
        sun_offsets_deg=(-3.0, 0.0, 3.0),
        sharpest=96,
        tolerance=1e-6,
    ),
    "high": Quality(
        view_panels=20,
        view_kinks=10,
        column_angles=128,
        levels=28,
        field_panels=8,
        field_kinks=6,
        first=Directions(up=28, limb=6, down=12, azimuths=1, degree=36, modes=36),
        higher=Directions(up=18, limb=4, down=10, azimuths=28, degree=28, modes=26),
        sun_azimuths=4,
        sun_offsets_deg=(-8.0, -3.0, -1.0, 0.0, 1.0, 3.0, 8.0),
        sharpest=160,
        tolerance=1e-7,
    ),
}


def coarser(quality: Quality) -> Quality:
    """Sizes to compare with: the next coarser quality, or two thirds of a draft's or own sizes."""
    if quality == QUALITIES["high"]:
        return QUALITIES["default"]
    if quality == QUALITIES["default"]:
        return QUALITIES["draft"]

    def fewer(directions: Directions) -> Directions:
        return Directions(*(max(1, 2 * size // 3) for size in directions))

    return quality._replace(
        view_panels=max(2, 2 * quality.view_panels // 3),
        field_panels=max(2, 2 * quality.field_panels // 3),
        levels=max(6, 2 * quality.levels // 3),
        first=fewer(quality.first),
        higher=fewer(quality.higher),
    )
