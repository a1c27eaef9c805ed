"""A campaign under way: a zarr store that keeps every finished sky, and which they are."""

from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .._files import alone, make_room, whole
from ..campaign import Campaign
from ..errors import InputError
from .files import check_suffix, holds_something, load_dataset, refuse_dataset, stored_attributes
from .record import sky_dataset


# Two of these that differ would put skies of different kinds into one record.
IDENTITY = ("campaign", "atmosphere", "source", "precision")


class SkyStore:
    """Skies of one campaign on disk, written one by one, in any order.

    The store is a dataset like any other, with a variable `done` over its skies besides; skies that
    are not done are NaN.

    Args:
        path: Name that ends in .zarr; the store is made if absent, continued if it is of the same
            campaign.
        template: Dataset of the campaign with NaN for every sky.
        overwrite: Begin anew in place of the sky dataset that is there.

    Raises:
        InputError: Something else is there, or a store of another campaign.
    """

    def __init__(self, path: str | PathLike[str], template: xr.Dataset, *, overwrite: bool = False):
        import zarr

        if check_suffix(path) != ".zarr":
            raise InputError(f"{path}: only a .zarr store can be filled sky by sky")
        self.path = Path(path)
        if holds_something(path) and not overwrite:
            refuse_another(self.path, template)
        else:
            refuse_dataset(path, overwrite=overwrite)
            self._create(template)
        self._group = group = zarr.open_group(self.path, mode="r+")
        self._skies = _sky_shape(template)
        self._arrays = {
            name: self._of_shape(str(name), array.shape)
            for name, array in template.data_vars.items()
        }
        # A record that was saved whole has no such mark.
        self._done = self._of_shape("done", self._skies) if "done" in group else None

    def done(self) -> np.ndarray:
        """Which skies are finished, over the campaign's `sky_dims`."""
        if self._done is None:
            return np.ones(self._skies, bool)
        return self._read("done", self._done) == 1

    def read(self, name: str) -> np.ndarray:
        """A variable of all skies; NaN where they are not done."""
        return self._read(name, _array(self._group, name))

    def _of_shape(self, name: str, shape: tuple[int, ...]) -> Any:
        """An array of numbers in the store, as large as the campaign's before it is read."""
        array = _array(self._group, name) if name in self._group else None
        if array is None or tuple(array.shape) != tuple(shape):
            came = "none" if array is None else f"shape {array.shape}"
            raise InputError(f"{self.path}: {name}: expected shape {tuple(shape)}; got {came}")
        if np.dtype(array.dtype).kind not in "biuf":
            raise InputError(f"{self.path}: {name}: expected numbers; got {array.dtype}")
        return array

    def _read(self, name: str, array: Any) -> np.ndarray:
        try:
            return np.asarray(array[:])
        except Exception as error:  # of any kind, from the libraries below
            raise InputError(f"{self.path}: {name} cannot be read; {error}") from None

    def write(self, sky: tuple[int, ...], variables: dict[str, np.ndarray]) -> None:
        """Keep one sky; it counts as done only when all of it is on disk."""
        if self._done is None:
            raise InputError(f"{self.path}: is complete; no sky can be added")
        for name, array in variables.items():
            self._arrays[name][sky] = array
        self._done[sky] = 1

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the dataset, as they are on disk."""
        return dict(self._group.attrs)

    def put_attributes(self, attributes: dict[str, str]) -> None:
        """Add attributes to the dataset on disk, or replace them."""
        self._group.attrs.update(attributes)

    def add(self, name: str, blank: xr.DataArray) -> np.ndarray:
        """A variable beside those of the template, to be filled sky by sky with `put`.

        Args:
            name: Name of the variable.
            blank: NaN for every sky; written if the store has no variable of that name.

        Returns:
            What the store has of it, NaN where a sky has none.
        """
        if name not in self._group:
            whole = xr.Dataset({name: blank.drop_vars(list(blank.coords))}, attrs=self.attributes)
            chunks = {name: {"chunks": _one_sky(blank.shape, len(self._skies))}}
            whole.to_zarr(self.path, mode="a", consolidated=False, encoding=chunks)
        self._arrays[name] = self._of_shape(name, blank.shape)
        return self.read(name)

    def put(self, name: str, sky: tuple[int, ...], array: np.ndarray) -> None:
        """Keep a variable of one sky that was added."""
        self._arrays[name][sky] = array

    def _create(self, template: xr.Dataset) -> None:
        skies = _sky_shape(template)
        front = template["radiance"].dims[: len(skies)]
        marked = template.assign(done=(front, np.zeros(skies, "int8")))
        chunks = {
            name: {"chunks": _one_sky(array.shape, len(skies))}
            for name, array in marked.data_vars.items()
        }
        # Whoever finds the store under its name finds all of it, even after a crash.
        with whole(self.path) as begun:
            marked.to_zarr(begun, mode="w", consolidated=False, encoding=chunks)


@contextmanager
def opened(
    path: str | PathLike[str] | None, template: xr.Dataset, *, overwrite: bool
) -> Iterator[tuple[SkyStore | None, xr.Dataset | None]]:
    """What a campaign has on disk, with no other run writing to it meanwhile.

    Args:
        path: Name that ends in .zarr or .nc; None for nothing on disk.
        template: Dataset of the campaign with NaN for every sky.
        overwrite: Begin anew in place of a sky dataset that is there.

    Yields:
        The store to fill, or the finished dataset of a netCDF file, or neither.

    Raises:
        InputError: Something else is there; another run is writing to it; nothing can be written.
    """
    if path is None:
        yield None, None
        return
    kind = check_suffix(path)
    make_room(path)
    with alone(path):
        if kind == ".zarr":
            yield SkyStore(path, template, overwrite=overwrite), None
        elif holds_something(path) and not overwrite:
            refuse_another(path, template)
            dataset = load_dataset(path)
            for name, array in {**template.data_vars, **template.coords}.items():
                if name not in dataset or dataset[name].sizes != array.sizes:
                    raise InputError(f"{path}: {name}: is missing, or not of the campaign's size")
            yield None, dataset
        else:
            refuse_dataset(path, overwrite=overwrite)
            yield None, None


def refuse_another(path: str | PathLike[str], template: xr.Dataset) -> None:
    """Refuse a dataset on disk that this campaign did not make.

    Raises:
        InputError: It is of another campaign, version or precision, or no sky dataset at all.
    """
    found = stored_attributes(path)
    for name in IDENTITY:
        if str(found.get(name)) != template.attrs[name]:
            made = {"source": f"by {found.get('source')}", "precision": "in another precision"}
            how = made.get(name, "by another campaign")
            raise InputError(f"{path}: was made {how}; give another name or overwrite=True")


def _sky_shape(template: xr.Dataset) -> tuple[int, ...]:
    """Sizes of what stands before direction and wavelength."""
    return tuple(template["radiance"].shape[:-2])


def _one_sky(shape: tuple[int, ...], dims: int) -> tuple[int, ...]:
    """Shape of a chunk that holds one sky of an array, whose skies have so many dimensions."""
    return (1,) * dims + shape[dims:]


def _array(group: Any, name: str) -> Any:
    import zarr

    array = group[name]
    if not isinstance(array, zarr.Array):
        raise InputError(f"{group.store}: {name} is not an array")
    return array


def empty_skies(campaign: Campaign, shapes: dict[str, tuple[int, ...]], dtype) -> xr.Dataset:
    """The dataset of a campaign before its first sky: NaN everywhere.

    Args:
        campaign: Campaign that will be simulated.
        shapes: Shape of each variable of one sky.
        dtype: Type of the radiance's numbers.
    """
    skies = campaign.sky_shape
    blank = {name: np.full((*skies, *shape), np.nan, dtype) for name, shape in shapes.items()}
    return sky_dataset(campaign, blank)
