"""Levenberg-Marquardt for batches of small fits, as a solver of optimistix."""

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Bool, Float, PyTree


class _State(eqx.Module):
    trial: Float[Array, " parameter"]
    predicted: Float[Array, ""]
    loss: Float[Array, ""]
    gram: Float[Array, "parameter parameter"]
    gradient: Float[Array, " parameter"]
    damping: Float[Array, ""]
    growth: Float[Array, ""]
    solved: Bool[Array, ""]
    terminate: Bool[Array, ""]
    result: optx.RESULTS


class NormalEquationsLM(optx.AbstractLeastSquaresSolver):
    """Levenberg-Marquardt on the normal equations, scaled by their diagonal.

    Made for many fits of a few parameters to some hundred residuals side by side, where a
    factorisation of the Jacobian is most of the work: a step costs one evaluation of the residuals
    with their tangents and one Cholesky factor. The step is measured in units of the diagonal
    (Marquardt 1963), the damping follows the gain ratio (Nielsen 1999). Parameters must be one
    array, scaled so that 1 is a large change.

    A fit has converged when an undamped step promises to lower the loss by less than `rtol` of it,
    or when the step is below `atol`.

    Attributes:
        rtol: Relative decrease of the loss, promised by an undamped step, that ends a fit.
        atol: Length of a step that ends a fit.
        norm: Norm that optimistix asks for.
        first_damping: Damping of the first step.
        longest_step: Largest change of a parameter in one step.
        equations: Function of the parameters and `args` that gives half the sum of squares, JᵀJ
            and Jᵀr, where these have a structure to use; by default the Jacobian of the residuals.
    """

    rtol: Any
    atol: float
    norm: Any = eqx.field(static=True, default=optx.max_norm)
    first_damping: float = 1e-3
    longest_step: float = 2.0
    equations: Callable[..., Any] | None = eqx.field(static=True, default=None)

    def init(
        self,
        fn: Any,
        y: Float[Array, " parameter"],
        args: PyTree,
        options: dict[str, Any],
        f_struct: PyTree,
        aux_struct: PyTree,
        tags: frozenset[object],
    ) -> _State:
        """State before the first evaluation, whose trial is the start itself."""
        zero = jnp.zeros((), y.dtype)
        return _State(
            trial=y,
            predicted=zero,
            loss=zero + jnp.inf,
            gram=jnp.zeros((y.size, y.size), y.dtype),
            gradient=jnp.zeros_like(y),
            damping=zero + self.first_damping,
            growth=zero + 2,
            solved=jnp.array(True),
            terminate=jnp.array(False),
            result=optx.RESULTS.successful,
        )

    def step(
        self,
        fn: Any,
        y: Float[Array, " parameter"],
        args: PyTree,
        options: dict[str, Any],
        state: _State,
        tags: frozenset[object],
    ) -> tuple[Float[Array, " parameter"], _State, PyTree]:
        """Evaluate the trial, take it or leave it, and propose the next."""
        if self.equations is None:
            loss, gram, gradient, aux = _normal_equations(fn, state.trial, args)
        else:
            (loss, gram, gradient), aux = self.equations(state.trial, args), None
        first = jnp.isinf(state.loss)
        # A trial that overflows is a bad one, not the end; a start that does is.
        ratio = jnp.where(first, 1.0, (state.loss - loss) / _above_zero(state.predicted))
        accept = jnp.isfinite(loss) & jnp.all(jnp.isfinite(gram)) & (ratio > 1e-4)
        failed = first & ~accept

        shrink = jnp.clip(1 - (2 * ratio - 1) ** 3, 0.1, 2.0)
        damping = jnp.where(first, 1.0, jnp.where(accept, shrink, state.growth)) * state.damping
        # Less damping than rounding errors of the equations would let a flat direction run away.
        damping = jnp.clip(damping, 10 * jnp.finfo(y.dtype).eps, 1e12)
        growth = jnp.where(accept, 2.0, 2 * state.growth)
        moved = state.trial - y
        y = jnp.where(accept, state.trial, y)
        loss, gram, gradient = jax.tree.map(
            lambda new, old: jnp.where(accept, new, old),
            (loss, gram, gradient),
            (state.loss, state.gram, state.gradient),
        )

        change, predicted, solved = self._propose(gram, gradient, damping)
        # What is promised under strong damping says nothing about the distance to the optimum.
        settled = (predicted <= self.rtol * loss) & (damping <= 1e-2) & solved
        stuck = (jnp.max(jnp.abs(moved)) <= self.atol) & ~first & state.solved
        return (
            y,
            _State(
                trial=y + change,
                predicted=predicted,
                loss=loss,
                gram=gram,
                gradient=gradient,
                damping=damping,
                growth=growth,
                solved=solved,
                terminate=settled | stuck,
                result=_result(failed),
            ),
            aux,
        )

    def terminate(
        self,
        fn: Any,
        y: Float[Array, " parameter"],
        args: PyTree,
        options: dict[str, Any],
        state: _State,
        tags: frozenset[object],
    ) -> tuple[Bool[Array, ""], optx.RESULTS]:
        """Whether the last step settled it."""
        return state.terminate, state.result

    def postprocess(
        self,
        fn: Any,
        y: Float[Array, " parameter"],
        aux: PyTree,
        args: PyTree,
        options: dict[str, Any],
        state: _State,
        tags: frozenset[object],
        result: optx.RESULTS,
    ) -> tuple[Float[Array, " parameter"], PyTree, dict[str, Any]]:
        """Hand on the loss with the solution."""
        return y, aux, {"loss": state.loss}

    def _propose(self, gram, gradient, damping):
        """The next step, by how much it should lower the loss, and whether there is one."""
        diagonal = jnp.diagonal(gram)
        floor = 1e-10 * jnp.max(diagonal) + jnp.finfo(gram.dtype).tiny
        scale = 1 / jnp.sqrt(jnp.maximum(diagonal, floor))
        scaled = gram * scale[:, None] * scale[None, :]
        factor = jax.scipy.linalg.cho_factor(
            scaled + damping * jnp.eye(scale.size, dtype=scale.dtype)
        )
        change = -scale * jax.scipy.linalg.cho_solve(factor, scale * gradient)
        # Equations that rounding errors made indefinite have no factor: more damping gives one.
        solved = jnp.all(jnp.isfinite(change))
        change = jnp.where(solved, change, 0.0)
        change = change / jnp.maximum(1.0, jnp.max(jnp.abs(change)) / self.longest_step)
        return change, -(gradient @ change + 0.5 * change @ gram @ change), solved


def _normal_equations(fn, y, args):
    """Half the sum of squares, JᵀJ, Jᵀr and what else `fn` returns."""

    def residuals(y):
        value, aux = fn(y, args)
        return value, (value, aux)

    jacobian, (residual, aux) = jax.jacfwd(residuals, has_aux=True)(y)
    jacobian, residual = jacobian.reshape(-1, y.size), residual.ravel()
    return 0.5 * residual @ residual, jacobian.T @ jacobian, residual @ jacobian, aux


def _result(failed) -> Any:
    names: Any = optx.RESULTS
    return names.where(failed, names.nonfinite_input, names.successful)


def _above_zero(x):
    return jnp.maximum(x, jnp.finfo(x.dtype).tiny)
