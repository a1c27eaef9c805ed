"""The result of a fit, and what its file holds."""

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float, check
from ..errors import InputError
from ..models.basis import Basis
from ..models.distribution import AbstractDistribution
from ..models.formula import FormulaSky, Ranges
from ..models.preetham import warn_outside
from ..models.scale import AbstractScale, LogScale, PaperZenith
from .diagnostics import Diagnostics
from .document import plain, write_document
from .positivity import Positivity


# NumPy arrays; traced ones where a fit is an argument of a compiled function.
Table = Any


@dataclass(frozen=True)
class TwoStage:
    """One channel fitted as Preetham et al. (1999) describe: by parameter, then a line.

    Attributes:
        values: Values of the parameter.
        coefficients: A to E at each value.
        line: Slope and intercept through them by least squares.
        rms_by_value: Root mean square residual of the fit at each value.
        rms: Root mean square residual of the line over all skies.
    """

    values: Float[np.ndarray, " value"]
    coefficients: Float[np.ndarray, "value coefficient"]
    line: Float[np.ndarray, "coefficient 2"]
    rms_by_value: Float[np.ndarray, " value"]
    rms: float


@dataclass(frozen=True, eq=False)
class Notes:
    """What is known of a fit besides its numbers. Two are equal if they say the same.

    Attributes:
        diagnostics: Residuals, condition number, unidentified combinations, by channel.
        scale_rms: Root mean square relative error of each channel's scale over the skies.
        two_stage: The fit in two stages, for comparison; None if there is no line to compare.
        positivity: How far from negative light and impossible colours the sky stays; None if it
            was not looked at.
        settings: Choices the fit was made with.
        provenance: Attributes of the data, and the versions that made the fit.
    """

    diagnostics: dict[str, Diagnostics]
    scale_rms: dict[str, float]
    two_stage: dict[str, TwoStage] | None
    positivity: Positivity | None
    settings: dict[str, Any]
    provenance: dict[str, Any]

    def text(self) -> str:
        """All of it as JSON."""
        return json.dumps(plain(self), sort_keys=True)

    def __hash__(self):
        return hash(self.text())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Notes) and self.text() == other.text()


