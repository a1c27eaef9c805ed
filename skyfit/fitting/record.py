"""The result of a fit in the published form, and what its file holds."""

import dataclasses
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from jaxtyping import Float

from .._typing import ArrayLike, as_float, check
from ..models.perez import CHANNELS, PerezSky
from ..models.preetham import warn_outside
from ..models.zenith import CubicZenith, TangentZenith
from .diagnostics import Diagnostics
from .document import array_of, diagnostics_from, write_document
from .positivity import Positivity


FORM = "published"  # of a file's document: A to E linear in the parameter, the paper's zenith


@dataclass(frozen=True)
class TwoStage:
    """One channel fitted as Preetham et al. (1999) describe: by parameter, then a line.

    Attributes:
        values: Of the parameter.
        coefficients: A to E at each value.
        line: Slope and intercept through them by least squares.
        rms_by_value: Root mean square residual of the fit at each value.
        rms: That of the line over all skies.
    """

    values: Float[np.ndarray, " value"]
    coefficients: Float[np.ndarray, "value coefficient"]
    line: Float[np.ndarray, "coefficient 2"]
    rms_by_value: Float[np.ndarray, " value"]
    rms: float


@dataclass(frozen=True)
class SkyFit:
    """A sky formula fitted to skies. Dictionaries have the channels "x", "y" and "Y".

    Attributes:
        coefficients: A to E by (slope in the parameter, intercept): [5, 2].
        standard_errors: The same shape; see `skyfit.fitting.diagnostics.covariance`.
        zenith: Numbers of the zenith formulas: for "x" and "y" the `matrix` of `CubicZenith`, for
            "Y" the `linear` [cd m⁻²] and `angle` numbers of `TangentZenith`.
        zenith_standard_errors: The same shapes.
        zenith_rms: Root mean square relative residual of each zenith formula.
        parameter_name: What was swept; None if nothing.
        parameter_range: The values between which the fit holds; None if nothing was swept.
        sun_zenith_range: The suns between which it holds [rad].
        diagnostics: Residuals, condition number, unidentified combinations.
        two_stage: The fit in two stages, for comparison; None if nothing was swept.
        settings: Choices the fit was made with.
        provenance: Attributes of the data, and the versions that made the fit.
        positivity: How far from negative light and impossible colours the sky stays; None if it
            was not looked at.
    """

    coefficients: dict[str, Float[np.ndarray, "5 2"]]
    standard_errors: dict[str, Float[np.ndarray, "5 2"]]
    zenith: dict[str, dict[str, np.ndarray]]
    zenith_standard_errors: dict[str, dict[str, np.ndarray]]
    zenith_rms: dict[str, float]
    parameter_name: str | None
    parameter_range: tuple[float, float] | None
    sun_zenith_range: tuple[float, float]
    diagnostics: dict[str, Diagnostics]
    two_stage: dict[str, TwoStage] | None
    settings: dict[str, Any]
    provenance: dict[str, Any]
    positivity: Positivity | None = None

    def sky(self, **swept: ArrayLike) -> PerezSky:
        """The fitted sky model.

        Args:
            **swept: The swept parameter under its own name, as in `turbidity=3.0`; nothing where
                nothing was swept. Outside the fitted range it is held at the nearest end, with a
                warning where it is known.

        Raises:
            ValueError: The parameter is missing, NaN, or another one is given.
        """
        expected = [self.parameter_name] if self.parameter_name else []
        if list(swept) != expected:
            raise ValueError(f"SkyFit.sky: expected the parameters {expected}; got {list(swept)}")
        value, valid = as_float(0.0), (0.0, 0.0)
        if self.parameter_name and self.parameter_range:
            name, valid = f"SkyFit.sky({self.parameter_name}=...)", self.parameter_range
            value = as_float(swept[self.parameter_name])
            value = check(value, lambda v: v != v, f"{name} must be a number")
            warn_outside(value, valid, name)
        return PerezSky(
            parameter=value,
            coefficients=as_float(np.stack([self.coefficients[name] for name in CHANNELS])),
            zenith_x=CubicZenith(as_float(self.zenith["x"]["matrix"])),
            zenith_y=CubicZenith(as_float(self.zenith["y"]["matrix"])),
            zenith_luminance=TangentZenith(
                as_float(self.zenith["Y"]["linear"]), as_float(self.zenith["Y"]["angle"])
            ),
            parameter_name=self.parameter_name or "",
            parameter_range=valid,
            sun_zenith_range=self.sun_zenith_range,
        )

    def save(self, path: str | PathLike[str]) -> None:
        """Write the fit as JSON; `load_fit` reads it back equal.

        Raises:
            ValueError: There is a file that is no fit of skyfit: it is not replaced.
        """
        write_document(path, FORM, dataclasses.asdict(self))

    @classmethod
    def from_document(cls, path: str | PathLike[str], document: dict[str, Any]) -> "SkyFit":
        """The fit of a file's document; a missing key raises KeyError."""
        document = {"positivity": None, **document}  # schema 1 had none
        fields = {field.name: document[field.name] for field in dataclasses.fields(cls)}
        for name in ("coefficients", "standard_errors"):
            fields[name] = {
                channel: array_of(path, f"{name}.{channel}", fields[name][channel], (5, 2))
                for channel in CHANNELS
            }
        for name in ("zenith", "zenith_standard_errors"):
            tables = fields[name]
            fields[name] = {
                channel: {
                    key: array_of(path, f"{name}.{channel}.{key}", tables[channel][key], shape)
                    for key, shape in _ZENITH_SHAPES[channel].items()
                }
                for channel in CHANNELS
            }
        for name in ("parameter_range", "sun_zenith_range"):
            fields[name] = tuple(fields[name]) if fields[name] is not None else None
        fields["diagnostics"] = {c: diagnostics_from(d) for c, d in fields["diagnostics"].items()}
        if fields["two_stage"] is not None:
            fields["two_stage"] = {c: _two_stage(d) for c, d in fields["two_stage"].items()}
        if fields["positivity"] is not None:
            fields["positivity"] = Positivity(**fields["positivity"])
        return cls(**fields)


def _two_stage(record: dict[str, Any]) -> TwoStage:
    fields: dict[str, Any] = {f.name: record[f.name] for f in dataclasses.fields(TwoStage)}
    rms = float(fields.pop("rms"))
    return TwoStage(**{name: np.array(value, float) for name, value in fields.items()}, rms=rms)


_ZENITH_SHAPES = {
    "x": {"matrix": (3, 4)},
    "y": {"matrix": (3, 4)},
    "Y": {"linear": (4,), "angle": (2,)},
}
