"""Reading of an initial shear stress in SI units from a CSV or netCDF file."""

from pathlib import Path

import numpy as np

from .checks import short_repr
from .stress_file import StressFileError, read_stress_file

# Values of the units that a file may have, in m and Pa. A file without units is in m and Pa.
MICRO = {"um": 1e-6, "\N{MICRO SIGN}m": 1e-6, "\N{GREEK SMALL LETTER MU}m": 1e-6}
LENGTHS = {"": 1.0, "m": 1.0, "km": 1e3, "cm": 1e-2, "mm": 1e-3} | MICRO
STRESSES = {"": 1.0, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5}


def read_in_si(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Read positions (m) and stresses (Pa). ValueError names the file, the row and what is allowed.

    The columns are found as by `Prestress.from_file`.
    """
    table = read_stress_file(path)
    x = np.array(table.x) * _value(path, "x", table.x_unit, LENGTHS)
    stress = np.array(table.prestress) * _value(path, "stress", table.prestress_unit, STRESSES)
    return x, stress


def _value(path: str | Path, column: str, unit: str, known: dict[str, float]) -> float:
    if unit not in known:
        allowed = ", ".join(filter(None, known))
        raise StressFileError(f"{path}: unit {short_repr(unit)} of {column}; allowed: {allowed}")
    return known[unit]
