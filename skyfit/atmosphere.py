"""What scatters and absorbs: constituents, and the atmosphere they make up."""

from collections.abc import Sequence

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import (
    ArrayLike,
    Scalar,
    Spectrum,
    as_parameter,
    as_scalar,
    as_wavelengths,
    check,
    is_traced,
)
from .bands import Bands
from .constants import EARTH_RADIUS, TOP_OF_ATMOSPHERE
from .errors import InputError
from .phase import AbstractPhaseFunction
from .profile import AbstractProfile


class Constituent(eqx.Module):
    """A gas or an aerosol.

    Args:
        density: Relative density over altitude.
        scattering: Coefficient where the relative density is 1, 0 or more [m⁻¹]: one value or
            one per wavelength.
        absorption: Absorption coefficient where the relative density is 1 [m⁻¹].
        phase: Phase function, the directions into which it scatters.
        bands: What it absorbs besides, by lines too narrow for the wavelengths; None for nothing.
    """

    density: AbstractProfile
    scattering: Float[Array, " #wavelength"]
    absorption: Float[Array, " #wavelength"]
    phase: AbstractPhaseFunction
    bands: Bands | None

    def __init__(
        self,
        density: AbstractProfile,
        scattering: ArrayLike,
        absorption: ArrayLike = 0.0,
        *,
        phase: AbstractPhaseFunction,
        bands: Bands | None = None,
    ):
        self.density = density
        self.scattering = _coefficient(scattering, "scattering")
        self.absorption = _coefficient(absorption, "absorption")
        self.phase = phase
        self.bands = bands

    @property
    def extinction(self) -> Float[Array, " #wavelength"]:
        """Scattering plus absorption coefficient [m⁻¹].

        Raises:
            InputError: It absorbs in bands too, for which no one coefficient stands.
        """
        if self.bands is not None:
            raise InputError(
                "extinction: a constituent absorbs in bands, which have no one coefficient; take "
                "one class of lines at a time as skyfit.transfer.line_classes does"
            )
        return self.scattering + self.absorption


class Refraction(eqx.Module):
    """How air bends light: its index of refraction is 1 + refractivity × relative density.

    Args:
        refractivity: n - 1 where the relative density is 1, 0 or more: one value for all
            wavelengths. Dry air at 15 °C and 1013.25 hPa has 2.778e-4 at 550 nm, 1.4 % more at
            400 nm and 0.7 % less at 700 nm (Peck & Reeder 1972, J. Opt. Soc. Am. 62, 958).
        density: Relative density over altitude, as a rule that of the air.
    """

    refractivity: Scalar
    density: AbstractProfile

    def __init__(self, refractivity: ArrayLike, density: AbstractProfile):
        name = "Refraction(refractivity=...)"
        value = as_scalar(refractivity, name)
        self.refractivity = check(
            value, lambda v: ~((v >= 0) & (v < 0.1)), f"{name} must be 0 to 0.1"
        )
        self.density = density


