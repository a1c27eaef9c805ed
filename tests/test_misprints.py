"""One test for each misprint and trap of the sources; docs/misprints.md cites them by name.

P99: Preetham, Shirley & Smits (1999), "A Practical Analytic Model for Daylight". HP02: Hoffman &
Preetham (2002), "Photorealistic Real-Time Outdoor Light Scattering". SCS: "Simulating the Colors of
the Sky", a tutorial on Nishita's ray marcher. DAY: "Simulating a Day's Sky", a shader of P99.
Formulas are written out as printed, beside what is right.
"""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import twin

from skyfit import phase, preetham_air
from skyfit.colour import spectrum_to_xyY
from skyfit.models import preetham_sky
from skyfit.tables import read_table


GREEN = 550.0  # nm
HAZE_DECAY, AIR_DECAY = 0.8333e-3, 0.1136e-3  # 1/m; P99, appendix A.4
NODES, WEIGHTS = np.polynomial.legendre.leggauss(400)


def perez_coefficients(channel, turbidity):
    """A to E as P99's appendix A.2 gives them."""
    table = read_table("preetham1999_perez_coefficients")
    rows = table["channel"] == channel
    return table["slope_per_turbidity"][rows] * turbidity + table["intercept"][rows]


def zenith_luminance(turbidity, sun_zenith):
    """P99, appendix A.2 [kcd/m²]."""
    chi = (4 / 9 - turbidity / 120) * (np.pi - 2 * sun_zenith)
    return (4.0453 * turbidity - 4.9710) * np.tan(chi) - 0.2155 * turbidity + 2.4192


# 1. P99 A.3: c·1e-16


def test_the_haze_concentration_is_of_the_order_1e_minus_18_not_1e_minus_16():
    atm = preetham_air.preetham_atmosphere(2.0, wavelengths=GREEN)
    air, haze = atm.scattering[:, 0]
    printed = 100 * float(preetham_air.haze_scattering(2.0, GREEN))
    assert printed > 80 * float(haze)
    np.testing.assert_allclose(printed, 7.9e-3, rtol=0.01)
    # Koschmieder: 42 km against 490 m, for what P99 calls a very clear day.
    mended = float(preetham_air.haze_scattering(2.0, GREEN))
    np.testing.assert_allclose(3.912 / (float(air) + mended), 42e3, rtol=0.01)
    assert 3.912 / (float(air) + printed) < 500


# 2. P99 §4.1: the sign of K


def test_the_exponent_of_extinction_has_a_positive_k():
    beta, alpha, cosine, length = 7.9e-5, HAZE_DECAY, 0.5, 20e3
    path = 0.5 * length * (NODES + 1)
    depth = 0.5 * length * WEIGHTS @ (beta * np.exp(-alpha * path * cosine))
    h, u = 1.0, np.exp(-alpha * length * cosine)
    k = beta / (alpha * cosine)
    np.testing.assert_allclose(np.exp(-k * (h - u)), np.exp(-depth), rtol=1e-12)
    assert np.exp(k * (h - u)) > 1  # as printed, light grows on its way


# 3. P99 A.4: slopes of the Hermite cubic


def haze_integral(view_zenith, length, slopes=None, haze=7.9e-5, air=1.36e-5):
    """P99's I₁ by quadrature of equation 9, or of equation 11 with a cubic of given end slopes."""
    cosine = np.cos(view_zenith)
    k1, k2 = haze / (HAZE_DECAY * cosine), air / (AIR_DECAY * cosine)
    ratio = AIR_DECAY / HAZE_DECAY
    if slopes is None:
        x = 0.5 * length * (NODES + 1)
        u1, u2 = np.exp(-HAZE_DECAY * x * cosine), np.exp(-AIR_DECAY * x * cosine)
        return 0.5 * length * WEIGHTS @ (u1 * np.exp(-k1 * (1 - u1) - k2 * (1 - u2)))

    def f(v):
        return np.exp(-k2 * (1 - v**ratio))

    end = np.exp(-HAZE_DECAY * length * cosine)
    v = end + 0.5 * (1 - end) * (NODES + 1)
    by_v = [k2 * ratio * u ** (ratio - 1) * f(u) for u in (1.0, end)]
    by_x = [-air * u**ratio * f(u) for u in (1.0, end)]
    first, last = by_v if slopes == "by v" else by_x
    rows = [[1, 1, 1, 1], [end**3, end**2, end, 1], [3, 2, 1, 0], [3 * end**2, 2 * end, 1, 0]]
    cubic = np.linalg.solve(rows, [1, f(end), first, last])
    integrand = np.exp(-k1 * (1 - v)) * np.polyval(cubic, v)
    return 0.5 * (1 - end) * WEIGHTS @ integrand / (HAZE_DECAY * cosine)


