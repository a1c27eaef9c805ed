"""Shapes, bases and the sky model made of them: hand values, limits, gradients."""

import itertools
import json
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from skyfit._typing import as_float
from skyfit.angles import unit_vector, view_sun_angle
from skyfit.colour import rgb_to_xyz, spectrum_to_xyz, xyY_to_xyz
from skyfit.models.axes import Chebyshev, Line, Tents
from skyfit.models.basis import Basis, basis_from
from skyfit.models.domes import DISTRIBUTIONS, Series, distribution_from
from skyfit.models.formula import FormulaSky
from skyfit.models.scale import LogScale, scale_from


TURBIDITIES, SUNS = (2.0, 6.0), (0.1, 1.4)


def polynomial(parameter_degree, sun_degree, function="identity"):
    """A polynomial in turbidity and the sun."""
    return Basis(
        (
            Chebyshev("turbidity", TURBIDITIES, parameter_degree),
            Chebyshev("sun_zenith", SUNS, sun_degree, function),
        )
    )


NODES = ([2.0, 3.0, 6.0], [0.1, 0.8, 1.1, 1.4])
BASES = {
    "polynomial": polynomial(2, 3),
    "cosine": polynomial(1, 2, "cosine"),
    "root": polynomial(1, 2, "cube root of elevation"),
    "nodes": Basis((Tents("turbidity", NODES[0]), Tents("sun_zenith", NODES[1]))),
    "total": Basis(
        (
            Chebyshev("turbidity", TURBIDITIES, 2, "reciprocal"),
            Chebyshev("sun_zenith", (0.1, 1.7), 3, "cube root through the horizon"),
        ),
        total_degree=True,
    ),
}


def terms_at(basis, turbidity, sun):
    """Terms of a basis at a turbidity and a sun."""
    return basis.terms({"turbidity": as_float(turbidity), "sun_zenith": as_float(sun)})


PAIRS = [
    ("perez", "nodes"),
    ("cie", "cosine"),
    ("hosek-wilkie", "root"),
    ("series", "polynomial"),
]


def numbers_of(shape, basis, seed=0):
    """Free numbers near the shape's start that change a little with parameter and sun."""
    rng = np.random.default_rng(seed)
    table = 0.05 * rng.standard_normal((3, len(shape.names), basis.num_terms))
    return table + free_start(shape)[:, None] * basis.constant()


def free_start(shape, which=0, channel="Y"):
    """Free numbers of a distribution's start."""
    return np.asarray(shape.free_numbers(as_float(shape.starts(channel)[which])))


def sky_of(shape, basis, kind="XYZ", wavelengths=None, parameter=3.0):
    scales = np.zeros((3, basis.num_terms))
    scales[:, 0] = 1.0
    swept = {axis.quantity for axis in basis.axes} - {"sun_zenith"}
    return FormulaSky(
        swept={name: as_float(parameter) for name in swept},
        numbers=as_float(numbers_of(shape, basis)),
        basis=basis,
        distribution=shape,
        scale=LogScale(
            numbers=as_float(scales),
            basis=basis,
            dimming=as_float([4.0, 4.0, 4.0]),
            lowest_sun=1.4,
            night=(False, False, True) if kind == "Yxy" else (True, True, True),
        ),
        wavelengths=None if wavelengths is None else as_float(wavelengths),
        linked=True,
        kind=kind,
        ranges=tuple((name, TURBIDITIES) for name in swept),
        sun_zenith_range=SUNS,
    )


def by_hand(name, c, theta, gamma):
    """The formulas once more, a number at a time, as they are printed."""
    if name == "series":
        r, k, g = (0.15, 0.5, 1.5), (1.0, 4.0), 0.6
        m = 1 / (math.cos(theta) + 0.01)
        one = [1.0, *(math.exp(-x * m) for x in r)]
        chi = (1 + math.cos(gamma) ** 2) / (1 + g**2 - 2 * g * math.cos(gamma)) ** 1.5
        two = [1.0, math.cos(gamma), math.cos(gamma) ** 2]
        two += [*(math.exp(-x * gamma) for x in k), chi]
        return sum(w * a * b for w, (a, b) in zip(c, itertools.product(one, two), strict=True))
    if name == "hosek-wilkie":
        a, b, cc, d, e, f, g, h, i = c
        chi = (1 + math.cos(gamma) ** 2) / (1 + h**2 - 2 * h * math.cos(gamma)) ** 1.5
        return (1 + a * math.exp(b / (math.cos(theta) + 0.01))) * (
            cc
            + d * math.exp(e * gamma)
            + f * math.cos(gamma) ** 2
            + g * chi
            + i * math.sqrt(math.cos(theta))
        )
    a, b, cc, d, e = c
    glow = math.exp(d * gamma) - (math.exp(d * math.pi / 2) if name == "cie" else 0.0)
    gradation = 1 + a * math.exp(b / math.cos(theta))
    return gradation * (1 + cc * glow + e * math.cos(gamma) ** 2)


