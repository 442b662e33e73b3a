"""Reading of Datasets from netCDF-4 files.

Each of the fifty variables of a sweep takes five times as long to read by xarray's engine, and
three times as long by h5py's objects, as by the calls of HDF5 below them.
"""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from .files import UnreadableFile

# Attributes of HDF5 and of the netCDF-4 library.
PLUMBING = {"CLASS", "DIMENSION_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates"}


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
                # A dimension that has no coordinate has a scale of this name.
                if not attributes[name].pop("NAME", b"").startswith(b"This is a netCDF dimension"):
                    values = _values(item, h5py.h5s.ALL, h5py.h5s.ALL)
                    variables[name] = dimensions[item], values, attributes[name]
            return xr.Dataset(variables, attrs=file.attrs)
    except (OSError, ValueError, LookupError, RuntimeError) as error:
        raise UnreadableFile(path, error) from error


def _attributes(item: h5py.h5d.DatasetID) -> dict[str, Any]:
    """Attributes of a variable, as builtins."""
    opened = [h5py.h5a.open(item, index=number) for number in range(h5py.h5a.get_num_attrs(item))]
    named = {attribute.name.decode(): attribute for attribute in opened}
    return {name: _values(named[name]).tolist() for name in named if name not in PLUMBING}


def _values(item: h5py.h5d.DatasetID | h5py.h5a.AttrID, *spaces: h5py.h5s.SpaceID) -> np.ndarray:
    """Values of a variable or of an attribute, text as text."""
    values = np.empty(item.shape, item.dtype)
    item.read(*spaces, values)
    if values.dtype.kind == "O":
        values = np.array([text.decode() for text in values.flat], dtype=str).reshape(values.shape)
    return values
