"""Which skies to simulate: an atmosphere, what it is swept over, suns and directions."""

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..atmosphere import Atmosphere
from ..errors import InputError
from ..spectrum import PAPER_WAVELENGTHS
from ..transfer.quality import QUALITIES
from .checks import axis_of, one_of
from .description import DescribedAtmosphere, PaperAtmosphere, Sweep
from .description.sweep import GROUND_ALBEDO, OBSERVER_ALTITUDE
from .directions import PAPER_SUN_ZENITHS_DEG, Values, paper_directions
from .given import (
    KIND,
    AtmosphereFunction,
    build_given,
    call_given,
    given_of,
    given_record,
)
from .places import SAMPLE, places_of, swept_by_name, without_observer
from .swept import find_swept


GEOMETRIES = ("spherical", "flat", "paper")

SCHEMA = "skyfit/campaign/1"
# What a record can hold in memory; more is several campaigns.
MOST_DIRECTIONS, MOST_NUMBERS, MOST_ORDERS = 100_000, 200_000_000, 100
Described = PaperAtmosphere | DescribedAtmosphere  # what can be described in words


@dataclass(frozen=True, init=False, eq=False)
class Campaign:
    """The skies to simulate; `Campaign()` is the paper's 5 turbidities × 12 suns × 343 directions.

    Two campaigns are equal if the same skies come of them. An atmosphere that a program gives is
    compared number by number; a function is called once for each value, here.

    Args:
        turbidity: Swept turbidities, increasing, 1 or more, of the paper's atmosphere or of a
            function that takes a turbidity; the paper's five by default.
        sun_zenith: Zenith angles of the sun, increasing, in [0, π] [rad].
        view_zenith: Zenith angle of every direction, in [0, π] [rad].
        relative_azimuth: Azimuth of every direction from the sun, as many as `view_zenith` [rad].
        wavelengths: Wavelengths, increasing; by default those of an `Atmosphere`, else 380 to 780
            by 10 [nm].
        atmosphere: Air that the sky is made of; the paper's by default. An `Atmosphere`; a function
            that is called with the swept values under their names, as in `air(turbidity=3.0)`, and
            returns one; a `PaperAtmosphere`; or the atmosphere of a campaign file.
        orders: Orders of scattering, 1 or more; None for all.
        geometry: "spherical", "flat" or "paper" (flat where the view zenith is below 70°).
        quality: Size of the simulator's quadratures: "draft", "default" or "high".
        observer_altitude: Altitude of the observer, 0 or more [m].
        keep_orders: Whether to keep the radiance of each order of scattering too.
        sweep: Parameters other than turbidity with their values, increasing, as in
            `{"dust": [0.1, 0.2], "observer_altitude": [0.0, 2000.0]}`: arguments of a function,
            `ground_albedo` of the paper's atmosphere, `observer_altitude` [m] of any; or the
            `Sweep`s of a file. None for turbidity alone, or for nothing.
        samples: Number of places that fill the ranges of what is swept, in place of every
            combination of its values: the corners first, then Halton's sequence. None for the
            combinations.

    Raises:
        InputError: Naming the argument, what was expected and what came.
    """

    turbidity: tuple[float, ...]
    sun_zenith: tuple[float, ...]
    view_zenith: tuple[float, ...]
    relative_azimuth: tuple[float, ...]
    wavelengths: tuple[float, ...]
    atmosphere: Described | Atmosphere | AtmosphereFunction
    orders: int | None
    geometry: str
    quality: str
    observer_altitude: float
    keep_orders: bool
    sweep: tuple[Sweep, ...]
    samples: int | None
    _built: tuple[Atmosphere, ...] = field(init=False, repr=False)

    def __init__(
        self,
        turbidity: Values | None = None,
        sun_zenith: Values | None = None,
        view_zenith: Values | None = None,
        relative_azimuth: Values | None = None,
        wavelengths: Values | None = None,
        atmosphere: Described | Atmosphere | AtmosphereFunction | None = None,
        orders: int | None = 2,
        geometry: str = "spherical",
        quality: str = "default",
        observer_altitude: float = 0.0,
        keep_orders: bool = False,
        sweep: Sweep | Sequence[Sweep] | Mapping[str, Values] | None = None,
        samples: int | None = None,
    ):
        if (view_zenith is None) != (relative_azimuth is None):
            raise InputError(
                "Campaign: view_zenith and relative_azimuth describe the directions together; "
                "got only one of them"
            )
        if sun_zenith is None:
            sun_zenith = np.radians(PAPER_SUN_ZENITHS_DEG)
        if view_zenith is None or relative_azimuth is None:
            view_zenith, relative_azimuth = paper_directions()
        angles = axis_of("view_zenith", view_zenith, 0.0, np.pi, increasing=False)
        azimuths = axis_of(
            "relative_azimuth", relative_azimuth, -4 * np.pi, 4 * np.pi, increasing=False
        )
        if len(angles) != len(azimuths):
            raise InputError(
                "Campaign: expected as many relative_azimuth as view_zenith, one a direction; "
                f"got {len(azimuths)} and {len(angles)}"
            )
        if len(angles) > MOST_DIRECTIONS:
            raise InputError(
                f"Campaign(view_zenith=...): expected at most {MOST_DIRECTIONS} directions; got "
                f"{len(angles)}"
            )
        if orders is not None and (isinstance(orders, bool) or not 1 <= orders <= MOST_ORDERS):
            raise InputError(
                f"Campaign(orders=...): expected 1 to {MOST_ORDERS}, or None for all; got {orders}"
            )
        one_of("Campaign", "geometry", geometry, GEOMETRIES)
        one_of("Campaign", "quality", quality, tuple(QUALITIES))
        if not 0 <= observer_altitude < np.inf:
            raise InputError(
                f"Campaign(observer_altitude=...): expected 0 m or more; got {observer_altitude}"
            )
        atmosphere = PaperAtmosphere() if atmosphere is None else atmosphere
        turbidities, sweeps = find_swept(atmosphere, turbidity, sweep)
        places = places_of(turbidities, sweeps, samples)
        built: tuple[Atmosphere, ...] = ()
        if not isinstance(atmosphere, Described):
            built = build_given(atmosphere, [without_observer(one, sweeps) for one in places])
            wavelengths = _wavelengths_of(built[0], wavelengths)
        elif wavelengths is None:
            wavelengths = PAPER_WAVELENGTHS
        fields = {
            "turbidity": turbidities,
            "sun_zenith": axis_of("sun_zenith", sun_zenith, 0.0, np.pi),
            "view_zenith": angles,
            "relative_azimuth": azimuths,
            "wavelengths": axis_of("wavelengths", wavelengths, 1.0, 1e6),
            "atmosphere": atmosphere,
            "orders": orders,
            "geometry": geometry,
            "quality": quality,
            "observer_altitude": float(observer_altitude),
            "keep_orders": keep_orders,
            "sweep": sweeps,
            "samples": samples,
            "_built": built,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        numbers = self.num_skies * len(angles) * len(self.wavelengths)
        numbers *= 1 if not keep_orders else orders or MOST_ORDERS
        if numbers > MOST_NUMBERS:
            raise InputError(
                f"Campaign: expected at most {MOST_NUMBERS} radiances; {self.num_skies} skies of "
                f"{len(angles)} directions and {len(self.wavelengths)} wavelengths make {numbers}"
            )

    @property
    def swept(self) -> dict[str, tuple[float, ...]]:
        """Values of every swept parameter by its name; of a sample, the ends of their ranges."""
        return swept_by_name(self.turbidity, self.sweep)

    @cached_property
    def places(self) -> tuple[dict[str, float], ...]:
        """Values of what is swept, by name, for every atmosphere, in the order of the dataset."""
        return places_of(self.turbidity, self.sweep, self.samples)

    @property
    def sky_dims(self) -> tuple[str, ...]:
        """Dimensions of the dataset that tell skies apart."""
        front = self.swept if self.samples is None else (SAMPLE,)
        return (*front, "sun_zenith")

    @property
    def sky_shape(self) -> tuple[int, ...]:
        """Sizes of these dimensions."""
        sizes = [len(values) for values in self.swept.values()]
        return (*(sizes if self.samples is None else [self.samples]), len(self.sun_zenith))

    @property
    def num_skies(self) -> int:
        """Skies, that is places times suns."""
        return math.prod(self.sky_shape)

    def build_atmosphere(self, *values: float, **swept: float) -> Atmosphere:
        """The atmosphere for values of what is swept, in the dataset's order or by name.

        Raises:
            InputError: A value is missing, or one of another parameter is given.
        """
        place = self._place(values, swept)
        wavelengths = np.asarray(self.wavelengths)
        keys = {one.key: place[one.name] for one in self.sweep}
        if isinstance(self.atmosphere, PaperAtmosphere):
            turbidity = place["turbidity"]
            return self.atmosphere.build(turbidity, wavelengths, keys.get(GROUND_ALBEDO))
        if isinstance(self.atmosphere, DescribedAtmosphere):
            return self.atmosphere.build(wavelengths, keys)
        if isinstance(self.atmosphere, Atmosphere):
            return self.atmosphere
        places = self.places
        if place in places:
            return self._built[places.index(place)]
        return call_given(self.atmosphere, without_observer(place, self.sweep))

    def observer_altitude_at(self, *values: float, **swept: float) -> float:
        """Altitude of the observer [m] for values of what is swept, given as for the atmosphere.

        Raises:
            InputError: A value is missing, or one of another parameter is given.
        """
        place = self._place(values, swept)
        names = [one.name for one in self.sweep if one.key == OBSERVER_ALTITUDE]
        return place[names[0]] if names else self.observer_altitude

    def _place(self, values: tuple[float, ...], named: Mapping[str, float]) -> dict[str, float]:
        """Values in the dataset's order."""
        names = list(self.swept)
        given = {**dict(zip(names, values, strict=False)), **named}
        if set(given) != set(names) or len(values) + len(named) != len(names):
            got = ", ".join((*map(str, values), *named)) or "none"
            raise InputError(
                f"Campaign: expected values of {', '.join(names) or 'nothing'}; got {got}"
            )
        return {name: float(given[name]) for name in names}

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers and words, for JSON."""
        fields = {one.name: getattr(self, one.name) for one in dataclasses.fields(self) if one.init}
        air = self.atmosphere
        ours = isinstance(air, Described)
        fields["atmosphere"] = air.to_dict() if ours else given_record(self._built)
        sweeps = [dataclasses.asdict(one) for one in self.sweep]
        fields["sweep"] = sweeps if len(sweeps) > 1 else next(iter(sweeps), None)
        if self.samples is None:  # as in records of before there were samples
            del fields["samples"]
        return {"schema": SCHEMA, **fields}

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> "Campaign":
        """Undo `to_dict`.

        Raises:
            InputError: The record is of another schema, or a value is impossible.
        """
        fields = dict(record)
        if (schema := fields.pop("schema", "missing")) != SCHEMA:
            raise InputError(f"Campaign.from_dict: schema is {schema!r}, expected {SCHEMA!r}")
        fields["turbidity"] = fields["turbidity"] or None
        sweeps = fields.get("sweep") or []
        sweeps = [Sweep(**one) for one in ([sweeps] if isinstance(sweeps, dict) else sweeps)]
        fields["sweep"] = tuple(sweeps)
        kind = fields["atmosphere"].get("kind", PaperAtmosphere.kind)
        if kind == KIND:
            places = places_of(tuple(fields["turbidity"] or ()), sweeps, fields.get("samples"))
            places = [without_observer(one, sweeps) for one in places]
            fields["atmosphere"] = given_of(fields["atmosphere"], places)
        else:
            home = PaperAtmosphere if kind == PaperAtmosphere.kind else DescribedAtmosphere
            fields["atmosphere"] = home.from_dict(fields["atmosphere"])
        return cls(**fields)

    def __eq__(self, other: object) -> bool:
        """Whether the same skies come of both."""
        return isinstance(other, Campaign) and self.to_dict() == other.to_dict()

    def __hash__(self) -> int:
        """The same for campaigns that are equal."""
        return hash(json.dumps(self.to_dict()))


def _wavelengths_of(air: Atmosphere, given: Values | None) -> Values:
    """Wavelengths of a program's atmosphere; those that were given must be the same."""
    own = np.asarray(air.wavelengths, float)
    if given is None:
        return own
    asked = np.atleast_1d(np.asarray(given, float))
    if asked.shape != own.shape or not np.allclose(asked, own, rtol=1e-6):
        raise InputError(
            f"Campaign(wavelengths=...): expected those of the atmosphere, {own.size} from "
            f"{own[0]:g} to {own[-1]:g} nm; got {asked.size} from {asked[0]:g} to {asked[-1]:g} nm"
        )
    return asked
