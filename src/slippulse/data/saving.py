"""Writing of Datasets as netCDF-4 files, without a time of writing."""

from io import BytesIO
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from .files import configuration, write_whole


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
            bare = f"This is a netCDF dimension but not a netCDF variable.{size:10d}"
            items[name].make_scale(name if name in dataset.variables else bare)
            items[name].attrs["_Netcdf4Dimid"] = np.int32(number)
        for name, variable in dataset.variables.items():
            dimensions = () if name in dataset.sizes else variable.dims
            for axis, dimension in enumerate(dimensions):
                items[name].dims[axis].attach_scale(items[dimension])
    write_whole(path, lambda part: part.write_bytes(content.getbuffer()))
