"""Which skies to simulate: an atmosphere, the parameter it is swept over, suns and directions."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from jaxtyping import ArrayLike, Float

from .atmosphere import Atmosphere
from .preetham_air import PAPER_WAVELENGTHS, preetham_atmosphere
from .transfer.quality import QUALITIES


Values = ArrayLike | Sequence[int | float]
GEOMETRIES = ("spherical", "flat", "paper")

SCHEMA = "skyfit/campaign/1"
PAPER_TURBIDITIES = (2.0, 3.0, 4.0, 5.0, 6.0)
# The paper simulated 12 suns and 343 directions and lists neither: these are this project's choice.
PAPER_SUN_ZENITHS_DEG = tuple(np.linspace(0.0, 85.0, 12).tolist())
PAPER_VIEW_ZENITHS_DEG = tuple(np.arange(5.0, 91.0, 5.0).tolist())
PAPER_RELATIVE_AZIMUTHS_DEG = tuple(np.arange(0.0, 181.0, 10.0).tolist())
TURBIDITY_MEANINGS = ("optical thickness", "coefficients")


def half_dome(
    view_zenith: Values, relative_azimuth: Values, *, zenith: bool = True
) -> tuple[Float[np.ndarray, " direction"], Float[np.ndarray, " direction"]]:
    """Directions on a grid, the zenith first.

    Args:
        view_zenith: Zenith angles of the rings [rad].
        relative_azimuth: Azimuths from the sun in each ring [rad].
        zenith: Put the zenith before the rings.

    Returns:
        View zenith and relative azimuth of every direction [rad].
    """
    rings, spokes = np.meshgrid(
        np.atleast_1d(np.asarray(view_zenith, float)),
        np.atleast_1d(np.asarray(relative_azimuth, float)),
        indexing="ij",
    )
    first = np.zeros(1 if zenith else 0)
    return np.concatenate([first, rings.ravel()]), np.concatenate([first, spokes.ravel()])


def paper_directions() -> tuple[Float[np.ndarray, " direction"], Float[np.ndarray, " direction"]]:
    """The default 343 directions: the zenith, and 5° … 90° by 5° times 0° … 180° by 10°."""
    return half_dome(np.radians(PAPER_VIEW_ZENITHS_DEG), np.radians(PAPER_RELATIVE_AZIMUTHS_DEG))


@dataclass(frozen=True)
class PaperAtmosphere:
    """The atmosphere of Preetham et al. (1999), all but its turbidity; see `preetham_atmosphere`.

    Args:
        turbidity_means: The definition by optical thickness, or appendix A.3's coefficients.
        ozone: Whether 3.5 mm of ozone absorb.
        ground_albedo: Lambertian, in [0, 1].
    """

    swept: ClassVar[str] = "turbidity"

    turbidity_means: Literal["optical thickness", "coefficients"] = "optical thickness"
    ozone: bool = False
    ground_albedo: float = 0.0

    def __post_init__(self):
        """Refuse what no atmosphere can be made of."""
        _one_of("PaperAtmosphere", "turbidity_means", self.turbidity_means, TURBIDITY_MEANINGS)
        if not 0 <= self.ground_albedo <= 1:
            raise ValueError(
                f"PaperAtmosphere(ground_albedo=...): expected 0 to 1; got {self.ground_albedo}"
            )

    def build(self, turbidity: ArrayLike, wavelengths: ArrayLike) -> Atmosphere:
        """The atmosphere of one turbidity at wavelengths [nm]."""
        return preetham_atmosphere(
            turbidity,
            wavelengths=wavelengths,
            turbidity_means=self.turbidity_means,
            ozone=self.ozone,
            ground_albedo=self.ground_albedo,
        )


@dataclass(frozen=True, init=False)
class Campaign:
    """The skies to simulate; `Campaign()` is the paper's 5 turbidities × 12 suns × 343 directions.

    Args:
        turbidity: Increasing, 1 or more.
        sun_zenith: Increasing, in [0, π] [rad].
        view_zenith: Of every direction, in [0, π] [rad].
        relative_azimuth: Of every direction, as many as `view_zenith`; 0 towards the sun [rad].
        wavelengths: Increasing [nm].
        atmosphere: What the sky is made of, but for the turbidity; the paper's by default.
        orders: Orders of scattering, 1 or more; None for all.
        geometry: "spherical", "flat" or "paper" (flat where the view zenith is below 70°).
        quality: Size of the simulator's quadratures: "draft", "default" or "high".
        observer_altitude: 0 or more [m].
        keep_orders: Keep the radiance of each order of scattering too.

    Raises:
        ValueError: Naming the argument, what was expected and what came.
    """

    turbidity: tuple[float, ...]
    sun_zenith: tuple[float, ...]
    view_zenith: tuple[float, ...]
    relative_azimuth: tuple[float, ...]
    wavelengths: tuple[float, ...]
    atmosphere: PaperAtmosphere
    orders: int | None
    geometry: str
    quality: str
    observer_altitude: float
    keep_orders: bool

    def __init__(
        self,
        turbidity: Values = PAPER_TURBIDITIES,
        sun_zenith: Values | None = None,
        view_zenith: Values | None = None,
        relative_azimuth: Values | None = None,
        wavelengths: Values = PAPER_WAVELENGTHS,
        atmosphere: PaperAtmosphere | None = None,
        orders: int | None = 2,
        geometry: str = "spherical",
        quality: str = "default",
        observer_altitude: float = 0.0,
        keep_orders: bool = False,
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
        angles = _values("view_zenith", view_zenith, 0.0, np.pi, increasing=False)
        azimuths = _values("relative_azimuth", relative_azimuth, -np.inf, np.inf, increasing=False)
        if len(angles) != len(azimuths):
            raise ValueError(
                "Campaign: expected as many relative_azimuth as view_zenith, one a direction; "
                f"got {len(azimuths)} and {len(angles)}"
            )
        if orders is not None and (isinstance(orders, bool) or orders < 1):
            raise ValueError(f"Campaign(orders=...): expected 1 or more, or None; got {orders}")
        _one_of("Campaign", "geometry", geometry, GEOMETRIES)
        _one_of("Campaign", "quality", quality, tuple(QUALITIES))
        if not 0 <= observer_altitude < np.inf:
            raise ValueError(
                f"Campaign(observer_altitude=...): expected 0 m or more; got {observer_altitude}"
            )
        fields = {
            "turbidity": _values("turbidity", turbidity, 1.0, np.inf),
            "sun_zenith": _values("sun_zenith", sun_zenith, 0.0, np.pi),
            "view_zenith": angles,
            "relative_azimuth": azimuths,
            "wavelengths": _values("wavelengths", wavelengths, 1.0, 1e6),
            "atmosphere": PaperAtmosphere() if atmosphere is None else atmosphere,
            "orders": orders,
            "geometry": geometry,
            "quality": quality,
            "observer_altitude": float(observer_altitude),
            "keep_orders": keep_orders,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def swept(self) -> tuple[str, tuple[float, ...]]:
        """Name and values of the swept parameter, the first dimension of the dataset."""
        name = self.atmosphere.swept
        return name, getattr(self, name)

    @property
    def num_skies(self) -> int:
        """Skies, that is values of the swept parameter times suns."""
        return len(self.swept[1]) * len(self.sun_zenith)

    def build_atmosphere(self, value: float) -> Atmosphere:
        """The atmosphere for one value of the swept parameter."""
        return self.atmosphere.build(value, np.asarray(self.wavelengths))

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers and words, for JSON."""
        return {"schema": SCHEMA, **dataclasses.asdict(self)}

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> "Campaign":
        """Undo `to_dict`.

        Raises:
            ValueError: The record is of another schema, or a value is impossible.
        """
        fields = dict(record)
        if (schema := fields.pop("schema", "missing")) != SCHEMA:
            raise ValueError(f"Campaign.from_dict: schema is {schema!r}, expected {SCHEMA!r}")
        fields["atmosphere"] = PaperAtmosphere(**fields["atmosphere"])
        return cls(**fields)


