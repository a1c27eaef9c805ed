"""Hoffman & Preetham (2002): light scattering in air of constant density, in three colours.

"Photorealistic Real-Time Outdoor Light Scattering", Game Developer Magazine. What air and haze do
is told at 650, 570 and 475 nm, which stand for red, green and blue; their densities do not change
along a ray, whose length is instead the optical length of the atmosphere. Mended are the numerator
of Henyey & Greenstein's function and the sign of its g; see the README.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, Scalar, as_float, as_parameter, as_scalar, check
from ..angles import as_sight, as_zenith, view_sun_angle
from ..colour import rgb_to_xyz, spectrum_to_xyz, xyz_to_rgb, xyz_to_xyY
from ..errors import InputError
from ..phase import HenyeyGreenstein, Rayleigh
from ..preetham_air import (
    haze_scattering,
    rayleigh_scattering,
    solar_irradiance,
)
from ..spectrum import PAPER_WAVELENGTHS
from ..sun.light import air_mass
from .base import AbstractSkyModel
from .directions import align, angle_between, components
from .twilight import daytime_sun, dimming


RGB_WAVELENGTHS = (650.0, 570.0, 475.0)  # nm
AIR_LENGTH, HAZE_LENGTH = 8.4e3, 1.25e3  # m: optical lengths to the zenith
# Table 1, m^-1. Its g (-1 to -30 as printed) are no parameters of a phase function.
HAZES = {
    "light haze": (2e-5, 3e-5, 4e-5),
    "heavy haze": (8e-5, 1e-4, 1.2e-4),
    "light fog": (9e-4, 1e-3, 1.1e-3),
    "heavy fog": (1e-2, 1e-2, 1e-2),
}
DEFAULT_G = 0.76  # of haze, as in Nishita et al. (1993)


class HoffmanPreethamSky(AbstractSkyModel):
    """The two-shell sky, with the sun and the aerial perspective that go with it. RGB throughout.

    Colours are linear sRGB in cd m⁻², illuminances in lx. A view below the horizon has the air of
    the horizon before it.

    Attributes:
        air: Scattering coefficients at the ground [m⁻¹].
        haze: Scattering coefficient of haze [m⁻¹].
        haze_absorption: [m⁻¹].
        haze_phase: With g above 0 haze scatters forward.
        sun: Illuminance above the atmosphere, normal to the beam [lx].
        air_length: Optical length to the zenith [m].
        haze_length: Length of the path through haze, no longer than that through air [m].
    """

    air: Float[Array, " 3"]
    haze: Float[Array, " 3"]
    haze_absorption: Float[Array, " 3"]
    haze_phase: HenyeyGreenstein
    sun: Float[Array, " 3"]
    air_length: Scalar
    haze_length: Scalar

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """Range of the sun's zenith angle [rad]."""
        return {"sun_zenith": (0.0, math.pi / 2)}

    @property
    def extinction(self) -> Float[Array, " 3"]:
        """Of air and haze together at the ground [m⁻¹]."""
        return self.air + self.haze + self.haze_absorption

    def sunlight(self, sun_zenith: ArrayLike) -> Float[Array, "*batch 3"]:
        """Illuminance by the sun at the ground, normal to the beam; equation 5 [lx].

        Args:
            sun_zenith: Below the horizon it dims as the sky models do [rad].
        """
        return _sunlight(self, as_zenith(sun_zenith, "sunlight(sun_zenith=...)"))

    def scattered(
        self, cos_gamma: Float[Array, "*batch"]
    ) -> tuple[Float[Array, "*batch 3"], Float[Array, "*batch 3"]]:
        """Angular scattering coefficients β(Θ) of air and of haze [m⁻¹ sr⁻¹]."""
        dtype = cos_gamma.dtype
        air = Rayleigh().spectral(cos_gamma) * _row(self.air, cos_gamma)
        phase = jax.tree.map(lambda g: g.astype(dtype), self.haze_phase)
        return air, phase.spectral(cos_gamma) * _row(self.haze, cos_gamma)

    def rgb(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Linear sRGB [cd m⁻²]; see `AbstractSkyModel.rgb`."""
        sun, view, azimuth = align(*as_sight(sun_zenith, view_zenith, relative_azimuth, "sky"))
        return _sky(self, sun, view, view_sun_angle(view, sun, azimuth))

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        return xyz_to_xyY(rgb_to_xyz(self.rgb(sun_zenith, view_zenith, relative_azimuth)))

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        split = align(*components(as_float(direction)), *components(as_float(sun_direction)))
        view, sun = split[:3], split[3:]
        up = jnp.zeros_like(sun[2])
        sun_zenith, _ = angle_between(sun, (up, up, up + 1))
        up = jnp.zeros_like(view[2])
        view_zenith, _ = angle_between(view, (up, up, up + 1))
        gamma, _ = angle_between(view, sun)
        return rgb_to_xyz(_sky(self, sun_zenith, view_zenith, gamma))


def hoffman_preetham_sky(
    turbidity: ArrayLike | None = None,
    *,
    haze: str | ArrayLike | None = None,
    g: ArrayLike = DEFAULT_G,
    haze_absorption: ArrayLike = 0.0,
) -> HoffmanPreethamSky:
    """The sky of Hoffman & Preetham (2002) at a turbidity, or with a haze of its own.

    Args:
        turbidity: T, 1 or more: the haze whose optical depth at 550 nm is T - 1 times that of the
            air, over the model's own optical lengths; coloured as in Preetham et al. (1999).
        haze: Name in place of a turbidity: "light haze", "heavy haze", "light fog" or "heavy fog"
            of the article's table 1; or scattering coefficients at 650, 570 and 475 nm [m⁻¹].
        g: Mean cosine of the haze's scattering, in (-1, 1). The article prints no usable one.
        haze_absorption: One value or three; up to about 5e-5 where the air is polluted [m⁻¹].

    Raises:
        InputError: Neither or both of turbidity and haze; an unknown haze; a value out of range.
    """
    if turbidity is not None and haze is None:
        name = "hoffman_preetham_sky(turbidity=...)"
        value = as_scalar(turbidity, name)
        value = check(value, lambda v: ~((v >= 1) & (v < np.inf)), f"{name} must be 1 or more")
        beta = _haze_of(value)
    elif isinstance(haze, str) and turbidity is None:
        if haze not in HAZES:
            names = ", ".join(repr(known) for known in HAZES)
            raise InputError(
                f"hoffman_preetham_sky(haze=...): expected one of {names}, or three numbers; "
                f"got {haze!r}"
            )
        beta = as_parameter(HAZES[haze])
    elif haze is not None and turbidity is None:
        beta = _coefficients(haze, "haze")
    else:
        raise InputError("hoffman_preetham_sky: expected turbidity or haze, one of the two")
    name = "hoffman_preetham_sky(g=...)"
    asymmetry = check(as_scalar(g, name), lambda v: ~(abs(v) < 1), f"{name} must lie in (-1, 1)")
    return HoffmanPreethamSky(
        air=rayleigh_scattering(as_parameter(RGB_WAVELENGTHS)),
        haze=beta,
        haze_absorption=_coefficients(haze_absorption, "haze_absorption"),
        # pyright takes the constructor from the fields; it is the class's own.
        haze_phase=HenyeyGreenstein(asymmetry),  # pyright: ignore[reportCallIssue]
        sun=sun_colour(),
        air_length=as_parameter(AIR_LENGTH),
        haze_length=as_parameter(HAZE_LENGTH),
    )


@jax.jit
def sun_colour() -> Float[Array, " 3"]:
    """Linear sRGB illuminance of the sun above the atmosphere, normal to the beam [lx]."""
    spectrum = solar_irradiance(as_parameter(PAPER_WAVELENGTHS))
    return xyz_to_rgb(spectrum_to_xyz(spectrum, PAPER_WAVELENGTHS))


@jax.jit
def _haze_of(turbidity: Scalar) -> Float[Array, " 3"]:
    green = as_parameter(550.0)
    wanted = (turbidity - 1) * rayleigh_scattering(green) * AIR_LENGTH / HAZE_LENGTH
    shape = haze_scattering(3.0, as_parameter(RGB_WAVELENGTHS)) / haze_scattering(3.0, green)
    return wanted * shape


def _coefficients(value: ArrayLike, name: str) -> Float[Array, " 3"]:
    beta = as_parameter(value)
    if beta.shape not in ((), (3,)):
        raise InputError(
            f"hoffman_preetham_sky({name}=...): expected one value or three; got shape {beta.shape}"
        )
    message = f"hoffman_preetham_sky({name}=...) must be 0 or more, in 1/m"
    beta = check(beta, lambda v: ~((v >= 0) & (v < np.inf)), message)
    return jnp.broadcast_to(beta, (3,))


def _row(colour, like):
    """A colour as the last axis of arrays shaped like another, in its precision."""
    return colour.astype(like.dtype).reshape((1,) * like.ndim + (3,))


@jax.jit
def _sunlight(sky: HoffmanPreethamSky, sun_zenith):
    mass = air_mass(daytime_sun(sun_zenith))[..., None]
    haze = sky.haze + sky.haze_absorption
    depth = _row(sky.air * sky.air_length + haze * sky.haze_length, sun_zenith) * mass
    return _row(sky.sun, sun_zenith) * jnp.exp(-depth) * dimming(sun_zenith)[..., None]


@jax.jit
def _sky(sky: HoffmanPreethamSky, sun_zenith, view_zenith, gamma):
    """Both shells: air and haze as far as haze reaches, then air alone."""
    mass = air_mass(jnp.minimum(view_zenith, math.pi / 2))[..., None]
    inner = sky.haze_length.astype(mass.dtype) * mass
    outer = sky.air_length.astype(mass.dtype) * mass - inner
    air, haze = sky.scattered(jnp.cos(gamma))
    near, far = _row(sky.extinction, view_zenith), _row(sky.air, view_zenith)
    through = jnp.exp(-near * inner)
    lit = (air + haze) / near * (1 - through) + air / far * (1 - jnp.exp(-far * outer)) * through
    return _sunlight(sky, sun_zenith) * lit
