"""How well the numbers of a formula are determined."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from ..models.basis import AbstractBasis
from ..models.shapes import AbstractShape
from .diagnostics import Diagnostics
from .joint import JointFit


class Spectrum(NamedTuple):
    """Of a fit's normal matrix scaled to a unit diagonal: eigenvalues, eigenvectors unscaled.

    The matrix includes the prior's share, without which a series would not be determined.
    """

    values: Float[np.ndarray, " number"]
    vectors: Float[np.ndarray, "number number"]
    variance: float

    def errors(self) -> Float[np.ndarray, " number"]:
        """Standard errors, as if residuals were independent."""
        return np.sqrt(self.variance * (self.vectors**2 / self.values).sum(1))


def spectrum_of(joint: JointFit) -> Spectrum:
    """Decompose a fit's normal matrix."""
    seen = np.count_nonzero(joint.residual)
    variance = (joint.residual**2).sum() / max(seen - joint.numbers.size, 1)
    size = np.sqrt(np.maximum(np.diag(joint.normal), 1e-300))
    values, vectors = np.linalg.eigh(joint.normal / size / size[:, None])
    return Spectrum(np.maximum(values, 1e-16 * values[-1]), vectors / size[:, None], variance)


def formula_diagnostics(
    joint: JointFit, spectrum: Spectrum, shape: AbstractShape, basis: AbstractBasis
) -> Diagnostics:
    """What a sceptic asks of one channel."""
    seen = np.count_nonzero(joint.residual)
    return Diagnostics(
        rms=float(np.sqrt((joint.residual**2).sum() / max(seen, 1))),
        worst=float(np.abs(joint.residual).max()),
        condition=float(np.sqrt(spectrum.values[-1] / spectrum.values[0])),
        unidentified=_loose(spectrum, shape, basis),
        converged=joint.converged,
        steps=joint.steps,
    )


def _loose(spectrum: Spectrum, shape: AbstractShape, basis: AbstractBasis) -> tuple[str, ...]:
    """Combinations of numbers known no better than by a unit, loosest first, at most eight."""
    length = np.linalg.norm(spectrum.vectors, axis=0)
    error = np.sqrt(spectrum.variance / spectrum.values) * length
    found = {}
    for k in np.argsort(error)[::-1]:
        if error[k] <= 1 or len(found) == 8:
            break
        share = (spectrum.vectors[:, k] ** 2).reshape(basis.num_terms, -1).sum(0) / length[k] ** 2
        first, second = np.argsort(share)[::-1][:2]
        names = shape.names[first]
        if share[second] > 0.1:
            names += f" with {shape.names[second]}"
        found.setdefault(names, f"{names} (±{error[k]:.2g})")
    return tuple(found.values())
