"""Perez's all-weather sky: from the sun's and the sky's irradiance to luminance everywhere.

Perez, Seals & Michalsky (1993), "All-weather model for sky luminance distribution: preliminary
configuration and validation", Solar Energy 50(3), 235, with the erratum in 51(5), 423. Two numbers
describe the sky: clearness ε, by which one of eight rows of coefficients is chosen, and brightness
Δ. Luminance takes the diffuse efficacy of Perez et al. (1990), Solar Energy 44(5), 271.
"""

import abc
import math

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float, check
from ..sun.irradiance import Irradiance, bird
from ..sun.light import air_mass
from ..tables import read_table
from .levels import AbstractQuantity, ByIlluminance
from .luminance_sky import ConstantChromaticity, LuminanceSky
from .perez import perez
from .preetham import TURBIDITY_RANGE, warn_outside
from .standard_skies import AbstractLuminanceForm, Parameters, Sight
from .twilight import daytime_sun


SOLAR_CONSTANT = 1367.0  # W m^-2; Perez et al. (1990)
CLEARNESS_RANGE, BRIGHTNESS_RANGE = (1.0, 12.0), (0.01, 0.6)
PRECIPITABLE_WATER = 2.0  # cm
# The least light of a clear sky at sunset, from where twilight falls; see `skyfit.models.base`.
SUNSET_ILLUMINANCE = 600.0  # lx
# A pyranometer reads that far below 0 by night; lower numbers stand for something else.
LARGEST_OFFSET = 30.0  # W m^-2
# Between these clearnesses Δ counts as 0.2 at least: the authors' advice, against odd shapes.
HESITANT_CLEARNESS, LEAST_BRIGHTNESS = (1.065, 2.8), 0.2
# Between these it counts as that times cos Z at least: below, the fit is negative over most of a
# dome under a high sun, and all the light comes from a spot.
BROKEN_CLEARNESS, LEAST_UNDER_ZENITH = (2.8, 4.5), 0.1


class AbstractWeather(eqx.Module):
    """Where the irradiance comes from."""

    @abc.abstractmethod
    def __call__(self, sun_zenith: Float[Array, "..."], parameters: Parameters) -> Irradiance:
        """Irradiance for a sun above the horizon or on it."""


class MeasuredWeather(AbstractWeather):
    """Irradiance that the caller gave, whatever the sun."""

    def __call__(self, sun_zenith: Float[Array, "..."], parameters: Parameters) -> Irradiance:
        """Irradiance for a sun above the horizon or on it."""
        flat = jnp.zeros_like(sun_zenith)
        direct, diffuse = parameters["direct_normal"], parameters["diffuse_horizontal"]
        # With one of them missing there is no telling what the sky was like.
        missing = jnp.isnan(direct + diffuse)
        given = (jnp.where(missing, jnp.nan, value) + flat for value in (direct, diffuse))
        return Irradiance(*jnp.broadcast_arrays(*given))


class ClearWeather(AbstractWeather):
    """Irradiance under a clear sky by Bird's model."""

    def __call__(self, sun_zenith: Float[Array, "..."], parameters: Parameters) -> Irradiance:
        """Irradiance for a sun above the horizon or on it."""
        turbidity, sun = jnp.broadcast_arrays(parameters["turbidity"], sun_zenith)
        return bird(turbidity, sun, jnp.full_like(sun, 0.2))


class AllWeather(AbstractLuminanceForm):
    """Perez's form with coefficients that follow clearness, brightness and sun.

    Attributes:
        weather: Where the irradiance comes from.
    """

    weather: AbstractWeather

    def __call__(self, sight: Sight, parameters: Parameters) -> Float[Array, "..."]:
        """Luminance up to a factor."""
        day = daytime_sun(sight.sun_zenith)
        irradiance, top = self.weather(day, parameters), _top(parameters)
        clearness, brightness = sky_conditions(irradiance, day, top)
        coefficients = all_weather_coefficients(clearness, brightness, day)
        return perez(coefficients, sight.cos_view, sight.gamma, sight.cos_gamma)


