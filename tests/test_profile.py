import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit import profile
from skyfit.constants import TOP_OF_ATMOSPHERE


pytestmark = pytest.mark.any_precision


# Density [kg m⁻³] at geometric altitude [m]: U.S. Standard Atmosphere 1976, table I, as printed.
PRINTED = {
    0.0: 1.2250,
    1e3: 1.1117,
    2e3: 1.0066,
    5e3: 0.73643,
    8e3: 0.52579,
    10e3: 0.41351,
    15e3: 0.19476,
    20e3: 0.088910,
    25e3: 0.040084,
    30e3: 0.018410,
    40e3: 0.0039957,
    50e3: 0.0010269,
    60e3: 3.0968e-4,
    70e3: 8.2829e-5,
    80e3: 1.8458e-5,
}
PROFILES = [
    profile.Exponential(8e3),
    profile.Tabulated([0.0, 1e3, 4e3, 60e3], [1.0, 0.5, 0.2, 0.1]),
    profile.StandardAtmosphere(),
    profile.elterman_haze(),
    profile.Squared(profile.StandardAtmosphere()),
]
# Small programs: eager calls would compile every operation by itself.
density = eqx.filter_jit(lambda rho, altitude: rho(altitude))
column = eqx.filter_jit(lambda rho, top: rho.column(top))
names = pytest.mark.parametrize("rho", PROFILES, ids=lambda p: type(p).__name__)


@pytest.mark.parametrize(("altitude", "printed"), PRINTED.items())
def test_the_standard_atmosphere_has_the_printed_densities(altitude, printed):
    got = 1.2250 * density(profile.StandardAtmosphere(), jnp.array(altitude))
    # Five digits are printed, so half of the last is up to 4.5e-5.
    np.testing.assert_allclose(got, printed, rtol=5e-5)


def test_the_standard_atmosphere_is_continuous_across_its_layers():
    for base in (11e3, 20e3, 32e3, 47e3, 51e3, 71e3, 84.852e3):
        edge = 6.356766e6 * base / (6.356766e6 - base)
        low, high = density(profile.StandardAtmosphere(), jnp.array([edge - 1e-3, edge + 1e-3]))
        # The last base pressure is printed to five digits; 2 mm change the density by 3e-7.
        np.testing.assert_allclose(high, low, rtol=2e-5)


@pytest.mark.float64
def test_the_standard_atmosphere_thins_out_for_ever():
    rho = density(profile.StandardAtmosphere(), jnp.linspace(0, 1e6, 2001))
    assert np.all(np.diff(rho) < 0)
    assert np.all(np.asarray(rho) > 0)


def test_the_air_above_the_ground_is_as_heavy_as_the_ground_pressure():
    # Hydrostatic balance with gravity g0 (r0 / r)²: what is above 60 km weighs 22 Pa, and the
    # density column is p0 / (ρ0 g0) but for gravity's 0.2 % at the height of the column's middle.
    air = column(profile.StandardAtmosphere(), TOP_OF_ATMOSPHERE)
    np.testing.assert_allclose(air, 101325 / (1.2250 * 9.80665), rtol=3e-3)


@pytest.mark.float64
def test_the_standard_column_is_that_of_a_fine_sum():
    altitude = (np.arange(60000) + 0.5) * 1.0
    want = np.sum(density(profile.StandardAtmosphere(), altitude))
    # The sum errs by (1 m / 8 km)² / 24 = 1e-9, the quadrature by the kinks inside its panels.
    np.testing.assert_allclose(column(profile.StandardAtmosphere(), 60e3), want, rtol=1e-7)


def test_eltermans_column_is_1580_metres_of_ground_density():
    # Trapezia over the printed table to 32 km; interpolating its logarithm gives 1516 m.
    np.testing.assert_allclose(column(profile.elterman_haze(), 60e3), 1581.690, rtol=1e-6)


@pytest.mark.float64
def test_eltermans_haze_falls_as_printed_and_ends_at_32_km():
    altitude = jnp.array([0.0, 1e3, 2.5e3, 10e3, 32e3, 32e3 + 1e-6, 40e3])
    want = [1, 0.106 / 0.24, (0.0456 + 0.0191) / 0.48, 4.82e-3 / 0.24, 1.11e-4 / 0.24, 0, 0]
    np.testing.assert_allclose(density(profile.elterman_haze(), altitude), want, rtol=1e-11)


@pytest.mark.float64
def test_an_exponential_falls_by_e_with_every_scale_height():
    altitude = jnp.array([0.0, 1200.0, 2400.0])
    want = [1, 0.36787944117144233, 0.1353352832366127]
    np.testing.assert_allclose(density(profile.Exponential(1200.0), altitude), want, rtol=1e-15)


@pytest.mark.float64
def test_the_column_of_an_exponential_is_its_scale_height():
    # 1 - e^{-50}; 200 m is the thinnest layer the docstring promises.
    for height in (200.0, 1200.0):
        np.testing.assert_allclose(column(profile.Exponential(height), 60e3), height, rtol=1e-9)


@pytest.mark.float64
def test_a_table_is_linear_inside_constant_below_and_nothing_above():
    rho = profile.Tabulated([100.0, 200.0, 400.0], [0.4, 1.0, 0.5])
    altitude = jnp.array([0.0, 100.0, 125.0, 300.0, 400.0, 400.1])
    np.testing.assert_allclose(density(rho, altitude), [0.4, 0.4, 0.55, 0.75, 0.5, 0], rtol=1e-14)


