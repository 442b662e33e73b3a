"""Reading of a table of pre-stress from a CSV or netCDF file."""

import csv
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from .checks import short_repr
from .prestress import MOST_POINTS

# Names of the columns that are looked for, in any case, if none is given.
POSITIONS = ("x", "position", "distance")
STRESSES = ("tau", "prestress", "pre_stress", "shear_stress", "stress", "initial_stress")
# Units in which a table needs no conversion.
DIMENSIONLESS = {"x": ("", "1", "-", "H"), "prestress": ("", "1", "-", "S")}
# A table of the most points, written with far more digits than a number has, is smaller.
LARGEST_FILE = 20_000_000
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
# The number of a row in its file, and its cells.
Row = tuple[int, Sequence[str]]
NETCDF_BEGINNINGS = (b"CDF", b"\x89HDF")
NETCDF_SUFFIXES = (".nc", ".nc4", ".cdf", ".h5")


class StressTable(NamedTuple):
    """Two columns of a file, and their units (empty if there are none)."""

    x: list[float]
    prestress: list[float]
    x_unit: str
    prestress_unit: str


class StressFileError(ValueError):
    """Refusal of a file, in one line with its path."""


def read_stress_file(
    path: str | Path, x: str | None = None, prestress: str | None = None
) -> StressTable:
    """Read two columns of a file. ValueError names the file, the row and what is allowed.

    The columns are found by the given names, or by POSITIONS and STRESSES. In a CSV file the first
    row has the names, and the row below may have units. A row that begins with # is a comment.
    """
    path = Path(path)
    try:
        if path.exists() and not path.is_file():
            raise StressFileError("not a regular file; allowed: a CSV or netCDF file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise StressFileError(
                f"more than {LARGEST_FILE} bytes; allowed: at most {MOST_POINTS} rows"
            )
        netcdf = content.startswith(NETCDF_BEGINNINGS) or path.suffix in NETCDF_SUFFIXES
        read = _read_netcdf if netcdf else _read_csv
        return read(content, x, prestress)
    except OSError as error:
        reason = f"{error.strerror or error}; allowed: a CSV or netCDF file that can be read"
    except UnicodeDecodeError as error:
        reason = f"not text (byte {error.start}); allowed: CSV in UTF-8"
    except StressFileError as error:
        reason = str(error)
    raise StressFileError(f"{path}: {reason}")


def read_dimensionless(path: str | Path, x: str | None, prestress: str | None) -> StressTable:
    """Read a file in units of H and of the stress drop, which are written 1, - or nothing, too."""
    table = read_stress_file(path, x, prestress)
    units = {"x": table.x_unit, "prestress": table.prestress_unit}
    for name, unit in units.items():
        if unit not in DIMENSIONLESS[name]:
            words = ", ".join(filter(None, DIMENSIONLESS[name]))
            raise StressFileError(f"{path}: unit {short_repr(unit)} of {name}; allowed: {words}")
    for place, value in (("first", table.prestress[0]), ("last", table.prestress[-1])):
        if not value < 1.0:
            allowed = "< 1, since it holds beyond the table"
            raise StressFileError(f"{path}: {place} prestress {value:.10g}; allowed: {allowed}")
    return table


def _read_csv(content: bytes, x: str | None, prestress: str | None) -> StressTable:
    lines = content.decode("utf-8-sig").splitlines()
    kept = [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]
    kept = [(number, line) for number, line in kept if not line.lstrip().startswith("#")]
    if not kept:
        raise StressFileError("empty; allowed: a row of names, and rows of numbers below")
    # The names and the units take a row each.
    for number, _ in kept[MOST_POINTS + 2 :][:1]:
        raise StressFileError(f"row {number}: one too many; allowed: at most {MOST_POINTS} rows")
    delimiter = next((one for one in ",;\t" if one in kept[0][1]), None)
    numbers = [number for number, _ in kept]
    if delimiter is None:
        rows = [line.split() for _, line in kept]
    else:
        rows = [*csv.reader((line for _, line in kept), delimiter=delimiter)]
    cells = [[cell.strip() for cell in row] for row in rows]
    x_column, tau_column = _columns(cells[0], x, prestress)
    body = [*zip(numbers, cells, strict=True)][1:]
    units = _units(body, (x_column, tau_column))
    if units is not None:
        body = body[1:]
    positions = [_number(row, cells[0], x_column) for row in body]
    values = [_number(row, cells[0], tau_column) for row in body]
    _check_rows([number for number, _ in body], positions, values)
    return StressTable(positions, values, *(units or ("", "")))


