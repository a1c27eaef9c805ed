"""What a fit reads from a dataset, and what it refuses."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from model_skies import DIRECTIONS, SUNS, TURBIDITIES, model_skies

from skyfit.angles import view_sun_angle
from skyfit.fitting.skies import read_skies
from skyfit.models import preetham_sky


DATA = model_skies()


def angle(sun, view, azimuth):
    return view_sun_angle(*(jnp.asarray(a) for a in (view, sun, azimuth)))


def test_skies_come_in_a_row_with_their_sun_and_turbidity():
    skies = read_skies(DATA)
    assert list(skies.swept) == ["turbidity"]
    assert skies.shape == (len(TURBIDITIES), len(SUNS))
    np.testing.assert_array_equal(skies.swept["turbidity"], np.repeat(TURBIDITIES, len(SUNS)))
    np.testing.assert_array_equal(skies.sun_zenith, np.tile(SUNS, len(TURBIDITIES)))
    # sky 5 is T = 3.5 under the second sun
    want = preetham_sky(3.5).xyY(SUNS[1], *DIRECTIONS)
    np.testing.assert_allclose(skies.values[:, 5], want.T, rtol=1e-12)
    np.testing.assert_allclose(skies.zenith[:, 5], want[0], rtol=1e-12)
    np.testing.assert_allclose(skies.gamma[5], angle(SUNS[1], *DIRECTIONS), rtol=1e-12)


def test_the_order_of_dimensions_does_not_matter():
    turned = DATA.transpose("direction", "turbidity", "sun_zenith")
    np.testing.assert_array_equal(read_skies(turned).values, read_skies(DATA).values)


@pytest.mark.slow
def test_colours_follow_from_radiance_where_they_are_not_given():
    lam = np.arange(360.0, 831.0, 10.0)
    light = preetham_sky(3.0).radiance(SUNS[:, None], *DIRECTIONS, lam)
    data = xr.Dataset(
        {"radiance": (("sun_zenith", "direction", "wavelength"), np.asarray(light))},
        {
            **{k: DATA[k] for k in ("sun_zenith", "view_zenith", "relative_azimuth")},
            "wavelength": lam,
        },
    )
    got = read_skies(data)
    want = read_skies(model_skies(turbidities=[3.0]))
    # As well as a daylight spectrum carries a chromaticity
    np.testing.assert_allclose(got.values, want.values, rtol=2e-3)
    assert got.swept == {}


def test_measured_skies_have_a_time_and_azimuths_of_their_own():
    azimuth = np.stack([DIRECTIONS[1] + shift for shift in (0.0, 0.1, 0.2)])
    sun = np.array([0.9, 0.7, 0.5])
    colours = np.asarray(preetham_sky(2.5).xyY(sun[:, None], DIRECTIONS[0], azimuth))
    data = xr.Dataset(
        {
            name: (("time", "direction"), colours[..., k])
            for k, name in enumerate(("x", "y", "luminance"))
        },
        {
            "sun_zenith": ("time", sun),
            "view_zenith": ("direction", DIRECTIONS[0]),
            "relative_azimuth": (("time", "direction"), azimuth),
        },
    )
    skies = read_skies(data)
    assert skies.swept == {}
    np.testing.assert_array_equal(skies.sun_zenith, sun)
    np.testing.assert_allclose(skies.gamma[2], angle(0.5, DIRECTIONS[0], azimuth[2]), rtol=1e-12)


def test_solid_angle_weights_share_out_the_dome():
    skies = read_skies(DATA)
    weight = skies.weights("solid angle", np.pi / 2)
    share = weight[0] ** 2 / (weight[0] ** 2).sum()
    view = DIRECTIONS[0]
    # The zenith has a cap of 5°, each ring a band of 10°, the horizon half of one.
    edges = np.cos(np.radians([0, 5, 15, 85, 90]))
    np.testing.assert_allclose(share[view == 0], edges[0] - edges[1], rtol=1e-12)
    ten = np.isclose(view, np.radians(10))
    np.testing.assert_allclose(share[ten].sum(), edges[1] - edges[2], rtol=1e-12)
    np.testing.assert_allclose(share[np.isclose(view, np.pi / 2)].sum(), edges[3], rtol=1e-12)


def test_equal_weights_stop_at_the_limit_and_include_it():
    weight = read_skies(DATA).weights("equal", np.radians(80.0))
    np.testing.assert_array_equal(weight[0] == 1, DIRECTIONS[0] < np.radians(81))


def test_groups_of_unequal_size_are_padded():
    skies = read_skies(DATA)
    four = np.arange(skies.count) < 4
    values = np.array([1.0, 2, 2, 2])
    skies = dataclasses.replace(
        skies.subset(four), swept={"turbidity": values, "albedo": 0 * values}
    )
    np.testing.assert_array_equal(skies.groups("swept"), [[0, -1, -1], [1, 2, 3]])


def test_several_parameters_may_be_swept():
    skies = read_skies(DATA.expand_dims(albedo=[0.1, 0.2]))
    assert set(skies.swept) == {"turbidity", "albedo"}
    assert skies.count == 2 * len(TURBIDITIES) * len(SUNS)
    assert skies.ranges == {"albedo": (0.1, 0.2), "turbidity": (2.0, 6.0)}
    assert skies.groups("swept").shape == (2 * len(TURBIDITIES), len(SUNS))


def broken(**changes):
    data = DATA.copy(deep=True)
    for name, value in changes.items():
        data[name].values.flat[7 if data[name].size > 7 else 0] = value
    return data


def in_degrees(name):
    return DATA.assign_coords({name: np.degrees(DATA[name])})


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (broken(luminance=np.nan).assign_attrs(campaign="{}"), "luminance has 1 non-finite values"),
        (DATA.where(DATA.sun_zenith > 0.2), "expected skies with a value somewhere; 3 of 12 have"),
        (broken(x=np.inf), "x has 1 non-finite values of 552"),
        (broken(y=0.0), "y must be above 0; 1 of 552 values are not"),
        (broken(luminance=-5.0), "luminance must be above 0; 1 of 552"),
        (in_degrees("sun_zenith"), "sun_zenith must lie in 0 to π/2 rad.*got 5"),
        (in_degrees("view_zenith"), "view_zenith must lie in 0 to π rad; got 10"),
        (DATA.drop_vars("view_zenith"), "expected a variable 'view_zenith'"),
        (DATA.drop_vars("x"), r"\['x'\] are missing"),
        (DATA.drop_vars("luminance"), r"\['luminance'\] are missing"),
        (DATA.isel(sun_zenith=slice(0, 0)), "expected skies; sun_zenith is empty"),
        (DATA.isel(direction=slice(0, 0)), "expected skies; direction is empty"),
        (DATA.rename(turbidity="self"), "may not be called 'self'"),
        (DATA.drop_vars("turbidity"), "dimension 'turbidity' has no coordinate values"),
    ],
)  # fmt: skip
def test_data_that_cannot_be_fitted_are_refused_in_one_line(data, message):
    with pytest.raises(ValueError, match=message) as error:
        read_skies(data)
    assert str(error.value).startswith("fit_sky(data=...): ")
    assert "\n" not in str(error.value)