class DiffuseIlluminance(AbstractQuantity):
    """The sky's irradiance times its luminous efficacy [lx]; Perez et al. (1990), equation 7.

    Attributes:
        weather: Where the irradiance comes from.
        least: What it does not fall below by day [lx].
    """

    weather: AbstractWeather
    least: float = eqx.field(static=True, default=0.0)

    def __call__(
        self, sun_zenith: Float[Array, "..."], parameters: Parameters
    ) -> Float[Array, "..."]:
        """Illuminance [lx]."""
        irradiance = self.weather(sun_zenith, parameters)
        clearness, brightness = sky_conditions(irradiance, sun_zenith, _top(parameters))
        efficacy = diffuse_efficacy(clearness, brightness, sun_zenith)
        return jnp.maximum(irradiance.diffuse_horizontal * efficacy, self.least)


def perez_all_weather_sky(
    direct_normal: ArrayLike,
    diffuse_horizontal: ArrayLike,
    *,
    extraterrestrial: ArrayLike = SOLAR_CONSTANT,
) -> LuminanceSky:
    """The sky under a measured irradiance, clear or cloudy; D65 in colour.

    A year of measurements may be given as it is: without diffuse light the sky is black, an offset
    below 0 is none, and where one of the two is NaN the sky is.

    Args:
        direct_normal: The sun's irradiance on a plane that faces it, the whole spectrum [W m⁻²].
        diffuse_horizontal: The sky's without its sun on a horizontal plane [W m⁻²]. Arrays
            broadcast against the angles.
        extraterrestrial: The sun's irradiance above the air that day, normal to it [W m⁻²].

    Raises:
        InputError: An irradiance above the solar constant, or further below 0 than the offset of
            an instrument by night, 30 W/m².
    """
    direct, diffuse = (
        check(
            as_float(value),
            lambda v: (v < -LARGEST_OFFSET) | (v > SOLAR_CONSTANT),
            f"perez_all_weather_sky({name}=...) must lie in 0 to {SOLAR_CONSTANT:.0f} W/m², or be "
            "NaN where it is missing",
        )
        for name, value in (
            ("direct_normal", direct_normal), ("diffuse_horizontal", diffuse_horizontal)
        )
    )  # fmt: skip
    parameters = {"direct_normal": direct, "diffuse_horizontal": diffuse}
    ranges = tuple((name, (0.0, SOLAR_CONSTANT)) for name in parameters)
    parameters["extraterrestrial"] = check(
        as_float(extraterrestrial),
        lambda v: ~((v > 0) & (v < np.inf)),
        "perez_all_weather_sky(extraterrestrial=...) must be above 0",
    )
    return _sky(parameters, DiffuseIlluminance(MeasuredWeather()), ranges)


def perez_clear_sky(turbidity: ArrayLike) -> LuminanceSky:
    """The all-weather sky under the clear-sky irradiance of `skyfit.sun.clear_sky_irradiance`.

    That irradiance ends with the day; the light of the sky on the ground is held at 600 lx or
    more while the sun is up, from where it dims as all skies do.

    Args:
        turbidity: T; an array broadcasts against the angles. Held to 1.9 to 10.

    Raises:
        InputError: Turbidity below 1 or NaN.
    """
    argument = "perez_clear_sky(turbidity=...)"
    value = check(as_float(turbidity), lambda v: ~(v >= 1), f"{argument} must be 1 or more")
    warn_outside(value, TURBIDITY_RANGE, argument)
    illuminance = DiffuseIlluminance(ClearWeather(), SUNSET_ILLUMINANCE)
    return _sky({"turbidity": value}, illuminance, (("turbidity", TURBIDITY_RANGE),))


def _sky(parameters, illuminance, ranges):
    return LuminanceSky(
        parameters=parameters,
        distribution=AllWeather(illuminance.weather),
        level=ByIlluminance(illuminance),
        chromaticity=ConstantChromaticity(),
        ranges=ranges,
    )


def _top(parameters):
    return parameters.get("extraterrestrial", SOLAR_CONSTANT)


