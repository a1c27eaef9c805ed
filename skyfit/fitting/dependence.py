"""How the coefficients of a distribution depend on what was swept.

A dependence interpolates coefficients between nodes. Where they are within bounds at the nodes
they are so in between, and numbers at the nodes are far less correlated than slope and intercept.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float


class AbstractDependence(eqx.Module):
    """Weights that mix the coefficients at the nodes into those of a sky."""

    @property
    @abc.abstractmethod
    def num_nodes(self) -> int:
        """How many sets of coefficients there are."""

    @abc.abstractmethod
    def basis(self, parameter: Float[Array, " sky"]) -> Float[Array, "sky node"]:
        """Weight of each node for each sky."""

    @abc.abstractmethod
    def line(self, nodes: Float[Array, "node coefficient"]) -> Float[Array, "coefficient 2"]:
        """Slope in the parameter and intercept of each coefficient."""


class Constant(AbstractDependence):
    """The same coefficients for all skies."""

    @property
    def num_nodes(self) -> int:
        """One."""
        return 1

    def basis(self, parameter):
        """Ones."""
        return jnp.ones((*parameter.shape, 1), parameter.dtype)

    def line(self, nodes):
        """Slope 0."""
        return jnp.stack([jnp.zeros_like(nodes[0]), nodes[0]], axis=-1)


class Linear(AbstractDependence):
    """Coefficients linear in the parameter: the form of Preetham et al. (1999).

    Attributes:
        low: Smallest value of the parameter, where the first node is.
        high: Largest value, where the second is.
    """

    low: Float[Array, ""]
    high: Float[Array, ""]

    @property
    def num_nodes(self) -> int:
        """Two."""
        return 2

    def basis(self, parameter):
        """Linear interpolation between the ends."""
        share = (parameter - self.low) / (self.high - self.low)
        return jnp.stack([1 - share, share], axis=-1)

    def line(self, nodes):
        """Slope and intercept through the ends."""
        slope = (nodes[1] - nodes[0]) / (self.high - self.low)
        return jnp.stack([slope, nodes[0] - slope * self.low], axis=-1)


def linear_in(parameter: ArrayLike) -> AbstractDependence:
    """Linear between the smallest and the largest value, constant if they are the same."""
    values = np.asarray(parameter)
    if np.ptp(values) == 0:
        return Constant()
    return Linear(as_float(values.min()), as_float(values.max()))
