"""Simulated skies as sources: simulated on a few directions, interpolated to every pixel.

Around the sun light follows the phase functions, too sharp for a coarse grid. So the first order of
each constituent is simulated by itself, its phase function divided out, the smooth rest put on the
grid, and the phase function at the pixel's own angle to the sun multiplied in again. What all other
light makes of a peak is divided and multiplied likewise, by how it falls off beside the sun.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import Float

from ..atmosphere import Atmosphere, Constituent
from ..colour import xyz_weights
from ..errors import InputError
from ..transfer.simulate_sky import simulate
from ..transfer.trust import warn_of_straight_rays
from .cameras import direction_of
from .dome_table import DomeTable, Zone, spokes
from .falloff import GLOW_ENDS, Falloff, beside_the_sun, crowding, glow, phase_of_light
from .sources import AbstractSource, horizon_of, sun_through


RINGS, SPOKES = 28, 25
_BLACK = 1e-9  # of the zone's brightest, added before the logarithm
_NOTHING = 30  # roundings of the brightest: what may be left where there is no light
_VISIBLE = 0.01  # of a sky's light
_NIGHT = 5e-4  # cd/m²: a moonless night's own light, which no simulated sky has
# At the limb constituents end at altitudes of their own, and after sunset where the planet's shadow
# begins: a logarithm would make cliffs of that.
_CLIFF_BLACK = 3e-3


class _Part(NamedTuple):
    """Light of one kind in one zone: colours on the grid, logarithmic, and what multiplies them."""

    tables: tuple[DomeTable, DomeTable, DomeTable]
    black: float
    falloff: Falloff | None


class SimulatedSource(AbstractSource):
    """The simulated sky of an atmosphere.

    Against the simulation itself, direction by direction, luminance seen from the ground is within
    0.02 % (root mean square; 0.2 % at worst) for suns 20° to 88° from the zenith at turbidity 3. In
    dust of mean cosine 0.95 it is within 1 % from 0.3° to 45° beside the sun.

    Args:
        atmosphere: Air that scatters and absorbs.
        name: Name of the sky.
        orders: Number of orders of scattering; None for all.
        quality: Quality of the simulation, as of `skyfit.simulate`.
        observer_altitude: Altitude of the eye [m]; above 0 the planet is seen as well.
        grid: Rings in each zone and azimuths in half a turn at which the sky is simulated.

    Raises:
        InputError: There is no visible sunlight; later, when a picture asks: simulated light is
            negative.
    """

    def __init__(
        self,
        atmosphere: Atmosphere,
        name: str,
        orders: int | None = 2,
        quality: str = "default",
        observer_altitude: float = 0.0,
        grid: tuple[int, int] = (RINGS, SPOKES),
    ):
        warn_of_straight_rays(
            atmosphere,
            f"{name}: the sun and its glare are drawn where the sun stands without refraction, "
            "up to 0.6 degrees too low at sunset",
        )
        self.atmosphere, self.name = atmosphere, name
        self.orders, self.quality = orders, quality
        self.observer_altitude = observer_altitude
        self.grid = grid
        self.has_ground = observer_altitude > 0
        weights = np.asarray(xyz_weights(atmosphere.wavelengths))
        seen = weights[:, 1] * np.asarray(atmosphere.solar_irradiance)
        if not seen.any():
            first, last = (float(atmosphere.wavelengths[k]) for k in (0, -1))
            raise InputError(
                f"{name}: expected sunlight that eyes see; got none from {first:g} to {last:g} nm"
            )
        self.ground_albedo = float(np.average(np.asarray(atmosphere.ground_albedo), weights=seen))
        self._weights = weights
        self._tables = lru_cache(maxsize=4)(self._simulate)

    def horizon(self):  # noqa: D102
        return horizon_of(self.atmosphere, self.observer_altitude)

    def is_day(self, sun_zenith):  # noqa: D102
        air = self.atmosphere
        scatters = any(np.any(np.asarray(one.scattering)) for one in air.constituents)
        return (
            super().is_day(sun_zenith)
            and scatters
            and self.observer_altitude < float(air.top_altitude)
        )

    def sun_xyz(self, sun_zenith):  # noqa: D102
        return sun_through(self.atmosphere, sun_zenith, self.observer_altitude)

    def identity(self) -> Any:  # noqa: D102
        return self.atmosphere, self.orders, self.quality, self.observer_altitude, self.grid

    def xyz(self, direction, sun_zenith, sun_azimuth):  # noqa: D102
        unit = direction.astype(float)
        zenith = np.arctan2(np.hypot(unit[:, 0], unit[:, 1]), unit[:, 2])
        azimuth = np.arctan2(unit[:, 0], unit[:, 1]) - sun_azimuth
        # The chord keeps small angles to the sun.
        chord = np.linalg.norm(unit - direction_of(sun_zenith, sun_azimuth), axis=1)
        gamma = 2 * np.arcsin(np.minimum(chord / 2, 1))
        light = np.zeros((len(unit), 3))
        for zone, parts in self._tables(float(sun_zenith)):
            here = zone.holds(zenith)
            for part in parts:
                light[here] += _read(part, zenith[here], azimuth[here], gamma[here])
        return light

    def zones(self) -> tuple[Zone, ...]:
        """Parts of the sphere between which the light jumps, or is none."""
        horizon = np.pi / 2 - np.arcsin(self.horizon())
        if self.observer_altitude == 0:
            return (Zone(0.0, np.pi / 2),)
        ground = Zone(np.pi, horizon)
        top, radius = (
            float(a) for a in (self.atmosphere.top_altitude, self.atmosphere.planet_radius)
        )
        if self.observer_altitude < top:
            return Zone(0.0, horizon), ground
        limb = np.pi - np.arcsin((radius + top) / (radius + self.observer_altitude))
        return Zone(limb, horizon), ground

    def _simulate(self, sun_zenith: float) -> list[tuple[Zone, list[_Part]]]:
        zones = self.zones()
        view, azimuth = self._directions(zones, sun_zenith)
        chord = np.linalg.norm(direction_of(view, azimuth) - direction_of(sun_zenith, 0.0), axis=-1)
        gamma = 2 * np.arcsin(np.minimum(chord / 2, 1))
        whole = self._light(self.atmosphere, self.orders, sun_zenith, view, azimuth)
        risen = len(view) > len(zones)
        scattered = self._first_orders(sun_zenith, view, azimuth, risen)
        rest = whole - sum(alone for alone, _ in scattered)
        self._refuse_negative(rest @ self._weights[:, 1], whole @ self._weights[:, 1])
        around = glow(rest[-1, :, 0] @ self._weights) if risen else None
        least = _NOTHING * np.finfo(whole.dtype).eps * whole.max()
        found = []
        for number, zone in enumerate(zones):
            kinds = [(rest, around if number == 0 else None, zone.open)]
            kinds += [(alone, phase, zone.open and risen) for alone, phase in scattered]
            parts = [
                _part(zone, light[number] @ self._weights, falloff, gamma[number], smooth)
                for light, falloff, smooth in kinds
                if not light[number].max() <= least  # NaN is shown, and refused
            ]
            found.append((zone, parts))
        return found

    def _first_orders(
        self, sun_zenith: float, view: np.ndarray, azimuth: np.ndarray, risen: bool
    ) -> list[tuple[np.ndarray, Falloff]]:
        """Of each constituent that scatters: its light, and its phase function in X, Y and Z.

        Where that depends on the wavelength light has another spectrum beside the sun than
        elsewhere, and another phase function: a glow makes up for it.
        """
        found = []
        for number, constituent in enumerate(self.atmosphere.constituents):
            if np.any(np.asarray(constituent.scattering)):
                alone = self._light(only(self.atmosphere, number), 1, sun_zenith, view, azimuth)
                spectrum = alone.mean(axis=(0, 1, 2))
                phase = phase_of_light(constituent.phase, spectrum, self._weights)
                if risen and not constituent.phase.is_grey:
                    beside = alone[-1, :, 0] @ self._weights
                    around = glow(beside / phase(crowding(len(beside), GLOW_ENDS)))
                    phase = phase if around is None else phase * around
                found.append((alone, phase))
        return found

    def _refuse_negative(self, rest: np.ndarray, whole: np.ndarray) -> None:
        """Expect no negative luminance [cd m⁻²] beyond the first order, which would hide some."""
        worst = np.argmax(-rest - _VISIBLE * whole)
        if -rest.flat[worst] > _VISIBLE * whole.flat[worst] + _NIGHT:
            raise InputError(
                f"{self.name}: expected light of 0 or more beyond the first order; simulated "
                f"{rest.flat[worst]:.3g} cd/m2 where all light is {whole.flat[worst]:.3g}; a "
                "higher quality or less sharp phase functions may help"
            )

    def _directions(
        self, zones: tuple[Zone, ...], sun_zenith: float
    ) -> Float[np.ndarray, "2 part ring spoke"]:
        """Zenith angles and azimuths from the sun's [rad] at which the sky is simulated.

        Each zone is a part. Under a risen sun, in an eye's own sky, one more part is
        `beside_the_sun`, the same on all spokes.
        """
        count, around = self.grid[0], spokes(self.grid[1])
        rings = np.stack([zone.rings(count) for zone in zones])
        # The very edges belong to the next zone: stay inside by a hundred-thousandth.
        edge = 1e-5 * (self.observer_altitude > 0) * np.sign(rings[:, -2] - rings[:, -1])
        rings[:, -1] += edge
        if self.observer_altitude > 0 and not zones[0].open:
            rings[0, 0] += 1e-5
        grids = np.stack(np.broadcast_arrays(rings[:, :, None], around))
        if not (zones[0].open and sun_zenith < zones[0].end):
            return grids
        line = beside_the_sun(count, sun_zenith)[:, None, :, None]
        return np.concatenate([grids, np.broadcast_to(line, (2, 1, *grids.shape[2:]))], axis=1)

    def _light(
        self,
        atmosphere: Atmosphere,
        orders: int | None,
        sun_zenith: float,
        view: np.ndarray,
        azimuth: np.ndarray,
    ) -> Float[np.ndarray, "part ring spoke wavelength"]:
        """Spectral radiance [W m⁻² sr⁻¹ nm⁻¹]."""
        sky = simulate(
            atmosphere, sun_zenith, view, azimuth, orders,
            quality=self.quality, observer_altitude=self.observer_altitude,
        )  # fmt: skip
        return np.asarray(sky.radiance)


def only(atmosphere: Atmosphere, number: int) -> Atmosphere:
    """The atmosphere in which one constituent scatters and the others only dim, over black."""

    def dimmed(one: Constituent) -> Constituent:
        absorption = one.absorption + one.scattering  # bands besides stay as they are
        return eqx.tree_at(
            lambda c: (c.scattering, c.absorption), one, (0 * one.scattering, absorption)
        )

    changed = tuple(
        one if k == number else dimmed(one) for k, one in enumerate(atmosphere.constituents)
    )
    black = 0 * atmosphere.ground_albedo
    return eqx.tree_at(lambda a: (a.constituents, a.ground_albedo), atmosphere, (changed, black))


def _part(
    zone: Zone, colours: np.ndarray, falloff: Falloff | None, gamma: np.ndarray, smooth: bool
) -> _Part:
    if falloff is not None:
        colours = colours / falloff(gamma)
    black = max((_BLACK if smooth else _CLIFF_BLACK) * float(colours.max()), 1e-30)
    logarithms = np.log(np.maximum(colours, 0.0) + black)
    tables = [DomeTable(zone, logarithms[..., k]) for k in range(3)]
    return _Part((tables[0], tables[1], tables[2]), black, falloff)


def _read(part: _Part, zenith: np.ndarray, azimuth: np.ndarray, gamma: np.ndarray) -> np.ndarray:
    logarithms = np.stack([table(zenith, azimuth) for table in part.tables], axis=-1)
    light = np.maximum(np.exp(logarithms) - part.black, 0.0)
    return light if part.falloff is None else light * part.falloff(gamma)
