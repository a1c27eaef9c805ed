import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import phase
from skyfit.legendre import legendre_polynomials


ANGLES = np.radians([2.0, 10.0, 35.0, 90.0, 140.0, 175.0])
VALUES = np.array([[9.0, 8.0], [6.0, 7.0], [1.2, 1.0], [0.2, 0.3], [0.15, 0.1], [0.3, 0.4]])
FUNCTIONS = {
    "isotropic": phase.Isotropic(),
    "Rayleigh": phase.Rayleigh(),
    "Rayleigh depolarised": phase.Rayleigh(0.3),
    "Rayleigh by wavelength": phase.Rayleigh([0.02, 0.03]),
    "Henyey-Greenstein forward": phase.HenyeyGreenstein(0.76),
    "Henyey-Greenstein backward": phase.HenyeyGreenstein(-0.4),
    "Henyey-Greenstein by wavelength": phase.HenyeyGreenstein([0.5, 0.7]),
    "Cornette-Shanks": phase.CornetteShanks(0.76),
    "Cornette-Shanks by wavelength": phase.CornetteShanks([0.3, 0.7]),
    "table": phase.Tabulated(ANGLES, 17.0 * VALUES[:, 0]),
    "table by wavelength": phase.Tabulated(ANGLES, VALUES),
}
every = pytest.mark.parametrize("p", FUNCTIONS.values(), ids=FUNCTIONS)


def nodes(p):
    """Cosines, and weights that integrate over the sphere; cut where a table has a kink."""
    if not isinstance(p, phase.Tabulated):
        mu, weight = np.polynomial.legendre.leggauss(200)
        return mu, 2 * np.pi * weight
    edges = np.r_[0, ANGLES, np.pi]
    x, w = np.polynomial.legendre.leggauss(40)
    half = np.diff(edges)[:, None] / 2
    theta = ((edges[1:] + edges[:-1])[:, None] / 2 + half * x).ravel()
    return np.cos(theta), 2 * np.pi * np.sin(theta) * (half * w).ravel()


# Each is one small program: eager calls would compile every operation by itself.
@eqx.filter_jit
def density(p, mu):
    """Values with the wavelength axis there in any case."""
    return p.spectral(jnp.asarray(mu))


@eqx.filter_jit
def value(p, mu):
    return p(mu)


@eqx.filter_jit
def coefficients(p, degree):
    return p.legendre(degree)


@every
def test_phase_functions_integrate_to_one_over_the_sphere(p):
    mu, weight = nodes(p)
    # Rounding alone; a looser bound would hide little, a lost π nothing.
    np.testing.assert_allclose(weight @ density(p, mu), 1, rtol=1e-12)


def test_an_isotropic_function_is_one_in_four_pi():
    np.testing.assert_allclose(phase.Isotropic()(0.3), 0.07957747154594767, rtol=1e-15)


def test_rayleighs_function_is_twice_as_bright_forward_as_aside():
    p = phase.Rayleigh()
    np.testing.assert_allclose(p(0.0), 0.05968310365946075, rtol=1e-15)
    np.testing.assert_allclose([p(1.0), p(-1.0)], 2 * 0.05968310365946075, rtol=1e-15)


def test_depolarised_scattering_has_the_values_of_its_formula():
    # δ = 0.0279 is a King factor of 1.048, (6 + 3δ)/(6 - 7δ). At 90° 3/(8π) 1.0279/2.0279; forward
    # and backward 3/(8π) 2/2.0279.
    p = phase.Rayleigh(0.0279)
    np.testing.assert_allclose(p(0.0), 0.119366207 * 0.50687904, rtol=1e-8)
    np.testing.assert_allclose([p(1.0), p(-1.0)], 0.119366207 * 0.98624192, rtol=1e-8)
    np.testing.assert_allclose(coefficients(p, 2)[2, 0], 0.9721 / (5 * 2.0279), rtol=1e-14)
    # Isotropic where the light at 90° is wholly depolarised.
    np.testing.assert_allclose(phase.Rayleigh(1.0)(0.3), 1 / (4 * np.pi), rtol=1e-14)


