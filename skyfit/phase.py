"""Phase functions: how scattered light spreads over directions.

A phase function is a probability density [sr⁻¹]: its integral over the sphere is 1. (Many texts
use one that is 4π times larger.) It is called with the cosine of the scattering angle Θ, 1 being
forward, and answers in the same shape; with a wavelength axis last if it depends on wavelength.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._typing import ArrayLike, as_float, as_parameter, check, falls_or_stays
from .errors import InputError
from .legendre import legendre_polynomials, powers
from .phase_tables import normalised, panel_nodes


class AbstractPhaseFunction(eqx.Module):
    """Probability density of the scattering direction [sr⁻¹]."""

    __hash__ = object.__hash__  # arrays have none, and `jax.jit(phase)` asks for it

    @abc.abstractmethod
    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #wavelength"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last (size 1 if grey)."""

    @abc.abstractmethod
    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #wavelength"]:
        """Legendre coefficients χ₀…χ_degree; χ₀ = 1 and χ₁ is the mean cosine.

        p(Θ) = Σ (2l + 1) χ_l P_l(cos Θ) / 4π.
        """

    def __call__(self, cos_angle: ArrayLike) -> Float[Array, "..."]:
        """Density [sr⁻¹] at cosines of the scattering angle.

        Args:
            cos_angle: Cosine of the scattering angle, any shape.

        Returns:
            Same shape, with a wavelength axis appended if the function depends on wavelength.
        """
        values = self.spectral(as_float(cos_angle))
        return values[..., 0] if self.is_grey else values

    @property
    def is_grey(self) -> bool:
        """Whether the function is the same at every wavelength."""
        return True

    @property
    def max_degree(self) -> int | None:
        """Highest degree with a Legendre coefficient other than 0; None without end."""
        return None

    @property
    def mean_cosine(self) -> Float[Array, "..."]:
        """Mean cosine of the scattering angle."""
        mean = self.legendre(1)[1]
        return mean[0] if self.is_grey else mean


class Isotropic(AbstractPhaseFunction):
    """Equal in all directions: 1/4π."""

    @property
    def max_degree(self) -> int:
        """Highest degree with a Legendre coefficient other than 0: 0."""
        return 0

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch 1"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last."""
        return jnp.full((*cos_angle.shape, 1), 1 / (4 * np.pi), dtype=cos_angle.dtype)

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 1"]:
        """Legendre coefficients χ₀…χ_degree."""
        return as_float(np.eye(degree + 1, 1))


class Rayleigh(AbstractPhaseFunction):
    """Scattering by molecules, 3 (1 + δ + (1 - δ) cos²Θ) / (8π (2 + δ)).

    Without depolarisation 3 (1 + cos²Θ) / 16π, as Preetham et al. (1999), appendix A.3, have it.
    Air's molecules are not round: δ = 0.028 makes it 1.4 % brighter across and 1.4 % darker along
    the beam.

    Source: Bucholtz (1995), "Rayleigh-scattering calculations for the terrestrial atmosphere",
    Applied Optics 34(15), 2765, whose γ is δ / (2 - δ).

    Args:
        depolarisation: δ in [0, 1], of unpolarised light scattered at 90°: one value or one per
            wavelength. It is 0 for round molecules, 6 (F - 1) / (3 + 7 F) for a King factor F.
    """

    depolarisation: Float[Array, " #wavelength"]
    grey: bool = eqx.field(static=True)

    def __init__(self, depolarisation: ArrayLike = 0.0):
        value = as_parameter(depolarisation)
        if value.ndim > 1:
            raise InputError("Rayleigh(depolarisation=...): expected one value or one per "
                             f"wavelength; got shape {value.shape}")  # fmt: skip
        self.grey = value.ndim == 0
        message = "Rayleigh(depolarisation=...) must lie in [0, 1]"
        self.depolarisation = jnp.atleast_1d(
            check(value, lambda v: ~((v >= 0) & (v <= 1)), message)
        )

    @property
    def is_grey(self) -> bool:
        """Whether the function is the same at every wavelength."""
        return self.grey

    @property
    def max_degree(self) -> int:
        """Highest degree with a Legendre coefficient other than 0: 2."""
        return 2

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #wavelength"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last."""
        delta = self.depolarisation.reshape((1,) * cos_angle.ndim + self.depolarisation.shape)
        delta, mu = delta.astype(cos_angle.dtype), cos_angle[..., None]
        return 3 / (8 * np.pi) / (2 + delta) * (1 + delta + (1 - delta) * mu**2)

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #wavelength"]:
        """Legendre coefficients χ₀…χ_degree: 1, 0, (1 - δ) / (5 (2 + δ)), 0, …."""
        delta = self.depolarisation
        chi = jnp.zeros((max(degree, 2) + 1, delta.size), delta.dtype)
        chi = chi.at[0].set(1.0).at[2].set((1 - delta) / (5 * (2 + delta)))
        return chi[: degree + 1]


