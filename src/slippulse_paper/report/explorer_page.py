"""Write results/explorer.html, a page with sliders that computes a rupture in the browser.

The page contains a table of front speeds, and measured runs for comparison with the exact solution.
Its scripts compute everything else.
"""

import json
import math
from collections.abc import Iterable, Mapping
from itertools import chain

import matplotlib
import numpy as np
import pandas as pd
from markupsafe import Markup

from slippulse.model.prestress import Prestress, prestress_from
from slippulse.model.recorded_law import read_recorded_law

from .html import page

SETTING_COLUMNS = ("left", "gamma", "width", "beta", "damping_ratio", "release")
# Measured numbers of a run that the page shows if they are finite.
MEASURED_COLUMNS = ("front_speed_right", "transition_time", "transition_length", "pulse_slip")
# Significant digits of measured numbers, and shades of the colour map.
MEASURED_DIGITS = 5
SHADE_COUNT = 32


def explorer_page(law: pd.DataFrame, measured: Iterable[pd.DataFrame], colours: str) -> str:
    """Return the page as HTML.

    law : the table of the study explorer_law
    measured : tables of measured runs
    colours : the name of a colour map
    """
    shades = matplotlib.colormaps[colours](np.linspace(0.0, 1.0, SHADE_COUNT))
    # Opacity is the fourth component of a colour.
    red_green_blue = shades[:, :3]
    largest_ratio = float(law["damping_ratio"].max())
    runs = chain.from_iterable(simulated_runs(table, largest_ratio) for table in measured)
    data = {
        "law": front_law(law),
        "largest_ratio": largest_ratio,
        "runs": [*runs],
        "colours": np.rint(255.0 * red_green_blue).astype(int).tolist(),
    }
    # The data are written into a script element. A "<" in them could end it.
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    return page("explorer.html", data=Markup(text), largest_ratio=largest_ratio)


def front_law(law: pd.DataFrame) -> dict:
    """Return the front law as grids from which the page interpolates.

    The front law relates the pre-stress tau, the damping ratio b and the front speed v. The result
    has one grid of ln(tau/(1 - tau)) for each release rule. Row i of a grid belongs to the damping
    ratio b = scale sinh(i step), and column j to the speed ln(v - 1) = first + j step. The entry
    "ratio" has the constants of the rows (scale and step), and "excess" those of the columns.

    law : the table of the study explorer_law
    """
    # The browser does not compute this law itself, because that needs the Wiener-Hopf method.
    # The study has evenly spaced values of arsinh(b/scale), from 0 on, which become the rows, and
    # of ln(v - 1), which become the columns.
    row_values, column_values = law["ratio_arsinh"].unique(), law["excess_log"].unique()
    last_row = float(row_values[-1])
    first_column, last_column = float(column_values[0]), float(column_values[-1])
    # The table has nine digits, and the scale is rounded to remove their error.
    scale = float(law["damping_ratio"].max() / np.sinh(last_row))
    grids: dict = {
        "ratio": {"scale": round(scale, 6), "step": last_row / (len(row_values) - 1)},
        "excess": {
            "first": first_column,
            "step": (last_column - first_column) / (len(column_values) - 1),
        },
    }
    for release, rows in law.groupby("release", sort=False):
        grid = rows.pivot(index="damping_ratio", columns="excess_log", values="logit")
        grids[release] = grid.values.tolist()
    return grids


def simulated_runs(table: pd.DataFrame, largest_ratio: float) -> list[list]:
    """Return the settings and measured numbers of the runs that the page can compute, too.

    The page can compute runs with the displacement held, Coulomb friction, and a Gaussian on equal
    positive levels. Each has one list, with the values of `SETTING_COLUMNS` and `MEASURED_COLUMNS`.

    largest_ratio : the largest damping ratio of the page
    """
    is_shown = (table["left"] > 0.0) & (table["damping_ratio"] <= largest_ratio)
    is_shown &= table["boundary"] == "displacement"
    rows = []
    for run in table[is_shown].to_dict("records"):
        if not _has_coulomb_and_equal_levels(run):
            continue
        # Only a steady pulse has a slip that the page can compare.
        if run.get("pulse_state", "steady") != "steady":
            run["pulse_slip"] = math.nan
        settings = [run[name] for name in SETTING_COLUMNS]
        measured = [_rounded(run.get(name, math.nan)) for name in MEASURED_COLUMNS]
        rows.append([*settings, *measured])
    return rows


def _has_coulomb_and_equal_levels(run: Mapping) -> bool:
    """Return True if a run has Coulomb friction and a Gaussian on equal levels.

    A run with a table of pre-stress (points) has no levels.
    """
    if json.loads(run["steps_and_bumps"]).get("points"):
        return False
    plain = Prestress(run["left"], run["left"], run["width"])
    return prestress_from(run) == plain and read_recorded_law(run)["law"] == "coulomb"


def _rounded(number: float) -> float | None:
    """Return a number with `MEASURED_DIGITS` significant digits, or None if it is not finite."""
    return float(f"{number:.{MEASURED_DIGITS}g}") if math.isfinite(number) else None
