"""Read Datasets from netCDF-4 files.

The files are read with the low-level functions of h5py. A sweep has about fifty variables, and
reading them with xarray takes five times as long, with the high-level objects of h5py three times.
"""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from .files import UnreadableFile

# Attributes that HDF5 and netCDF-4 use internally. They are not part of a Dataset.
INTERNAL_ATTRIBUTES = {"CLASS", "DIMENSION_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates"}
# The attribute NAME of a dimension without a coordinate begins with this text.
BARE_DIMENSION = b"This is a netCDF dimension"


def load_dataset(path: str | Path) -> xr.Dataset:
    """Read a Dataset into memory, or raise UnreadableFile with the path and a remedy."""
    try:
        # The file is opened by Python, not by HDF5, so that Python's audit hooks record the read.
        with open(path, "rb") as source, h5py.File(source) as file:
            items = {name: h5py.h5d.open(file.id, name.encode()) for name in file}
            attributes = {name: _attributes(item) for name, item in items.items()}
            dimensions = _dimensions_of_variables(file, items, attributes)
            variables = {}
            for name, item in items.items():
                # These two attributes describe dimensions, and are not part of the Dataset.
                attributes[name].pop("REFERENCE_LIST", None)
                scale_name = attributes[name].pop("NAME", b"")
                # An item with such a NAME is a dimension without a coordinate, not a variable.
                if not scale_name.startswith(BARE_DIMENSION):
                    variables[name] = dimensions[name], _values(item), attributes[name]
            return xr.Dataset(variables, attrs=file.attrs)
    except (OSError, ValueError, LookupError, RuntimeError) as error:
        raise UnreadableFile(path, error) from error


def _dimensions_of_variables(
    file: h5py.File, items: dict[str, h5py.h5d.DatasetID], attributes: dict[str, dict[str, Any]]
) -> dict[str, list[str]]:
    """Return the names of the dimensions of each variable.

    A dimension is an item of the file. Its attribute REFERENCE_LIST lists the variables that have
    the dimension, each with the number of the axis. A variable that is in no such list is a
    coordinate: its dimension has its own name.

    items, attributes : all variables and dimensions of the file, and their attributes, by name
    """
    # The keys are items, because REFERENCE_LIST refers to items, not to names.
    dimensions = {item: [name] * item.rank for name, item in items.items()}
    for dimension, attributes_of_dimension in attributes.items():
        for reference, axis in attributes_of_dimension.get("REFERENCE_LIST", ()):
            variable = h5py.h5r.dereference(reference, file.id)
            dimensions[variable][axis] = dimension
    return {name: dimensions[item] for name, item in items.items()}


def _attributes(item: h5py.h5d.DatasetID) -> dict[str, Any]:
    """Return the attributes of a variable, as builtin Python types."""
    attributes = {}
    for number in range(h5py.h5a.get_num_attrs(item)):
        attribute = h5py.h5a.open(item, index=number)
        name = attribute.name.decode()
        if name not in INTERNAL_ATTRIBUTES:
            attributes[name] = _values(attribute).tolist()
    return attributes


def _values(item: h5py.h5d.DatasetID | h5py.h5a.AttrID) -> np.ndarray:
    """Return all values of a variable or an attribute, with bytes decoded to text."""
    values = np.empty(item.shape, item.dtype)
    if isinstance(item, h5py.h5d.DatasetID):
        # The first two arguments select parts of the memory and of the file.
        item.read(h5py.h5s.ALL, h5py.h5s.ALL, values)
    else:
        item.read(values)
    if values.dtype.kind == "O":
        # An array of fixed-width texts would need the memory of the longest text for every run.
        texts = [text.decode() for text in values.flat]
        values = np.array(texts, dtype=object).reshape(values.shape)
    return values