class Atmosphere(eqx.Module):
    """A spherical atmosphere over a Lambertian ground, lit by the sun.

    Args:
        wavelengths: Wavelengths of all spectra, increasing [nm].
        solar_irradiance: Sunlight above the air on a plane normal to it, 0 or more: one value
            or one per wavelength [W m⁻² nm⁻¹].
        constituents: Gases and aerosols, one or more, with spectra of as many values as
            `wavelengths`, or of 1.
        ground_albedo: Albedo of a Lambertian ground, in [0, 1]: one value or one per wavelength.
        planet_radius: Radius of the planet, to the ground [m].
        top_altitude: Altitude above which there is nothing [m].
        refraction: Law by which the air bends light; None for straight rays.
    """

    wavelengths: Spectrum
    solar_irradiance: Spectrum
    constituents: tuple[Constituent, ...]
    ground_albedo: Spectrum
    planet_radius: Scalar
    top_altitude: Scalar
    refraction: Refraction | None

    __hash__ = object.__hash__  # arrays have none, and `jax.jit(atm.density)` asks for it

    def __init__(
        self,
        wavelengths: ArrayLike,
        solar_irradiance: ArrayLike,
        constituents: Sequence[Constituent],
        ground_albedo: ArrayLike = 0.0,
        planet_radius: ArrayLike = EARTH_RADIUS,
        top_altitude: ArrayLike = TOP_OF_ATMOSPHERE,
        refraction: Refraction | None = None,
    ):
        lam = as_wavelengths(wavelengths, "Atmosphere(wavelengths=...)")
        self.wavelengths = lam
        sun = _spectrum(solar_irradiance, lam, "solar_irradiance")
        self.solar_irradiance = check(
            sun,
            lambda v: ~((v >= 0) & (v < np.inf)),
            "Atmosphere(solar_irradiance=...) must be 0 or more",
        )
        albedo = _spectrum(ground_albedo, lam, "ground_albedo")
        self.ground_albedo = check(
            albedo, lambda v: ~((v >= 0) & (v <= 1)), "Atmosphere(ground_albedo=...) must be 0 to 1"
        )
        self.planet_radius = _length(planet_radius, "planet_radius")
        self.top_altitude = _length(top_altitude, "top_altitude")
        self.refraction = refraction
        if refraction is not None and not is_traced(refraction, self.planet_radius):
            self._refuse_ducts(refraction)
        if isinstance(constituents, Constituent):
            raise InputError("Atmosphere(constituents=...): expected a tuple; got one Constituent")
        self.constituents = tuple(constituents)
        if not self.constituents:
            raise InputError("Atmosphere(constituents=...): expected one or more; got none")
        for number, one in enumerate(self.constituents):
            for name, width in _spectral_widths(one):
                if width not in (1, lam.size):
                    raise InputError(
                        f"Atmosphere: constituents[{number}].{name} has {width} wavelengths, "
                        f"expected 1 or {lam.size} as in wavelengths"
                    )
        _check_bands(self.constituents, lam.size)

    def _refuse_ducts(self, refraction: Refraction) -> None:
        """Where n r falls with altitude light would go round the planet."""
        with jax.ensure_compile_time_eval():
            altitude = jnp.linspace(0, self.top_altitude, 4001)
            index = 1 + refraction.refractivity * refraction.density(altitude)
            rises = np.all(np.diff(np.asarray(index * (self.planet_radius + altitude))) > 0)
        if not rises:
            raise InputError(
                "Atmosphere(refraction=...): expected an index of refraction times radius that "
                "rises with altitude; this air would lead light round the planet"
            )

    @property
    def scattering(self) -> Float[Array, "species wavelength"]:
        """Scattering coefficients where each density is 1 [m⁻¹]."""
        return self._stack([one.scattering for one in self.constituents])

    @property
    def extinction(self) -> Float[Array, "species wavelength"]:
        """Extinction coefficients where each density is 1 [m⁻¹].

        Raises:
            InputError: Some constituent absorbs in bands, for which no one coefficient stands.
        """
        return self._stack([one.extinction for one in self.constituents])

    def density(self, altitude: Float[Array, "*batch"]) -> Float[Array, "*batch species"]:
        """Relative densities [1] at altitudes [m]; 0 above the top."""
        values = jnp.stack([one.density(altitude) for one in self.constituents], axis=-1)
        return jnp.where((altitude <= self.top_altitude)[..., None], values, 0.0)

    def knots(self) -> Float[Array, " knot"]:
        """Altitudes where some density is not smooth, below the top [m]; in no order."""
        every = jnp.concatenate([one.density.knots() for one in self.constituents])
        return jnp.minimum(every, self.top_altitude)

    def vertical_column(self) -> Float[Array, " species"]:
        """Column of each constituent from the ground up [m at relative density 1]."""
        return jnp.stack([one.density.column(self.top_altitude) for one in self.constituents])

    def optical_depth(self) -> Float[Array, "species wavelength"]:
        """Vertical optical depth of each constituent [1].

        Of bands it is -ln of their mean transmittance, and not half of it for half the column.
        """
        column = self.vertical_column()
        plain = self.scattering + self._stack([one.absorption for one in self.constituents])
        depth = column[:, None] * plain
        for number, one in enumerate(self.constituents):
            if one.bands is not None:
                depth = depth.at[number].add(one.bands.optical_depth(column[number]))
        return depth

    def _stack(self, spectra) -> Float[Array, "species wavelength"]:
        return jnp.stack([jnp.broadcast_to(s, self.wavelengths.shape) for s in spectra])


def _check_bands(constituents: Sequence[Constituent], width: int) -> None:
    """Expect bands of the atmosphere's wavelengths, and classes of lines that all share."""
    found = [(n, one.bands) for n, one in enumerate(constituents) if one.bands is not None]
    for number, bands in found:
        if bands.width != width:
            raise InputError(
                f"Atmosphere: constituents[{number}].bands has {bands.width} wavelengths, expected "
                f"{width} as in wavelengths"
            )
        first, one = found[0][1].weights, bands.weights
        same = first.shape == one.shape
        if not same or not (is_traced(first, one) or np.allclose(first, one, rtol=1e-5)):
            raise InputError(
                f"Atmosphere: constituents[{number}].bands has other weights than those of "
                f"constituents[{found[0][0]}]; expected the same classes of lines in all"
            )


def _length(value: ArrayLike, name: str) -> Scalar:
    name = f"Atmosphere({name}=...)"
    length = as_scalar(value, name)
    return check(length, lambda v: ~((v > 0) & (v < np.inf)), f"{name} must be above 0 m")


def _coefficient(value: ArrayLike, name: str) -> Float[Array, " #wavelength"]:
    beta = jnp.atleast_1d(as_parameter(value))
    if beta.ndim != 1:
        raise InputError(f"Constituent({name}=...): expected one axis; got shape {beta.shape}")
    message = f"Constituent({name}=...) must be 0 or more, in 1/m"
    return check(beta, lambda v: ~((v >= 0) & (v < np.inf)), message)


def _spectrum(value: ArrayLike, wavelengths: Spectrum, name: str) -> Spectrum:
    spectrum = as_parameter(value)
    if spectrum.shape not in ((), (1,), wavelengths.shape):
        raise InputError(
            f"Atmosphere({name}=...): expected one value or {wavelengths.size} as in wavelengths; "
            f"got shape {spectrum.shape}"
        )
    return jnp.broadcast_to(spectrum, wavelengths.shape)


def _spectral_widths(one: Constituent):
    yield "scattering", one.scattering.size
    yield "absorption", one.absorption.size
    shape = eqx.filter_eval_shape(
        one.phase.spectral, jax.ShapeDtypeStruct((), jnp.result_type(float))
    ).shape
    yield "phase", shape[-1]
