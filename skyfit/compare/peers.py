"""Models that other packages offer, to compare with."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float
from ..angles import as_sight
from ..colour import spectrum_to_xyY


# Hosek and Wilkie's tables are for turbidities 1 to 10 and end at 720 nm, where the eye does.
WAVELENGTHS = np.arange(380.0, 721.0, 20.0)
# At 720 nm itself Mitsuba 3.9 reads past the end of its tables, NaN in half of all processes.
LONGEST = float(np.nextafter(np.float32(720), np.float32(0)))


@dataclass(frozen=True)
class HosekWilkieSky:
    """The sky of Hosek & Wilkie (2012) without the sun, by Mitsuba 3's `sunsky` emitter.

    Needs the package `mitsuba` (`pip install 'skyfit[peers]'`), and is no part of JAX: no
    derivatives, no compilation.

    Source: Hosek & Wilkie (2012), "An Analytic Model for Full Spectral Sky-Dome Radiance", ACM
    Transactions on Graphics 31(4).

    Attributes:
        turbidity: 1 to 10; held at the nearest end outside.
        ground_albedo: Albedo of the ground, 0 to 1.
    """

    turbidity: float
    ground_albedo: float = 0.0
    valid_range: dict[str, tuple[float, float]] = field(
        default_factory=lambda: {"turbidity": (1.0, 10.0), "sun_zenith": (0.0, math.pi / 2)}
    )

    def radiance(
        self,
        sun_zenith: ArrayLike,
        view_zenith: ArrayLike,
        relative_azimuth: ArrayLike,
        wavelengths: ArrayLike,
    ) -> Float[Array, "*batch wavelength"]:
        """Spectral radiance [W m⁻² sr⁻¹ nm⁻¹]; black with the sun below the horizon.

        Args:
            sun_zenith: Zenith angle of the sun, one [rad].
            view_zenith: Zenith angle of the view direction [rad].
            relative_azimuth: View azimuth minus sun azimuth [rad].
            wavelengths: Wavelengths on one axis, each from 320 to 720 [nm].
        """
        as_sight(sun_zenith, view_zenith, relative_azimuth, "sky")
        view, azimuth = np.broadcast_arrays(view_zenith, relative_azimuth)
        wanted = np.asarray(wavelengths, float)
        spectra = np.zeros((*view.shape, wanted.size))
        sun = float(np.asarray(sun_zenith))
        if sun <= math.pi / 2:
            look = _emitter(float(np.clip(self.turbidity, 1, 10)), self.ground_albedo, sun)
            for place in np.ndindex(view.shape):
                spectra[place] = look(float(view[place]), float(azimuth[place]), wanted)
        return as_float(spectra)

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; arguments as `radiance`."""
        spectra = self.radiance(sun_zenith, view_zenith, relative_azimuth, WAVELENGTHS)
        return spectrum_to_xyY(spectra, WAVELENGTHS)


def _emitter(turbidity: float, ground_albedo: float, sun: float):
    """A function of view zenith, azimuth and wavelengths that asks Mitsuba."""
    import drjit
    import mitsuba

    mi: Any = mitsuba
    dr: Any = drjit
    mi.set_variant("scalar_spectral")
    emitter = mi.load_dict(
        {
            "type": "sunsky",
            "sun_direction": [math.sin(sun), 0.0, math.cos(sun)],
            "turbidity": turbidity,
            "albedo": ground_albedo,
            "sun_scale": 0.0,
        }
    )
    # Zeros: a plain `SurfaceInteraction3f()` holds whatever was in that memory.
    interaction = dr.zeros(mi.SurfaceInteraction3f)

    def look(view: float, azimuth: float, wavelengths: np.ndarray) -> np.ndarray:
        sine = math.sin(view)
        toward = (sine * math.cos(azimuth), sine * math.sin(azimuth), math.cos(view))
        interaction.wi = [-part for part in toward]
        found = []
        # Four wavelengths at a time; the last are filled up with the last one.
        for first in range(0, wavelengths.size, 4):
            four = np.minimum(wavelengths, LONGEST)[first : first + 4]
            interaction.wavelengths = [*four, *[four[-1]] * (4 - four.size)]
            found.extend(list(emitter.eval(interaction))[: four.size])
        return np.array(found)

    return look
