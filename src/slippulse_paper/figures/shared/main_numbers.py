"""Select the main numbers of a run: their labels, measured values and exact theory."""

import json
import math

import numpy as np
import pandas as pd

from slippulse.data.readable_units import readable_unit
from slippulse.model.layer_units import Layer
from slippulse.model.si_quantities import QUANTITIES

# Labels of measured columns: those under both boundary conditions, those of pulses with the
# displacement held, and all those under each boundary condition.
COMMON_LABELS = {
    "front_speed_left": "front speed, left",
    "front_speed_right": "front speed, right",
    "transition_time": "T_trans",
    "transition_length": "L_trans",
}
PULSE_LABELS = {
    "first_stick_time": "first stick",
    "pulse_width": "pulse width, right",
    "pulse_peak_velocity": "peak velocity, right",
    "pulse_slip": "final slip, right",
}
LABELS = {
    "displacement": COMMON_LABELS | PULSE_LABELS,
    "stress": COMMON_LABELS
    | {"balance_distance": "|x_minus|", "largest_velocity": "largest velocity"},
}
# Beginnings of the names of predictions by steady theory: for the front and the pulse of each side.
PREDICTION_PREFIXES = {
    "left": ("exact_front_speed_left", "exact_left_pulse"),
    "right": ("exact_front_speed_right", "exact_pulse"),
}


def with_symbols(label: str) -> str:
    """Return a label of LABELS, written as a formula if it is a symbol."""
    symbols = {"|x_minus|": "|x_-|", "T_trans": r"T_\text{trans}", "L_trans": r"L_\text{trans}"}
    return f"${symbols[label]}$" if label in symbols else label


def main_numbers(run: pd.Series) -> pd.DataFrame:
    """Return the main measured numbers of a run, one in each row.

    The columns are:

    quantity : name of the measured column
    label : its label, from LABELS
    value : its measured value
    theory : its value by exact theory; NaN if there is none, or if it does not apply to the run

    The argument ``run`` has the measured and predicted numbers of the run.
    """
    run = without_invalid_predictions(run)
    rows = []
    for quantity, label in LABELS[run["boundary"]].items():
        value, theory = run.get(quantity, np.nan), run.get(f"exact_{quantity}", np.nan)
        rows.append({"quantity": quantity, "label": label, "value": value, "theory": theory})
    numbers = pd.DataFrame(rows)
    # A quantity that was not measured is left out.
    return numbers[np.isfinite(numbers["value"].astype(float))]


def without_invalid_predictions(run: pd.Series) -> pd.Series:
    """Return the numbers of a run, with NaN for predictions of steady theory that do not apply.

    Steady theory assumes that a front runs in a constant pre-stress. If the pre-stress is given as
    a table, it may still vary where the front ends.
    """
    run = run.copy()
    for side, prefixes in PREDICTION_PREFIXES.items():
        # Only runs with a table of pre-stress have this number. It is NaN if the pre-stress varies
        # ahead of the front.
        column = f"level_ahead_{side}"
        if column in run and np.isnan(run[column]):
            is_prediction = run.index.astype(str).str.startswith(prefixes)
            run[is_prediction] = np.nan
    return run


def scene_numbers(run: pd.Series, study: pd.DataFrame) -> pd.DataFrame:
    """Return `main_numbers` of a scene, with the uncertainty of each number.

    Theory that does not apply to the scene is NaN. A transition that is not defined and a time that
    would be repeated are left out. If the scene has a promised accuracy, the result also has the
    columns promised and kept of `slippulse.measurement.promise`.

    run : measured and predicted numbers
    study : the grid study of the scene, with one row for each quantity
    """
    numbers = main_numbers(run)
    quantity = numbers["quantity"]
    # Steady theory gives the numbers of a steady pulse, and the speed of a front that still runs.
    if run.get("pulse_state") != "steady":
        numbers.loc[quantity.str.startswith("pulse"), "theory"] = np.nan
    if run.get("pulse_state") == "stopped":
        numbers.loc[quantity == "front_speed_right", "theory"] = np.nan
    left_out = []
    # Under a stress boundary, the balance position defines the transition. It is computed without
    # the bumps of the pre-stress, so the transition of a scene with bumps is left out.
    has_bumps = bool(json.loads(run["steps_and_bumps"])["bumps"])
    if has_bumps and run["boundary"] == "stress":
        left_out += ["transition_time", "transition_length"]
    # Only if the displacement is held, the first stick is a main number. The transition is then at
    # the first stick, so both times are equal.
    if (quantity == "transition_time").any():
        left_out.append("first_stick_time")
    numbers = numbers[~quantity.isin(left_out)]
    promise_columns = [name for name in ("promised", "kept") if name in study]
    numbers = numbers.merge(study[["quantity", "uncertainty", *promise_columns]], on="quantity")
    return numbers[["quantity", "label", "value", "uncertainty", "theory", *promise_columns]]


def numbers_in_si(numbers: pd.DataFrame, run: pd.Series, layer: Layer) -> pd.DataFrame:
    """Return the numbers of a scene in SI units, with two more columns.

    unit : the unit of the number, with a suitable prefix such as "mm"
    paper : the number by the formula that the paper prints with dimensions; NaN if there is none

    Parameters
    ----------
    numbers : table from `scene_numbers`
    run : measured and predicted numbers, without dimensions
    """
    paper = [run.get(f"paper_{quantity}", math.nan) for quantity in numbers["quantity"]]
    converted = numbers.assign(unit="", paper=np.array(paper, dtype=float))
    # The paper's formulas without and with dimensions agree, except for the peak slip velocity. For
    # this one, the formula with dimensions (section IV A) gives half of the other one.
    converted.loc[converted["quantity"] == "pulse_peak_velocity", "paper"] *= 0.5
    for index, row in converted.iterrows():
        # The physical quantity, such as a length, decides the SI unit.
        quantity = QUANTITIES[str(row["quantity"])]
        unit = readable_unit(quantity, layer.convert_to_si(row["value"], quantity))
        for column in ("value", "uncertainty", "theory", "paper"):
            number = layer.convert_to_si(row[column], quantity)
            converted.loc[index, column] = number / unit.value
        converted.loc[index, "unit"] = unit.text
    return converted
