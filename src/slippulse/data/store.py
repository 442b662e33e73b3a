"""Files: netCDF data, CSV tables and figures, written whole or not at all and with no clock in them."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
import xarray as xr

from .files import write_whole
from .origin import configuration

# Attributes of HDF5 and of the netCDF-4 library, and what marks a dimension that has no coordinate.
PLUMBING = {
    "CLASS",
    "NAME",
    "DIMENSION_LIST",
    "REFERENCE_LIST",
    "_Netcdf4Dimid",
    "_Netcdf4Coordinates",
    "_NCProperties",
}
BARE = b"This is a netCDF dimension but not a netCDF variable"


def save_dataset(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a Dataset as netCDF-4; equal data give equal bytes.

    Through memory: HDF5 that meets a full disk half way does not always leave the interpreter standing.
    """
    if configuration():
        dataset = dataset.assign_attrs(configuration=configuration())
    content = dataset.to_netcdf(engine="h5netcdf", format="NETCDF4")
    write_whole(path, lambda part: part.write_bytes(content))


class UnreadableFile(ValueError):
    """A file of the pipeline that is cut short, corrupted or edited beyond reading."""

    def __init__(self, path: str | Path, reason: object) -> None:
        text = " ".join(str(reason).split())[:120]
        super().__init__(f"{path}: cannot be read ({text}); delete it and run again, and it is made anew")


def load_dataset(path: str | Path) -> xr.Dataset:
    """Read a Dataset into memory and close the file.

    Raises
    ------
    UnreadableFile
        Naming the file and the remedy.
    """
    try:
        with h5py.File(path) as file:
            variables = {
                name: _read(name, item)
                for name, item in file.items()
                if not item.attrs.get("NAME", b"").startswith(BARE)
            }
            return xr.decode_cf(xr.Dataset(variables, attrs=_attributes(file)))
    except FileNotFoundError:
        raise
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise UnreadableFile(path, error) from error


def _read(name: str, item: h5py.Dataset) -> tuple[list[str], np.ndarray, dict[str, Any]]:
    """Dimensions, values and attributes; through xarray's engine each variable takes three times as long."""
    dimensions = [name] if item.is_scale else [dimension[0].name.lstrip("/") for dimension in item.dims]
    text = h5py.check_string_dtype(item.dtype) is not None
    return dimensions, item.asstr()[()].astype(str) if text else item[()], _attributes(item)


def _attributes(item: h5py.HLObject) -> dict[str, Any]:
    return {name: value for name, value in item.attrs.items() if name not in PLUMBING}


def save_table(table: pd.DataFrame, path: str | Path, digits: int = 9) -> None:
    """Write a table as CSV, to some significant digits."""
    form = f"%.{digits}g"
    write_whole(path, lambda part: table.to_csv(part, index=False, float_format=form, lineterminator="\n"))


def load_table(path: str | Path, whole: Collection[str] | None = None) -> pd.DataFrame:
    """Read a table; empty text stays text. With ``whole``, only these columns may hold whole numbers, others fractions.

    Raises
    ------
    UnreadableFile
        Naming the file and the remedy.
    """
    try:
        table = pd.read_csv(path, keep_default_na=True, na_filter=True, low_memory=False)
        if whole is None:
            return table
        # Read again, since -0 as a whole number has lost its sign.
        fractions = [name for name in table if table[name].dtype.kind == "i" and name not in whole]
        return pd.read_csv(
            path,
            keep_default_na=True,
            na_filter=True,
            low_memory=False,
            dtype=dict.fromkeys(fractions, float),
        )
    except ValueError as error:
        raise UnreadableFile(path, error) from error