def error(degrees, length, slopes):
    view = np.radians(degrees)
    return abs(haze_integral(view, length, slopes) / haze_integral(view, length) - 1)


def test_the_hermite_closed_form_is_good_on_short_paths_only_with_slopes_by_v():
    assert error(85, 10e3, "by v") < 3e-4
    assert error(85, 10e3, "by x") > 3e-3


def test_the_hermite_closed_form_diverges_where_haze_thins_out_along_the_path():
    # df/dv ~ v^{α₂/α₁ - 1} is unbounded as v = u₁(s) goes to 0.
    assert error(80, 50e3, "by v") > 1
    assert error(45, 50e3, "by v") > 1e6


def test_slopes_by_x_keep_the_hermite_closed_form_bounded_and_percents_off():
    errors = [error(80, 50e3, "by x"), error(45, 50e3, "by x"), error(80, 100e3, "by x")]
    assert 0.03 < min(errors) < max(errors) < 0.3


# 4. HP02: Henyey–Greenstein


def test_henyey_greensteins_numerator_is_one_minus_g_squared():
    g = 0.76
    printed = (1 - g) ** 2 / (4 * np.pi * (1 + g**2 - 2 * g * NODES) ** 1.5)
    # As printed most of the light is lost; the library's function integrates to 1.
    np.testing.assert_allclose(2 * np.pi * WEIGHTS @ printed, (1 - g) / (1 + g), rtol=1e-12)
    mended = phase.HenyeyGreenstein(g)(NODES)
    np.testing.assert_allclose(2 * np.pi * WEIGHTS @ mended, 1, rtol=1e-12)


# 5. SCS: red, haze, compositing, mean cosine


def test_the_red_coefficient_of_the_tutorials_code_is_not_that_of_its_680_nanometres():
    text, code = 5.8e-6, 3.8e-6
    right = float(preetham_air.rayleigh_scattering(680.0))
    np.testing.assert_allclose(right, text, rtol=2e-3)
    np.testing.assert_allclose((right / code) ** 0.25 * 680, 756, atol=1)  # nm: what 3.8e-6 is for


def test_the_haze_coefficient_of_the_tutorials_text_is_fog():
    # 210e-5 m⁻¹ (× 1.1 for extinction) hides everything beyond 1.7 km; the code's 21e-6 is clear.
    assert 3.912 / (1.1 * 210e-5) < 1.7e3
    assert 3.912 / (1.1 * 21e-6) > 150e3


def test_an_object_is_seen_through_the_transmittance_not_through_the_rest_of_it():
    albedo, airlight = 0.4, 0.7

    def seen(distance, extinction=1e-4):
        transmittance = np.exp(-extinction * distance)
        right = albedo * transmittance + airlight * (1 - transmittance)
        printed = albedo * (1 - transmittance) + airlight * (1 - transmittance)
        return right, printed

    np.testing.assert_allclose(seen(0.0), (albedo, 0.0))  # as printed, what is near is black
    np.testing.assert_allclose(seen(1e7), (airlight, albedo + airlight))


def test_cornette_shanks_with_g_of_0_76_has_a_mean_cosine_of_0_81():
    mean = 2 * np.pi * WEIGHTS @ (NODES * np.asarray(phase.CornetteShanks(0.76)(NODES)))
    np.testing.assert_allclose(mean, 0.81, atol=5e-4)


# 6. DAY: Julian date for the day of the year


def test_the_declination_drifts_when_given_a_julian_date():
    def declination(day):
        return 0.4093 * np.sin(2 * np.pi * (day - 81) / 368)

    noon_of_2000_june_21, day_of_year = 2451717.0, 173
    np.testing.assert_allclose(np.degrees(declination(day_of_year)), 23.45, atol=0.01)
    # 368 days are no year: the same day's declination moves from year to year, by 47° in all.
    years = declination(noon_of_2000_june_21 + 365.2422 * np.arange(134))
    assert np.degrees(np.ptp(years)) > 46


# 7. P99: one haze for the sky, another for the sun


def test_the_haze_of_the_sky_is_bluer_than_the_haze_before_the_sun():
    sky = preetham_air.haze_scattering(3.0, [400.0, 700.0])
    exponent = np.log(sky[0] / sky[1]) / np.log(700 / 400)
    # λ⁻² times the slow K of table 2, against Ångström's λ^-1.3 of appendix A.1.
    np.testing.assert_allclose(exponent, 1.917, atol=1e-3)
    assert exponent - 1.3 > 0.6


# 8. Perez's form is not identifiable for every channel


