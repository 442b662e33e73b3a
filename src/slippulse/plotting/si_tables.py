"""Tables of a run converted to SI units with readable prefixes, before they are drawn."""

import pandas as pd

from ..data.readable_units import readable_unit
from ..model.layer_units import Layer
from ..model.si_quantities import QUANTITIES

# Quantity of the column value by role; of the other roles the column series names it.
ROLE_QUANTITIES = {"prestress": "stress", "map": "slip_velocity", "largest": "slip_velocity"}
ROLE_QUANTITIES["strength"] = "stress"
# Non-dimensional stresses that are marked (role strength).
STRENGTHS = {"kinetic friction": 0.0, "static friction": 1.0}
# Roles whose values share one unit by quantity, so that they can share an axis.
ON_AXES = ("prestress", "strength", "map", "largest", "profile", "steady")
COLUMN_QUANTITIES = {"position": "length", "time": "time"}


def table_in_si(table: pd.DataFrame, layer: Layer) -> pd.DataFrame:
    """Convert the rows of a run, and add rows with the units of its axes (role unit).

    The column unit has the unit of the column value. Rows of numbers stay as they are. Static and
    kinetic friction are added as well (role strength).
    """
    strengths = [
        {"role": "strength", "series": name, "value": value} for name, value in STRENGTHS.items()
    ]
    table = pd.concat([table, pd.DataFrame(strengths)], ignore_index=True)
    table = table if "unit" in table else table.assign(unit="")
    units = {}
    for column, quantity in COLUMN_QUANTITIES.items():
        numbers = layer.convert_to_si(table[column], quantity)
        unit = readable_unit(quantity, numbers)
        table[column], units[column] = numbers / unit.value, unit.text
    quantities = table["role"].map(ROLE_QUANTITIES).fillna(table["series"].map(QUANTITIES))
    on_axes = table["role"].isin(ON_AXES)
    for quantity, rows in table[on_axes].groupby(quantities[on_axes]):
        units[str(quantity)] = _convert_values(table, rows.index, str(quantity), layer)
    for index in table.index[(table["role"] == "parameter") & quantities.notna()]:
        # Each parameter has a prefix of its own.
        _convert_values(table, pd.Index([index]), quantities[index], layer)
    unit = readable_unit("length", layer.thickness)
    height = {"series": "thickness", "value": layer.thickness / unit.value, "unit": unit.text}
    added = [{"role": "parameter", **height}]
    added += [{"role": "unit", "series": name, "unit": text} for name, text in units.items()]
    return pd.concat([table, pd.DataFrame(added)], ignore_index=True)


def _convert_values(table: pd.DataFrame, rows: pd.Index, quantity: str, layer: Layer) -> str:
    """Convert the values of some rows of a table in place, and return their unit."""
    numbers = layer.convert_to_si(table.loc[rows, "value"], quantity)
    unit = readable_unit(quantity, numbers)
    table.loc[rows, "value"] = numbers / unit.value
    table.loc[rows, "unit"] = unit.text
    return unit.text


def with_unit(label: str, roles: dict[str, pd.DataFrame], name: str) -> str:
    """Add to the label of an axis the unit of a column or quantity, if the table is in SI units."""
    if "unit" not in roles:
        return label
    units = roles["unit"].set_index("series")["unit"]
    return f"{label} ({units[name]})"
