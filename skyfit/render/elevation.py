"""Elevation models: heights on a grid, read between its nodes, and where they come from."""

from os import PathLike
from pathlib import Path

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import Scalar
from ..constants import EARTH_RADIUS


class Elevation(eqx.Module):
    """Heights on a grid of equal steps, in float32.

    The grid is continued by its own mirror images, so that land reaches to the horizon.

    Attributes:
        height: Above sea level, from south to north and from west to east [m].
        north: Step between rows [m].
        east: Step between columns [m].
    """

    height: Float[Array, "row column"]
    north: Scalar
    east: Scalar

    def __init__(self, height: Float[np.ndarray, "row column"], north: float, east: float):
        heights = np.asarray(height, np.float32)
        if heights.ndim != 2 or min(heights.shape) < 3:
            raise ValueError(
                f"Elevation(height=...): expected 3 x 3 heights or more; got shape {heights.shape}"
            )
        if not np.isfinite(heights).all():
            raise ValueError("Elevation(height=...): expected finite heights; got NaN or infinity")
        for name, step in (("north", north), ("east", east)):
            if not 0 < step < np.inf:
                raise ValueError(f"Elevation({name}=...): expected a step above 0 m; got {step}")
        self.height = jnp.asarray(heights)
        self.north, self.east = jnp.float32(north), jnp.float32(east)

    @property
    def size(self) -> tuple[float, float]:
        """From west to east and from south to north [m]."""
        rows, columns = self.height.shape
        return float(self.east) * (columns - 1), float(self.north) * (rows - 1)

    def at(self, east: Float[Array, "*b"], north: Float[Array, "*b"]) -> Float[Array, "*b"]:
        """Height at places [m] from the south-western corner, linear between the nodes."""
        return self.read(self.height[..., None], east, north)[..., 0]

    def read(
        self,
        table: Float[Array, "row column channel"],
        east: Float[Array, "*b"],
        north: Float[Array, "*b"],
    ) -> Float[Array, "*b channel"]:
        """Values of a table with the grid's nodes, linear in between."""
        rows, columns, channels = table.shape
        x, _ = _mirror(east / self.east, columns)
        y, _ = _mirror(north / self.north, rows)
        column = jnp.clip(x.astype(jnp.int32), 0, columns - 2)
        row = jnp.clip(y.astype(jnp.int32), 0, rows - 2)
        u, v = (x - column.astype(x.dtype))[..., None], (y - row.astype(y.dtype))[..., None]
        flat, corner = table.reshape(rows * columns, channels), row * columns + column
        south = flat[corner] * (1 - u) + flat[corner + 1] * u
        north_side = flat[corner + columns] * (1 - u) + flat[corner + columns + 1] * u
        return south * (1 - v) + north_side * v

    def signs(
        self, east: Float[Array, "*b"], north: Float[Array, "*b"]
    ) -> tuple[Float[Array, "*b"], Float[Array, "*b"]]:
        """Whether a place lies in an image mirrored east to west, or north to south: -1, else 1."""
        rows, columns = self.height.shape
        return _mirror(east / self.east, columns)[1], _mirror(north / self.north, rows)[1]

    def slopes(self) -> Float[Array, "row column 2"]:
        """Rise per metre towards east and north, at the nodes."""
        padded = jnp.pad(self.height, 1, mode="reflect")
        east = (padded[1:-1, 2:] - padded[1:-1, :-2]) / (2 * self.east)
        north = (padded[2:, 1:-1] - padded[:-2, 1:-1]) / (2 * self.north)
        return jnp.stack([east, north], axis=-1)


def _mirror(place, count):
    """Place on the grid, in [0, count - 1], and the direction in which it runs there."""
    period = 2.0 * (count - 1)
    turned = place - period * jnp.floor(place / period)
    back = turned > count - 1
    return jnp.where(back, period - turned, turned), jnp.where(back, -1.0, 1.0)


def sample_elevation() -> Elevation:
    """Hills near Jacksboro, Tennessee: 32 by 30 km, 236 to 1076 m, every 3 arc seconds.

    The sample that comes with matplotlib: `jacksboro_fault_dem.npz`, from the Shuttle Radar
    Topography Mission, public domain.
    """
    from matplotlib import get_data_path

    with np.load(Path(get_data_path()) / "sample_data" / "jacksboro_fault_dem.npz") as data:
        return _geographic(data["elevation"], float(data["dy"]), float(data["dx"]),
                           0.5 * (float(data["ymin"]) + float(data["ymax"])))  # fmt: skip


def load_elevation(path: str | PathLike[str]) -> Elevation:
    """Read an elevation model.

    Args:
        path: A GeoTIFF (.tif, .tiff; needs the extra `geotiff`), in degrees or in metres, or a
            .npz with `elevation` [row, column] from north to south and the steps `dx` and `dy` [m].

    Raises:
        ValueError: Another ending, or the file lacks something.
    """
    path = Path(path)
    if path.suffix == ".npz":
        with np.load(path, allow_pickle=False) as data:
            for needed in ("elevation", "dx", "dy"):
                if needed not in data.files:
                    raise ValueError(f"{path}: {needed} is missing")
            return Elevation(
                data["elevation"][::-1].astype(float), float(data["dy"]), float(data["dx"])
            )
    if path.suffix in (".tif", ".tiff"):
        return _geotiff(path)
    raise ValueError(f"{path}: expected a name ending in .npz, .tif or .tiff")


def _geotiff(path: Path) -> Elevation:
    try:
        import rasterio  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise ValueError(
            f"{path}: a GeoTIFF needs rasterio: pip install 'skyfit[geotiff]'"
        ) from None
    if not path.exists():
        raise ValueError(f"{path}: not found")
    with rasterio.open(path) as data:
        heights = data.read(1, masked=True).astype(float).filled(np.nan)
        east, north = abs(data.transform.a), abs(data.transform.e)
        if data.crs is not None and data.crs.is_geographic:
            middle = data.transform.f + 0.5 * data.transform.e * data.height
            return _geographic(heights, north, east, middle)
    return Elevation(heights[::-1], north, east)


def _geographic(heights: np.ndarray, north: float, east: float, latitude: float) -> Elevation:
    """From steps in degrees, rows from north to south."""
    degree = np.radians(1.0) * EARTH_RADIUS
    wide = east * degree * float(np.cos(np.radians(latitude)))
    return Elevation(heights[::-1].astype(float), float(north * degree), wide)
