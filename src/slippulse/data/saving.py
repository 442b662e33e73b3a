"""Write Datasets as netCDF-4 files.

The files are written with h5py, in the layout of netCDF-4, and contain no time of writing. Equal
data therefore give files with equal bytes. For all data of the paper, `xarray.Dataset.to_netcdf`
would take 3.4 s of processor time instead of 0.6 s.
"""

from collections.abc import Hashable
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from .files import configuration_digest, write_whole


def save_dataset(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a Dataset as netCDF-4; equal data give equal bytes.

    Each coordinate must have the name of its dimension. In the workflow, the digest (checksum) of
    the configuration is added to the attributes. The file is either complete or absent.
    """
    if configuration_digest():
        dataset = dataset.assign_attrs(configuration=configuration_digest())
    write_whole(path, lambda unfinished: _write_netcdf(dataset, unfinished))


def _write_netcdf(dataset: xr.Dataset, path: Path) -> None:
    """Write a Dataset to a new file."""
    with path.open("w+b") as target, h5py.File(target, "w", track_order=True) as file:
        file.attrs.update(dataset.attrs)
        stored = {}
        for name, variable in dataset.variables.items():
            is_text = variable.dtype.kind in "UO"
            values = variable.values.astype(h5py.string_dtype()) if is_text else variable.values
            stored[name] = file.create_dataset(name, data=values)
            stored[name].attrs.update(variable.attrs)
        _store_dimensions(file, stored, dataset)


def _store_dimensions(
    file: h5py.File, stored: dict[Hashable, h5py.Dataset], dataset: xr.Dataset
) -> None:
    """Store the dimensions of a Dataset, and attach them to its variables.

    netCDF-4 stores each dimension as an HDF5 dimension scale. The scale is the coordinate variable
    of the dimension. For a dimension without such a variable, the scale is an empty array with a
    name that says so.

    stored : the variables in the file by name
    """
    for number, (name, size) in enumerate(dataset.sizes.items()):
        if name in dataset.variables:
            scale_name = name
        else:
            stored[name] = file.create_dataset(name, shape=size, dtype="f4")
            scale_name = f"This is a netCDF dimension but not a netCDF variable.{size:10d}"
        stored[name].make_scale(scale_name)
        stored[name].attrs["_Netcdf4Dimid"] = np.int32(number)
    for name, variable in dataset.variables.items():
        # A coordinate variable is the scale of its own dimension.
        if name not in dataset.sizes:
            for axis, dimension in enumerate(variable.dims):
                stored[name].dims[axis].attach_scale(stored[dimension])