def test_depolarisation_has_the_gradient_of_its_formula():
    @jax.jit
    @jax.grad
    def slope(delta):
        return phase.Rayleigh(delta)(0.5)

    # d/dδ of (1 + δ + (1 - δ) μ²) / (2 + δ) is (1 - 3 μ²) / (2 + δ)².
    want = 3 / (8 * np.pi) * 0.25 / 2.03**2
    np.testing.assert_allclose(slope(0.03), want, rtol=1e-12)


@pytest.mark.parametrize("delta", [-0.1, 1.1, np.nan])
def test_depolarisation_lies_between_0_and_1(delta):
    with pytest.raises(
        ValueError, match=r"Rayleigh\(depolarisation=...\) must lie in \[0, 1\]; got"
    ):
        phase.Rayleigh(delta)
    with pytest.raises(ValueError, match="expected one value or one per wavelength; got shape"):
        phase.Rayleigh([[0.1]])


def test_henyey_greensteins_function_has_its_textbook_values():
    # (1 - g²)/4π over (1 - g)³, over (1 + g²)^1.5 and over (1 + g)³ at g = 1/2.
    p = phase.HenyeyGreenstein(0.5)
    want = np.array([0.75 / 0.125, 0.75 / 1.25**1.5, 0.75 / 3.375]) / (4 * np.pi)
    np.testing.assert_allclose(p(jnp.array([1.0, 0.0, -1.0])), want, rtol=1e-14)


def test_cornette_shanks_function_has_its_textbook_values():
    # At g = 1/2, (1 - g²)/(2 + g²) is 1/3 and 1 + g² - 2gμ is 1/4, 5/4 and 9/4.
    p = phase.CornetteShanks(0.5)
    want = 3 / (8 * np.pi) * np.array([16 / 3, 1 / 3 / 1.25**1.5, 2 / 3 / 3.375])
    np.testing.assert_allclose(p(jnp.array([1.0, 0.0, -1.0])), want, rtol=1e-14)


def test_cornette_shanks_tends_to_rayleigh_without_asymmetry():
    mu = jnp.linspace(-1, 1, 7)
    np.testing.assert_allclose(phase.CornetteShanks(0.0)(mu), phase.Rayleigh()(mu), rtol=1e-15)


def test_cornette_shanks_mean_cosine_is_larger_than_its_parameter():
    g = 0.76  # Cornette & Shanks (1992): 3g (4 + g²) / 5 (2 + g²)
    want = 3 * g * (4 + g**2) / (5 * (2 + g**2))
    assert want > 0.8
    np.testing.assert_allclose(phase.CornetteShanks(g).mean_cosine, want, rtol=1e-14)


def test_a_table_is_log_linear_between_its_angles_and_constant_outside():
    p = phase.Tabulated(ANGLES, VALUES)
    at = np.radians([0.0, 1.0, 2.0, 6.0, 175.0, 180.0])
    ratio = density(p, np.cos(at)) / density(p, np.cos(np.radians([90.0])))
    between = np.sqrt(VALUES[0] * VALUES[1])
    want = np.stack([VALUES[0], VALUES[0], VALUES[0], between, VALUES[5], VALUES[5]]) / VALUES[3]
    np.testing.assert_allclose(ratio, want, rtol=1e-12)


def test_a_table_may_carry_any_factor():
    mu = jnp.linspace(-1, 1, 9)
    once, thousandfold = phase.Tabulated(ANGLES, VALUES), phase.Tabulated(ANGLES, 1e3 * VALUES)
    np.testing.assert_allclose(value(thousandfold, mu), value(once, mu), rtol=1e-13)


def test_a_table_from_0_to_180_degrees_integrates_to_one():
    p = phase.Tabulated([0.0, np.pi / 2, np.pi], [4.0, 1.0, 2.0])
    x, w = np.polynomial.legendre.leggauss(40)
    theta = np.pi / 4 * np.r_[1 + x, 3 + x]
    total = 2 * np.pi * np.pi / 4 * np.r_[w, w] @ (np.sin(theta) * value(p, np.cos(theta)))
    np.testing.assert_allclose(total, 1, rtol=1e-12)


