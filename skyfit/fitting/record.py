"""The result of a fit, and its file: a JSON document that outlives the program that wrote it."""

import dataclasses
import json
import platform
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from .._typing import ArrayLike, as_float, check
from ..models.perez import CHANNELS, PerezSky
from ..models.preetham import warn_outside
from ..models.zenith import CubicZenith, TangentZenith
from .diagnostics import Diagnostics


SCHEMA = "skyfit/fit/1"


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
        target = Path(path)
        if target.exists():
            _read_document(target)
        document = {"schema": SCHEMA, **plain(dataclasses.asdict(self))}
        target.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def load_fit(path: str | PathLike[str]) -> SkyFit:
    """Read a fit back.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not a fit, is of a later version, or a key is missing or of wrong shape;
            the message names the file and the key.
    """
    document = _read_document(Path(path))
    try:
        fields = {field.name: document[field.name] for field in dataclasses.fields(SkyFit)}
        for name in ("coefficients", "standard_errors"):
            fields[name] = {
                channel: _array(path, f"{name}.{channel}", fields[name][channel], (5, 2))
                for channel in CHANNELS
            }
        for name in ("zenith", "zenith_standard_errors"):
            fields[name] = {
                channel: {
                    key: _array(path, f"{name}.{channel}.{key}", fields[name][channel][key], shape)
                    for key, shape in _ZENITH_SHAPES[channel].items()
                }
                for channel in CHANNELS
            }
        for name in ("parameter_range", "sun_zenith_range"):
            fields[name] = tuple(fields[name]) if fields[name] is not None else None
        fields["diagnostics"] = {c: _diagnostics(d) for c, d in fields["diagnostics"].items()}
        if fields["two_stage"] is not None:
            fields["two_stage"] = {c: _two_stage(d) for c, d in fields["two_stage"].items()}
    except KeyError as error:
        raise ValueError(f"{path}: key {error} is missing") from error
    return SkyFit(**fields)


def _diagnostics(record: dict[str, Any]) -> Diagnostics:
    fields: dict[str, Any] = {f.name: record[f.name] for f in dataclasses.fields(Diagnostics)}
    fields["unidentified"] = tuple(fields["unidentified"])
    return Diagnostics(**fields)


def _two_stage(record: dict[str, Any]) -> TwoStage:
    fields: dict[str, Any] = {f.name: record[f.name] for f in dataclasses.fields(TwoStage)}
    rms = float(fields.pop("rms"))
    return TwoStage(**{name: np.array(value, float) for name, value in fields.items()}, rms=rms)


_ZENITH_SHAPES = {
    "x": {"matrix": (3, 4)},
    "y": {"matrix": (3, 4)},
    "Y": {"linear": (4,), "angle": (2,)},
}


def _array(path, key: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    try:
        array = np.array(value, float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {key}: expected {shape} numbers; {error}") from error
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"{path}: {key}: expected {shape} numbers; got shape {array.shape}")
    return array


def _read_document(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: expected a fit in JSON; {error}") from error
    schema = document.get("schema", "missing") if isinstance(document, dict) else "missing"
    if schema != SCHEMA:
        raise ValueError(f"{path}: schema is {schema!r}, expected {SCHEMA!r}")
    return document


def plain(value: Any) -> Any:
    """The same in dictionaries, lists, numbers and words alone, for JSON."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return str(value)


def versions() -> dict[str, str]:
    """Versions of what a fit's numbers depend on."""
    found = {"python": platform.python_version()}
    for name in ("skyfit", "jax", "equinox", "optimistix", "lineax", "numpy"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "unreleased"
    return found
