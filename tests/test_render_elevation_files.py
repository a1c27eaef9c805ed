"""Heights from files: which way is north, how long is a step, what is refused."""

import warnings

import jax.numpy as jnp
import numpy as np
import pytest
from peers import peer

from skyfit import cli
from skyfit.constants import EARTH_RADIUS
from skyfit.render.elevation import Elevation
from skyfit.render.elevation_files import load_elevation


rasterio = peer("rasterio")
Affine = peer("rasterio.transform").Affine

UTM17, DEGREES = "EPSG:32617", "EPSG:4326"
FEET = "EPSG:2264"  # North Carolina
# North-western corner and steps, as GeoTIFFs have them.
NORTH_UP = Affine(30.0, 0.0, 5e5, 0.0, -20.0, 4e6)
ROWS = 100.0 * np.arange(5)[:, None] + np.arange(4)[None, :]  # the first row 0, 1, 2, 3


@pytest.fixture
def written(tmp_path):
    """Write a GeoTIFF of one band; return its path."""

    def write(rows=ROWS, crs=UTM17, transform=NORTH_UP, dtype="float32", name="land.tif", **band):
        path = tmp_path / name
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
            with rasterio.open(
                path, "w", driver="GTiff", height=rows.shape[0], width=rows.shape[1], count=1,
                dtype=dtype, crs=crs, transform=transform, nodata=band.pop("nodata", None),
            ) as file:  # fmt: skip
                for key, value in band.items():
                    setattr(file, key, (value,))
                file.write(rows.astype(dtype), 1)
        return path

    return write


def test_a_projected_file_lies_north_up_in_metres(written):
    land = load_elevation(written())
    assert (float(land.east), float(land.north)) == (30.0, 20.0)
    assert land.size == (90.0, 80.0)
    # Rows run from the south here, from the north in the file.
    assert np.asarray(land.height).tolist() == ROWS[::-1].tolist()
    # 60 m from the western edge, at the northern one: the file's first row, third column.
    assert float(land.at(jnp.float32(60.0), jnp.float32(80.0))) == 2


@pytest.mark.parametrize(
    ("rows", "transform"),
    [
        (ROWS[::-1], Affine(30.0, 0.0, 5e5, 0.0, 20.0, 4e6)),
        (ROWS[:, ::-1], Affine(-30.0, 0.0, 5e5, 0.0, -20.0, 4e6)),
    ],
    ids=["south up", "east on the left"],
)
def test_a_file_the_other_way_round_is_the_same_land(written, rows, transform):
    land = load_elevation(written(rows, transform=transform, name="LAND.TIF"))
    assert np.asarray(land.height).tolist() == ROWS[::-1].tolist()
    assert (float(land.east), float(land.north)) == (30.0, 20.0)


def test_degrees_become_metres_at_the_middle_latitude(written):
    # 5 rows of 0.01° from 60.025° to 59.975° north: cos 60° is a half.
    land = load_elevation(written(crs=DEGREES, transform=Affine(0.01, 0, 10.0, 0, -0.01, 60.025)))
    degree = np.pi / 180 * EARTH_RADIUS
    assert float(land.north) == pytest.approx(0.01 * degree, rel=1e-6)
    assert float(land.east) == pytest.approx(0.005 * degree, rel=1e-6)


def test_feet_become_metres(written):
    land = load_elevation(written(crs=FEET, units="ft"))
    # The survey foot is 1200/3937 m, the foot 0.3048 m.
    assert float(land.east) == pytest.approx(30 * 1200 / 3937, rel=1e-6)
    assert float(land.height[0, 0]) == pytest.approx(400 * 0.3048, rel=1e-6)


