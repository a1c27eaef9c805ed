"""The tutorial's air: its constants for the marcher, and as an atmosphere for the simulator."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, Scalar, as_parameter, as_scalar, check
from ..atmosphere import Atmosphere, Constituent
from ..constants import EARTH_RADIUS, TOP_OF_ATMOSPHERE
from ..errors import InputError
from ..phase import CornetteShanks, Rayleigh
from ..profile import Exponential


# The tutorial's code. 5.8e-6, its text's red, is what molecules scatter at its 680 nm.
RAYLEIGH_SCATTERING = (3.8e-6, 13.5e-6, 33.1e-6)  # m^-1 at 680, 550, 440 nm
MIE_SCATTERING = 21e-6  # m^-1; its text prints 210e-5, which is fog
MIE_EXTINCTION_RATIO = 1.1
RAYLEIGH_HEIGHT, MIE_HEIGHT = 7994.0, 1200.0  # m
MIE_G = 0.76
SUN_INTENSITY = 20.0  # no unit: "a magic number"
WAVELENGTHS = (680.0, 550.0, 440.0)  # nm


class MarchedAir(eqx.Module):
    """Air and haze around a planet; three colours, red first.

    Attributes:
        rayleigh: Scattering coefficient of air at the ground [m⁻¹].
        mie: Scattering coefficient of haze at the ground [m⁻¹].
        mie_extinction: Extinction coefficient of haze at the ground [m⁻¹].
        rayleigh_height: Scale height of air [m].
        mie_height: Scale height of haze [m].
        g: Parameter of Cornette & Shanks's phase function.
        sun: Irradiance above the air, normal to the beam; its unit times sr⁻¹ is the light's.
        planet_radius: Radius of the planet [m].
        top_altitude: Altitude at which the air ends [m].
    """

    rayleigh: Float[Array, " 3"]
    mie: Float[Array, " 3"]
    mie_extinction: Float[Array, " 3"]
    rayleigh_height: Scalar
    mie_height: Scalar
    g: Scalar
    sun: Float[Array, " 3"]
    planet_radius: Scalar
    top_altitude: Scalar

    @property
    def scale_heights(self) -> Float[Array, " 2"]:
        """Of air and haze [m]."""
        return jnp.stack([self.rayleigh_height, self.mie_height])

    @property
    def extinction(self) -> Float[Array, "2 3"]:
        """Of air and haze at the ground [m⁻¹]."""
        return jnp.stack([self.rayleigh, self.mie_extinction])

    def atmosphere(self) -> Atmosphere:
        """The same for `simulate`; its wavelengths increase, so that blue comes first."""
        mie, lost = self.mie[::-1], (self.mie_extinction - self.mie)[::-1]
        air = Constituent(Exponential(self.rayleigh_height), self.rayleigh[::-1], phase=Rayleigh())
        # pyright takes the constructor from the fields; it is the class's own.
        phase = CornetteShanks(self.g)  # pyright: ignore[reportCallIssue]
        haze = Constituent(Exponential(self.mie_height), mie, lost, phase=phase)
        return Atmosphere(
            WAVELENGTHS[::-1], self.sun[::-1], (air, haze),
            planet_radius=self.planet_radius, top_altitude=self.top_altitude,
        )  # fmt: skip


def scs_air(
    *,
    rayleigh: ArrayLike = RAYLEIGH_SCATTERING,
    mie: ArrayLike = MIE_SCATTERING,
    mie_extinction_ratio: ArrayLike = MIE_EXTINCTION_RATIO,
    rayleigh_height: ArrayLike = RAYLEIGH_HEIGHT,
    mie_height: ArrayLike = MIE_HEIGHT,
    g: ArrayLike = MIE_G,
    sun: ArrayLike = SUN_INTENSITY,
    planet_radius: ArrayLike = EARTH_RADIUS,
    top_altitude: ArrayLike = TOP_OF_ATMOSPHERE,
) -> MarchedAir:
    """The tutorial's air, or with other numbers an alien one.

    Args:
        rayleigh: Scattering coefficient of air at the ground, red, green, blue [m⁻¹].
        mie: Scattering coefficient of haze at the ground, one value or three [m⁻¹].
        mie_extinction_ratio: Extinction over scattering of haze, 1 or more.
        rayleigh_height: Scale height of air [m].
        mie_height: Scale height of haze [m].
        g: Parameter of Cornette & Shanks's phase function, in (-1, 1), below its mean cosine.
        sun: Irradiance above the air, one value or three.
        planet_radius: Radius of the planet [m].
        top_altitude: Altitude at which the air ends [m].

    Raises:
        InputError: A value out of its range.
    """
    scattering = _colour(mie, "mie")
    ratio = _number(mie_extinction_ratio, "mie_extinction_ratio", 1.0)
    asymmetry = as_scalar(g, "scs_air(g=...)")
    return MarchedAir(
        rayleigh=_colour(rayleigh, "rayleigh"),
        mie=scattering,
        mie_extinction=ratio * scattering,
        rayleigh_height=_number(rayleigh_height, "rayleigh_height", 1.0),
        mie_height=_number(mie_height, "mie_height", 1.0),
        g=check(asymmetry, lambda v: ~(abs(v) < 1), "scs_air(g=...) must lie in (-1, 1)"),
        sun=_colour(sun, "sun"),
        planet_radius=_number(planet_radius, "planet_radius", 1.0),
        top_altitude=_number(top_altitude, "top_altitude", 1.0),
    )


def scs_atmosphere() -> Atmosphere:
    """The tutorial's air for `simulate`, at 440, 550 and 680 nm."""
    return scs_air().atmosphere()


def _colour(value: ArrayLike, name: str) -> Float[Array, " 3"]:
    beta = as_parameter(value)
    if beta.shape not in ((), (3,)):
        raise InputError(f"scs_air({name}=...): expected one value or three; got {beta.shape}")
    message = f"scs_air({name}=...) must be 0 or more"
    return jnp.broadcast_to(check(beta, lambda v: ~((v >= 0) & (v < np.inf)), message), (3,))


def _number(value: ArrayLike, name: str, least: float) -> Scalar:
    number = as_scalar(value, f"scs_air({name}=...)")
    message = f"scs_air({name}=...) must be {least:g} or more"
    return check(number, lambda v: ~((v >= least) & (v < np.inf)), message)