@every
def test_legendre_coefficients_are_those_of_brute_force_quadrature(p):
    mu, weight = nodes(p)
    polynomials = np.polynomial.legendre.legvander(mu, 12).T
    want = polynomials @ (weight[:, None] * density(p, mu))
    np.testing.assert_allclose(coefficients(p, 12), want, atol=1e-13)


@every
def test_fewer_legendre_coefficients_are_the_first_of_more(p):
    for degree in (0, 1):
        few = coefficients(p, degree)
        assert few.shape[0] == degree + 1
        np.testing.assert_allclose(few, coefficients(p, 12)[: degree + 1], atol=1e-14)


@pytest.mark.parametrize("name", ["isotropic", "Rayleigh", "Rayleigh depolarised"])
def test_a_polynomial_has_no_coefficient_beyond_its_degree(name):
    p = FUNCTIONS[name]
    mu, weight = nodes(p)
    polynomials = np.polynomial.legendre.legvander(mu, 8).T
    chi = (polynomials @ (weight * density(p, mu)[:, 0])).ravel()
    above = int(p.max_degree or 0) + 1
    np.testing.assert_allclose(chi[above:], 0, atol=1e-14)
    assert abs(chi[above - 1]) > 0.05


@pytest.mark.parametrize("g", [-0.4, 0.0, 0.76])
def test_henyey_greensteins_mean_cosine_is_its_parameter(g):
    np.testing.assert_allclose(phase.HenyeyGreenstein(g).mean_cosine, g, atol=1e-16)


def test_legendre_polynomials_are_numpys():
    x = jnp.linspace(-1, 1, 11)
    want = [np.polynomial.legendre.Legendre.basis(n)(np.asarray(x)) for n in range(6)]
    np.testing.assert_allclose(legendre_polynomials(5, x), want, atol=1e-14)
    np.testing.assert_allclose(legendre_polynomials(0, x), want[:1])


@every
def test_a_wavelength_axis_comes_last_and_only_where_there_is_one(p):
    wavelengths = p.spectral(jnp.zeros(())).shape
    assert wavelengths == ((2,) if not p.is_grey else (1,))
    want = () if p.is_grey else (2,)
    assert value(p, jnp.array(0.5)).shape == want
    assert value(p, jnp.zeros((3, 1))).shape == (3, 1, *want)
    assert jax.eval_shape(lambda: p.mean_cosine).shape == want


@every
def test_a_phase_function_and_its_methods_can_be_jitted_as_they_are(p):
    want = value(p, jnp.array(0.3))
    np.testing.assert_allclose(jax.jit(p)(0.3), want, rtol=1e-14)
    np.testing.assert_allclose(jax.jit(p.spectral)(jnp.array(0.3)), jnp.atleast_1d(want))


@every
def test_float32_is_within_rounding_of_float64(p):
    mu = np.cos(np.linspace(0.01, 3.13, 50))
    want = value(p, mu)
    with jax.enable_x64(False):
        narrow = jax.tree.map(lambda leaf: jnp.asarray(leaf, jnp.float32), p)
        got = value(narrow, mu.astype(np.float32))
    assert got.dtype == jnp.float32
    # Rounding a cosine near 1 moves the angle of 0.01 by 6e-8 / 0.01.
    np.testing.assert_allclose(got, want, rtol=2e-5)


def test_strong_forward_scattering_keeps_its_peak_in_float32(float32):
    # 1 + g² - 2gμ as it stands would lose (1 - g)² = 1e-6 in the last digits of 2.
    got = phase.HenyeyGreenstein(0.999)(1.0)
    g = float(np.float32(0.999))
    np.testing.assert_allclose(got, (1 + g) / (4 * np.pi * (1 - g) ** 2), rtol=1e-5)


@every
def test_gradients_are_finite_forward_backward_and_at_a_tables_edges(p):
    mu = jnp.array([-1.0, -0.3, 0.0, float(np.cos(ANGLES[0])), 1.0])
    assert np.all(np.isfinite(jax.jit(jax.vmap(jax.grad(lambda m: p(m).sum())))(mu)))


