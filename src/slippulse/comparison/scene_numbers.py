"""Measured numbers of one run beside exact theory, where there is any."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

from ..model.scene import prestress_from
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_law import front_speed
from ..theory.pulse import SteadyPulse, steady_pulse


def far_pulse(attributes: Mapping, side: str = "right") -> SteadyPulse | None:
    """The steady pulse that theory has for one side of a run; None where it has none."""
    if attributes["boundary"] != "displacement":
        return None
    tau = float(prestress_from(attributes).level(np.asarray(1e300 if side == "right" else -1e300)))
    if not 0.0 < tau < 1.0:
        return None
    speed = float(front_speed(tau, attributes["damping_ratio"], attributes["release"]))
    return steady_pulse(tau, attributes["gamma"], attributes["beta"], speed)


def scene_numbers(
    attributes: Mapping, study: pd.DataFrame, share: float, pulse_state: str = "steady"
) -> pd.DataFrame:
    """Measured numbers of a scene with their uncertainty, beside exact theory where there is any.

    Parameters
    ----------
    attributes : of the run's data
    study : grid study of the scene: quantity, value, uncertainty
    share : share of |x_minus| that the left front covers at T_trans under a stress boundary
    pulse_state : of the leading pulse (`pulse_state`); the theory of steady pulses applies to a steady one alone

    Returns
    -------
    one row a number: quantity, label, value, uncertainty, theory (NaN where there is none), and where an accuracy is
    promised: promised and kept, as in the study
    """
    study = study.set_index("quantity")
    theory = theories(attributes, share)
    if pulse_state != "steady":
        theory = {name: value for name, value in theory.items() if not name.startswith("pulse")}
    profile = prestress_from(attributes)
    rows = []
    for quantity, label in LABELS[attributes["boundary"]].items():
        if quantity not in study.index or not math.isfinite(study.loc[quantity, "value"]):
            continue
        # The balance of the pre-stress is computed for the Gaussian and its levels alone.
        if profile.bumps and attributes["boundary"] == "stress" and quantity.startswith("transition"):
            continue
        number = study.loc[quantity]
        rows.append(
            {
                "quantity": quantity,
                "label": label,
                "value": number["value"],
                "uncertainty": number["uncertainty"],
                "theory": theory.get(quantity, math.nan),
            }
            | {name: number[name] for name in PROMISE if name in study}
        )
    if any(row["quantity"] == "transition_time" for row in rows):
        rows = [row for row in rows if row["quantity"] != "first_stick_time"]
    columns = ["quantity", "label", "value", "uncertainty", "theory"]
    return pd.DataFrame(rows, columns=columns + [name for name in PROMISE if name in study])


# Columns of a grid study that judges a promise.
PROMISE = ("promised", "kept")
LABELS = {
    "displacement": {
        "front_speed_left": "front speed, left",
        "front_speed_right": "front speed, right",
        "transition_time": "T_trans",
        "transition_length": "L_trans",
        "first_stick_time": "first stick",
        "pulse_width": "pulse width, right",
        "pulse_peak_velocity": "peak velocity, right",
        "pulse_slip": "final slip, right",
    },
    "stress": {
        "front_speed_left": "front speed, left",
        "front_speed_right": "front speed, right",
        "transition_time": "T_trans",
        "transition_length": "L_trans",
        "balance_distance": "|x_minus|",
        "largest_velocity": "largest velocity",
    },
}


def theories(attributes: Mapping, share: float) -> dict[str, float]:
    """What exact theory has for a run, by quantity; NaN where it has an answer in principle but not here.

    Parameters
    ----------
    attributes : of the run's data, or a row of a measured table
    share : share of |x_minus| that the left front covers at T_trans under a stress boundary
    """
    return {name: _or_nan(find) for name, find in _theories(attributes, share).items()}


def _theories(attributes: Mapping, share: float) -> dict[str, Callable[[], float]]:
    """How to compute what theory says of each quantity; a ValueError where it says nothing."""
    profile = prestress_from(attributes)
    ratio, release = attributes["damping_ratio"], attributes["release"]
    far = {
        "left": float(profile.level(np.asarray(-1e300))),
        "right": float(profile.level(np.asarray(1e300))),
    }
    out = {
        f"front_speed_{side}": lambda level=level: float(front_speed(level, ratio, release))
        for side, level in far.items()
    }
    plain = not profile.steps and not profile.bumps
    if attributes["boundary"] == "displacement":
        if pulse := _or_none(lambda: far_pulse(attributes)):
            out |= {
                "pulse_width": lambda: pulse.width,
                "pulse_peak_velocity": lambda: pulse.peak_velocity,
                "pulse_slip": lambda: pulse.slip,
            }
        if plain:
            exact = _or_none(
                lambda: exact_transition_displacement(profile, attributes["gamma"], ratio, release)
            )
            if exact:
                out |= {
                    "transition_time": lambda: exact.time,
                    "first_stick_time": lambda: exact.time,
                    "transition_length": lambda: exact.length,
                }
    elif plain and (crack := _or_none(lambda: ArrestingCrack(profile, ratio, release))):
        out |= {
            "transition_time": lambda: crack.share_time(share),
            "transition_length": lambda: crack.share_length(share),
            "balance_distance": lambda: -crack.balance_position,
            "largest_velocity": lambda: crack.peak_velocity,
        }
    return out


def _or_none(find: Callable):
    try:
        return find()
    except (ValueError, ArithmeticError):
        return None


def _or_nan(find: Callable[[], float]) -> float:
    value = _or_none(find)
    return math.nan if value is None else float(value)
