"""Tables of how exact the numbers are, from the grid studies, and of simulation beside theory."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pandas as pd

from ..data.numerals import number, percent, setting, with_uncertainty
from ..studies.outcomes import FLAGGED
from ..theory.front_law import front_speed, front_speed_undamped
from ..theory.pulse import steady_pulse
from ..theory.rupture import Rupture
from .markdown import plain, table

# What the grid table shows: simulation, column, name.
QUANTITIES = (
    ("steady_displacement", "front_speed_right", "front speed"),
    ("steady_displacement", "pulse_slip", "final slip"),
    ("steady_displacement", "pulse_peak_velocity", "peak slip velocity"),
    ("steady_displacement", "pulse_width", "pulse width"),
    ("scaling_displacement", "transition_time", r"$T_\mathrm{trans}$, displacement boundary"),
    ("scaling_displacement", "transition_length", r"$L_\mathrm{trans}$, displacement boundary"),
    ("scaling_stress", "transition_time", r"$T_\mathrm{trans}$, stress boundary"),
    ("scaling_stress", "transition_length", r"$L_\mathrm{trans}$, stress boundary"),
    ("scaling_stress", "last_release_time", "last release, stress boundary"),
)


def attempt(function: Callable, *arguments: object):
    """``function(*arguments)``, or None where the theory says that it has no answer, or an argument has none."""
    if any(argument is None for argument in arguments):
        return None
    try:
        return function(*arguments)
    except (ValueError, ArithmeticError):
        return None


def grid_studies(study: Callable[[str], pd.DataFrame]) -> str:
    """Observed order and relative numerical uncertainty of the main quantities.

    Parameters
    ----------
    study : from the name of a simulation to its grid study
    """
    rows = []
    for simulation, quantity, name in QUANTITIES:
        found = study(simulation)
        found = found[found["quantity"] == quantity]
        relative = (found["uncertainty"] / found["value"].abs()).dropna()
        if relative.empty:
            rows.append([name, str(len(found)), *["—"] * 3])
            continue
        orders = found["observed_order"].dropna()
        order = number(float(orders.median()), 2) if len(orders) else "—"
        rows.append(
            [
                name,
                str(len(relative)),
                order,
                percent(float(relative.median())),
                percent(float(relative.max())),
            ]
        )
    head = ["quantity", "runs", "order", "median uncertainty", "largest"]
    return table(head, rows, [40, 10, 12, 20, 18], "lrrrr")


def presets(settings: Mapping[str, Mapping], chosen: str) -> str:
    """The presets of the configuration; the one of this run is in bold."""
    rows = []
    for name, preset in settings.items():
        shown = f"**{name}**" if name == chosen else name
        factors = " and ".join(setting(factor) for factor in preset["coarser"])
        rows.append(
            [shown, setting(preset["dx"]), setting(preset["max_step"]), str(preset["order"]), factors]
        )
    head = [
        "preset",
        r"spacing $\Delta x$",
        r"largest step over $\Delta x$",
        "order",
        "grid study, times coarser",
    ]
    return table(head, rows, [18, 18, 24, 12, 28], "lrrrr")


def sticking(rupture: Rupture | None, positions: Sequence[float]) -> str:
    """When positions of an exact rupture are released and stick, and how far they slip; empty without a rupture."""
    if rupture is None:
        return ""
    x = np.array(positions, dtype=float)
    # Nothing is known to more than this many places, the release at a nucleation point among them.
    columns = x, *np.round([rupture.release_time(x), rupture.stick_time(x), rupture.final_slip(x)], 8)
    rows = [
        [setting(place), *(number(value, 5) for value in values)]
        for place, *values in zip(*columns, strict=True)
    ]
    head = ["$x$", r"release $T$", r"stick $t_\mathrm{s}$", r"slip $u(x,t_\mathrm{s})$"]
    return table(head, rows, [10, 15, 15, 15], "rrrr")


def speeds(measured: pd.DataFrame, study: pd.DataFrame) -> str:
    """Front speed and peak slip velocity of steady pulses: simulated, exact, and by the paper's formulas.

    Parameters
    ----------
    measured : measured numbers of one simulation, one row a run
    study : its grid study, for their uncertainties
    """
    errors = study.set_index(["point", "quantity"])["uncertainty"]

    def with_error(row, quantity: str) -> str:
        return with_uncertainty(getattr(row, quantity), errors.get((row.Index, quantity)))

    rows = []
    for row in measured.itertuples():
        speed = attempt(front_speed, row.left, row.damping_ratio, row.release)
        pulse = attempt(steady_pulse, row.left, row.gamma, row.beta, speed)
        undamped = attempt(front_speed_undamped, row.left)
        rows.append(
            [
                setting(row.left),
                setting(row.damping_ratio),
                with_error(row, "front_speed_right"),
                number(speed, 5),
                number(undamped, 5),
                with_error(row, "pulse_peak_velocity"),
                number(pulse and pulse.peak_velocity, 5),
                number(row.gamma**-0.5, 5),
            ]
        )
    head = [
        r"$\tau_0$",
        "$b$",
        "$v$, run",
        "$v$, exact",
        r"$1/\sqrt{1-\tau_0^2}$",
        "peak, run",
        "peak, exact",
        r"$1/\sqrt{\gamma}$",
    ]
    return table(head, rows, [9, 9, 13, 13, 16, 13, 14, 13], "rrrrrrrr")


def edges(study: pd.DataFrame) -> str:
    """The edges of the solver's domain: what was compared, its error and tolerance, and how it ended."""
    rows = []
    for _, row in study.iterrows():
        flag = str(row["message"]).partition(",")[0].replace("_", " ") if row["verdict"] == FLAGGED else ""
        outcome = f"{row['verdict']}: {flag}" if flag else row["verdict"]
        error, tolerance = (
            "" if pd.isna(row[name]) else number(row[name], 2) for name in ("error", "tolerance")
        )
        rows.append([row["family"], plain(row["value"]), plain(row["quantity"]), error, tolerance, outcome])
    head = ["edge", "value", "compared", "error", "tolerance", "outcome"]
    return table(head, rows, [16, 28, 18, 12, 12, 24], "lllrrl")
