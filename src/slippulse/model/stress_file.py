"""Read a table of pre-stress from a CSV or netCDF file.

`read_stress_file` returns the numbers as they are in the file, with their units.
`read_dimensionless` also checks that these units are those of the model.
"""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import xarray as xr

from .checks import short_repr
from .prestress_parts import MAX_TABLE_POINTS

# Default names of the columns, in upper or lower case.
POSITION_NAMES = ("x", "position", "distance")
STRESS_NAMES = ("tau", "prestress", "pre_stress", "shear_stress", "stress", "initial_stress")
# Names of the units of the model. A table in these units needs no conversion.
DIMENSIONLESS_UNITS = {"x": ("", "1", "-", "H"), "prestress": ("", "1", "-", "S")}
# No sensible file is larger: MAX_TABLE_POINTS rows of very many digits still fit.
MAX_FILE_BYTES = 20_000_000
NUMBER_PATTERN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
# Characters that may separate the cells of a row. If the first row has none of them, spaces do.
DELIMITERS = ",;\t"
HDF_BEGINNING = b"\x89HDF"
NETCDF_BEGINNINGS = (b"CDF", HDF_BEGINNING)
NETCDF_SUFFIXES = (".nc", ".nc4", ".cdf", ".h5")


class Row(NamedTuple):
    """The cells of a line, and the number of the line in its file (from 1)."""

    number: int
    cells: list[str]


class StressTable(NamedTuple):
    """Positions and pre-stress of a file, and their units (empty text if there are none)."""

    x: list[float]
    prestress: list[float]
    x_unit: str
    prestress_unit: str


class StressFileError(ValueError):
    """Error in a file, described in one line that begins with the path of the file."""


def read_stress_file(
    path: str | Path, x: str | None = None, prestress: str | None = None
) -> StressTable:
    """Read the columns of positions and pre-stress from a file.

    x, prestress : names of the two columns; by default one of POSITION_NAMES and of STRESS_NAMES

    In a CSV file the first row has the names, and the second may have units. A row that begins with
    # is a comment. Raises StressFileError, which names the file, the row and what is allowed.
    """
    path = Path(path)
    try:
        if path.exists() and not path.is_file():
            raise StressFileError("not a regular file; allowed: a CSV or netCDF file")
        with path.open("rb") as file:
            content = file.read(MAX_FILE_BYTES + 1)
        if len(content) > MAX_FILE_BYTES:
            raise StressFileError(
                f"more than {MAX_FILE_BYTES} bytes; allowed: at most {MAX_TABLE_POINTS} rows"
            )
        is_netcdf = content.startswith(NETCDF_BEGINNINGS) or path.suffix in NETCDF_SUFFIXES
        read = _read_netcdf if is_netcdf else _read_csv
        return read(content, x, prestress)
    except OSError as error:
        reason = f"{error.strerror or error}; allowed: a CSV or netCDF file that can be read"
    except UnicodeDecodeError as error:
        reason = f"not text (byte {error.start}); allowed: CSV in UTF-8"
    except StressFileError as error:
        reason = str(error)
    raise StressFileError(f"{path}: {reason}")


def read_dimensionless(path: str | Path, x: str | None, prestress: str | None) -> StressTable:
    """Read a file whose positions are in units of H and whose pre-stress is in stress drops.

    x, prestress : names of the two columns; by default one of POSITION_NAMES and of STRESS_NAMES

    Raises StressFileError if the file names another unit, or if the first or last value, which
    holds everywhere beyond the table, is not < 1.
    """
    table = read_stress_file(path, x, prestress)
    units = {"x": table.x_unit, "prestress": table.prestress_unit}
    for name, unit in units.items():
        if unit not in DIMENSIONLESS_UNITS[name]:
            # The empty unit, which is allowed, is not listed.
            allowed = ", ".join(filter(None, DIMENSIONLESS_UNITS[name]))
            raise StressFileError(f"{path}: unit {short_repr(unit)} of {name}; allowed: {allowed}")
    for end, value in (("first", table.prestress[0]), ("last", table.prestress[-1])):
        if not value < 1.0:
            allowed = "< 1, since the pre-stress keeps this value beyond the table"
            raise StressFileError(f"{path}: {end} prestress {value:.10g}; allowed: {allowed}")
    return table


def _read_csv(content: bytes, x: str | None, prestress: str | None) -> StressTable:
    """Read the two columns of a CSV file, given as bytes.

    x, prestress : names of the columns; if None, they are found by their usual names
    """
    header, *body = _csv_rows(content)
    names = header.cells
    x_column = _find_column(names, "x", x, POSITION_NAMES)
    tau_column = _find_column(names, "prestress", prestress, STRESS_NAMES)
    x_unit, tau_unit = "", ""
    if body:
        x_cell, tau_cell = _cell(body[0], x_column), _cell(body[0], tau_column)
        # The row below the names has units if neither of its values is a number.
        if not (_is_number(x_cell) or _is_number(tau_cell)):
            x_unit, tau_unit = x_cell, tau_cell
            body = body[1:]
    positions = [_number(row, names, x_column) for row in body]
    values = [_number(row, names, tau_column) for row in body]
    _check_rows([row.number for row in body], positions)
    return StressTable(positions, values, x_unit, tau_unit)


