"""The result of a fit of any formula, and what its file holds."""

import dataclasses
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from jaxtyping import Float

from .._typing import ArrayLike, as_float, check
from ..models.basis import AbstractBasis, basis_from
from ..models.formula import CHANNEL_KINDS, FormulaSky
from ..models.preetham import warn_outside
from ..models.shapes import AbstractShape, shape_from
from .diagnostics import Diagnostics
from .document import array_of, diagnostics_from, write_document
from .positivity import Positivity


FORM = "formula"  # of a file's document


@dataclass(frozen=True)
class FormulaFit:
    """A formula fitted to skies: a distribution, a dependence, and channels.

    Dictionaries have an entry a channel. A channel is e^s F, or e^s F / F(zenith) where the
    distribution is relative; s and the free numbers of F's coefficients are sums of numbers times
    the terms of a basis in the swept parameter and the sun; see `skyfit.models.formula`.

    Attributes:
        shape: The distribution over the dome.
        basis: Terms of the coefficients.
        scale_basis: Terms of the scale's logarithm.
        kind: "Yxy", "XYZ", "RGB" or "bands".
        wavelengths: Of the bands [nm]; None for colours.
        coefficients: Numbers of every coefficient (rows) and term.
        standard_errors: The same shape, as if residuals were independent, with the prior's help.
        scale: Numbers of the scale's logarithm.
        scale_rms: Root mean square error of the scale's logarithm over the skies.
        dimming: Fall of the scale's logarithm per radian of a sun lower than the range.
        parameter_name: What was swept; None if nothing.
        parameter_range: The values between which the fit holds; None if nothing was swept.
        sun_zenith_range: The suns between which it holds [rad].
        diagnostics: Residuals, condition number, unidentified combinations.
        positivity: How far from negative light and impossible colours the sky stays.
        settings: Choices the fit was made with.
        provenance: Attributes of the data, and the versions that made the fit.
    """

    shape: AbstractShape
    basis: AbstractBasis
    scale_basis: AbstractBasis
    kind: str
    wavelengths: Float[np.ndarray, " channel"] | None
    coefficients: dict[str, Float[np.ndarray, "coefficient term"]]
    standard_errors: dict[str, Float[np.ndarray, "coefficient term"]]
    scale: dict[str, Float[np.ndarray, " scale_term"]]
    scale_rms: dict[str, float]
    dimming: dict[str, float]
    parameter_name: str | None
    parameter_range: tuple[float, float] | None
    sun_zenith_range: tuple[float, float]
    diagnostics: dict[str, Diagnostics]
    positivity: Positivity | None
    settings: dict[str, Any]
    provenance: dict[str, Any]

    @property
    def num_coefficients(self) -> int:
        """Numbers of one channel: coefficients times terms, and those of the scale."""
        return self.basis.num_terms * len(self.shape.names) + self.scale_basis.num_terms

    def sky(self, **swept: ArrayLike) -> FormulaSky:
        """The fitted sky model; arguments and errors as `SkyFit.sky`."""
        expected = [self.parameter_name] if self.parameter_name else []
        if list(swept) != expected:
            raise ValueError(
                f"FormulaFit.sky: expected the parameters {expected}; got {list(swept)}"
            )
        value, valid = as_float(0.0), (0.0, 0.0)
        if self.parameter_name and self.parameter_range:
            name, valid = f"FormulaFit.sky({self.parameter_name}=...)", self.parameter_range
            value = as_float(swept[self.parameter_name])
            value = check(value, lambda v: v != v, f"{name} must be a number")
            warn_outside(value, valid, name)
        return FormulaSky(
            parameter=value,
            numbers=as_float(np.stack(list(self.coefficients.values()))),
            scales=as_float(np.stack(list(self.scale.values()))),
            dimming=as_float(np.array(list(self.dimming.values()))),
            basis=self.basis,
            scale_basis=self.scale_basis,
            shape=self.shape,
            wavelengths=None if self.wavelengths is None else as_float(self.wavelengths),
            kind=self.kind,
            parameter_name=self.parameter_name or "",
            parameter_range=valid,
            sun_zenith_range=self.sun_zenith_range,
        )

    def describe(self) -> dict[str, Any]:
        """The formula as plain names and numbers, all that is needed to evaluate it."""
        return {
            "kind": self.kind,
            "channels": list(self.coefficients),
            "wavelengths": None if self.wavelengths is None else self.wavelengths.tolist(),
            "shape": self.shape.describe(),
            "dependence": self.basis.describe(),
            "numbers": {name: table.tolist() for name, table in self.coefficients.items()},
            "scale": {
                "formula": "e^(sum of numbers times terms)",
                "dependence": self.scale_basis.describe(),
                "numbers": {name: row.tolist() for name, row in self.scale.items()},
                "dimming": dict(self.dimming),
            },
        }

    def save(self, path: str | PathLike[str]) -> None:
        """Write the fit as JSON; `load_fit` reads it back equal.

        Raises:
            ValueError: There is a file that is no fit of skyfit: it is not replaced.
        """
        kept = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        described = ("shape", "basis", "scale_basis", "kind", "wavelengths", "coefficients")
        for name in (*described, "scale", "dimming"):
            del kept[name]
        kept["diagnostics"] = {c: dataclasses.asdict(d) for c, d in self.diagnostics.items()}
        if self.positivity is not None:
            kept["positivity"] = dataclasses.asdict(self.positivity)
        write_document(path, FORM, {"formula": self.describe(), **kept})

    @classmethod
    def from_document(cls, path: str | PathLike[str], document: dict[str, Any]) -> "FormulaFit":
        """The fit of a file's document; a missing key raises KeyError."""
        formula = document["formula"]
        try:
            shape = shape_from(formula["shape"])
            basis = basis_from(formula["dependence"])
            scale_basis = basis_from(formula["scale"]["dependence"])
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}: formula: {error}") from error
        kind, names = formula["kind"], formula["channels"]
        if kind not in (*CHANNEL_KINDS, "bands"):
            raise ValueError(f"{path}: formula.kind: expected a kind of channels; got {kind!r}")
        size = (len(shape.names), basis.num_terms)
        bands = formula["wavelengths"]

        def tables(key, record, shape):
            return {c: array_of(path, f"{key}.{c}", record[c], shape) for c in names}

        ends = document["parameter_range"]
        margins = document["positivity"]
        return cls(
            shape=shape,
            basis=basis,
            scale_basis=scale_basis,
            kind=kind,
            wavelengths=bands and array_of(path, "formula.wavelengths", bands, (len(names),)),
            coefficients=tables("formula.numbers", formula["numbers"], size),
            standard_errors=tables("standard_errors", document["standard_errors"], size),
            scale=tables(
                "formula.scale.numbers", formula["scale"]["numbers"], (scale_basis.num_terms,)
            ),
            scale_rms={c: float(document["scale_rms"][c]) for c in names},
            dimming={c: float(formula["scale"]["dimming"][c]) for c in names},
            parameter_name=document["parameter_name"],
            parameter_range=ends and tuple(ends),
            sun_zenith_range=tuple(document["sun_zenith_range"]),
            diagnostics={c: diagnostics_from(document["diagnostics"][c]) for c in names},
            positivity=margins and Positivity(**margins),
            settings=document["settings"],
            provenance=document["provenance"],
        )