def _values(
    name: str, given: Any, low: float, high: float, *, increasing: bool = True
) -> tuple[float, ...]:
    """One axis of numbers within bounds, as Python floats."""
    try:
        axis = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        raise ValueError(f"Campaign({name}=...): expected numbers; got {given!r:.60}") from None
    if axis.ndim != 1 or axis.size == 0:
        raise ValueError(f"Campaign({name}=...): expected one axis; got shape {axis.shape}")
    # A rounding error beyond π is no reason to refuse a direction.
    outside = ~(np.isfinite(axis) & (axis >= low) & (axis <= high + 1e-9))
    if outside.any():
        bounds = f"within [{low:.6g}, {high:.6g}]" if np.isfinite(high) else f"{low:.6g} or more"
        raise ValueError(
            f"Campaign({name}=...): expected finite values {bounds if np.isfinite(low) else ''}"
            f"; got {axis[outside][0]:.6g}".replace(" ;", ";")
        )
    if increasing and np.any(np.diff(axis) <= 0):
        at = int(np.argmax(np.diff(axis) <= 0))
        raise ValueError(
            f"Campaign({name}=...): expected increasing values; got {axis[at]:.6g} "
            f"before {axis[at + 1]:.6g}"
        )
    return tuple(axis.tolist())


def _one_of(owner: str, name: str, given: Any, choices: tuple[str, ...]) -> None:
    if given not in choices:
        expected = ", ".join(repr(choice) for choice in choices)
        raise ValueError(f"{owner}({name}=...): expected one of {expected}; got {given!r}")