@pytest.mark.parametrize("name", sorted(DISTRIBUTIONS))
def test_a_shape_is_the_printed_formula(name):
    shape = distribution_from({"name": name})
    rng = np.random.default_rng(3)
    free = as_float(free_start(shape) + 0.1 * rng.standard_normal(len(shape.names)))
    coefficients = shape.coefficients(free)
    for theta, gamma in ((0.0, 0.0), (0.4, 1.0), (1.3, 0.2), (1.5, 3.0)):
        angles = [as_float(v) for v in (math.cos(theta), gamma, math.cos(gamma))]
        expected = by_hand(name, np.asarray(coefficients).tolist(), theta, gamma)
        assert float(shape.value(coefficients, *angles)) == pytest.approx(expected, rel=1e-12)


def test_the_standard_clear_sky_of_the_cie_has_its_tabulated_zenith_factor():
    # CIE S 011, type 12: a -1, b -0.32, c 10, d -3, e 0.45. By hand for a sun at 60° and a view
    # at 30° towards it, γ = 30°: gradation 1 - e^{-0.32/cos 30°} = 0.308923 over 1 - e^{-0.32} =
    # 0.273851; indicatrix 1 + 10 (e^{-π/2} - e^{-3π/2}) + 0.45 cos² 30° = 3.326467 over that of
    # γ = 60°, 1 + 10 (e^{-π} - e^{-3π/2}) + 0.45 / 4 = 1.454806.
    shape = distribution_from({"name": "cie"})
    coefficients = as_float(shape.starts("Y")[0])
    view, zenith = (
        float(shape.value(coefficients, *map(as_float, (c, g, math.cos(g)))))
        for c, g in ((math.cos(math.pi / 6), math.pi / 6), (1.0, math.pi / 3))
    )
    assert view / zenith == pytest.approx(0.308923 / 0.273851 * 3.326467 / 1.454806, rel=1e-5)


@pytest.mark.parametrize("name", ["polynomial", "cosine", "root"])
def test_polynomial_terms_are_chebyshev(name):
    basis = BASES[name]
    function = {
        "polynomial": lambda s: s,
        "cosine": math.cos,
        "root": lambda s: (math.pi / 2 - s) ** (1 / 3),
    }[name]
    low, high = function(0.1), function(1.4)
    u, v = 2 * (3.5 - 2) / 4 - 1, 2 * (function(0.9) - low) / (high - low) - 1
    expected = [
        math.cos(i * math.acos(u)) * math.cos(j * math.acos(v))
        for i in range(basis.axes[0].degree + 1)
        for j in range(basis.axes[1].degree + 1)
    ]
    terms = terms_at(basis, 3.5, 0.9)
    np.testing.assert_allclose(terms, expected, atol=1e-14)


def test_nodes_interpolate_linearly():
    basis = BASES["nodes"]
    table = np.arange(12.0).reshape(3, 4) ** 2
    for parameter, sun in ((2.0, 0.1), (2.5, 0.8), (6.0, 1.4), (5.0, 1.0), (9.0, 0.0)):
        row = [np.interp(sun, NODES[1], line) for line in table]
        expected = np.interp(parameter, NODES[0], row)
        got = table.ravel() @ np.asarray(terms_at(basis, parameter, sun))
        assert got == pytest.approx(expected, abs=1e-12)
    straight = np.add.outer(*map(np.asarray, NODES)).ravel()
    np.testing.assert_allclose(basis.bends() @ straight, 0, atol=1e-11)
    assert np.square(basis.bends() @ table.ravel()).sum() > 1


