"""results/explorer.html: the exact rupture, its formulas and nearby simulations, recomputed as sliders move.

The page computes by itself, in the scripts beside its template; from here it has a table of the front law, which needs
the Wiener-Hopf factor, and the measured numbers of the sweeps.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable

import matplotlib
import numpy as np
import pandas as pd
from markupsafe import Markup

from ..figures.style import VELOCITY_MAP
from ..model.prestress import Prestress
from ..model.scene import RELEASES, prestress_from
from ..theory.front_law import prestress_for_speed
from .html import page

# Grid of the front law: ln(v - 1), and asinh(b/SCALE), which is b where it is small and logarithmic beyond.
EXCESS = np.linspace(-8.0, 12.0, 61)
SCALE, LARGEST_RATIO, RATIOS = 0.005, 5.0, 33
# What is shown of a run, beside its settings; absent where it was not measured.
MEASURED = ("front_speed_right", "transition_time", "transition_length", "pulse_slip")
DIGITS = 5
COLOURS = 32


def explorer_page(measured: Iterable[pd.DataFrame]) -> str:
    """The page, one file that loads nothing.

    Parameters
    ----------
    measured : measured tables of sweeps; runs without equal positive levels and a plain peak are left out
    """
    shades = matplotlib.colormaps[VELOCITY_MAP](np.linspace(0.0, 1.0, COLOURS))
    data = {
        "law": front_law_table(),
        "largest_ratio": LARGEST_RATIO,
        "runs": [run for table in measured for run in simulated_runs(table)],
        "colours": [[round(255 * part) for part in shade[:3]] for shade in shades.tolist()],
    }
    # No text in it can end the script that it stands in.
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    return page("explorer.html", data=Markup(text), largest_ratio=LARGEST_RATIO)


def front_law_table() -> dict:
    """ln(tau/(1 - tau)) by release rule, damping ratio (rows) and ln(v - 1) (columns), with the grid.

    Speeds found in it by cubics are exact to 1e-4.
    """
    places = np.linspace(0.0, np.arcsinh(LARGEST_RATIO / SCALE), RATIOS)
    ratios, speeds = SCALE * np.sinh(places), 1.0 + np.exp(EXCESS)
    table: dict = {
        "ratio": {"scale": SCALE, "step": places[1]},
        "excess": {"first": EXCESS[0], "step": EXCESS[1] - EXCESS[0]},
    }
    for release in RELEASES:
        tau = prestress_for_speed(speeds[None, :], ratios[:, None], release)
        table[release] = np.round(np.log(tau) - np.log1p(-tau), 6).tolist()
    return table


def simulated_runs(table: pd.DataFrame) -> list[list]:
    """Rows of tau_0, gamma, W, beta, b, release rule and `MEASURED` of the runs that the page can compare with."""
    kept = []
    for run in table[table["boundary"] == "displacement"].to_dict("records"):
        prestress = prestress_from(run)
        plain = Prestress(prestress.left, prestress.left, prestress.width)
        if prestress != plain or not prestress.left > 0.0 or run["damping_ratio"] > LARGEST_RATIO:
            continue
        if run.get("pulse_state", "steady") != "steady":
            run["pulse_slip"] = math.nan
        settings = [run[name] for name in ("left", "gamma", "width", "beta", "damping_ratio", "release")]
        kept.append(settings + [_short(run.get(name, math.nan)) for name in MEASURED])
    return kept


def _short(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
