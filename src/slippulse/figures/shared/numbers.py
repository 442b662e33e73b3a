"""The main numbers of a run: what they are called, as measured, and exact theory."""

import numpy as np
import pandas as pd

from ...model.prestress import prestress_from

EITHER = {
    "front_speed_left": "front speed, left", "front_speed_right": "front speed, right", "transition_time": "T_trans",
    "transition_length": "L_trans",
}  # fmt: skip
LABELS = {
    "displacement": EITHER | {
        "first_stick_time": "first stick", "pulse_width": "pulse width, right",
        "pulse_peak_velocity": "peak velocity, right", "pulse_slip": "final slip, right",
    },
    "stress": EITHER | {"balance_distance": "|x_minus|", "largest_velocity": "largest velocity"},
}  # fmt: skip


def with_symbols(label: str) -> str:
    """A label of LABELS with its symbol as a formula."""
    symbols = {"|x_minus|": "|x_-|", "T_trans": r"T_\text{trans}", "L_trans": r"L_\text{trans}"}
    return f"${symbols[label]}$" if label in symbols else label


def main_numbers(run: pd.Series) -> pd.DataFrame:
    """The main numbers that a run, a row of measured and predicted ones, has: quantity, label, value, theory or NaN."""
    found = pd.Series(LABELS[run["boundary"]], name="label").rename_axis("quantity").reset_index()
    found["value"] = [run.get(name, np.nan) for name in found["quantity"]]
    found["theory"] = [run.get(f"exact_{name}", np.nan) for name in found["quantity"]]
    return found[np.isfinite(found["value"].astype(float))]


def scene_numbers(run: pd.Series, study: pd.DataFrame) -> pd.DataFrame:
    """`main_numbers` of a scene with their uncertainty by its grid study, and promised and kept where that has them."""
    found = main_numbers(run)
    quantity = found["quantity"]
    # The theory of steady pulses applies to a steady one alone.
    if run.get("pulse_state") != "steady":
        found.loc[quantity.str.startswith("pulse"), "theory"] = np.nan
    # The balance of the pre-stress is computed for the Gaussian and its levels alone.
    if prestress_from(run).bumps and run["boundary"] == "stress":
        found = found[~quantity.str.startswith("transition")]
    if (quantity == "transition_time").any():
        found = found[quantity != "first_stick_time"]
    promise = [name for name in ("promised", "kept") if name in study]
    found = found.merge(study[["quantity", "uncertainty", *promise]], on="quantity")
    return found[["quantity", "label", "value", "uncertainty", "theory", *promise]]