class SkyFit(eqx.Module):
    """A sky formula fitted to skies: a distribution, a basis, a scale.

    A fit is a pytree whose leaves are its numbers. Dictionaries have an entry a channel.

    Attributes:
        numbers: Numbers of every coefficient in the terms of `basis`.
        number_errors: Standard errors of `numbers`, as if residuals were independent.
        basis: Terms of the coefficients.
        distribution: Formula of the dome.
        scale: Factor of every channel, with its own numbers.
        scale_errors: Standard errors of the scale's numbers by name, where they are known.
        wavelengths: Wavelengths of spectral bands [nm]; None for colours.
        linked: Whether sums of numbers times terms are free numbers, whose links are the
            coefficients; elsewhere the sums are the coefficients.
        kind: "Yxy", "XYZ", "RGB" or "bands".
        channels: Names of the channels, in order.
        ranges: Name of every swept parameter, and the values between which the fit holds.
        sun_zenith_range: Suns between which it holds [rad].
        notes: What is known of the fit besides its numbers.
    """

    numbers: dict[str, Table]
    number_errors: dict[str, Table]
    basis: Basis
    distribution: AbstractDistribution
    scale: AbstractScale
    scale_errors: dict[str, dict[str, Any]]
    wavelengths: Float[Array | np.ndarray, " channel"] | None
    linked: bool = eqx.field(static=True)
    kind: str = eqx.field(static=True)
    channels: tuple[str, ...] = eqx.field(static=True)
    ranges: Ranges = eqx.field(static=True)
    sun_zenith_range: tuple[float, float] = eqx.field(static=True)
    notes: Notes = eqx.field(static=True)

    __hash__ = object.__hash__  # arrays have none

    @property
    def coefficients(self) -> dict[str, Table]:
        """Coefficients linear in the parameter by (slope, intercept): [5, 2] for Perez's A to E.

        Raises:
            AttributeError: The formula is another; `sky(...).coefficients(sun_zenith)` has them.
        """
        if self.linked:
            raise AttributeError(
                f"SkyFit.coefficients: those of a {self.notes.settings.get('dependence')} formula "
                "change with the sun; expected sky(...).coefficients(sun_zenith)"
            )
        return {name: _line(table, self.basis) for name, table in self.numbers.items()}

    @property
    def standard_errors(self) -> dict[str, Table]:
        """Standard errors of `coefficients`, or of `numbers` where the formula is linked."""
        if self.linked:
            return self.number_errors
        return {name: _line(table, self.basis) for name, table in self.number_errors.items()}

    @property
    def num_numbers(self) -> int:
        """Numbers of one channel: coefficients times terms, and those of the scale."""
        scale = self.scale
        if isinstance(scale, PaperZenith):
            size = scale.luminance.linear.size + scale.luminance.angle.size
        else:
            assert isinstance(scale, LogScale)
            size = scale.basis.num_terms
        return self.basis.num_terms * len(self.distribution.names) + size

    @property
    def zenith(self) -> dict[str, dict[str, Any]]:
        """Numbers of the paper's zenith: `matrix` of x and y, `linear` and `angle` of Y.

        Raises:
            AttributeError: The formula has another scale.
        """
        if not isinstance(self.scale, PaperZenith):
            raise AttributeError("SkyFit.zenith: this formula has no zenith of the paper's form")
        return self.scale.numbers()

    @property
    def zenith_standard_errors(self) -> dict[str, dict[str, Any]]:
        """Standard errors of `zenith`; the same shapes."""
        return self.scale_errors

    @property
    def zenith_rms(self) -> dict[str, float]:
        """Root mean square relative residual of each channel's scale."""
        return self.notes.scale_rms

    @property
    def swept(self) -> dict[str, tuple[float, float]]:
        """Every swept parameter, and the values between which the fit holds."""
        return dict(self.ranges)

    @property
    def parameter_name(self) -> str | None:
        """Name of the one swept parameter; None if nothing was swept.

        Raises:
            ValueError: Several were swept; `swept` has them all.
        """
        one = self._one_parameter()
        return one and one[0]

    @property
    def parameter_range(self) -> tuple[float, float] | None:
        """Values of the one swept parameter between which the fit holds; None if there is none.

        Raises:
            ValueError: Several were swept; `swept` has them all.
        """
        one = self._one_parameter()
        return one and one[1]

    def _one_parameter(self) -> tuple[str, tuple[float, float]] | None:
        if len(self.ranges) > 1:
            names = ", ".join(self.swept)
            raise InputError(f"SkyFit: expected a fit over one parameter; this one is over {names}")
        return self.ranges[0] if self.ranges else None

    @property
    def diagnostics(self) -> dict[str, Diagnostics]:
        """Residuals, condition number, unidentified combinations."""
        return self.notes.diagnostics

    @property
    def two_stage(self) -> dict[str, TwoStage] | None:
        """The fit in two stages, for comparison."""
        return self.notes.two_stage

    @property
    def positivity(self) -> Positivity | None:
        """How far from negative light and impossible colours the sky stays."""
        return self.notes.positivity

    @property
    def settings(self) -> dict[str, Any]:
        """Choices the fit was made with."""
        return self.notes.settings

    @property
    def provenance(self) -> dict[str, Any]:
        """Attributes of the data, and the versions that made the fit."""
        return self.notes.provenance

    def sky(self, **swept: ArrayLike) -> FormulaSky:
        """The fitted sky model.

        Args:
            **swept: Every swept parameter under its own name, as in `turbidity=3.0`; nothing where
                nothing was swept. Outside the fitted range it is held at the nearest end, with a
                warning where it is known.

        Raises:
            ValueError: A parameter is missing, NaN, or another one is given.
        """
        expected = [name for name, _ in self.ranges]
        if sorted(swept) != sorted(expected):
            raise InputError(f"SkyFit.sky: expected the parameters {expected}; got {list(swept)}")
        values = {}
        for name, valid in self.ranges:
            where = f"SkyFit.sky({name}=...)"
            value = check(as_float(swept[name]), lambda v: v != v, f"{where} must be a number")
            warn_outside(value, valid, where)
            values[name] = value
        return self._at(values)

    def _at(self, swept) -> FormulaSky:
        return FormulaSky(
            swept=swept,
            numbers=jnp.stack([as_float(self.numbers[name]) for name in self.channels]),
            basis=self.basis,
            distribution=self.distribution,
            scale=self.scale,
            wavelengths=None if self.wavelengths is None else as_float(self.wavelengths),
            linked=self.linked,
            kind=self.kind,
            ranges=self.ranges,
            sun_zenith_range=self.sun_zenith_range,
        )

    def describe(self) -> dict[str, Any]:
        """The formula as plain names and numbers, all that is needed to evaluate it."""
        return {
            "kind": self.kind,
            "channels": list(self.channels),
            "wavelengths": plain(self.wavelengths),
            "ranges": {name: list(ends) for name, ends in self.ranges},
            "sun_zenith_range": list(self.sun_zenith_range),
            "distribution": self.distribution.describe(),
            "basis": self.basis.describe(),
            "linked": self.linked,
            "numbers": plain(self.numbers),
            "scale": self.scale.describe(),
        }

    def save(self, path: str | PathLike[str]) -> None:
        """Write the fit as JSON; `load_fit` reads it back equal.

        Raises:
            ValueError: There is a file that is no fit of skyfit: it is not replaced.
        """
        errors = {"standard_errors": self.number_errors, "scale_errors": self.scale_errors}
        write_document(path, {"formula": self.describe(), **errors, **plain(self.notes)})


def _line(table: Table, basis: Basis) -> Table:
    """Slope and intercept, where nothing varies a slope of 0."""
    if basis.axes:
        return table
    return np.concatenate([np.zeros_like(table), np.asarray(table)], axis=1)