@pytest.mark.parametrize("name", sorted(BASES))
def test_bases_and_shapes_come_back_from_their_description(name):
    basis = basis_from(json.loads(json.dumps(BASES[name].describe())))
    at = 4.3, 0.7
    np.testing.assert_array_equal(terms_at(basis, *at), terms_at(BASES[name], *at))
    np.testing.assert_allclose(basis.constant() @ terms_at(basis, *at), 1, rtol=1e-12)
    shape = distribution_from(json.loads(json.dumps(Series((0.3,), (0, 2)).describe())))
    assert shape.names == ("w00", "w01", "w02", "w03", "w04", "w10", "w11", "w12", "w13", "w14")
    with pytest.raises(ValueError, match="expected a distribution of"):
        distribution_from({"name": "lambert"})
    with pytest.raises(ValueError, match="expected an axis of kind"):
        basis_from([{"kind": "spline", "quantity": "turbidity"}])
    with pytest.raises(ValueError, match="expected a scale of kind"):
        scale_from({"kind": "spline", "numbers": []})


@pytest.mark.parametrize(("name", "basis"), PAIRS)
def test_a_channel_is_its_scale_times_its_shape(name, basis):
    shape, terms = distribution_from({"name": name}), terms_at(BASES[basis], 3.0, 0.9)
    sky = sky_of(shape, BASES[basis])
    theta, azimuth = 1.1, 0.7
    gamma = float(view_sun_angle(*map(as_float, (theta, 0.9, azimuth))))
    got = sky.channels(0.9, theta, azimuth)
    factor = math.exp(float((sky.scale.numbers @ terms)[0]))
    for k in range(3):
        c = np.asarray(shape.coefficients(sky.numbers[k] @ terms)).tolist()
        expected = factor * by_hand(name, c, theta, gamma)
        if shape.relative:
            expected /= by_hand(name, c, 0.0, 0.9)
        assert float(got[k]) == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_every_kind_of_channels_is_the_same_sky_in_every_unit():
    shape, basis, at = Series(), BASES["polynomial"], (0.9, 1.1, 0.7)
    bands = (450.0, 550.0, 650.0)
    for kind, to_xyz in (
        ("XYZ", lambda v: v),
        ("RGB", rgb_to_xyz),
        ("Yxy", xyY_to_xyz),
        ("bands", lambda v: spectrum_to_xyz(v, bands)),
    ):
        sky = sky_of(shape, basis, kind, bands if kind == "bands" else None)
        expected = to_xyz(sky.channels(*at))
        vectors = (
            unit_vector(as_float(1.1), as_float(0.7)),
            unit_vector(as_float(0.9), as_float(0.0)),
        )
        np.testing.assert_allclose(sky.xyz(*vectors), expected, rtol=1e-9)
        np.testing.assert_allclose(xyY_to_xyz(sky.xyY(*at)), expected, rtol=1e-12)
    middle = sky.radiance(*at, [450.0, 500.0])
    values = sky.channels(*at)
    np.testing.assert_allclose(middle, [values[0], (values[0] + values[1]) / 2], rtol=1e-12)
    assert sky.valid_range["wavelength"] == (450.0, 650.0)
    with pytest.raises(ValueError, match="must lie within the model's bands; got 700"):
        sky.radiance(*at, [700.0])


@pytest.mark.slow
@pytest.mark.parametrize(("name", "basis"), PAIRS)
def test_derivatives_are_finite_everywhere(name, basis):
    def total(parameter, sun, view, azimuth):
        return (
            sky_of(distribution_from({"name": name}), BASES[basis], parameter=parameter)
            .rgb(sun, view, azimuth)
            .sum()
        )

    places = np.array(
        [
            (3.0, 0.0, 0.0, 0.0),  # sun at the zenith
            (2.0, 0.8, 0.8, 0.0),  # at the sun, on a node
            (3.0, 0.8, math.pi / 2, math.pi),  # horizon, opposite
            (3.0, math.pi / 2, math.pi / 2, math.pi),
            (3.0, math.pi / 2, math.pi / 2, 0.0),
            (6.0, 1.4, 1.7, 0.4),  # below the horizon
            (9.0, 1.9, math.pi, 0.4),  # night, out of range
        ]
    )
    slopes = jax.vmap(jax.grad(total, argnums=(0, 1, 2, 3)))(*as_float(places.T))
    assert np.isfinite(np.stack(slopes)).all()


def test_night_falls_and_nothing_jumps():
    sky = sky_of(Series(), BASES["nodes"], "Yxy")
    suns = as_float([1.4, 1.45, math.pi / 2, math.pi / 2 + math.radians(2.5)])
    values = np.asarray(sky.channels(suns, 0.0, 0.0))
    np.testing.assert_allclose(
        values[1:, 2] / values[:-1, 2],
        [math.exp(-4 * 0.05), math.exp(-4 * (math.pi / 2 - 1.45)), 0.1],
        rtol=0.1,
    )  # the view-sun angle changes a little too
    for end in (0.1, 0.8, 1.4, math.pi / 2):
        for view in (0.3, math.pi / 2):
            a, b = (sky.channels(end + s, view + s, 0.4) for s in (-1e-7, 1e-7))
            np.testing.assert_allclose(a, b, rtol=1e-4)


