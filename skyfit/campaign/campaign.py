"""Which skies to simulate: an atmosphere, the parameter it is swept over, suns and directions."""

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..atmosphere import Atmosphere
from ..preetham_air import PAPER_WAVELENGTHS
from ..transfer.quality import QUALITIES
from .checks import axis_of, one_of
from .description import DescribedAtmosphere, PaperAtmosphere, Sweep
from .description.sweep import OBSERVER_ALTITUDE
from .directions import PAPER_SUN_ZENITHS_DEG, PAPER_TURBIDITIES, Values, paper_directions


GEOMETRIES = ("spherical", "flat", "paper")

SCHEMA = "skyfit/campaign/1"


@dataclass(frozen=True, init=False)
class Campaign:
    """The skies to simulate; `Campaign()` is the paper's 5 turbidities × 12 suns × 343 directions.

    Args:
        turbidity: Of the paper's atmosphere, increasing, 1 or more; the paper's five by default.
        sun_zenith: Increasing, in [0, π] [rad].
        view_zenith: Of every direction, in [0, π] [rad].
        relative_azimuth: Of every direction, as many as `view_zenith`; 0 towards the sun [rad].
        wavelengths: Increasing [nm].
        atmosphere: What the sky is made of, but for what is swept; the paper's by default.
        orders: Orders of scattering, 1 or more; None for all.
        geometry: "spherical", "flat" or "paper" (flat where the view zenith is below 70°).
        quality: Size of the simulator's quadratures: "draft", "default" or "high".
        observer_altitude: 0 or more [m].
        keep_orders: Keep the radiance of each order of scattering too.
        sweep: What is swept where the atmosphere is not the paper's; None for a single one.

    Raises:
        ValueError: Naming the argument, what was expected and what came.
    """

    turbidity: tuple[float, ...]
    sun_zenith: tuple[float, ...]
    view_zenith: tuple[float, ...]
    relative_azimuth: tuple[float, ...]
    wavelengths: tuple[float, ...]
    atmosphere: PaperAtmosphere | DescribedAtmosphere
    orders: int | None
    geometry: str
    quality: str
    observer_altitude: float
    keep_orders: bool
    sweep: Sweep | None

    def __init__(
        self,
        turbidity: Values | None = None,
        sun_zenith: Values | None = None,
        view_zenith: Values | None = None,
        relative_azimuth: Values | None = None,
        wavelengths: Values = PAPER_WAVELENGTHS,
        atmosphere: PaperAtmosphere | DescribedAtmosphere | None = None,
        orders: int | None = 2,
        geometry: str = "spherical",
        quality: str = "default",
        observer_altitude: float = 0.0,
        keep_orders: bool = False,
        sweep: Sweep | None = None,
    ):
        if (view_zenith is None) != (relative_azimuth is None):
            raise ValueError(
                "Campaign: view_zenith and relative_azimuth describe the directions together; "
                "got only one of them"
            )
        if sun_zenith is None:
            sun_zenith = np.radians(PAPER_SUN_ZENITHS_DEG)
        if view_zenith is None or relative_azimuth is None:
            view_zenith, relative_azimuth = paper_directions()
        angles = axis_of("view_zenith", view_zenith, 0.0, np.pi, increasing=False)
        azimuths = axis_of("relative_azimuth", relative_azimuth, -np.inf, np.inf, increasing=False)
        if len(angles) != len(azimuths):
            raise ValueError(
                "Campaign: expected as many relative_azimuth as view_zenith, one a direction; "
                f"got {len(azimuths)} and {len(angles)}"
            )
        if orders is not None and (isinstance(orders, bool) or orders < 1):
            raise ValueError(f"Campaign(orders=...): expected 1 or more, or None; got {orders}")
        one_of("Campaign", "geometry", geometry, GEOMETRIES)
        one_of("Campaign", "quality", quality, tuple(QUALITIES))
        if not 0 <= observer_altitude < np.inf:
            raise ValueError(
                f"Campaign(observer_altitude=...): expected 0 m or more; got {observer_altitude}"
            )
        atmosphere = PaperAtmosphere() if atmosphere is None else atmosphere
        fields = {
            "turbidity": _turbidities(atmosphere, turbidity, sweep),
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
            "sweep": sweep,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def swept(self) -> tuple[str | None, tuple[float, ...]]:
        """Name and values of the swept parameter, the first dimension of the dataset.

        The name is None, and the only value NaN, where nothing is swept.
        """
        if isinstance(self.atmosphere, PaperAtmosphere):
            return self.atmosphere.swept, self.turbidity
        return (
            (None, (np.nan,)) if self.sweep is None else (self.sweep.name, tuple(self.sweep.values))
        )

    @property
    def sky_dims(self) -> tuple[str, ...]:
        """Dimensions of the dataset that tell skies apart."""
        name = self.swept[0]
        return ("sun_zenith",) if name is None else (name, "sun_zenith")

    @property
    def sky_shape(self) -> tuple[int, ...]:
        """Sizes of these dimensions."""
        sizes = len(self.swept[1]), len(self.sun_zenith)
        return sizes[-len(self.sky_dims) :]

    @property
    def num_skies(self) -> int:
        """Skies, that is values of the swept parameter times suns."""
        return len(self.swept[1]) * len(self.sun_zenith)

    def build_atmosphere(self, value: float) -> Atmosphere:
        """The atmosphere for one value of the swept parameter."""
        wavelengths = np.asarray(self.wavelengths)
        if isinstance(self.atmosphere, PaperAtmosphere):
            return self.atmosphere.build(value, wavelengths)
        return self.atmosphere.build(wavelengths, self.sweep, value)

    def observer_altitude_at(self, value: float) -> float:
        """Altitude of the observer for one value of the swept parameter [m]."""
        swept = self.sweep is not None and self.sweep.key == OBSERVER_ALTITUDE
        return value if swept else self.observer_altitude

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers and words, for JSON."""
        fields = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        fields["atmosphere"] = self.atmosphere.to_dict()
        fields["sweep"] = None if self.sweep is None else dataclasses.asdict(self.sweep)
        return {"schema": SCHEMA, **fields}

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> "Campaign":
        """Undo `to_dict`.

        Raises:
            ValueError: The record is of another schema, or a value is impossible.
        """
        fields = dict(record)
        if (schema := fields.pop("schema", "missing")) != SCHEMA:
            raise ValueError(f"Campaign.from_dict: schema is {schema!r}, expected {SCHEMA!r}")
        kind = fields["atmosphere"].get("kind", PaperAtmosphere.kind)
        home = PaperAtmosphere if kind == PaperAtmosphere.kind else DescribedAtmosphere
        fields["atmosphere"] = home.from_dict(fields["atmosphere"])
        fields["turbidity"] = fields["turbidity"] or None
        fields["sweep"] = Sweep(**fields["sweep"]) if fields.get("sweep") else None
        return cls(**fields)


def _turbidities(atmosphere: Any, given: Values | None, sweep: Sweep | None) -> tuple[float, ...]:
    """Turbidities of the paper's atmosphere; none of any other."""
    if isinstance(atmosphere, PaperAtmosphere):
        if sweep is not None:
            raise ValueError("Campaign(sweep=...): the paper's atmosphere is swept over turbidity")
        return axis_of("turbidity", PAPER_TURBIDITIES if given is None else given, 1.0, np.inf)
    if given is not None and np.size(given) > 0:
        raise ValueError(
            "Campaign(turbidity=...): only the paper's atmosphere has one; give sweep=..."
        )
    return ()
