"""Conversion of the table of a run to SI units with readable prefixes, before it is drawn.

The column `role` of a table decides what is drawn from a row, for example a map or a front.
"""

import pandas as pd

from ..data.readable_units import readable_unit
from ..model.layer_units import Layer
from ..model.si_quantities import QUANTITIES

# The quantity in the column `value` of rows with these roles. In rows with another role, the column
# `series` names the quantity.
ROLE_QUANTITIES = {
    "prestress": "stress",
    "strength": "stress",
    "map": "slip_velocity",
    "largest": "slip_velocity",
}
# Dimensionless stresses that are marked on the axis of stresses (role strength).
STRENGTHS = {"kinetic friction": 0.0, "static friction": 1.0}
# Rows with these roles are drawn on axes. All values of one quantity get the same unit, so that
# they can share an axis.
AXIS_ROLES = ("prestress", "strength", "map", "largest", "profile", "steady")
# Quantities in the columns with coordinates.
COLUMN_QUANTITIES = {"position": "length", "time": "time"}


def table_in_si(table: pd.DataFrame, layer: Layer) -> pd.DataFrame:
    """Convert the table of everything that is drawn of a run to SI units.

    Each row has a role, such as "map", and may have a number (column `value`), a position and a
    time. The new column `unit` holds the unit of the column `value`, and is empty for dimensionless
    numbers. These rows are added:

    strength : static and kinetic friction, as stresses
    unit : the unit of each axis
    parameter : the thickness of the layer
    """
    strengths = [
        {"role": "strength", "series": name, "value": value} for name, value in STRENGTHS.items()
    ]
    table = pd.concat([table, pd.DataFrame(strengths)], ignore_index=True)
    # Rows that are in SI units already, such as the numbers below a figure, keep their unit.
    if "unit" not in table:
        table["unit"] = ""
    axis_units = _convert_coordinates(table, layer)
    # The physical quantity, such as "stress", of the number in the column `value` of each row. The
    # quantity follows from the role or, for other roles, from the column `series`, and is NaN for a
    # dimensionless number.
    quantities = table["role"].map(ROLE_QUANTITIES).fillna(table["series"].map(QUANTITIES))
    # All values of one quantity on the axes get the same unit.
    is_on_axis = table["role"].isin(AXIS_ROLES)
    for quantity, rows in table[is_on_axis].groupby(quantities[is_on_axis]):
        axis_units[str(quantity)] = _convert_values(table, rows.index, str(quantity), layer)
    is_parameter = (table["role"] == "parameter") & quantities.notna()
    for index in table.index[is_parameter]:
        # Each parameter has its own prefix.
        _convert_values(table, pd.Index([index]), quantities[index], layer)
    unit = readable_unit("length", layer.thickness)
    thickness = {"series": "thickness", "value": layer.thickness / unit.value, "unit": unit.text}
    added = [{"role": "parameter", **thickness}]
    added += [{"role": "unit", "series": name, "unit": text} for name, text in axis_units.items()]
    return pd.concat([table, pd.DataFrame(added)], ignore_index=True)


def _convert_coordinates(table: pd.DataFrame, layer: Layer) -> dict[str, str]:
    """Convert the positions and times of a table to SI units in place, and return their units."""
    units = {}
    for column, quantity in COLUMN_QUANTITIES.items():
        numbers = layer.convert_to_si(table[column], quantity)
        unit = readable_unit(quantity, numbers)
        table[column] = numbers / unit.value
        units[column] = unit.text
    return units


def _convert_values(table: pd.DataFrame, rows: pd.Index, quantity: str, layer: Layer) -> str:
    """Convert the values of some rows of a table to SI units in place, and return their unit.

    quantity : physical quantity of these values, such as "stress"
    """
    numbers = layer.convert_to_si(table.loc[rows, "value"], quantity)
    unit = readable_unit(quantity, numbers)
    table.loc[rows, "value"] = numbers / unit.value
    table.loc[rows, "unit"] = unit.text
    return unit.text


def with_unit(label: str, rows_by_role: dict[str, pd.DataFrame], name: str) -> str:
    """Append the unit of an axis to its label, if the table is in SI units.

    name : the column or quantity on the axis
    """
    if "unit" not in rows_by_role:
        return label
    units = rows_by_role["unit"].set_index("series")["unit"]
    return f"{label} ({units[name]})"
