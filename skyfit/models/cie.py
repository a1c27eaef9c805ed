"""The skies of the CIE: clear, overcast, intermediate, and the fifteen of the general sky.

They say how luminance is distributed, not its colour: the clear sky is given the published colour
of the zenith, the overcast one the flat spectrum's white, the others that of D65.
"""

from typing import Literal

import numpy as np

from .._typing import ArrayLike, as_float, as_parameter, check
from ..errors import InputError
from .levels import (
    ByIlluminance,
    ByZenith,
    ClearZenith,
    Given,
    MeanOf,
    OvercastZenith,
    PublishedZenith,
    SkyIlluminance,
)
from .luminance_sky import ConstantChromaticity, LuminanceSky, ZenithChromaticity
from .preetham import (
    TURBIDITY_RANGE,
    ZENITH_ANGLE,
    ZENITH_LUMINANCE,
    published_zenith_chromaticity,
    warn_outside,
)
from .scale import CubicZenith, TangentZenith
from .standard_skies import (
    SKY_TYPES,
    Intermediate,
    Overcast,
    clear_distribution,
    general_distribution,
)


FLAT_SPECTRUM = (1 / 3, 1 / 3)  # chromaticity of the overcast sky; Preetham et al. (1999), 5

# a, b [lx], c of a + b (sin h)^c for a cloudy, a partly cloudy and a clear sky; IES (1984), table 1
SKY_LIGHT = {
    "overcast": (300.0, 21000.0, 1.0),
    "partly cloudy": (300.0, 45000.0, 1.0),
    "clear": (800.0, 15500.0, 0.5),
}


def cie_clear_sky(
    turbidity: ArrayLike,
    *,
    turbid: bool = False,
    zenith: Literal["preetham", "karayel"] = "preetham",
) -> LuminanceSky:
    """The CIE's standard clear sky, made absolute by the luminance of its zenith.

    Args:
        turbidity: T; an array broadcasts against the angles. Held to 1.9 to 10.
        turbid: The variant for polluted air.
        zenith: Luminance of the zenith: "preetham" for that of `skyfit.preetham_sky`, "karayel" for
            (1.376 T - 1.81) tan h + 0.38 kcd/m², where T is Linke's turbidity.

    Raises:
        InputError: Turbidity below 1 or NaN; an unknown zenith.

    Source: CIE 110-1994; Preetham et al. (1999), equation 1.
    """
    if zenith not in ("preetham", "karayel"):
        raise InputError(
            f"cie_clear_sky(zenith=...): expected 'preetham' or 'karayel'; got {zenith!r}"
        )
    luminance = _published_zenith() if zenith == "preetham" else ClearZenith()
    return LuminanceSky(
        parameters={"turbidity": _turbidity(turbidity, "cie_clear_sky")},
        distribution=clear_distribution(turbid=turbid),
        level=ByZenith(luminance),
        chromaticity=_zenith_colour(),
        ranges=(("turbidity", TURBIDITY_RANGE),),
    )


def cie_overcast_sky() -> LuminanceSky:
    """The CIE's standard overcast sky: (1 + 2 cos θ) / 3 of the zenith's 123 + 8600 sin h cd/m².

    It puts 300 + 21 000 sin h lx on the ground for a sun of elevation h.

    Source: Moon & Spencer (1942); Krochmann & Seidl (1974).
    """
    return LuminanceSky(
        parameters={},
        distribution=Overcast(),
        level=ByZenith(OvercastZenith()),
        chromaticity=ConstantChromaticity(FLAT_SPECTRUM),
    )


def cie_intermediate_sky(turbidity: ArrayLike) -> LuminanceSky:
    """The CIE's intermediate sky, of thin or broken clouds.

    Its zenith is as bright as the mean of the clear one ("karayel") and the overcast one, as
    lighting programs have it.

    Args:
        turbidity: T of the air without clouds; as for `cie_clear_sky`.

    Raises:
        InputError: Turbidity below 1 or NaN.

    Source: Nakamura, Oki & Hayashi (1985); CIE 110-1994.
    """
    return LuminanceSky(
        parameters={"turbidity": _turbidity(turbidity, "cie_intermediate_sky")},
        distribution=Intermediate(),
        level=ByZenith(MeanOf(ClearZenith(), OvercastZenith())),
        chromaticity=ConstantChromaticity(),
        ranges=(("turbidity", TURBIDITY_RANGE),),
    )


def cie_general_sky(sky_type: int, *, diffuse_illuminance: ArrayLike | None = None) -> LuminanceSky:
    """One of the fifteen relative distributions of the CIE standard general sky.

    Types 1 to 5 are overcast, 6 to 10 partly cloudy, 11 to 15 clear; 12 is the standard clear sky.

    Args:
        sky_type: 1 to 15.
        diffuse_illuminance: What the sky without the sun puts on the ground, whatever the sun by
            day [lx]. If not given, it follows the sun's elevation h by the formulas of the IES
            (1984): 300 + 21 000 sin h, 300 + 45 000 sin h and 800 + 15 500 √sin h.

    Raises:
        InputError: An unknown type; an illuminance below 0.

    Source: ISO 15469:2004 / CIE S 011/E:2003.
    """
    if sky_type not in SKY_TYPES:
        raise InputError(f"cie_general_sky(sky_type=...): expected 1 to 15; got {sky_type!r}")
    if diffuse_illuminance is None:
        parameters = {}
        kind = "overcast" if sky_type <= 5 else "partly cloudy" if sky_type <= 10 else "clear"
        quantity = SkyIlluminance(as_parameter(SKY_LIGHT[kind]))
    else:
        message = "cie_general_sky(diffuse_illuminance=...) must be 0 or more"
        light = check(as_float(diffuse_illuminance), lambda v: ~((v >= 0) & (v < np.inf)), message)
        parameters, quantity = {"diffuse_illuminance": light}, Given("diffuse_illuminance")
    return LuminanceSky(
        parameters=parameters,
        distribution=general_distribution(sky_type),
        level=ByIlluminance(quantity),
        chromaticity=ConstantChromaticity(),
    )


def _turbidity(value, name):
    argument = f"{name}(turbidity=...)"
    value = check(as_float(value), lambda v: ~(v >= 1), f"{argument} must be 1 or more")
    warn_outside(value, TURBIDITY_RANGE, argument)
    return value


def _published_zenith():
    return PublishedZenith(
        TangentZenith(as_parameter(ZENITH_LUMINANCE), as_parameter(ZENITH_ANGLE))
    )


def _zenith_colour():
    x, y = (CubicZenith(as_parameter(matrix)) for matrix in published_zenith_chromaticity())
    return ZenithChromaticity(x, y)
