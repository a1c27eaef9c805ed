"""Spectra: integrals against tabulated curves, and the daylight basis."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit.spectrum import daylight_basis, daylight_table, product_weights
from skyfit.tables import read_table


NODES = np.arange(360.0, 831.0)


def bump(centre, width):
    return np.exp(-0.5 * ((NODES - centre) / width) ** 2)[:, None]


def test_a_flat_spectrum_integrates_to_the_area_under_the_curve():
    # The 1 nm trapezoid of a Gaussian is exact to rounding; its tails beyond 360 nm hold 1e-11.
    weights = product_weights(jnp.array([360.0, 500.0, 830.0]), NODES, bump(560, 30))
    np.testing.assert_allclose(weights.sum(), 30 * np.sqrt(2 * np.pi), rtol=1e-10)


def test_a_ramp_integrates_to_the_first_moment_whatever_the_grid():
    rng = np.random.default_rng(0)
    grid = np.sort(np.r_[360, 830, rng.uniform(360, 830, 9)])
    weights = np.asarray(product_weights(jnp.asarray(grid), NODES, bump(560, 30)))[:, 0]
    # ∫ λ g dλ = 560 · area: symmetric, and a linear spectrum is resolved by any grid.
    np.testing.assert_allclose(weights @ grid, 560 * 30 * np.sqrt(2 * np.pi), rtol=1e-10)


def test_two_lines_multiply_to_a_parabola_between_grid_and_node():
    # (λ - 400)/10 falls against the constant 1 on half a cell: ∫₀⁵ (1 - t/10) dt = 3.75.
    nodes = np.array([360.0, 400.0, 405.0, 405.000001, 830.0])
    curve = np.array([0.0, 1.0, 1.0, 0.0, 0.0])[:, None]
    weights = product_weights(jnp.array([400.0, 410.0]), nodes, curve)
    np.testing.assert_allclose(weights[:, 0], [3.75, 1.25], atol=1e-6)


def test_light_outside_the_grid_does_not_count():
    weights = product_weights(jnp.array([550.0, 570.0]), NODES, bump(560, 1e4))
    np.testing.assert_allclose(weights.sum(), 20, rtol=1e-4)


def test_weights_have_a_gradient_with_respect_to_the_grid():
    grid = jnp.array([400.0, 512.3, 601.7, 700.0])

    def total(grid):
        return (product_weights(grid, NODES, bump(560, 30))[:, 0] * grid**2).sum()

    step = 1e-3 * jnp.array([0.0, 1.0, -0.5, 0.0])
    slope = (total(grid + step) - total(grid - step)) / 2
    # The trapezoid has kinks where a grid point crosses a node; none is crossed here.
    np.testing.assert_allclose(jax.grad(total)(grid) @ step, slope, rtol=1e-6)


def test_daylight_basis_is_table_2_where_the_paper_has_values():
    table = read_table("preetham1999_table2_spectra")
    basis = np.asarray(daylight_basis(table["wavelength_nm"]))
    np.testing.assert_array_equal(basis, np.stack([table[f"S{k}"] for k in range(3)], axis=1))


def test_daylight_basis_is_the_cie_table_beyond_the_paper():
    # CIE 015:2018, table 6, at 300, 330, 360, 790 and 830 nm
    want = [
        [0.04, 0.02, 0.0],
        [55.3, 42.0, 8.5],
        [61.5, 38.0, 5.3],
        [66.0, -10.6, 7.0],
        [61.9, -9.8, 6.5],
    ]
    got = daylight_basis([300.0, 330.0, 360.0, 790.0, 830.0])
    np.testing.assert_allclose(got, want, atol=1e-12)


def test_daylight_tables_join_without_a_jump():
    nodes, values = daylight_table()
    assert np.all(np.diff(nodes) > 0)
    # Nowhere outside do neighbours differ by more than inside, joints included.
    steps = np.abs(np.diff(values, axis=0)).max(axis=1)
    inside = (nodes[:-1] >= 380) & (nodes[1:] <= 780)
    assert steps[~inside].max() <= steps[inside].max()
    np.testing.assert_allclose(daylight_basis(380.0 - 1e-9), daylight_basis(380.0), atol=1e-8)


@pytest.mark.parametrize("bad", [299.9, 830.1, np.nan])
def test_daylight_outside_300_to_830_nm_is_refused(bad):
    with pytest.raises(ValueError, match="must lie in 300 to 830 nm; got"):
        daylight_basis([500.0, bad])
