"""The main numbers of a run: their labels, the measured values and exact theory."""

import json
import math

import numpy as np
import pandas as pd

from slippulse.data.readable_units import readable_unit
from slippulse.model.layer_units import Layer
from slippulse.model.si_quantities import QUANTITIES

# Labels of the measured columns that both boundary conditions have, and of all by boundary.
COMMON = {
    "front_speed_left": "front speed, left",
    "front_speed_right": "front speed, right",
    "transition_time": "T_trans",
    "transition_length": "L_trans",
}
PULSE = {
    "first_stick_time": "first stick",
    "pulse_width": "pulse width, right",
    "pulse_peak_velocity": "peak velocity, right",
    "pulse_slip": "final slip, right",
}
LABELS = {
    "displacement": COMMON | PULSE,
    "stress": COMMON | {"balance_distance": "|x_minus|", "largest_velocity": "largest velocity"},
}


# Beginnings of the names of predictions for the front, and for the pulse, of each side.
PREDICTED = {
    "left": ("exact_front_speed_left", "exact_left_pulse"),
    "right": ("exact_front_speed_right", "exact_pulse"),
}


def with_symbols(label: str) -> str:
    """Return a label of LABELS, as a formula where it is a symbol."""
    symbols = {"|x_minus|": "|x_-|", "T_trans": r"T_\text{trans}", "L_trans": r"L_\text{trans}"}
    return f"${symbols[label]}$" if label in symbols else label


def main_numbers(run: pd.Series) -> pd.DataFrame:
    """Main measured numbers of a run: quantity, label, value, theory (NaN where there is none)."""
    run = at_constant_levels(run)
    numbers = pd.Series(LABELS[run["boundary"]], name="label").rename_axis("quantity").reset_index()
    numbers["value"] = [run.get(name, np.nan) for name in numbers["quantity"]]
    numbers["theory"] = [run.get(f"exact_{name}", np.nan) for name in numbers["quantity"]]
    return numbers[np.isfinite(numbers["value"].astype(float))]


def at_constant_levels(run: pd.Series) -> pd.Series:
    """A measured and predicted row without the theory of steady fronts and pulses in a table.

    Theory is that of the levels at the ends of a table, which a front may not have reached.
    """
    run = run.copy()
    for side, prefixes in PREDICTED.items():
        if f"level_ahead_{side}" in run and not np.isfinite(run[f"level_ahead_{side}"]):
            names = [name for name in map(str, run.index) if name.startswith(prefixes)]
            run[names] = np.nan
    return run


def scene_numbers(run: pd.Series, study: pd.DataFrame) -> pd.DataFrame:
    """`main_numbers` of a scene, with what its grid study has: uncertainty, promised and kept."""
    numbers = main_numbers(run)
    quantity = numbers["quantity"]
    # The theory of steady pulses applies to a steady pulse alone.
    if run.get("pulse_state") != "steady":
        numbers.loc[quantity.str.startswith("pulse"), "theory"] = np.nan
    if run.get("pulse_state") == "stopped":
        numbers.loc[quantity == "front_speed_right", "theory"] = np.nan
    # The balance of the pre-stress is computed for the Gaussian and its levels alone.
    if json.loads(run["steps_and_bumps"])["bumps"] and run["boundary"] == "stress":
        numbers = numbers[~quantity.str.startswith("transition")]
    if (quantity == "transition_time").any():
        numbers = numbers[quantity != "first_stick_time"]
    promise = [name for name in ("promised", "kept") if name in study]
    numbers = numbers.merge(study[["quantity", "uncertainty", *promise]], on="quantity")
    return numbers[["quantity", "label", "value", "uncertainty", "theory", *promise]]


def numbers_in_si(numbers: pd.DataFrame, run: pd.Series, layer: Layer) -> pd.DataFrame:
    """Convert the numbers of a scene, each with a prefix of its own in a column unit.

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
