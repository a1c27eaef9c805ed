import inspect

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit._typing import as_float, as_parameter, as_scalar, as_wavelengths, check


def positive(value):
    return check(value, lambda v: ~(v > 0), "height must be above 0 m")


@pytest.mark.parametrize("three", [3, 3.0, np.float64(3), np.float32(3), np.array(3), jnp.array(3)])
def test_every_spelling_of_a_number_is_one_program(three):
    assert as_float(three).dtype == as_scalar(three, "three").dtype == jnp.float64
    assert not as_float(three).weak_type


def test_points_keep_their_width_and_descriptions_do_not():
    narrow = np.ones(3, np.float32)
    assert as_float(narrow).dtype == jnp.float32
    assert as_parameter(narrow).dtype == jnp.float64


def test_lists_and_lists_of_lists_are_arrays():
    assert as_float([[1, 2.5], [3, 4]]).shape == (2, 2)
    np.testing.assert_array_equal(as_wavelengths([400, 500.5], "w"), [400, 500.5])


def test_one_wavelength_is_a_spectrum_of_one():
    assert as_wavelengths(550, "w").shape == (1,)


def test_without_float64_everything_is_float32(float32):
    assert as_float(np.ones(2)).dtype == as_parameter(np.ones(2)).dtype == jnp.float32


def test_a_value_in_its_domain_passes_unchanged():
    value = jnp.array([1.0, 2.0])
    assert check(value, lambda v: ~(v > 0), "…") is value


def test_the_message_shows_the_first_value_out_of_domain():
    with pytest.raises(ValueError, match=r"^height must be above 0 m; got -2\.5$"):
        positive(jnp.array([1.0, -2.5, -3.0]))


def test_nan_is_out_of_every_domain():
    with pytest.raises(ValueError, match="got nan"):
        positive(jnp.array(np.nan))


def test_a_traced_value_is_refused_when_the_program_runs():
    with pytest.raises(RuntimeError, match="height must be above 0 m"):
        eqx.filter_jit(positive)(jnp.array(-1.0))


def test_a_traced_value_in_its_domain_passes():
    assert jax.jit(positive)(jnp.array(2.0)) == 2


def test_checking_is_transparent_to_gradients():
    assert jax.grad(lambda v: 3 * positive(v))(2.0) == 3


@pytest.mark.parametrize("value", ["8 km", None, [1.0, 2.0]])
def test_what_is_not_one_number_is_named(value):
    with pytest.raises(ValueError, match=r"^thing\(size=\.\.\.\): expected (a number|one value)"):
        # Without the suite's type checks: a user may pass anything.
        inspect.unwrap(as_scalar)(value, "thing(size=...)")


@pytest.mark.parametrize(
    ("wavelengths", "got"),
    [
        ([500.0, 400.0], "400"),
        ([400.0, 400.0], "400"),
        ([400.0, np.nan], "nan"),
        ([np.nan, 500.0], "nan"),
        ([-1.0, 500.0], "-1"),
        ([400.0, np.inf], "inf"),
    ],
)
def test_wavelengths_that_do_not_increase_are_refused(wavelengths, got):
    with pytest.raises(ValueError, match=rf"^w must increase from above 0 nm; got {got}$"):
        as_wavelengths(wavelengths, "w")


def test_unsorted_wavelengths_are_refused_under_jit():
    with pytest.raises(RuntimeError, match="w must increase"):
        eqx.filter_jit(lambda w: as_wavelengths(w, "w"))(jnp.array([2.0, 1.0]))


@pytest.mark.parametrize("wavelengths", [[], [[400.0, 500.0]]])
def test_wavelengths_without_one_axis_are_refused(wavelengths):
    with pytest.raises(ValueError, match=r"^w: expected one axis of one value or more; got shape"):
        as_wavelengths(wavelengths, "w")