@every
def test_gradients_agree_with_differences(p):
    mu = np.array([-0.71, 0.12, 0.93])
    got = jax.jit(jax.vmap(jax.jacfwd(lambda m: p(m))))(jnp.asarray(mu))
    want = (value(p, mu + 1e-6) - value(p, mu - 1e-6)) / 2e-6
    # Rounding of the density over the step, 1e-16 / 1e-6, and the step squared.
    np.testing.assert_allclose(got, want, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("kind", [phase.HenyeyGreenstein, phase.CornetteShanks])
def test_more_asymmetry_scatters_more_forward_as_the_derivative_says(kind):
    @jax.jit
    def forward(g):
        return kind(g)(0.9)

    want = (forward(0.6 + 1e-6) - forward(0.6 - 1e-6)) / 2e-6
    np.testing.assert_allclose(jax.grad(forward)(0.6), want, rtol=1e-8)
    assert np.isfinite(jax.jit(jax.grad(lambda g: kind(g).legendre(4).sum()))(0.0))


def test_a_tables_normalisation_is_part_of_its_gradient():
    @jax.jit
    def brightened(factor):
        values = jnp.asarray(VALUES[:, 0]).at[0].multiply(factor)
        return phase.Tabulated(ANGLES, values)(0.0)

    slope = jax.grad(brightened)(1.0)
    want = (brightened(1 + 1e-6) - brightened(1 - 1e-6)) / 2e-6
    assert slope < 0
    np.testing.assert_allclose(slope, want, rtol=1e-7)


@pytest.mark.parametrize("kind", [phase.HenyeyGreenstein, phase.CornetteShanks])
@pytest.mark.parametrize("g", [1.0, -1.0, 1.5, np.nan, [0.5, -1.2]])
def test_an_asymmetry_out_of_range_is_refused(kind, g):
    message = rf"^{kind.__name__}\(g=\.\.\.\) must lie in \(-1, 1\); got {np.ravel(g)[-1]:g}$"
    with pytest.raises(ValueError, match=message):
        kind(g)


def test_an_asymmetry_out_of_range_is_refused_under_jit():
    with pytest.raises(RuntimeError, match=r"HenyeyGreenstein\(g=\.\.\.\) must lie in"):
        eqx.filter_jit(lambda g: phase.HenyeyGreenstein(g)(1.0))(jnp.array(1.5))


def test_an_asymmetry_has_one_axis_at_most():
    with pytest.raises(ValueError, match=r"one value or one per wavelength; got shape \(1, 1\)$"):
        phase.CornetteShanks([[0.5]])


@pytest.mark.parametrize(
    ("angle", "value", "message"),
    [
        ([0.0, 2.0, 1.0], [1.0, 1.0, 1.0], r"angle must increase within \[0, pi\] rad; got 1$"),
        ([0.0, 2.0, 4.0], [1.0, 1.0, 1.0], r"angle must increase within \[0, pi\] rad; got 4$"),
        ([-0.1, 2.0], [1.0, 1.0], r"angle must increase within \[0, pi\] rad; got -0\.1$"),
        ([0.0, np.nan], [1.0, 1.0], r"angle must increase within \[0, pi\] rad; got nan$"),
        ([0.0, 2.0], [1.0, 0.0], r"value must be above 0; got 0$"),
        ([0.0, 2.0], [[1.0, -1.0], [1.0, 1.0]], r"value must be above 0; got -1$"),
        ([0.0, 2.0], [1.0, np.nan], r"value must be above 0; got nan$"),
        ([0.0, 2.0], [1.0, 1.0, 1.0], r"got shapes \(2,\) and \(3,\)$"),
        ([0.0], [1.0], r"two angles or more; got shapes \(1,\) and \(1,\)$"),
        ([0.0, 2.0], 1.0, r"got shapes \(2,\) and \(\)$"),
        ([0.0, 2.0], [[[1.0]], [[1.0]]], r"got shapes \(2,\) and \(2, 1, 1\)$"),
    ],
)
def test_a_table_that_is_none_is_refused(angle, value, message):
    with pytest.raises(ValueError, match="phase.Tabulated: .*" + message):
        phase.Tabulated(angle, value)