def sky_conditions(
    irradiance: Irradiance,
    sun_zenith: Float[Array, "..."],
    extraterrestrial: Float[Array, "..."] | float = SOLAR_CONSTANT,
) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
    """Clearness ε and brightness Δ, held to the ranges they were fitted in.

    ε = (1 + I / D + κ Z³) / (1 + κ Z³), κ = 1.041; Δ = m D / I₀. Perez et al. (1990), 1 and 2.
    """
    direct, diffuse = irradiance
    bend = 1.041 * sun_zenith**3
    # A sky without light has no clearness; it is called overcast.
    clearness = 1 + direct / jnp.maximum(diffuse, 1e-6) / (1 + bend)
    brightness = air_mass(sun_zenith) * diffuse / extraterrestrial
    return jnp.clip(clearness, *CLEARNESS_RANGE), jnp.clip(brightness, *BRIGHTNESS_RANGE)


def all_weather_coefficients(
    clearness: Float[Array, "..."],
    brightness: Float[Array, "..."],
    sun_zenith: Float[Array, "..."],
) -> Float[Array, "5 ..."]:
    """Perez's a to e on the first axis; Perez et al. (1993), equations 6 to 8.

    Args:
        clearness: ε.
        brightness: Δ.
        sun_zenith: Z [rad].
    """
    low, high = HESITANT_CLEARNESS
    hesitant = (clearness > low) & (clearness < high)
    broken = (clearness >= BROKEN_CLEARNESS[0]) & (clearness < BROKEN_CLEARNESS[1])
    under_sun = jnp.where(broken, LEAST_UNDER_ZENITH * jnp.cos(sun_zenith), 0.0)
    delta = jnp.maximum(brightness, jnp.where(hesitant, LEAST_BRIGHTNESS, under_sun))
    rows = _chosen("perez1993_sky_luminance", clearness)
    z, k = sun_zenith, rows.reshape(5, 4, *rows.shape[1:])
    a, b, c, d, e = (row[0] + row[1] * z + delta * (row[2] + row[3] * z) for row in k)
    # The row of overcast skies has two forms of its own.
    overcast = clearness < low
    (c1, c2, c3, c4), (d1, d2, d3, d4) = k[2], k[3]
    base = jnp.where(overcast, delta * (c1 + c2 * z), 1.0)
    c_overcast = jnp.exp(base ** jnp.where(overcast, c3, 1.0)) - c4
    slope = jnp.where(overcast, delta * (d1 + d2 * z), 0.0)
    d_overcast = -jnp.exp(slope) + d3 + delta * d4
    c, d = jnp.where(overcast, c_overcast, c), jnp.where(overcast, d_overcast, d)
    # Negative, so that the horizon has a limit.
    return jnp.stack([a, jnp.minimum(b, -1e-3), c, d, e])


def diffuse_efficacy(
    clearness: Float[Array, "..."],
    brightness: Float[Array, "..."],
    sun_zenith: Float[Array, "..."],
) -> Float[Array, "..."]:
    """Luminous efficacy of the sky's light [lm/W]; Perez et al. (1990), equation 7.

    a + b W + c cos Z + d ln Δ with W = 2 cm of precipitable water; arguments as
    `all_weather_coefficients`.
    """
    a, b, c, d = _chosen("perez1990_luminous_efficacy", clearness)[:4]
    return a + b * PRECIPITABLE_WATER + c * jnp.cos(sun_zenith) + d * jnp.log(brightness)


def direct_efficacy(
    clearness: Float[Array, "..."],
    brightness: Float[Array, "..."],
    sun_zenith: Float[Array, "..."],
) -> Float[Array, "..."]:
    """Luminous efficacy of the sun's light [lm/W]; Perez et al. (1990), equation 8.

    a + b W + c e^{5.73 Z - 5} + d Δ, never negative; arguments as `all_weather_coefficients`.
    """
    a, b, c, d = _chosen("perez1990_luminous_efficacy", clearness)[4:]
    bend = c * jnp.exp(5.73 * jnp.clip(sun_zenith, 0.0, math.pi / 2) - 5)
    return jnp.maximum(a + b * PRECIPITABLE_WATER + bend + d * brightness, 0.0)


def _chosen(name, clearness):
    """The row of a table for a clearness, columns on the first axis."""
    start, *columns = read_table(name).values()
    bin_of = jnp.searchsorted(jnp.asarray(start[1:], clearness.dtype), clearness, side="right")
    return jnp.asarray(np.stack(columns), clearness.dtype)[:, bin_of]
