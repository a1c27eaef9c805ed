import numpy as np
import pytest

import skyfit
from skyfit import tables
from skyfit.tables import read_table


pytestmark = pytest.mark.any_precision


# Each column of the documents, added up with its row numbers as weights: one wrong digit shows,
# and so do two values that have changed places.
CHECKSUMS = {
    "astm_g173_extraterrestrial": {
        "wavelength_nm": 7700,
        "irradiance_W_m-2_nm-1": 12.2241,
    },
    "elterman1968_aerosol_profile": {
        "altitude_km": 44200,
        "extinction_per_km_340nm": 1.802601304,
    },
    "preetham1999_perez_coefficients": {
        "slope_per_turbidity": -3.8545,
        "intercept": -22.9614,
    },
    "preetham1999_table1_mie_eta": {
        "scattering_angle_deg": 9620,
        "eta_400nm": 44.60031,
        "eta_450nm": 45.06596,
        "eta_550nm": 45.63471,
        "eta_650nm": 45.94266,
        "eta_850nm": 46.24408,
    },
    "preetham1999_table2_spectra": {
        "wavelength_nm": 556780,
        "K": 587.883,
        "S0": 72095.4,
        "S1": -3583.3,
        "S2": 4206.9,
        "sun_W_m-2_nm-1_sr-1": 17031592.2,
        "k_ozone_m-1": 3870,
        "k_water_m-1": 7036.939,
        "k_gas_m-1": 125.4,
    },
    "preetham1999_zenith_chromaticity": {
        "turbidity_power": 17,
        "theta_s_cubed": 1.01545,
        "theta_s_squared": -1.69335,
        "theta_s": 0.32484,
        "constant": 2.41154,
    },
    "us_standard_1976_layers": {
        "geopotential_altitude_m": 1926816,
        "temperature_K": 8261.268,
        "gradient_K_per_m": -0.0231,
        "pressure_Pa": 167472.715592,
    },
}


@pytest.mark.parametrize("name", CHECKSUMS)
def test_columns_hold_what_the_documents_print(name):
    table = read_table(name)
    rows = np.arange(1, len(next(iter(table.values()))) + 1)
    got = {column: np.nansum(rows * table[column]) for column in CHECKSUMS[name]}
    # The sums have twelve digits; a wrong last digit of a table is 1e-8 of its sum or more.
    assert got == pytest.approx(CHECKSUMS[name], rel=1e-10)


def test_zenith_chromaticity_rounds_to_the_four_decimals_of_the_paper():
    table = read_table("preetham1999_zenith_chromaticity")
    x = [[0.0017, -0.0037, 0.0021, 0], [-0.0290, 0.0638, -0.0320, 0.0039]]
    x.append([0.1169, -0.2120, 0.0605, 0.2589])
    y = [[0.0028, -0.0061, 0.0032, 0], [-0.0421, 0.0897, -0.0415, 0.0052]]
    y.append([0.1535, -0.2676, 0.0667, 0.2669])
    columns = ("theta_s_cubed", "theta_s_squared", "theta_s", "constant")
    five_decimals = np.stack([table[name] for name in columns], axis=1)
    assert list(table["turbidity_power"]) == [2, 1, 0, 2, 1, 0]
    np.testing.assert_allclose(five_decimals, np.array(x + y), rtol=0, atol=0.5001e-4)


def test_the_sun_of_table_2_is_blank_where_the_paper_is():
    table = read_table("preetham1999_table2_spectra")
    blank = np.isnan(table["sun_W_m-2_nm-1_sr-1"])
    np.testing.assert_array_equal(table["wavelength_nm"][blank], [760, 770, 780])


def test_a_column_with_words_is_read_as_words():
    assert list(read_table("preetham1999_perez_coefficients")["coefficient"][:5]) == list("ABCDE")


def test_a_table_cannot_be_changed_by_its_reader():
    with pytest.raises(ValueError, match="read-only"):
        read_table("elterman1968_aerosol_profile")["altitude_km"][0] = 1


def test_a_missing_table_is_an_error():
    with pytest.raises(FileNotFoundError):
        read_table("nothing_of_the_kind")


def test_a_ragged_table_names_its_line(tmp_path, monkeypatch):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "ragged.csv").write_text("a,b\n1,2\n3\n")
    monkeypatch.setattr(tables.resources, "files", lambda _: tmp_path)
    with pytest.raises(ValueError, match=r"ragged\.csv:3: expected 2 columns, got 1$"):
        read_table("ragged")


USERS = {
    "plain": "wavelength_nm,albedo\n450,0.1\n650,0.3\n",
    "mark": "\ufeffwavelength_nm,albedo\n450,0.1\n650,0.3\n",
    "comments": "# of grass\n\nwavelength_nm,albedo\n450,0.1\n# gap\n650,0.3\n\n",
    "semicolons": "wavelength_nm;albedo\n450;0,1\n650;0,3\n",
    "tabs": "wavelength_nm\talbedo\tnote\n450\t0.1\ta, b\n650\t0.3\t\n",
    "spaces": "wavelength_nm, albedo\r\n450, 0.1\r\n650, 0.3\r\n",
}


@pytest.mark.parametrize("text", USERS.values(), ids=USERS)
def test_a_users_table_is_read_however_it_is_written(text, tmp_path):
    (tmp_path / "grass.csv").write_text(text, encoding="utf-8", newline="")
    nodes, values = tables.read_columns(tmp_path / "grass.csv", "wavelength_nm", "albedo")
    np.testing.assert_array_equal(nodes, [450.0, 650.0])
    np.testing.assert_array_equal(values, [0.1, 0.3])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "expected columns a, b; the file is empty"),
        (b"a,c\n1,2\n", "expected a column b; there is a, c"),
        (b"a,b\n1,2\n# x\n3\n", r"t.csv:4: expected 2 columns; got 1"),
        (b"a,b\n1,2,3\n", r"t.csv:2: expected 2 columns; got 3"),
        (b"a,b\n1,2\n\n3,x\n", r"t.csv:4: column b: expected a number; got 'x'"),
        (b"a,b\n\xff,1\n", "expected text in UTF-8"),
    ],
)
def test_a_users_table_that_is_none_is_refused_in_one_line(text, message, tmp_path):
    (tmp_path / "t.csv").write_bytes(text)
    with pytest.raises(skyfit.InputError, match=message) as error:
        tables.read_columns(tmp_path / "t.csv", "a", "b")
    assert "\n" not in str(error.value)