def _csv_rows(content: bytes) -> list[Row]:
    """Split a CSV file into rows, without blank lines and comments."""
    lines = content.decode("utf-8-sig").splitlines()
    numbered_lines = []
    for number, line in enumerate(lines, start=1):
        is_comment = line.lstrip().startswith("#")
        if line.strip() and not is_comment:
            numbered_lines.append((number, line))
    if not numbered_lines:
        raise StressFileError("empty; allowed: a row of names, and rows of numbers below")
    # Names and units are two rows in addition to the rows of numbers.
    max_lines = MAX_TABLE_POINTS + 2
    if len(numbered_lines) > max_lines:
        number, _ = numbered_lines[max_lines]
        raise StressFileError(
            f"row {number}: one row too many; allowed: at most {MAX_TABLE_POINTS} rows"
        )
    # The delimiter is None if spaces separate the cells.
    _, first_line = numbered_lines[0]
    delimiter = next((sign for sign in DELIMITERS if sign in first_line), None)
    return [Row(number, _cells(line, delimiter)) for number, line in numbered_lines]


def _cells(line: str, delimiter: str | None) -> list[str]:
    """Split a line into cells; None as the delimiter stands for spaces."""
    return [cell.strip().strip('"') for cell in line.split(delimiter)]


def _find_column(
    header: Sequence[str], key: str, given: str | None, default_names: Sequence[str]
) -> int:
    """Return the index of a column by its name, in upper or lower case.

    Raises StressFileError if there is no such column.

    header : names of all columns
    key : name of the argument with which a user can give the name of the column, for the message
    given : the name of the column; if it is None, the first default name that occurs is used
    """
    names = default_names if given is None else (given,)
    lower_case = [cell.lower() for cell in header]
    for name in names:
        if name in header:
            return header.index(name)
        if name.lower() in lower_case:
            return lower_case.index(name.lower())
    present = ", ".join(short_repr(cell) for cell in header[:8])
    allowed = f"a column of that name, or {key} = the name of another column"
    raise StressFileError(
        f"no column {' or '.join(names)}, but the columns {present}; allowed: {allowed}"
    )


def _is_number(text: str) -> bool:
    """Return True if Python can read a text as a number, which may be infinite or NaN."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _cell(row: Row, column: int) -> str:
    """Return the cell of a row in a column, or raise StressFileError if the row is too short."""
    if column >= len(row.cells):
        allowed = "a value in each column"
        raise StressFileError(f"row {row.number}: a value is missing; allowed: {allowed}")
    return row.cells[column]


def _number(row: Row, names: Sequence[str], column: int) -> float:
    """Return the number in a cell, or raise StressFileError if it is not a finite number.

    names : names of all columns, for the message
    """
    text = _cell(row, column)
    value = float(text) if NUMBER_PATTERN.fullmatch(text) else math.nan
    if not math.isfinite(value):
        given = short_repr(text) if text else "nothing"
        allowed = "a finite number"
        raise StressFileError(f"row {row.number}: {names[column]} = {given}; allowed: {allowed}")
    return value


def _check_rows(rows: Sequence[int], x: Sequence[float]) -> None:
    """Raise StressFileError if there are fewer than two rows, or if positions are not in order.

    Positions must increase from row to row. Two rows, but not three, may have the same position, at
    which the pre-stress jumps.

    rows : numbers of the rows in the file, for the message
    x : positions
    """
    if len(rows) < 2:
        count = "one row" if rows else "no row"
        raise StressFileError(f"{count} of numbers; allowed: at least 2, from left to right")
    for index in range(1, len(rows)):
        position, before = x[index], x[index - 1]
        wrong_row = f"row {rows[index]}: position {position:.10g}"
        if position < before:
            allowed = f">= {before:.10g}, the position in the row before"
            raise StressFileError(f"{wrong_row}; allowed: {allowed}")
        if index > 1 and position == before == x[index - 2]:
            allowed = "at most 2 rows with the same position; the pre-stress jumps between them"
            raise StressFileError(f"{wrong_row}; allowed: {allowed}")


def _read_netcdf(content: bytes, x: str | None, prestress: str | None) -> StressTable:
    """Read two one-dimensional variables of a netCDF file, given as bytes.

    x, prestress : names of the two variables; if None, they are found by their usual names
    """
    from io import BytesIO

    import xarray as xr

    # A netCDF-4 file is an HDF5 file.
    engine = "h5netcdf" if content.startswith(HDF_BEGINNING) else "scipy"
    try:
        data = xr.load_dataset(BytesIO(content), engine=engine, decode_times=False)
    except Exception as error:
        # On a damaged file the libraries raise many different types of errors.
        reason = " ".join(str(error).split())[:80]
        raise StressFileError(f"not netCDF ({reason}); allowed: netCDF-3 or netCDF-4") from None
    header = [str(name) for name in data.variables if data[name].ndim == 1]
    x_name = header[_find_column(header, "x", x, POSITION_NAMES)]
    tau_name = header[_find_column(header, "prestress", prestress, STRESS_NAMES)]
    positions, values = _netcdf_numbers(data, x_name), _netcdf_numbers(data, tau_name)
    if len(positions) != len(values):
        sizes = f"{len(positions)} values of {x_name}, {len(values)} of {tau_name}"
        raise StressFileError(f"{sizes}; allowed: equal numbers of values")
    _check_rows(range(1, len(values) + 1), positions)
    units = [str(data[name].attrs.get("units", "")) for name in (x_name, tau_name)]
    return StressTable(positions, values, units[0], units[1])


def _netcdf_numbers(data: "xr.Dataset", name: str) -> list[float]:
    """Return the values of a variable, or raise StressFileError if they are not finite numbers."""
    values = data[name].values
    if values.dtype.kind not in "iuf":
        raise StressFileError(f"{name}: values that are not numbers; allowed: numbers")
    if values.size > MAX_TABLE_POINTS:
        raise StressFileError(
            f"{values.size} values of {name}; allowed: at most {MAX_TABLE_POINTS}"
        )
    numbers = values.astype(float).tolist()
    for row, number in enumerate(numbers, start=1):
        if not math.isfinite(number):
            raise StressFileError(f"row {row}: {name} = {number}; allowed: a finite number")
    return numbers
