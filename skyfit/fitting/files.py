"""Reading a fit file back, whatever formula it holds."""

import dataclasses
from os import PathLike
from typing import Any

import numpy as np

from .._typing import as_table
from ..errors import InputError
from ..models.axes import SUN
from ..models.basis import basis_from
from ..models.domes import distribution_from
from ..models.scale import PaperZenith, scale_from
from .diagnostics import Diagnostics
from .document import read_document
from .positivity import Positivity
from .record import Notes, SkyFit, TwoStage
from .schema import refuse_malformed


def load_fit(path: str | PathLike[str]) -> SkyFit:
    """Read a fit back.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not a fit, is of a later version, or a key is missing or of wrong shape;
            the message names the file and the key.
    """
    document = read_document(path)
    try:
        return _fit(path, document)
    except KeyError as error:
        raise InputError(f"{path}: key {error} is missing") from error
    except (AttributeError, TypeError) as error:
        raise InputError(f"{path}: expected a fit as skyfit writes it; {error}") from error


def _fit(path, document) -> SkyFit:
    refuse_malformed(path, document)
    formula = document["formula"]
    kind, names = formula["kind"], formula["channels"]
    try:
        distribution = distribution_from(formula["distribution"])
        basis = basis_from(formula["basis"])
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: formula: {error}") from error
    try:
        scale = scale_from(formula["scale"])
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: formula.scale: {error}") from error
    ranges = tuple((name, (float(a), float(b))) for name, (a, b) in formula["ranges"].items())
    first, last = formula["sun_zenith_range"]
    _refuse_unknown(path, basis, scale, {name for name, _ in ranges})
    size = (len(distribution.names), basis.num_terms)

    def tables(key, record):
        return {name: as_table(record[name], f"{path}: {key}.{name}", size) for name in names}

    bands = formula["wavelengths"]
    sized = {name: document["scale_errors"].get(name, {}) for name in document["scale_errors"]}
    errors = {
        name: {part: np.array(value, float) for part, value in parts.items()}
        for name, parts in sized.items()
    }
    if isinstance(scale, PaperZenith):
        numbers = scale.numbers()
        errors = {
            name: {
                part: as_table(
                    errors[name][part], f"{path}: scale_errors.{name}.{part}", value.shape
                )
                for part, value in parts.items()
            }
            for name, parts in numbers.items()
        }
    return SkyFit(
        numbers=tables("formula.numbers", formula["numbers"]),
        number_errors=tables("standard_errors", document["standard_errors"]),
        basis=basis,
        distribution=distribution,
        scale=scale,
        scale_errors=errors,
        wavelengths=bands and as_table(bands, f"{path}: formula.wavelengths", (len(names),)),
        linked=bool(formula["linked"]),
        kind=kind,
        channels=tuple(names),
        ranges=ranges,
        sun_zenith_range=(float(first), float(last)),
        notes=_notes(document, names),
    )


def _refuse_unknown(path, basis, scale, swept: set[str]) -> None:
    """Refuse a formula of quantities that nobody gives it."""
    axes = basis.axes if isinstance(scale, PaperZenith) else (*basis.axes, *scale.basis.axes)
    used = {axis.quantity for axis in axes} - {SUN}
    if isinstance(scale, PaperZenith) and scale.quantity:
        used.add(scale.quantity)
    if used - swept:
        raise InputError(
            f"{path}: formula: expected quantities of {sorted(swept)}; got {sorted(used - swept)}"
        )


def _notes(document, names) -> Notes:
    stages, margins = document["two_stage"], document["positivity"]
    return Notes(
        diagnostics={name: _diagnostics(document["diagnostics"][name]) for name in names},
        scale_rms={name: float(document["scale_rms"][name]) for name in names},
        two_stage=stages and {name: _two_stage(stages[name]) for name in names},
        positivity=margins and Positivity(**margins),
        settings=document["settings"],
        provenance=document["provenance"],
    )


def _diagnostics(record: dict[str, Any]) -> Diagnostics:
    fields: dict[str, Any] = {f.name: record[f.name] for f in dataclasses.fields(Diagnostics)}
    fields["unidentified"] = tuple(fields["unidentified"])
    return Diagnostics(**fields)


def _two_stage(record: dict[str, Any]) -> TwoStage:
    fields: dict[str, Any] = {f.name: record[f.name] for f in dataclasses.fields(TwoStage)}
    rms = float(fields.pop("rms"))
    return TwoStage(**{name: np.array(value, float) for name, value in fields.items()}, rms=rms)
