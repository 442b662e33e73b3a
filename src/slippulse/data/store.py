"""Datasets as netCDF-4 files, without a time of writing.

Each of the fifty variables of a sweep takes five times as long to write and to read by xarray's
engine, and three times as long to read by h5py's objects as by the calls of HDF5 below them.
"""

from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from .files import UnreadableFile, configuration, write_whole

# Attributes of HDF5 and of the netCDF-4 library.
PLUMBING = {"CLASS", "DIMENSION_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates"}
# The name of a dimension that has no coordinate begins so.
BARE = "This is a netCDF dimension but not a netCDF variable."


def save_dataset(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a Dataset whose coordinates are dimensions; equal data give equal bytes."""
    if configuration():
        dataset = dataset.assign_attrs(configuration=configuration())
    content = BytesIO()
    with h5py.File(content, "w", track_order=True) as file:
        file.attrs.update(dataset.attrs)
        items = {}
        for name, variable in dataset.variables.items():
            text = variable.dtype.kind in "UO"
            values = variable.values.astype(h5py.string_dtype()) if text else variable.values
            items[name] = file.create_dataset(name, data=values)
            items[name].attrs.update(variable.attrs)
        for number, (name, size) in enumerate(dataset.sizes.items()):
            if name not in items:
                items[name] = file.create_dataset(name, shape=size, dtype="f4")
            items[name].make_scale(name if name in dataset.variables else f"{BARE}{size:10d}")
            items[name].attrs["_Netcdf4Dimid"] = np.int32(number)
        for name, variable in dataset.variables.items():
            dimensions = () if name in dataset.sizes else variable.dims
            for axis, dimension in enumerate(dimensions):
                items[name].dims[axis].attach_scale(items[dimension])
    write_whole(path, lambda part: part.write_bytes(content.getbuffer()))


def load_dataset(path: str | Path) -> xr.Dataset:
    """Read a Dataset into memory. Raises UnreadableFile with the path and the remedy."""
    try:
        # Python opens the file, so that the process sees what is read.
        with open(path, "rb") as source, h5py.File(source) as file:
            items = {name: h5py.h5d.open(file.id, name.encode()) for name in file}
            attributes = {name: _attributes(item) for name, item in items.items()}
            # A scale lists the variables and axes that it belongs to; without a list it is its own.
            dimensions = {item: [name] * item.rank for name, item in items.items()}
            for name, attrs in attributes.items():
                for reference, axis in attrs.pop("REFERENCE_LIST", ()):
                    dimensions[h5py.h5r.dereference(reference, file.id)][axis] = name
            variables = {}
            for name, item in items.items():
                if not attributes[name].pop("NAME", b"").startswith(BARE.encode()):
                    values = _values(item, h5py.h5s.ALL, h5py.h5s.ALL)
                    variables[name] = dimensions[item], values, attributes[name]
            return xr.Dataset(variables, attrs=file.attrs)
    except FileNotFoundError:
        raise
    except (OSError, ValueError, LookupError, RuntimeError) as error:
        raise UnreadableFile(path, error) from error


def _attributes(item: h5py.h5d.DatasetID) -> dict[str, Any]:
    """Attributes of a variable, as builtins."""
    count = h5py.h5a.get_num_attrs(item)
    opened = [h5py.h5a.open(item, index=number) for number in range(count)]
    named = {attribute.name.decode(): attribute for attribute in opened}
    return {name: _values(named[name]).tolist() for name in named if name not in PLUMBING}


def _values(item: h5py.h5d.DatasetID | h5py.h5a.AttrID, *spaces: h5py.h5s.SpaceID) -> np.ndarray:
    """Values of a variable or of an attribute, text as text."""
    values = np.empty(item.shape, item.dtype)
    item.read(*spaces, values)
    if values.dtype.kind == "O":
        values = np.array([text.decode() for text in values.flat], dtype=str).reshape(values.shape)
    return values
