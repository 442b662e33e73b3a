"""Read an initial shear stress from a CSV or netCDF file, and convert it to SI units."""

from pathlib import Path

import numpy as np

from .checks import short_repr
from .stress_file import StressFileError, read_stress_file

# Values of the units that a file may have, in metres and in pascal. A file without units is in m
# and Pa.
MICROMETRES = {"um": 1e-6, "\N{MICRO SIGN}m": 1e-6, "\N{GREEK SMALL LETTER MU}m": 1e-6}
LENGTH_UNITS = {"": 1.0, "m": 1.0, "km": 1e3, "cm": 1e-2, "mm": 1e-3} | MICROMETRES
STRESS_UNITS = {"": 1.0, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5}


def read_in_si(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions (m) and the stresses (Pa) of a file.

    The columns of the file have the default names of `Prestress.from_file`, such as x and stress.
    Raises StressFileError, which names the file, the row and what is allowed.
    """
    table = read_stress_file(path)
    x_unit = _unit_value(path, "x", table.x_unit, LENGTH_UNITS)
    stress_unit = _unit_value(path, "stress", table.prestress_unit, STRESS_UNITS)
    return np.array(table.x) * x_unit, np.array(table.prestress) * stress_unit


def _unit_value(path: str | Path, column: str, unit: str, unit_values: dict[str, float]) -> float:
    """Return the value of a unit in SI, or raise StressFileError if the unit is unknown.

    path, column : the file and its column, for the message
    unit_values : the values of all units that the column may have
    """
    if unit not in unit_values:
        # The empty unit, which means SI units, is not listed.
        allowed = ", ".join(filter(None, unit_values))
        raise StressFileError(f"{path}: unit {short_repr(unit)} of {column}; allowed: {allowed}")
    return unit_values[unit]
