"""Reading of a table of pre-stress from a CSV or netCDF file."""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import xarray as xr

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
# Signs that may divide the cells of a row; spaces do if the first row has none of them.
DELIMITERS = ",;\t"
NETCDF_BEGINNINGS = (b"CDF", b"\x89HDF")
NETCDF_SUFFIXES = (".nc", ".nc4", ".cdf", ".h5")


class Row(NamedTuple):
    """The number of a line in its file, and its cells."""

    number: int
    cells: list[str]


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
    (_, names), *body = _csv_rows(content)
    x_column = _column(names, "x", x, POSITIONS)
    tau_column = _column(names, "prestress", prestress, STRESSES)
    units = "", ""
    if body:
        cells = _cell(body[0], x_column), _cell(body[0], tau_column)
        # The row below the names has units if neither of its values is a number.
        if not any(map(_is_number, cells)):
            units, body = cells, body[1:]
    positions = [_number(row, names, x_column) for row in body]
    values = [_number(row, names, tau_column) for row in body]
    _check_rows([row.number for row in body], positions, values)
    return StressTable(positions, values, *units)


def _csv_rows(content: bytes) -> list[Row]:
    """The rows that are neither blank nor comments, with the numbers of their lines."""
    lines = content.decode("utf-8-sig").splitlines()
    numbered = [
        (number, line)
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise StressFileError("empty; allowed: a row of names, and rows of numbers below")
    # The names and the units take a row each.
    if len(numbered) > MOST_POINTS + 2:
        number = numbered[MOST_POINTS + 2][0]
        raise StressFileError(f"row {number}: one too many; allowed: at most {MOST_POINTS} rows")
    delimiter = next((sign for sign in DELIMITERS if sign in numbered[0][1]), None)
    return [Row(number, _cells(line, delimiter)) for number, line in numbered]


def _cells(line: str, delimiter: str | None) -> list[str]:
    """The cells of a line; spaces divide them if no other sign does."""
    return [cell.strip().strip('"') for cell in line.split(delimiter)]


def _column(header: Sequence[str], key: str, given: str | None, known: Sequence[str]) -> int:
    """Number of the column that has the given name, or the first of the known ones."""
    names = known if given is None else (given,)
    lower = [cell.lower() for cell in header]
    for name in names:
        if name in header:
            return header.index(name)
        if name.lower() in lower:
            return lower.index(name.lower())
    present = ", ".join(short_repr(cell) for cell in header[:8])
    allowed = f"a column of that name, or {key} = the name of a column"
    raise StressFileError(
        f"no column {' or '.join(names)} for {key} among {present}; allowed: {allowed}"
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _cell(row: Row, column: int) -> str:
    if column >= len(row.cells):
        allowed = "a value in each column"
        raise StressFileError(f"row {row.number}: {len(row.cells)} values; allowed: {allowed}")
    return row.cells[column]


def _number(row: Row, names: Sequence[str], column: int) -> float:
    text = _cell(row, column)
    plain = NUMBER.fullmatch(text)
    value = float(text) if plain else math.nan
    if not math.isfinite(value):
        given = short_repr(text) if text else "nothing"
        allowed = "a finite number"
        raise StressFileError(f"row {row.number}: {names[column]} = {given}; allowed: {allowed}")
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

    import xarray as xr

    engine = "h5netcdf" if content.startswith(NETCDF_BEGINNINGS[1]) else "scipy"
    try:
        data = xr.load_dataset(BytesIO(content), engine=engine, decode_times=False)
    except Exception as error:
        # The libraries raise errors of many kinds on a damaged file.
        reason = " ".join(str(error).split())[:80]
        raise StressFileError(f"not netCDF ({reason}); allowed: netCDF-3 or netCDF-4") from None
    header = [str(name) for name in data.variables if data[name].ndim == 1]
    x_name = header[_column(header, "x", x, POSITIONS)]
    tau_name = header[_column(header, "prestress", prestress, STRESSES)]
    positions, values = _netcdf_numbers(data, x_name), _netcdf_numbers(data, tau_name)
    if len(positions) != len(values):
        allowed = "equally many"
        raise StressFileError(f"{len(positions)} and {len(values)} values; allowed: {allowed}")
    _check_rows(range(1, len(values) + 1), positions, values)
    units = [str(data[name].attrs.get("units", "")) for name in (x_name, tau_name)]
    return StressTable(positions, values, units[0], units[1])


def _netcdf_numbers(data: "xr.Dataset", name: str) -> list[float]:
    """The values of a variable, or StressFileError."""
    values = data[name].values
    if values.dtype.kind not in "iuf":
        raise StressFileError(f"{name}: not numbers; allowed: numbers")
    if values.size > MOST_POINTS:
        raise StressFileError(f"{values.size} values of {name}; allowed: at most {MOST_POINTS}")
    numbers = values.astype(float).tolist()
    for row, number in enumerate(numbers, start=1):
        if not math.isfinite(number):
            raise StressFileError(f"row {row}: {name} = {number}; allowed: a finite number")
    return numbers
