"""The atmosphere of Preetham, Shirley & Smits (1999): molecules, haze, ozone and sun.

"A Practical Analytic Model for Daylight", SIGGRAPH 1999: section 3.2, appendices A.1 to A.3,
tables 1 and 2. The misprints mended here are listed in the README.
"""

from typing import Literal, get_args

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from . import constants
from ._typing import (
    Array,
    ArrayLike,
    Scalar,
    Spectrum,
    as_float,
    as_parameter,
    as_scalar,
    as_wavelengths,
    check,
)
from .atmosphere import Atmosphere, Constituent
from .errors import InputError
from .phase import Rayleigh, Tabulated
from .profile import (
    AbstractProfile,
    StandardAtmosphere,
    Tabulated as TabulatedProfile,
    elterman_haze,
)
from .spectrum import PAPER_WAVELENGTHS
from .tables import read_table


OZONE_AMOUNT = 0.0035  # m at NTP; Preetham et al. (1999), appendix A.1
TurbidityMeaning = Literal["optical thickness", "coefficients"]
TURBIDITY_MEANINGS: tuple[str, ...] = get_args(TurbidityMeaning)


def rayleigh_scattering(wavelengths: ArrayLike) -> Float[Array, "..."]:
    """Scattering coefficient of air at the ground, β_m [m⁻¹].

    8π³ (n² - 1)² / (3 N λ⁴) · (6 + 3p) / (6 - 7p); Preetham et al. (1999), appendix A.3. Gives
    6.95e-6, 1.18e-5 and 2.44e-5 at 650, 570 and 475 nm, as Hoffman & Preetham (2002) print.

    Args:
        wavelengths: Wavelengths, any shape [nm].
    """
    lam = 1e-9 * as_float(wavelengths)
    p = constants.PAPER_DEPOLARISATION
    refraction = (constants.AIR_REFRACTIVE_INDEX**2 - 1) ** 2
    king = (6 + 3 * p) / (6 - 7 * p)
    strength = 8 * np.pi**3 * refraction / (3 * constants.AIR_NUMBER_DENSITY) * king
    # Two squares, since λ⁴ ~ 1e-26 m⁴ and its inverse leave float32 little room.
    return float(strength) / lam**2 / lam**2


def haze_scattering(turbidity: ArrayLike, wavelengths: ArrayLike) -> Float[Array, "..."]:
    """Scattering coefficient of haze at the ground by appendix A.3 as it stands, β_p [m⁻¹].

    0.434 c π (2π/λ)^{v-2} K(λ) with v = 4 and c = (0.6544 T - 0.6510)·1e-18. The paper prints
    1e-16, which is 100 times too much: 1e-18 gives 7.9e-5 m⁻¹ at T = 2, 550 nm.

    Args:
        turbidity: T, 1 or more.
        wavelengths: Wavelengths, any shape [nm].

    Returns:
        In the shape of `wavelengths`.
    """
    concentration = (0.6544 * as_float(turbidity) - 0.6510) * 1e-18
    lam = 1e-9 * as_float(wavelengths)
    power = (2 * np.pi / lam) ** (constants.JUNGE_EXPONENT - 2)
    return 0.434 * np.pi * concentration * power * table2("K", wavelengths)


def haze_phase(wavelengths: ArrayLike) -> Tabulated:
    """Phase function of the haze: table 1's η, normalised.

    Log-linear in angle, constant within 1° of forward; linear in wavelength, constant beyond
    400–850 nm. Twice π K is the sphere's integral of η; the tables agree within 1 %.
    """
    lam = jnp.atleast_1d(as_parameter(wavelengths))
    return _haze_phase(_eta(lam))


def _eta(lam: Spectrum) -> Float[Array, "angle wavelength"]:
    """Table 1 at wavelengths."""
    table = read_table("preetham1999_table1_mie_eta")
    names = [name for name in table if name.startswith("eta_")]
    tabulated_at = as_parameter([float(name[4:-2]) for name in names])
    rows = as_parameter(np.stack([table[name] for name in names], axis=1))
    return jax.vmap(lambda row: jnp.interp(lam, tabulated_at, row))(rows)


def _haze_phase(eta: Float[Array, "angle wavelength"]) -> Tabulated:
    angle = read_table("preetham1999_table1_mie_eta")["scattering_angle_deg"]
    return Tabulated(np.radians(angle), eta)


def solar_irradiance(wavelengths: ArrayLike) -> Float[Array, "..."]:
    """Sunlight above the atmosphere, normal to the beam [W m⁻² nm⁻¹].

    Table 2's radiance of the disc times its solid angle of 6.80e-5 sr. Table 2 ends at 750 nm;
    beyond, ASTM G173-03's extraterrestrial spectrum continues it to 780 nm, scaled to join there.
    Constant below 380 and above 780 nm.
    """
    return constants.SUN_SOLID_ANGLE * table2("sun_W_m-2_nm-1_sr-1", wavelengths)


