"""AERONET's inversions: files like those of version 3, and an atmosphere with their aerosol."""

import jax.numpy as jnp
import numpy as np
import pytest

import skyfit
from skyfit.phase import HenyeyGreenstein


LAM, G = (440, 675, 870, 1020), (0.72, 0.66, 0.63, 0.62)
SSA, DEPTH = (0.95, 0.93, 0.91, 0.90), (0.40, 0.22, 0.15, 0.12)
ANGLES = np.array([180, 150, 120, 90, 60, 40, 30, 20, 15, 10, 6, 4, 3, 2, 1, 0.5, 0.0])
RADII = np.geomspace(0.05, 15.0, 22)
ABOUT = ["AERONET Version 3;", "Nowhere", "Almucantar Level 1.5", "PI=Müller", "UNITS", "points"]
FIRST = ["Site", "Date(dd:mm:yyyy)", "Time(hh:mm:ss)", "Day_of_Year"]


def lobe(g):
    """Four pi times the density of Henyey and Greenstein, as AERONET scales phase functions."""
    return (1 - g**2) / (1 + g**2 - 2 * g * np.cos(np.radians(ANGLES))) ** 1.5


PRODUCTS = {
    "pfn": {f"{a:f}[{n}nm]": p for n, g in zip(LAM, G, strict=True)
            for a, p in zip(ANGLES, lobe(g), strict=True)},
    "siz": {f"{radius:f}": 0.01 * k for k, radius in enumerate(RADII)},
    "ssa": {f"Single_Scattering_Albedo[{n}nm]": v for n, v in zip(LAM, SSA, strict=True)},
    "aod": {f"AOD_Extinction-Total[{n}nm]": v for n, v in zip(LAM, DEPTH, strict=True)},
}  # fmt: skip


def write(path, columns, gap=None):
    header = [*FIRST, *columns, "Inversion_Data_Quality_Level"]
    rows = [["Nowhere", "05:06:2023", "12:37:29", 156, *columns.values(), "lev15"]]
    rows.append(["Nowhere", "06:06:2023", "06:00:00", 157, *columns.values(), "lev15"])
    if gap:
        rows[1][header.index(gap)] = -999.0
    lines = [*ABOUT, ",".join(header), *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="latin-1")
    return path


@pytest.fixture
def inversion(tmp_path):
    gap = "Single_Scattering_Albedo[675nm]"
    everything = {name: v for product in PRODUCTS.values() for name, v in product.items()}
    return skyfit.read_aeronet(write(tmp_path / "a.all", everything, gap))


def test_every_product_is_read(inversion):
    assert inversion["phase_function"].dims == ("time", "wavelength", "scattering_angle")
    first = inversion.isel(time=0)
    assert str(first["time"].values).startswith("2023-06-05T12:37:29")
    np.testing.assert_array_equal(inversion["wavelength"], LAM)
    np.testing.assert_allclose(inversion["scattering_angle"], np.radians(ANGLES[::-1]))
    np.testing.assert_allclose(first["phase_function"][1], lobe(0.66)[::-1])
    np.testing.assert_allclose(first["single_scattering_albedo"], SSA)
    np.testing.assert_allclose(first["size_distribution"], 0.01 * np.arange(22))
    np.testing.assert_allclose(inversion["radius"], RADII, atol=1e-6)
    np.testing.assert_array_equal(
        np.isnan(inversion["single_scattering_albedo"].values[1]), [False, True, False, False]
    )


def test_products_of_several_files_are_one_record(inversion, tmp_path):
    paths = [write(tmp_path / f"b.{kind}", PRODUCTS[kind]) for kind in PRODUCTS]
    apart = skyfit.read_aeronet(*paths)
    assert set(apart) == set(inversion)
    np.testing.assert_array_equal(apart["phase_function"], inversion["phase_function"])


def test_direct_sun_measurements_are_read_and_their_empty_channels_left_out(tmp_path):
    columns = {"AOD_1640nm": -999.0, "AOD_870nm": 0.1, "AOD_500nm": 0.2}
    found = skyfit.read_aeronet(write(tmp_path / "a.lev15", columns))["direct_sun_optical_depth"]
    np.testing.assert_array_equal(found["wavelength"], [500, 870])
    np.testing.assert_array_equal(found[0], [0.2, 0.1])


def test_its_aerosol_scatters_as_measured(inversion):
    lam = [440.0, 557.5, 675.0]
    haze = skyfit.aeronet_aerosol(inversion.isel(time=1), lam)
    air = skyfit.preetham_atmosphere(1.0, wavelengths=lam)
    sky = skyfit.Atmosphere(
        wavelengths=lam, solar_irradiance=air.solar_irradiance,
        constituents=[air.constituents[0], haze],
    )  # fmt: skip
    # Between 440 and 675 nm by Ångström's law; the albedo at 675 nm is a gap there.
    between = 0.40 * (557.5 / 440) ** (np.log(0.22 / 0.40) / np.log(675 / 440))
    depth = np.asarray(sky.optical_depth()[1])
    np.testing.assert_allclose(depth, [0.40, between, 0.22], rtol=1e-3)
    share = np.asarray(haze.scattering / haze.extinction)
    np.testing.assert_allclose(share, np.interp(lam, (440, 870), (0.95, 0.91)), rtol=1e-9)
    # Between the angles of the file a phase function is log-linear: 3 % at 30° and beyond.
    cosines = jnp.cos(jnp.radians(jnp.array([30.0, 90.0, 150.0])))
    got = np.asarray(haze.phase.spectral(cosines))
    for k, g in ((0, 0.72), (2, 0.66)):
        want = np.asarray(HenyeyGreenstein(g).spectral(cosines))[:, 0]
        np.testing.assert_allclose(got[:, k], want, rtol=0.03)
    np.testing.assert_allclose(got[:, 1], (got[:, 0] + got[:, 2]) / 2, rtol=0.01)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected a line of columns with Date"),
        ("Date(dd:mm:yyyy),b\n05:06:2023,1\n", "expected columns of an inversion"),
        ("Date(dd:mm:yyyy),0.050000\nJune,1\n", "expected a date and time; got 'June'"),
        ("Date(dd:mm:yyyy),0.050000\n05:06:2023\n", r"a.siz:2: expected 2 columns; got 1"),
        ("Date(dd:mm:yyyy),0.050000\n05:06:2023,x\n", "expected numbers"),
    ],
)
def test_what_is_no_inversion_is_refused(text, message, tmp_path):
    (tmp_path / "a.siz").write_text(text)
    with pytest.raises(skyfit.InputError, match=message):
        skyfit.read_aeronet(tmp_path / "a.siz")


def test_an_aerosol_needs_one_time_and_three_products(inversion):
    with pytest.raises(skyfit.InputError, match="expected one time"):
        skyfit.aeronet_aerosol(inversion, [500.0])
    one = inversion.isel(time=0)
    with pytest.raises(skyfit.InputError, match="expected optical_depth; there is none"):
        skyfit.aeronet_aerosol(one.drop_vars("optical_depth"), [500.0])