def test_stored_integers_are_scaled(written):
    land = load_elevation(written(dtype="int16", scales=0.5, offsets=-10.0, nodata=-999))
    assert float(land.height[0, 3]) == 0.5 * 403 - 10


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"nodata": 102.0}, "expected a height everywhere; got none at 1 of 20 places"),
        ({"rows": np.where(ROWS > 402, np.nan, ROWS)}, "got none at 1 of 20 places"),
        ({"crs": None}, "expected a coordinate system, for its units; got none"),
        ({"units": "fathom"}, "expected heights in m or feet; got 'fathom'"),
        (
            {"transform": Affine.translation(5e5, 4e6) @ Affine.rotation(10) @ Affine.scale(30)},
            "expected rows from west to east; got a turned grid",
        ),
        ({"rows": ROWS[:2]}, "expected 3 x 3 heights or more"),
    ],
    ids=lambda value: "" if isinstance(value, str) else next(iter(value)),
)
def test_what_a_geotiff_may_not_be(written, capsys, given, message):
    words = ["render", "--turbidity", "3", "--view", "perspective", "--terrain"]
    path = written(**given)
    assert cli.run([*words, str(path), "--out", str(path.parent / "a.png")]) == 2
    assert message in capsys.readouterr().err


def test_what_is_no_file_of_heights(tmp_path):
    rows = np.arange(12.0).reshape(3, 4)
    np.savez(tmp_path / "land.npz", elevation=rows, dx=10.0, dy=20.0)
    land = load_elevation(tmp_path / "land.npz")
    assert land.size == (30.0, 40.0)
    # The first row of a file is the northern one.
    assert float(land.at(jnp.float32(0.0), jnp.float32(40.0))) == 0
    np.savez(tmp_path / "bad.npz", elevation=rows)
    with pytest.raises(ValueError, match=r"bad.npz: dx is missing"):
        load_elevation(tmp_path / "bad.npz")
    for name, message in (
        ("text.npz", "text.npz: expected a .npz file of numbers; got"),
        ("text.tif", "text.tif: expected a GeoTIFF; got"),
        ("land.png", "land.png: expected a name ending in .npz, .tif or .tiff"),
    ):
        (tmp_path / name).write_text("no heights")
        with pytest.raises(ValueError, match=message):
            load_elevation(tmp_path / name)
    for name in ("none.tif", "none.npz"):
        with pytest.raises(FileNotFoundError, match=name):
            load_elevation(tmp_path / name)


def test_impossible_heights_are_refused():
    with pytest.raises(ValueError, match="expected finite heights"):
        Elevation(np.full((3, 3), np.nan), 1.0, 1.0)
    with pytest.raises(ValueError, match="expected 3 x 3 heights or more"):
        Elevation(np.zeros((2, 3)), 1.0, 1.0)
    with pytest.raises(ValueError, match="expected a step above 0 m; got -1"):
        Elevation(np.zeros((3, 3)), -1.0, 1.0)


@pytest.mark.parametrize(("latitude", "wide"), [(0.0, 1.0), (45.0, 2**0.5), (63.0, 2.2027)])
def test_a_web_mercator_is_as_wide_as_the_land(written, latitude, wide):
    # Mercator's scale is one over the cosine of the latitude: 2.2027 at 63 degrees.
    y = 6378137.0 * np.log(np.tan(np.pi / 4 + np.radians(latitude) / 2))
    land = load_elevation(written(crs="EPSG:3857", transform=Affine(30.0, 0, 1e6, 0, -20.0, y)))
    # The sphere here is 0.1 % smaller than the map's, and the ellipsoid differs by 0.3 % from it.
    assert float(land.east) == pytest.approx(30.0 / wide, rel=0.01)
    assert float(land.north) == pytest.approx(20.0 / wide, rel=0.01)


def test_degrees_on_a_map_of_metres_are_as_wide_as_the_land(written):
    # Plate carree: 60 degrees north a metre on the map is half a metre eastwards.
    y = np.radians(60.0) * 6371007.0
    crs = "+proj=eqc +lat_ts=0 +R=6371007 +units=m"
    land = load_elevation(written(crs=crs, transform=Affine(30.0, 0, 1e6, 0, -20.0, y)))
    assert float(land.east) == pytest.approx(15.0, rel=0.01)
    assert float(land.north) == pytest.approx(20.0, rel=0.01)


def test_maps_that_are_turned_or_uneven_are_refused(written):
    polar = written(crs="EPSG:3031", transform=Affine(30.0, 0, 1e6, 0, -20.0, 1e6))
    with pytest.raises(ValueError, match="this map is turned"):
        load_elevation(polar)
    uneven = written(crs="EPSG:3857", transform=Affine(1e4, 0, 1e6, 0, -1e6, 8e6))
    with pytest.raises(ValueError, match="expected a map of one scale"):
        load_elevation(uneven)