@pytest.mark.slow
def test_single_precision_is_kept_and_good(float32):
    views = np.linspace(0, 1.5, 20)
    values = sky_of(distribution_from({"name": "series"}), basis_of_floats()).rgb(0.9, views, 0.3)
    assert values.dtype == jnp.float32
    with jax.enable_x64(True):
        sky = sky_of(distribution_from({"name": "series"}), basis_of_floats())
        reference = sky.rgb(0.9, views, 0.3)
    np.testing.assert_allclose(values, reference, rtol=2e-4)


def basis_of_floats():
    return polynomial(2, 3)


def test_coefficients_on_a_line_are_slope_and_intercept():
    basis = Basis((Line("turbidity", TURBIDITIES), Line("albedo", (0.0, 0.5))))
    at = {
        name: as_float(v) for name, v in (("turbidity", 3.0), ("albedo", 0.2), ("sun_zenith", 0.5))
    }
    # T a, T, a, 1
    np.testing.assert_allclose(basis.terms(at), [0.6, 3.0, 0.2, 1.0], rtol=1e-15)
    held = basis.terms(at | {"turbidity": as_float(9.0)})
    np.testing.assert_allclose(held, [1.2, 6.0, 0.2, 1.0], rtol=1e-15)


def test_terms_of_a_total_degree_are_the_low_ones_of_the_whole_product():
    axes = BASES["total"].axes
    # Degrees k/2 + n/3 of 1 or less: 0 with 0 to 3, 1 with 0 and 1, 2 with 0.
    low = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (2, 0)]
    assert list(BASES["total"].kept) == low
    every = list(Basis(axes).kept)
    some = terms_at(BASES["total"], [2.0, 3.0, 6.0], [0.2, 1.0, 1.6])
    whole = terms_at(Basis(axes), [2.0, 3.0, 6.0], [0.2, 1.0, 1.6])
    np.testing.assert_array_equal(some, whole[np.array([every.index(term) for term in low])])


def test_functions_of_a_polynomial_have_their_values():
    # u runs from -1 to 1 with -1/T from -1/2 to -1/6: at 3, half way.
    axis = Chebyshev("turbidity", (2.0, 6.0), 1, "reciprocal")
    np.testing.assert_allclose(axis.functions(as_float([2.0, 3.0, 6.0]))[1], [-1, 0, 1], atol=1e-6)
    # 4° from the horizon d (1 + 1)^(-1/3), odd about it.
    ends = math.radians(86.0), math.radians(94.0)
    axis = Chebyshev("sun_zenith", ends, 1, "cube root through the horizon")
    at = as_float(np.radians([86.0, 88.0, 90.0, 94.0]))
    half = 0.5 * 1.25 ** (-1 / 3) / 2 ** (-1 / 3)
    np.testing.assert_allclose(axis.functions(at)[1], [-1, -half, 0, 1], atol=1e-5)
    slope = jax.grad(lambda sun: axis.functions(sun)[1])(as_float(math.pi / 2))
    np.testing.assert_allclose(slope, 2 ** (1 / 3) / math.radians(4.0), rtol=1e-5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Basis((Tents("turbidity", [2.0, 3.0]),), True), "polynomials along every axis"),
        (lambda: Chebyshev("dust", (0.0, 1.0), 2, "reciprocal"), "expected a dust above 0; got 0"),
    ],
)
def test_what_has_no_degree_or_no_reciprocal_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_scale_goes_on_below_the_horizon_where_its_suns_do():
    basis = Basis((Chebyshev("sun_zenith", (0.1, 1.7), 1),))
    zeros = as_float([0.0, 0.0])
    scale = LogScale(as_float([[0.0, 1.0], [0.0, 1.0]]), basis, zeros, 1.7, (True, False))
    found = np.log(np.asarray(scale({"sun_zenith": as_float([1.5, 1.6, 1.7, 1.7 + 0.0436332])})))
    np.testing.assert_allclose(found[1], [0.75, 0.875, 1, 1], rtol=1e-5)
    # Beyond the last sun a decade in 2.5°.
    np.testing.assert_allclose(found[0], [0.75, 0.875, 1, 1 - math.log(10)], rtol=1e-5)