class _Asymmetric(AbstractPhaseFunction):
    """What the one-parameter functions share: g, grey or one value per wavelength."""

    g: Float[Array, " #wavelength"]
    grey: bool = eqx.field(static=True)

    def __init__(self, g: ArrayLike):
        value = as_parameter(g)
        if value.ndim > 1:
            raise InputError(f"{type(self).__name__}(g=...): expected one value or one per "
                             f"wavelength; got shape {value.shape}")  # fmt: skip
        self.grey = value.ndim == 0
        message = f"{type(self).__name__}(g=...) must lie in (-1, 1)"
        self.g = jnp.atleast_1d(check(value, lambda v: ~(abs(v) < 1), message))

    @property
    def is_grey(self) -> bool:
        """Whether the function is the same at every wavelength."""
        return self.grey

    def _per_wavelength(self, cos_angle):
        """Give g as many axes as the answer has."""
        return self.g.reshape((1,) * cos_angle.ndim + self.g.shape)


class HenyeyGreenstein(_Asymmetric):
    """Scattering by haze, (1 - g²) / (4π (1 + g² - 2 g cosΘ)^{3/2}).

    Source: Henyey & Greenstein (1941), Astrophysical Journal 93, 70. Hoffman & Preetham (2002)
    print (1 - g)², which integrates to (1 - g)/(1 + g).

    Args:
        g: Mean cosine, in (-1, 1); one value or one per wavelength.
    """

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #wavelength"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last."""
        g, mu = self._per_wavelength(cos_angle), cos_angle[..., None]
        # (1 - g)² + 2 g (1 - μ): the textbook 1 + g² - 2gμ cancels forward of g near 1.
        spread = (1 - g) ** 2 + 2 * g * (1 - mu)
        return (1 - g**2) / (4 * np.pi * spread * jnp.sqrt(spread))

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #wavelength"]:
        """Legendre coefficients χ₀…χ_degree: powers of g."""
        return powers(self.g, degree)


class CornetteShanks(_Asymmetric):
    """Scattering by haze, 3 (1 - g²)(1 + cos²Θ) / (8π (2 + g²) (1 + g² - 2 g cosΘ)^{3/2}).

    Tends to Rayleigh's function as g tends to 0. Its mean cosine is larger than g: 0.81 at 0.76.

    Source: Cornette & Shanks (1992), "Physically reasonable analytic expression for the
    single-scattering phase function", Applied Optics 31(16), 3152.

    Args:
        g: Parameter of the formula, in (-1, 1); one value or one per wavelength.
    """

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #wavelength"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last."""
        g, mu = self._per_wavelength(cos_angle), cos_angle[..., None]
        spread = (1 - g) ** 2 + 2 * g * (1 - mu)
        norm = 3 / (8 * np.pi) * (1 - g**2) / (2 + g**2)
        return norm * (1 + mu**2) / (spread * jnp.sqrt(spread))

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #wavelength"]:
        """Legendre coefficients χ₀…χ_degree, from those of Henyey & Greenstein's function.

        (1 + μ²) P_l expands in P_{l-2}, P_l and P_{l+2}; g^l stands for each P_l.
        """
        g = self.g
        series = powers(g, degree + 2)
        n = np.arange(degree + 1, dtype=float)[:, None]
        up = (n + 1) * (n + 2) / ((2 * n + 1) * (2 * n + 3))
        down = np.where(n > 1, n * (n - 1) / ((2 * n + 1) * np.where(n > 0, 2 * n - 1, 1)), 0)
        same = (n + 1) ** 2 / ((2 * n + 1) * (2 * n + 3)) + np.where(
            n > 0, n**2 / ((2 * n + 1) * np.where(n > 0, 2 * n - 1, 1)), 0
        )
        below = jnp.concatenate([jnp.zeros_like(series[:2]), series])[: degree + 1]
        up, down, same = (jnp.asarray(c, series.dtype) for c in (up, down, same))
        mixed = up * series[2:] + (1 + same) * series[: degree + 1] + down * below
        return (3 / (2 * (2 + g**2)))[None, :] * mixed