def test_a_long_table_is_read_like_a_short_one():
    altitude = np.linspace(0, 60e3, 301)
    long = profile.Tabulated(altitude, np.exp(-altitude / 7e3))
    at = jnp.linspace(-100.0, 61e3, 1777)
    want = np.interp(at, altitude, np.exp(-altitude / 7e3), right=0)
    np.testing.assert_allclose(density(long, at), want, atol=1e-15)


def test_profiles_tell_where_they_are_not_smooth():
    assert profile.Exponential(8e3).knots().size == 0
    np.testing.assert_array_equal(profile.elterman_haze().knots(), 1e3 * np.arange(33))
    # The standard's layers meet at whole geopotential kilometres: 11 is 11.019 km, 20 is 20.063.
    knots = profile.StandardAtmosphere().knots()
    want = [11.019, 20.063, 32.162, 47.350, 51.413, 71.802, 86.000]
    np.testing.assert_allclose(1e-3 * knots, want, atol=6e-4)


@pytest.mark.float64
@names
def test_profiles_answer_in_the_shape_of_the_altitude(rho):
    assert density(rho, 1e3).shape == ()
    assert density(rho, jnp.ones((2, 1, 3))).shape == (2, 1, 3)


@pytest.mark.float64
@names
def test_a_profile_and_its_methods_can_be_jitted_and_vmapped_as_they_are(rho):
    altitude = jnp.array([0.0, 2718.0])
    want = density(rho, altitude)
    np.testing.assert_allclose(jax.jit(rho)(altitude), want, rtol=1e-14)
    np.testing.assert_allclose(jax.jit(jax.vmap(rho))(altitude), want, rtol=1e-14)
    np.testing.assert_allclose(jax.jit(rho.column)(60e3), column(rho, 60e3), rtol=1e-14)


@pytest.mark.float64
@names
def test_profiles_in_float32_are_within_rounding_of_float64(rho):
    # 30.4 km in steps of 301 m: no knot is hit, where a table jumps to nothing.
    altitude = 301.0 * np.arange(102)
    want = density(rho, altitude)
    with jax.enable_x64(False):
        narrow = jax.tree.map(lambda leaf: jnp.asarray(leaf, jnp.float32), rho)
        got = density(narrow, altitude.astype(np.float32))
    assert got.dtype == jnp.float32
    # Differences of densities near 1 make up a table's small ones: absolute, not relative.
    np.testing.assert_allclose(got, want, rtol=3e-6, atol=3e-7)


@pytest.mark.float64
@names
def test_gradients_are_finite_and_agree_with_differences_between_knots(rho):
    altitude = jnp.array([2718.0, 15e3, 0.0, 1e3, 11e3, 32e3, 60e3])
    slope = jax.jit(jax.vmap(jax.grad(rho)))(altitude)
    assert np.all(np.isfinite(slope))
    want = (density(rho, altitude + 1.0) - density(rho, altitude - 1.0)) / 2
    # The first lies between knots, as does the second but for a table's. Curvature over a metre:
    # (1 m / 1 km)² / 6.
    np.testing.assert_allclose(slope[0], want[0], rtol=1e-6)
    if not isinstance(rho, profile.Tabulated):
        np.testing.assert_allclose(slope[1], want[1], rtol=1e-6)


@pytest.mark.float64
def test_density_rises_with_the_scale_height_as_the_derivative_says():
    slope = jax.grad(lambda height: profile.Exponential(height)(2e3))(8e3)
    np.testing.assert_allclose(slope, np.exp(-0.25) * 2e3 / 8e3**2, rtol=1e-14)


@pytest.mark.parametrize("height", [0.0, -8e3, np.nan])
def test_a_scale_height_must_be_positive(height):
    with pytest.raises(ValueError, match=r"^Exponential\(scale_height=\.\.\.\) must be above 0 m"):
        profile.Exponential(height)


def test_a_scale_height_is_one_number():
    with pytest.raises(ValueError, match=r"scale_height=.*: expected one value; got shape \(2,\)$"):
        profile.Exponential([8e3, 1.2e3])


def test_a_scale_height_is_checked_under_jit():
    with pytest.raises(RuntimeError, match="must be above 0 m"):
        eqx.filter_jit(lambda height: profile.Exponential(height)(1e3))(jnp.array(-1.0))


@pytest.mark.parametrize(
    ("altitude", "density", "message"),
    [
        ([0.0, 2e3, 1e3], [1.0, 0.5, 0.2], r"altitude must increase; got 1000$"),
        ([0.0, np.nan, 1e3], [1.0, 0.5, 0.2], r"altitude must increase; got nan$"),
        ([0.0, 1e3], [1.0, -0.5], r"relative_density must be 0 or more; got -0\.5$"),
        ([0.0, 1e3], [1.0, np.nan], r"relative_density must be 0 or more; got nan$"),
        ([0.0, 1e3], [1.0, 0.5, 0.2], r"one shape.* got shapes \(2,\) and \(3,\)$"),
        ([0.0], [1.0], r"two values or more; got shapes \(1,\) and \(1,\)$"),
        ([[0.0, 1.0]], [[1.0, 0.0]], r"got shapes \(1, 2\) and \(1, 2\)$"),
    ],
)
def test_a_table_out_of_order_is_refused(altitude, density, message):
    with pytest.raises(ValueError, match="profile.Tabulated: .*" + message):
        profile.Tabulated(altitude, density)


def test_the_square_of_an_exponential_has_half_its_scale_height():
    pairs, half = profile.Squared(profile.Exponential(8e3)), profile.Exponential(4e3)
    altitude = jnp.array([0.0, 1e3, 20e3])
    np.testing.assert_allclose(density(pairs, altitude), density(half, altitude), rtol=1e-12)
    layers = profile.StandardAtmosphere()
    np.testing.assert_array_equal(profile.Squared(layers).knots(), layers.knots())
