"""Datasets as netCDF-4 files, with no clock in them."""

from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from .files import UnreadableFile, configuration, write_whole

# Through xarray's engine each variable, of which a sweep has fifty, takes five times as long to write and to read.
# Attributes of HDF5 and of the netCDF-4 library, and what marks a dimension that has no coordinate.
PLUMBING = {
    *("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"),
    *("_Netcdf4Dimid", "_Netcdf4Coordinates", "_NCProperties"),
}
BARE = "This is a netCDF dimension but not a netCDF variable."


def save_dataset(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a Dataset without coordinates that are no dimension as netCDF-4; equal data give equal bytes."""
    if configuration():
        dataset = dataset.assign_attrs(configuration=configuration())
    content = BytesIO()
    with h5py.File(content, "w", track_order=True) as file:
        file.attrs.update(dataset.attrs)
        for name, variable in dataset.variables.items():
            text = variable.dtype.kind in "UO"
            values = variable.values.astype(h5py.string_dtype()) if text else variable.values
            file.create_dataset(name, data=values).attrs.update(variable.attrs)
        for number, (name, size) in enumerate(dataset.sizes.items()):
            if name not in file:
                file.create_dataset(name, shape=size, dtype="f4")
            file[name].make_scale(name if name in dataset.variables else f"{BARE}{size:10d}")
            file[name].attrs["_Netcdf4Dimid"] = np.int32(number)
        for name in (name for name in dataset.variables if name not in dataset.sizes):
            for axis, dimension in enumerate(dataset.variables[name].dims):
                file[name].dims[axis].attach_scale(file[dimension])
    write_whole(path, lambda part: part.write_bytes(content.getvalue()))


def load_dataset(path: str | Path) -> xr.Dataset:
    """Read a Dataset into memory and close the file; UnreadableFile names the file and the remedy."""
    try:
        with h5py.File(path) as file:
            variables = {
                name: _read(name, item)
                for name, item in file.items()
                if not item.attrs.get("NAME", b"").startswith(BARE.encode())
            }
            return xr.decode_cf(xr.Dataset(variables, attrs=_attributes(file)))
    except FileNotFoundError:
        raise
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise UnreadableFile(path, error) from error


def _read(name: str, item: h5py.Dataset) -> tuple[list[str], np.ndarray, dict[str, Any]]:
    """Dimensions, values and attributes."""
    dimensions = [name] if item.is_scale else [dimension[0].name.lstrip("/") for dimension in item.dims]
    text = h5py.check_string_dtype(item.dtype) is not None
    return dimensions, item.asstr()[()].astype(str) if text else item[()], _attributes(item)


def _attributes(item: h5py.HLObject) -> dict[str, Any]:
    return {name: value for name, value in item.attrs.items() if name not in PLUMBING}