class Tabulated(AbstractPhaseFunction):
    """A phase function given at angles, log-linear between them and constant outside.

    Normalised on construction, by the exact integral of that interpolation: the values may carry
    any factor.

    Args:
        angle: Scattering angles, two or more, increasing within [0, π] [rad].
        value: Values above 0 at each angle: [angle] or [angle, wavelength].
    """

    angle: Float[Array, " angle"]
    log_value: Float[Array, "angle #wavelength"]
    grey: bool = eqx.field(static=True)

    def __init__(self, angle: ArrayLike, value: ArrayLike):
        theta, p = as_parameter(angle), as_parameter(value)
        if theta.ndim != 1 or theta.size < 2 or p.ndim not in (1, 2) or p.shape[0] != theta.size:
            raise InputError(
                "phase.Tabulated: expected angle [angle] and value [angle] or [angle, "
                f"wavelength], two angles or more; got shapes {theta.shape} and {p.shape}"
            )
        theta = check(
            theta,
            lambda v: falls_or_stays(v) | (v < 0) | (v > np.pi + 1e-6),
            "phase.Tabulated: angle must increase within [0, pi] rad",
        )
        p = check(p, lambda v: ~((v > 0) & (v < np.inf)), "phase.Tabulated: value must be above 0")
        self.grey = p.ndim == 1
        self.angle = theta
        self.log_value = normalised(theta, p if p.ndim == 2 else p[:, None])

    @property
    def is_grey(self) -> bool:
        """Whether the function is the same at every wavelength."""
        return self.grey

    def spectral(self, cos_angle: Float[Array, "*batch"]) -> Float[Array, "*batch #wavelength"]:
        """Density [sr⁻¹] at cosines of the scattering angle, wavelength last."""
        # The table is flat forward of its first angle: holding the cosine there changes no value,
        # and keeps the infinite slope of arccos at ±1 out of the gradient.
        near, far = jnp.cos(self.angle[0]), jnp.cos(self.angle[-1])
        inside = (cos_angle < near) & (cos_angle > far) & (jnp.abs(cos_angle) < 1)
        theta = jnp.arccos(jnp.where(inside, cos_angle, 0.0))
        theta = jnp.where(inside, theta, jnp.where(cos_angle >= near, 0.0, np.pi))
        left = jnp.searchsorted(self.angle, theta, method="compare_all") - 1
        left = jnp.clip(left, 0, self.angle.size - 2)
        start, end = self.angle[left], self.angle[left + 1]
        share = jnp.clip((theta - start) / (end - start), 0, 1)[..., None]
        log_value = (1 - share) * self.log_value[left] + share * self.log_value[left + 1]
        return jnp.exp(log_value)

    def legendre(self, degree: int) -> Float[Array, "{degree}+1 #wavelength"]:
        """Legendre coefficients χ₀…χ_degree, by Gauss quadrature between the table's angles."""
        theta, weight = panel_nodes(self.angle, nodes_per_panel=12 + 4 * degree // self.angle.size)
        polynomials = legendre_polynomials(degree, jnp.cos(theta))
        weighted = (2 * np.pi * weight * jnp.sin(theta))[:, None] * self.spectral(jnp.cos(theta))
        return polynomials @ weighted
