"""Write results/explorer.html, a page with sliders that computes a rupture in the browser.

The page gets a table of the front law and the measured runs that it can show beside the exact
solution. Its scripts compute everything else.
"""

import json
import math
from collections.abc import Iterable
from itertools import chain

import matplotlib
import numpy as np
import pandas as pd
from markupsafe import Markup

from slippulse.model.prestress import Prestress, prestress_from
from slippulse.model.recorded_law import read_recorded_law

from .html import page

# Measured numbers of a run that the page shows if they are finite.
MEASURED_COLUMNS = ("front_speed_right", "transition_time", "transition_length", "pulse_slip")
# Significant digits of measured numbers, and shades of the colour map.
MEASURED_DIGITS = 5
SHADE_COUNT = 32


def explorer_page(law: pd.DataFrame, measured: Iterable[pd.DataFrame], colours: str) -> str:
    """Return the page as HTML.

    law : the table of `studies.explorer_law`
    measured : tables of measured runs
    colours : the name of a colour map
    """
    shades = matplotlib.colormaps[colours](np.linspace(0.0, 1.0, SHADE_COUNT))
    largest = float(law["damping_ratio"].max())
    runs = chain.from_iterable(simulated_runs(table, largest) for table in measured)
    data = {"law": front_law(law), "largest_ratio": largest, "runs": [*runs]}
    data["colours"] = np.rint(255.0 * shades[:, :3]).astype(int).tolist()
    # A "<" in the data could end the script element that contains them.
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    return page("explorer.html", data=Markup(text), largest_ratio=largest)


def front_law(law: pd.DataFrame) -> dict:
    """Return the logit of the pre-stress for each release rule, as rows of a grid.

    Rows belong to damping ratios and columns to ln(v - 1), both evenly spaced in the variables
    that the entries `ratio` and `excess` describe.
    """
    # The browser does not compute this law itself, since that takes the Wiener-Hopf factor.
    ratios, excesses = law["ratio_arsinh"].unique(), law["excess_log"].unique()
    first, last = float(excesses[0]), float(excesses[-1])
    scale = round(float(law["damping_ratio"].max() / np.sinh(ratios[-1])), 6)
    out: dict = {"ratio": {"scale": scale, "step": float(ratios[-1]) / (len(ratios) - 1)}}
    out["excess"] = {"first": first, "step": (last - first) / (len(excesses) - 1)}
    for release, rows in law.groupby("release", sort=False):
        grid = rows.pivot(index="damping_ratio", columns="excess_log", values="logit")
        out[release] = grid.values.tolist()
    return out


def simulated_runs(table: pd.DataFrame, largest_ratio: float) -> list[list]:
    """Return the settings and `MEASURED_COLUMNS` of each run that the page can compute.

    These are runs with the displacement held, Coulomb friction, and a Gaussian on equal positive
    levels. The settings are tau_0, gamma, W, beta, b and the release rule.
    """
    names = ("left", "gamma", "width", "beta", "damping_ratio", "release")
    kept = []
    shown = (table["left"] > 0.0) & (table["damping_ratio"] <= largest_ratio)
    for run in table[shown & (table["boundary"] == "displacement")].to_dict("records"):
        if json.loads(run["steps_and_bumps"]).get("points"):
            continue
        plain = Prestress(run["left"], run["left"], run["width"])
        if prestress_from(run) != plain or read_recorded_law(run)["law"] != "coulomb":
            continue
        if run.get("pulse_state", "steady") != "steady":
            run["pulse_slip"] = math.nan
        settings = [run[name] for name in names]
        for number in (run.get(name, math.nan) for name in MEASURED_COLUMNS):
            settings.append(
                float(f"{number:.{MEASURED_DIGITS}g}") if math.isfinite(number) else None
            )
        kept.append(settings)
    return kept
