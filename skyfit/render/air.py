"""The air between an eye and land, for the skies that pictures are made of."""

from ..aerial import AerialPerspective, ConstantAmbient, aerial_perspective, ward_larson_aerial
from ..errors import InputError
from .simulated import SimulatedSource
from .sources import AbstractSource, ModelSource


AIRS = ("paper", "ward-larson", "none")


def air_before(
    source: AbstractSource,
    sun_zenith: float,
    kind: str = "paper",
    ground_albedo: float = 0.2,
    *,
    sunlight: bool = True,
) -> AerialPerspective | ConstantAmbient | None:
    """Aerial perspective that belongs to a sky, in linear sRGB.

    Args:
        source: A model with a known turbidity, or a simulated atmosphere.
        sun_zenith: Zenith angle of the sun [rad].
        kind: "paper" for that of Preetham et al. (1999), "ward-larson" for the one they compare
            with, "none".
        ground_albedo: Albedo of the land, which lights the air too.
        sunlight: Whether the sun shines on the air; not under clouds.

    Raises:
        InputError: Another kind; a sky whose air is not known.
    """
    if kind not in AIRS:
        raise InputError(f"air_before(kind=...): expected one of {', '.join(AIRS)}; got {kind!r}")
    if kind == "none":
        return None
    if isinstance(source, SimulatedSource):
        air, sky, albedo = source.atmosphere, None, None
    elif isinstance(source, ModelSource) and source.turbidity is not None:
        air, sky, albedo = source.turbidity, source.model, ground_albedo
    else:
        raise InputError(f"{source.name}: its air is unknown; expected a turbidity, or no air")
    if kind == "ward-larson":
        return ward_larson_aerial(air, sky, sun_zenith, channels="rgb")
    return aerial_perspective(
        air, sky, sun_zenith, channels="rgb", ground_albedo=albedo,
        sun_irradiance=None if sunlight else 0.0,
    )  # fmt: skip
