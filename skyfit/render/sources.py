"""What a picture can show: skies as luminance and colour over direction, each with its sun."""

import abc
from typing import Any

import numpy as np
from jaxtyping import Float

from .._typing import as_scalar
from ..atmosphere import Atmosphere
from ..colour import spectrum_to_xyz, xyY_to_xyz
from ..errors import InputError
from ..models.base import AbstractSkyModel
from ..sun.light import sun_xyY, visible_fraction
from .cameras import direction_of
from .sun_disc import disc_radiance, hidden_sine


class AbstractSource(abc.ABC):
    """A sky under one sun at a time. Unit vectors are east, north, up.

    Attributes:
        has_ground: Whether the source answers below the horizon; else the picture adds a ground.
        ground_albedo: Albedo of that ground, unless the caller says otherwise.
        name: Name of the sky, in a few words.
    """

    has_ground: bool = False
    ground_albedo: float = 0.2
    name: str

    @abc.abstractmethod
    def xyz(
        self, direction: Float[np.ndarray, "ray 3"], sun_zenith: float, sun_azimuth: float
    ) -> Float[np.ndarray, "ray 3"]:
        """CIE XYZ [cd m⁻²] along lines of sight, without the sun's disc.

        Args:
            direction: Directions of the lines of sight.
            sun_zenith: Zenith angle of the sun [rad].
            sun_azimuth: Compass azimuth of the sun [rad].
        """

    @abc.abstractmethod
    def sun_xyz(self, sun_zenith: float) -> Float[np.ndarray, " 3"]:
        """Mean CIE XYZ [cd m⁻²] of the sun's disc as it is seen; 0 if set.

        Raises:
            InputError: It is not known what dims the sun of this source.
        """

    def is_day(self, sun_zenith: float) -> bool:
        """Whether some of what is above the horizontal must be bright under a sun [rad]."""
        return bool(sun_zenith < np.pi / 2)

    def horizon(self) -> float:
        """Sine of the horizon's elevation."""
        return 0.0

    def sun_range(self) -> tuple[float, float]:
        """Zenith angles of the suns that the sky was made for [rad]."""
        return 0.0, np.pi

    def identity(self) -> Any:
        """All that this sky is made of: numbers, words, arrays, skyfit's models; None by itself.

        An interrupted `animate` is continued under the sky that has the same. A class that does
        not define it is never continued, not even if its parent does.
        """
        return None


class ModelSource(AbstractSource):
    """A fitted or published model.

    Args:
        model: The sky.
        turbidity: Turbidity of the air before the sun; None if unknown.
        name: Name of the sky.
    """

    def __init__(self, model: AbstractSkyModel, turbidity: float | None, name: str):
        self.model, self.turbidity, self.name = model, turbidity, name

    def xyz(self, direction, sun_zenith, sun_azimuth):  # noqa: D102
        sun = direction_of(sun_zenith, sun_azimuth).astype(direction.dtype)
        return np.asarray(self.model.xyz(direction, sun))

    def sun_xyz(self, sun_zenith):  # noqa: D102
        return sun_through_haze(self.name, self.turbidity, sun_zenith)

    def sun_range(self):
        """Zenith angles of the suns that the sky was made for [rad].

        How a sky dims at night is the same for all models that are made for the whole day.
        """
        low, high = self.model.valid_range["sun_zenith"]
        return low, (np.pi if high >= np.pi / 2 - 1e-6 else high)

    def identity(self) -> Any:  # noqa: D102
        return self.model, self.turbidity


def sun_through_haze(
    name: str, turbidity: float | None, sun_zenith: float
) -> Float[np.ndarray, " 3"]:
    """Mean CIE XYZ [cd m⁻²] of what is above the horizon of the sun's disc; see `skyfit.sunlight`.

    Raises:
        InputError: The turbidity is not known.
    """
    if turbidity is None:
        raise InputError(
            f"{name}: what dims the sun is unknown; expected a turbidity, or a picture without the "
            "sun's disc"
        )
    above = float(visible_fraction(as_scalar(sun_zenith, "sun_zenith")))
    if above < 1e-6:
        return np.zeros(3)
    return np.asarray(xyY_to_xyz(sun_xyY(turbidity, sun_zenith))) / above


def sun_through(air: Atmosphere, sun_zenith: float, altitude: float) -> Float[np.ndarray, " 3"]:
    """Mean CIE XYZ [cd m⁻²] of the sun's disc through an atmosphere."""
    zenith, height = as_scalar(sun_zenith, "sun_zenith"), as_scalar(altitude, "altitude")
    light = disc_radiance(air, zenith, height)
    return np.asarray(spectrum_to_xyz(light, air.wavelengths))


def horizon_of(air: Atmosphere, altitude: float) -> float:
    """Sine of the horizon's elevation from an altitude [m]."""
    return hidden_sine(air, altitude)
