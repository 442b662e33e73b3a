"""Tables of a run converted to SI units with readable prefixes, before they are drawn."""

import math

import numpy as np
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


def numbers_in_si(numbers: pd.DataFrame, run: pd.Series, layer: Layer) -> pd.DataFrame:
    """Convert main numbers (`shared.numbers`), each with a prefix of its own in a column unit.

    The column paper has the number by the paper's formula as printed, from the row ``run`` of
    measured and predicted numbers: its peak slip velocity in SI units is half of its own formula
    without dimension (section IV A).
    """
    paper = [run.get(f"paper_{quantity}", math.nan) for quantity in numbers["quantity"]]
    converted = numbers.assign(unit="", paper=np.array(paper, dtype=float))
    converted.loc[converted["quantity"] == "pulse_peak_velocity", "paper"] *= 0.5
    for index, row in converted.iterrows():
        quantity = QUANTITIES[str(row["quantity"])]
        unit = readable_unit(quantity, layer.convert_to_si(row["value"], quantity))
        for column in ("value", "uncertainty", "theory", "paper"):
            number = layer.convert_to_si(row[column], quantity)
            converted.loc[index, column] = number / unit.value
        converted.loc[index, "unit"] = unit.text
    return converted


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
    for quantity, rows in table.groupby(quantities):
        drawn, parameters = (rows["role"].isin(roles) for roles in (ON_AXES, ("parameter",)))
        for chosen in (rows[drawn], *(rows.loc[[index]] for index in rows.index[parameters])):
            if chosen.empty:
                continue
            numbers = layer.convert_to_si(chosen["value"], str(quantity))
            unit = readable_unit(str(quantity), numbers)
            table.loc[chosen.index, "value"] = numbers / unit.value
            table.loc[chosen.index, "unit"] = unit.text
        if drawn.any():
            units[str(quantity)] = table.loc[rows.index[drawn], "unit"].iloc[0]
    unit = readable_unit("length", layer.thickness)
    height = {"series": "thickness", "value": layer.thickness / unit.value, "unit": unit.text}
    added = [{"role": "parameter", **height}]
    added += [{"role": "unit", "series": name, "unit": text} for name, text in units.items()]
    return pd.concat([table, pd.DataFrame(added)], ignore_index=True)


def with_unit(label: str, roles: dict[str, pd.DataFrame], name: str) -> str:
    """Add to the label of an axis the unit of a column or quantity, if the table is in SI units."""
    if "unit" not in roles:
        return label
    units = roles["unit"].set_index("series")["unit"]
    return f"{label} ({units[name]})"