def ozone_layer() -> TabulatedProfile:
    """Ozone density: a tent from 10 to 40 km with its peak of 1 at 25 km.

    Source: Bruneton (2017), "Precomputed Atmospheric Scattering: a New Implementation". Its column
    is 15 km.
    """
    return TabulatedProfile([0.0, 10e3, 25e3, 40e3], [0.0, 0.0, 1.0, 0.0])


def preetham_atmosphere(
    turbidity: ArrayLike,
    *,
    wavelengths: ArrayLike | None = None,
    turbidity_means: TurbidityMeaning = "optical thickness",
    haze_density: AbstractProfile | None = None,
    ozone: bool = False,
    ground_albedo: ArrayLike = 0.0,
) -> Atmosphere:
    """The paper's atmosphere: U.S. Standard air, Elterman's haze to 32 km, its sun.

    Args:
        turbidity: T, 1 (no haze) or more.
        wavelengths: 380 to 780 nm by 10 if not given; beyond these limits table 2's spectra are
            held constant [nm].
        turbidity_means: "optical thickness" for the definition T = (t_m + t_h) / t_m at 550 nm;
            "coefficients" for appendix A.3's haze coefficient at the ground, whose optical
            thickness makes T = 2 … 6 into 2.09 … 6.45 with Elterman's profile.
        haze_density: Profile of the haze in place of Elterman's.
        ozone: Absorb by 3.5 mm of ozone in a layer around 25 km. The paper's simulation has none.
        ground_albedo: The paper's is 0; one value or one per wavelength.

    Raises:
        InputError: Turbidity below 1 or NaN; an unknown meaning.
    """
    if turbidity_means not in TURBIDITY_MEANINGS:
        raise InputError(
            "preetham_atmosphere(turbidity_means=...): expected 'optical thickness' or "
            f"'coefficients'; got {turbidity_means!r}"
        )
    value = as_scalar(turbidity, "preetham_atmosphere(turbidity=...)")
    message = "preetham_atmosphere(turbidity=...) must be 1 or more"
    value = check(value, lambda v: ~((v >= 1) & (v < np.inf)), message)
    wavelengths = PAPER_WAVELENGTHS if wavelengths is None else wavelengths
    lam = as_wavelengths(wavelengths, "preetham_atmosphere(wavelengths=...)")
    density = elterman_haze() if haze_density is None else haze_density
    by_definition = turbidity_means == "optical thickness"
    beta_air, beta_haze, eta, sun, ozone_absorption = _spectra(value, lam, density, by_definition)
    air = Constituent(StandardAtmosphere(), beta_air, phase=Rayleigh())
    haze = Constituent(density, beta_haze, phase=_haze_phase(eta))
    layer = Constituent(ozone_layer(), 0.0, ozone_absorption, phase=Rayleigh())
    constituents = (air, haze, layer) if ozone else (air, haze)
    return Atmosphere(lam, sun, constituents, ground_albedo)


def table2(column: str, wavelengths: ArrayLike) -> Float[Array, "..."]:
    """A column of table 2, linear between its wavelengths and constant beyond 380 and 780 nm.

    Blank absorption coefficients are 0. The sun's column has none at 760 to 780 nm and is
    continued; see `solar_irradiance`.
    """
    table = read_table("preetham1999_table2_spectra")
    values = np.nan_to_num(table[column]) if column.startswith("k_") else table[column].copy()
    if column.startswith("sun_"):
        rest = read_table("astm_g173_extraterrestrial")
        scale = values[table["wavelength_nm"] == 750] / rest["irradiance_W_m-2_nm-1"][0]
        blank = np.isnan(values)
        values[blank] = scale * np.interp(
            table["wavelength_nm"][blank], rest["wavelength_nm"], rest["irradiance_W_m-2_nm-1"]
        )
    lam = as_float(wavelengths)
    return jnp.interp(
        lam, jnp.asarray(table["wavelength_nm"], lam.dtype), jnp.asarray(values, lam.dtype)
    )


@eqx.filter_jit
def _spectra(
    turbidity: Scalar, lam: Spectrum, haze: AbstractProfile, by_definition: bool
) -> tuple[Spectrum, Spectrum, Float[Array, "angle wavelength"], Spectrum, Spectrum]:
    """All that the atmosphere's spectra take: β_m, β_p, η, sun, ozone; in one compiled program."""
    beta_air, beta_haze = rayleigh_scattering(lam), haze_scattering(turbidity, lam)
    if by_definition:
        at = as_parameter(constants.TURBIDITY_WAVELENGTH)
        top = constants.TOP_OF_ATMOSPHERE
        air_depth = rayleigh_scattering(at) * StandardAtmosphere().column(top)
        haze_depth = haze_scattering(turbidity, at) * haze.column(top)
        beta_haze = beta_haze * (turbidity - 1) * air_depth / haze_depth
    ozone_column = ozone_layer().column(constants.TOP_OF_ATMOSPHERE)
    ozone = table2("k_ozone_m-1", lam) * OZONE_AMOUNT / ozone_column
    return beta_air, beta_haze, _eta(lam), solar_irradiance(lam), ozone