def _units(body: Sequence[Row], columns: tuple[int, int]) -> tuple[str, str] | None:
    """Units of both columns in the row below the names; None if that row has a number."""
    if not body:
        return None
    x_unit, tau_unit = (_cell(body[0], column) for column in columns)
    try:
        float(x_unit)
    except ValueError:
        try:
            float(tau_unit)
        except ValueError:
            return x_unit, tau_unit
    return None


def _columns(header: Sequence[str], x: str | None, prestress: str | None) -> list[int]:
    """Numbers of the two columns."""
    found = []
    for name, wanted, known in (("x", x, POSITIONS), ("prestress", prestress, STRESSES)):
        names = known if wanted is None else (wanted,)
        lower = [cell.lower() for cell in header]
        matches = [names_index for one in names for names_index in _places(header, lower, one)]
        if not matches:
            there = ", ".join(short_repr(cell) for cell in header[:8])
            raise StressFileError(
                f"no column {' or '.join(names)} for {name} among {there}; allowed: a column of"
                f" that name, or {name} = the name of a column"
            )
        found.append(matches[0])
    return found


def _places(header: Sequence[str], lower: Sequence[str], name: str) -> list[int]:
    """Columns of a name, those that are written exactly so first."""
    exact = [index for index, cell in enumerate(header) if cell == name]
    return exact + [index for index, cell in enumerate(lower) if cell == name.lower()]


def _cell(row: Row, column: int) -> str:
    number, cells = row
    if column >= len(cells):
        allowed = "a value in each column"
        raise StressFileError(f"row {number}: {len(cells)} values; allowed: {allowed}")
    return cells[column]


def _number(row: Row, names: Sequence[str], column: int) -> float:
    text = _cell(row, column)
    plain = NUMBER.fullmatch(text)
    value = float(text) if plain else math.nan
    if not math.isfinite(value):
        given = short_repr(text) if text else "nothing"
        allowed = "a finite number"
        raise StressFileError(f"row {row[0]}: {names[column]} = {given}; allowed: {allowed}")
    return value


def _check_rows(rows: Sequence[int], x: Sequence[float], prestress: Sequence[float]) -> None:
    """Refuse fewer than two rows, and positions that are not in order."""
    if len(rows) < 2:
        count = "one row" if rows else "no row"
        raise StressFileError(f"{count} of numbers; allowed: at least 2, from left to right")
    for index in range(1, len(rows)):
        before = x[index - 1]
        if x[index] < before:
            allowed = f">= {before:.10g}, the position in the row before"
            raise StressFileError(f"row {rows[index]}: {x[index]:.10g}; allowed: {allowed}")
        if index > 1 and x[index] == before == x[index - 2]:
            allowed = "a position in at most 2 rows, which are a jump"
            raise StressFileError(f"row {rows[index]}: {x[index]:.10g}; allowed: {allowed}")


def _read_netcdf(content: bytes, x: str | None, prestress: str | None) -> StressTable:
    from io import BytesIO

    import numpy as np
    import xarray as xr

    engine = "h5netcdf" if content.startswith(NETCDF_BEGINNINGS[1]) else "scipy"
    try:
        data = xr.load_dataset(BytesIO(content), engine=engine, decode_times=False)
    except Exception as error:
        # The libraries raise errors of many kinds on a damaged file.
        reason = " ".join(str(error).split())[:80]
        raise StressFileError(f"not netCDF ({reason}); allowed: netCDF-3 or netCDF-4") from None
    header = [str(name) for name in data.variables if data[name].ndim == 1]
    names = [header[column] for column in _columns(header, x, prestress)]
    arrays = [data[name].values for name in names]
    sizes = [array.size for array in arrays]
    if sizes[0] != sizes[1] or sizes[0] > MOST_POINTS:
        allowed = f"equally many, at most {MOST_POINTS}"
        raise StressFileError(f"{sizes[0]} and {sizes[1]} values; allowed: {allowed}")
    for name, array in zip(names, arrays, strict=True):
        if array.dtype.kind not in "iuf":
            raise StressFileError(f"{name}: not numbers; allowed: numbers")
        for row in (np.flatnonzero(~np.isfinite(array)) + 1)[:1]:
            raise StressFileError(f"row {row}: {name} = {array[row - 1]}; allowed: a finite number")
    columns = [array.astype(float).tolist() for array in arrays]
    _check_rows(range(1, sizes[0] + 1), *columns)
    return StressTable(*columns, *(str(data[name].attrs.get("units", "")) for name in names))
