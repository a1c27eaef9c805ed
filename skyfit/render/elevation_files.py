"""Where heights come from: a sample, NumPy files, GeoTIFFs."""

import warnings
import zipfile
from os import PathLike
from pathlib import Path

import numpy as np

from ..constants import EARTH_RADIUS
from ..errors import InputError, not_found
from .elevation import Elevation


# What a band's unit may be called [m].
_HEIGHT_UNITS = {
    "": 1.0, "m": 1.0, "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0,
    "ft": 0.3048, "foot": 0.3048, "feet": 0.3048, "us survey foot": 1200 / 3937,
    "cm": 0.01, "mm": 0.001,
}  # fmt: skip


_MOST_TURNED = 0.07  # 4 degrees between a row and the parallel
_MOST_UNEVEN = 0.05  # of the scale over a map


def sample_elevation() -> Elevation:
    """Hills near Jacksboro, Tennessee: 32 by 30 km, 236 to 1076 m, every 3 arc seconds.

    The sample that comes with matplotlib: `jacksboro_fault_dem.npz`, from the Shuttle Radar
    Topography Mission, public domain.
    """
    from matplotlib import get_data_path

    with np.load(Path(get_data_path()) / "sample_data" / "jacksboro_fault_dem.npz") as data:
        steps = np.radians(float(data["dy"])), np.radians(float(data["dx"]))
        middle = np.radians(0.5 * (float(data["ymin"]) + float(data["ymax"])))
        return Elevation(data["elevation"][::-1].astype(float), *_on_ground(*steps, middle))


def load_elevation(path: str | PathLike[str]) -> Elevation:
    """Read an elevation model.

    Args:
        path: A GeoTIFF (.tif, .tiff; needs the extra `geotiff`) in any map projection, north up, or
            in degrees; its first band is read. Or a .npz with `elevation` [row, column] from north
            to south and the steps `dx` and `dy` [m].

    Raises:
        FileNotFoundError: There is no such file.
        InputError: Another ending; the file lacks something, is turned, or has gaps.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in (".npz", ".tif", ".tiff"):
        raise InputError(f"{path}: expected a name ending in .npz, .tif or .tiff")
    if not path.is_file():
        raise not_found(path)
    return _numpy(path) if kind == ".npz" else _geotiff(path)


def _numpy(path: Path) -> Elevation:
    try:
        data = np.load(path, allow_pickle=False)
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: expected a .npz file of numbers; got {error}") from None
    with data:
        for needed in ("elevation", "dx", "dy"):
            if needed not in data.files:
                raise InputError(f"{path}: {needed} is missing")
        heights = data["elevation"].astype(float)
        return _checked(path, heights, float(data["dy"]), float(data["dx"]))


def _geotiff(path: Path) -> Elevation:
    try:
        import rasterio
        from rasterio.errors import NotGeoreferencedWarning, RasterioIOError
    except ImportError:
        raise InputError(
            f"{path}: a GeoTIFF needs rasterio: pip install 'skyfit[geotiff]'"
        ) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            data = rasterio.open(path)
    except RasterioIOError as error:
        raise InputError(f"{path}: expected a GeoTIFF; got {error}") from None
    with data:
        if data.crs is None:
            raise InputError(f"{path}: expected a coordinate system, for its units; got none")
        place, unit = data.transform, (data.units[0] or "").lower()
        if place.b or place.d:
            raise InputError(f"{path}: expected rows from west to east; got a turned grid")
        if unit not in _HEIGHT_UNITS:
            raise InputError(f"{path}: expected heights in m or feet; got {data.units[0]!r}")
        raw = data.read(1, masked=True).astype(float).filled(np.nan)
        heights = (raw * data.scales[0] + data.offsets[0]) * _HEIGHT_UNITS[unit]
        latitude = place.f + 0.5 * place.e * data.height
        # North up has a negative step from row to row, and a mirrored one from column to column.
        heights = heights[:: -1 if place.e > 0 else 1, :: -1 if place.a < 0 else 1]
        scale = data.crs.units_factor[1]  # of the system's unit, in rad or m
        north, east = abs(place.e) * scale, abs(place.a) * scale
        if data.crs.is_geographic:
            north, east = _on_ground(north, east, latitude * scale)
        else:
            north_scale, east_scale = _scales(path, data)
            north, east = north / north_scale, east / east_scale
    return _checked(path, heights, north, east)


def _scales(path: Path, data) -> tuple[float, float]:
    """Length on the map over that on the ground, north and east: 2.2 in Mercator's at 63° N.

    Raises:
        InputError: The map's rows do not run from west to east, or it is stretched unevenly.
    """
    from rasterio.warp import transform

    place = data.transform
    found = []
    for row, column in ((0.5, 0.5), (0.02, 0.02), (0.98, 0.98)):
        x, y = place @ (column * data.width, row * data.height)
        step_x, step_y = 0.5 * data.width * place.a, 0.5 * data.height * place.e
        step = 1e-3 * min(abs(step_x), abs(step_y))
        lon, lat = np.radians(
            transform(data.crs, "EPSG:4326", [x, x + step, x], [y, y, y + step])[:2]
        )
        east = EARTH_RADIUS * np.cos(lat[0]) * (lon[1:] - lon[0])
        north = EARTH_RADIUS * (lat[1:] - lat[0])
        unit = step * data.crs.units_factor[1]
        if not (np.isfinite(east).all() and np.isfinite(north).all()):
            raise InputError(f"{path}: its coordinates are not on the Earth in {data.crs}")
        if abs(north[0]) > _MOST_TURNED * abs(east[0]):
            raise InputError(f"{path}: expected rows from west to east; this map is turned there")
        found.append((unit / abs(north[1]), unit / abs(east[0])))
    middle, *corners = np.array(found)
    if np.abs(np.array(corners) / middle - 1).max() > _MOST_UNEVEN:
        raise InputError(
            f"{path}: expected a map of one scale; this one's differs by more than "
            f"{_MOST_UNEVEN:.0%} between its middle and its corners"
        )
    # Projections for surveys are true within 2 %; theirs are taken for the ground's own metres.
    return (1.0, 1.0) if np.abs(middle - 1).max() < 0.025 else tuple(middle.tolist())


def _checked(path: Path, heights: np.ndarray, north: float, east: float) -> Elevation:
    """From rows from north to south, in metres."""
    gaps = int(heights.size - np.isfinite(heights).sum())
    if gaps:
        raise InputError(
            f"{path}: expected a height everywhere; got none at {gaps} of {heights.size} places "
            "(GDAL's gdal_fillnodata fills gaps)"
        )
    return Elevation(heights[::-1], north, east)


def _on_ground(north: float, east: float, latitude: float) -> tuple[float, float]:
    """Steps in metres from those in latitude and longitude [rad]."""
    return float(north * EARTH_RADIUS), float(east * EARTH_RADIUS * np.cos(latitude))
