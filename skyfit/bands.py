"""Absorption in bands: by lines too narrow for the spectrum's sampling, told apart by strength."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import ArrayLike, as_parameter, as_scalar, check, is_traced
from .errors import InputError


class Bands(eqx.Module):
    """Absorption by classes of lines, none of which light of one wavelength fades by alone.

    Of a column c [m at relative density 1] the mean transmittance is Σ_k w_k exp(-κ_k c), with the
    weight w_k and the absorption κ_k of class k: no exponential of c. Light that is scattered goes
    by the same mean, of radiances simulated class by class, as long as lines that are strong in one
    place are strong in another: a correlated k-distribution.

    Source: Goody & Yung (1989), "Atmospheric Radiation", 2nd edition, chapter 4; Lacis & Oinas
    (1991), J. Geophys. Res. 96(D5), 9027. `skyfit.water_vapour` and `skyfit.oxygen` have numbers.

    Args:
        weights: Share of the spectrum that each class has, above 0; they add up to 1.
        absorption: Absorption of each class, where the relative density is 1, 0 or more;
            wavelengths as those of the atmosphere [m⁻¹]. Where no class absorbs, as far as that is
            known before compiling, none is simulated.
    """

    weights: Float[Array, " line_class"]
    strength: Float[Array, "line_class place"]
    place: tuple[int, ...] = eqx.field(static=True)
    width: int = eqx.field(static=True)

    def __init__(self, weights: ArrayLike, absorption: ArrayLike):
        shares, kappa = as_parameter(weights), as_parameter(absorption)
        if shares.ndim != 1 or shares.size == 0 or kappa.ndim != 2 or len(kappa) != len(shares):
            raise InputError(
                "Bands: expected weights [line_class] and absorption [line_class, wavelength]; got "
                f"shapes {shares.shape} and {kappa.shape}"
            )
        shares = check(
            shares, lambda v: ~((v > 0) & (v <= 1)), "Bands(weights=...) must be above 0, to 1"
        )
        self.weights = check(
            shares,
            lambda v: ~(abs(v.sum() - 1) < 1e-5),
            "Bands(weights=...) must add up to 1",
        )
        message = "Bands(absorption=...) must be 0 or more, in 1/m"
        kappa = check(kappa, lambda v: ~((v >= 0) & (v < np.inf)), message)
        self.width = kappa.shape[1]
        some = np.full(self.width, True) if is_traced(kappa) else np.asarray(kappa).any(axis=0)
        self.place = tuple(np.flatnonzero(some).tolist())
        self.strength = kappa[:, np.array(self.place, int)]

    @property
    def absorption(self) -> Float[Array, "line_class wavelength"]:
        """Of each class, where the relative density is 1 [m⁻¹]."""
        return self._at_all(self.strength)

    def scaled(self, factor: ArrayLike) -> "Bands":
        """The same lines, of so many times as much of what absorbs; derivatives go through.

        Args:
            factor: Factor of the absorption, 0 or more.
        """
        times = as_scalar(factor, "Bands.scaled(factor=...)")
        times = check(
            times,
            lambda v: ~((v >= 0) & (v < np.inf)),
            "Bands.scaled(factor=...) must be 0 or more",
        )
        return eqx.tree_at(lambda b: b.strength, self, times * self.strength)

    def transmittance(self, column: ArrayLike) -> Float[Array, " wavelength"]:
        """Mean over the classes of what a column [m at relative density 1] lets pass."""
        return jnp.exp(-self.optical_depth(column))

    def optical_depth(self, column: ArrayLike) -> Float[Array, " wavelength"]:
        """Of a column [m at relative density 1]: -ln of the mean transmittance [1].

        It is not proportional to the column, and does not add up over absorbers.
        """
        depth = as_scalar(column, "Bands.optical_depth(column=...)") * self.strength
        passed = jax.scipy.special.logsumexp(-depth, axis=0, b=self.weights[:, None])
        return self._at_all(-passed)

    def _at_all(self, values: Float[Array, "*batch place"]) -> Float[Array, "*batch wavelength"]:
        """Give 0 to the wavelengths without a band."""
        none = jnp.zeros((*values.shape[:-1], self.width), values.dtype)
        return none.at[..., np.array(self.place, int)].set(values)
