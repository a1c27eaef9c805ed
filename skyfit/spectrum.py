"""Spectra: exact integrals against tabulated curves, and the CIE daylight basis.

Wavelengths in nm, the wavelength axis last. A spectrum is taken to be linear between its
wavelengths and to hold nothing beyond the first and the last of them.
"""

from functools import cache

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import ArrayLike, Spectrum, as_float, check
from .tables import read_table


DAYLIGHT_RANGE = (300.0, 830.0)  # nm; CIE 015:2018, table 6
# Those of the paper's simulation, which are the default of campaigns and of the paper's atmosphere.
PAPER_WAVELENGTHS = np.arange(380.0, 781.0, 10.0)  # nm


@jax.jit
def product_weights(
    wavelengths: Spectrum, nodes: Float[Array, " node"], curves: Float[Array, "node curve"]
) -> Float[Array, "wavelength curve"]:
    """Weights that integrate a spectrum against curves on a grid of their own.

    The sum of `weights * spectrum` over wavelength is the exact integral of the product of the two
    piecewise linear functions, from the first wavelength to the last; the curves are 0 beyond
    their nodes. So a coarse grid costs only what the spectrum itself loses between its wavelengths.

    Args:
        wavelengths: Wavelengths of the spectrum, increasing [nm].
        nodes: Wavelengths of the curves, increasing [nm].
        curves: Values of each curve at the nodes.
    """
    edges = jnp.sort(jnp.concatenate([wavelengths, nodes]))
    edges = jnp.clip(edges, wavelengths[0], wavelengths[-1])
    left, right = edges[:-1], edges[1:]
    middle = 0.5 * (left + right)
    cell = jnp.searchsorted(wavelengths, middle, side="right") - 1
    cell = jnp.clip(cell, 0, wavelengths.size - 2)
    start, length = wavelengths[cell], wavelengths[cell + 1] - wavelengths[cell]

    def curve_at(lam):
        columns = [jnp.interp(lam, nodes, c, left=0.0, right=0.0) for c in curves.T]
        return jnp.stack(columns, axis=-1)

    weights = jnp.zeros((wavelengths.size, curves.shape[1]), wavelengths.dtype)
    # Both factors are linear between two edges, so their product is integrated by Simpson's rule.
    for at, share in ((left, 1 / 6), (middle, 4 / 6), (right, 1 / 6)):
        value = (share * (right - left))[:, None] * curve_at(at)
        toward_end = ((at - start) / length)[:, None]
        weights = weights.at[cell].add((1 - toward_end) * value)
        weights = weights.at[cell + 1].add(toward_end * value)
    return weights


def daylight_basis(wavelengths: ArrayLike) -> Float[Array, "*batch 3"]:
    """Mean S0 and characteristic vectors S1, S2 of daylight, relative units.

    Table 2 of Preetham et al. (1999) from 380 to 780 nm, and beyond it the CIE's table, whose
    values are the same at the 41 wavelengths of table 2; linear in between.

    Args:
        wavelengths: Any shape, from 300 to 830 [nm].

    Returns:
        The three functions on the last axis.

    Raises:
        InputError: A wavelength out of range.
    """
    lam = as_float(wavelengths)
    first, last = DAYLIGHT_RANGE
    lam = check(
        lam,
        lambda v: ~((v >= first) & (v <= last)),
        f"daylight_basis(wavelengths=...) must lie in {first:.0f} to {last:.0f} nm",
    )
    nodes, values = daylight_table()
    return _columns_at(lam, jnp.asarray(nodes, lam.dtype), jnp.asarray(values, lam.dtype))


def linear_in_wavelength(
    values: Float[Array, "*batch band"], bands: Float[Array, " band"], wavelengths: ArrayLike
) -> Float[Array, "*batch wavelength"]:
    """Spectra between the wavelengths at which they are known.

    Args:
        values: At the bands, on the last axis.
        bands: Increasing [nm].
        wavelengths: One axis, within the bands [nm].

    Raises:
        InputError: A wavelength beyond the bands.
    """
    lam = jnp.atleast_1d(as_float(wavelengths)).astype(values.dtype)
    ends = bands[0].astype(lam.dtype), bands[-1].astype(lam.dtype)
    lam = check(
        lam,
        lambda v: ~((v >= ends[0]) & (v <= ends[1])),
        "radiance(wavelengths=...) must lie within the model's bands",
    )
    shares = _columns_at(lam, bands.astype(lam.dtype), jnp.eye(bands.size, dtype=lam.dtype))
    return values @ shares.T


@jax.jit
def _columns_at(wavelengths, nodes, values):
    return jnp.stack([jnp.interp(wavelengths, nodes, column) for column in values.T], axis=-1)


@cache
def daylight_table() -> tuple[np.ndarray, np.ndarray]:
    """Nodes [node] in nm and values [node, 3] of S0, S1, S2; read-only."""
    from colour.colorimetry import SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES as CIE

    paper = read_table("preetham1999_table2_spectra")
    inner = np.asarray(paper["wavelength_nm"])
    outer = np.asarray(CIE["S0"].wavelengths)
    outer = outer[(outer < inner[0]) | (outer > inner[-1])]
    nodes = np.concatenate([inner, outer])
    order = np.argsort(nodes)
    values = [np.concatenate([paper[name], CIE[name][outer]]) for name in ("S0", "S1", "S2")]
    nodes, table = nodes[order], np.stack(values, axis=1)[order]
    nodes.flags.writeable = table.flags.writeable = False
    return nodes, table