def test_perez_form_keeps_its_shape_while_c_and_e_grow_without_bound():
    gamma = np.linspace(0, np.pi, 200)

    def shape(c, bend=-0.9, share=0.2):
        indicatrix = 1 + c * np.exp(bend * gamma) + share * c * np.cos(gamma) ** 2
        return indicatrix / indicatrix[60]

    # Ten thousandfold C and E change the sky by less than the 1 / C of the constant left behind.
    np.testing.assert_allclose(shape(1e7), shape(1e3), rtol=3e-3)
    np.testing.assert_allclose(shape(1e9), shape(1e7), rtol=3e-7)


# 9. The horizon


def test_the_horizons_exponential_has_a_limit_of_zero_and_a_gradient_of_nan():
    def naive(cosine):
        return jnp.exp(-0.3 / cosine)

    def guarded(cosine):
        above = cosine > 0
        return jnp.where(above, naive(jnp.where(above, cosine, 1.0)), 0.0)

    level = jnp.array(0.0)
    assert naive(level) == guarded(level) == 0
    assert np.isnan(jax.grad(naive)(level))
    assert jax.grad(guarded)(level) == 0
    assert naive(-0.01) > 1e12  # below the horizon it is huge and finite


# 10. The published zenith against a simulation with the paper's own optics


@pytest.mark.slow
@pytest.mark.parametrize(
    ("turbidity", "sun_deg", "ratio", "bluer"),
    [(2.0, 30.0, 1.27, 0.02), (6.0, 60.0, 2.39, 0.04)],
)
def test_the_published_zenith_is_brighter_and_bluer_than_a_simulation(
    turbidity, sun_deg, ratio, bluer
):
    wavelengths = np.arange(380.0, 781.0, 40.0)
    steps = dataclasses.replace(twin.DOUBLE, nodes=2, zeniths=10, azimuths=10)
    atm = preetham_air.preetham_atmosphere(turbidity, wavelengths=wavelengths)
    overhead = np.radians(sun_deg), 0.0, 0.0
    light = twin.single(atm, *overhead) + twin.double(atm, *overhead, steps=steps)
    x, y, bright = spectrum_to_xyY(light, wavelengths)
    model = preetham_sky(turbidity=turbidity)
    published = model.xyY(*map(jnp.array, overhead))
    # Ten angles leave 0.5 % of the second order, which is half of the light at most; wavelengths by
    # 40 nm leave 1 % of its luminance.
    np.testing.assert_allclose(published[2] / bright, ratio, rtol=0.02)
    np.testing.assert_allclose([x - published[0], y - published[1]], bluer, atol=0.01)


# 11. The published luminance model below T = 2 and under low suns


def test_the_published_luminance_has_a_pole_near_a_turbidity_of_1_64():
    def at_the_zenith(turbidity):
        a, b = perez_coefficients("Y", turbidity)[:2]
        return 1 + a * np.exp(b)

    assert at_the_zenith(1.63) < 0 < at_the_zenith(1.65)
    # The horizon's brightness over the zenith's, six times at T = 2, grows without bound.
    np.testing.assert_allclose(1 / at_the_zenith(2.0), 6.0, atol=0.05)
    assert 1 / at_the_zenith(1.7) > 25


@pytest.mark.parametrize(("turbidity", "elevation"), [(6.0, -4.2), (10.0, -0.59), (20.0, 2.6)])
def test_the_published_zenith_luminance_is_negative_under_low_suns(turbidity, elevation):
    # The elevations of its sign change are known to two digits.
    low, high = np.radians(90 - elevation + np.array([0.06, -0.06]))
    assert zenith_luminance(turbidity, low) < 0 < zenith_luminance(turbidity, high)


# 13. P99 eq. 10: the prefactor


def test_equation_10_starts_with_h1_not_with_its_exponential():
    view, length = np.radians(85), 100.0
    rate = HAZE_DECAY * np.cos(view) + 7.9e-5 + 1.36e-5
    closed = -np.expm1(-rate * length) / rate
    exact = haze_integral(view, length)
    # At the ground H₁ is 1; what the equation neglects is of order (100 m / 12 km)².
    np.testing.assert_allclose(closed, exact, rtol=1e-4)
    np.testing.assert_allclose(np.exp(-1) * closed / exact, 0.37, atol=0.003)


# 14. P99 A.3: the temperature of the air


def test_the_number_density_belongs_to_288_kelvin_not_to_228():
    def density(kelvin):
        return 101325 / (1.380649e-23 * kelvin)  # ideal gas at 1013.25 hPa

    np.testing.assert_allclose(density(288.15), 2.545e25, rtol=1e-3)
    np.testing.assert_allclose(density(273.15), 2.687e25, rtol=1e-3)  # HP02's 0 °C
    assert density(228.15) > 1.25 * 2.545e25
