"""Pulses on a rough pre-stress: deaths and barriers (Gamma = 1), and random walks (Gamma = 0).

An ensemble is a set of runs whose pre-stress is drawn from the same random field. It has one colour
and one marker, and is named by the four parameters of the field.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, GREY, MARKERS, OPEN_MARKER, PAGE_WIDTH, SMALL_TEXT, Look

NEEDS = {"studies": ["rough_prestress"]}

# Parameters of the random field of an ensemble, and their symbols as a title of the legend.
PARAMETERS = ["level", "deviation", "correlation_length", "hurst"]
LEGEND_TITLE = r"$\tau_0$, $\sigma$, $\ell$, Hurst"
COLOURS = (style.BLUE, style.GREEN, style.PURPLE, style.YELLOW, style.ORANGE, style.SKY, BLACK)
# A larger study has more ensembles than colours. Of the others, only death rates are drawn.
ENSEMBLE_MARKERS = (*MARKERS, "X")
# Survival is drawn only if more than this fraction of the pulses has died.
MIN_DRAWN_DEATHS = 0.1
# The guide of slope -1/2 begins at this fraction of the largest distance, above the curve by the
# second factor.
GUIDE_START, GUIDE_OFFSET = 0.2, 1.5


class Ensemble(NamedTuple):
    """One ensemble of the study: its look, its row of the part ensemble, and all its rows."""

    colour: str
    marker: str
    label: str
    row: pd.Series
    rows: pd.DataFrame

    def part(self, name: str) -> pd.DataFrame:
        """Return the rows of one part of the study."""
        return self.rows[self.rows["part"] == name]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the table of the study; the balance is NaN if it is not reached within the table."""
    return style.as_given(data, tables, settings).replace(np.inf, np.nan)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) survival and (b) death rate at Gamma = 1, (c) survival and (d) velocity at 0."""
    figure, panels = style.new_panels(PAGE_WIDTH, 5.6, "ab;cd")
    survival_axes, rate_axes, walk_axes, velocity_axes = panels
    at_gamma_1 = table[table["boundary"] == "displacement"]
    dying = at_gamma_1[(at_gamma_1["part"] == "ensemble") & (at_gamma_1["deaths"] > 0.0)]
    for ensemble in ensembles(at_gamma_1, dying):
        draw_survival(survival_axes, ensemble)
        draw_rate(rate_axes, ensemble)
    finish_survival(survival_axes, dying["stop"].max())
    finish_rates(rate_axes, dying)
    at_gamma_0 = table[table["boundary"] == "stress"]
    for ensemble in ensembles(at_gamma_0, at_gamma_0[at_gamma_0["part"] == "ensemble"]):
        if ensemble.row["deaths"] > MIN_DRAWN_DEATHS * ensemble.row["pulses"]:
            draw_survival(walk_axes, ensemble)
            curve = ensemble.part("survival")
            look: Look = {"color": ensemble.colour, "linewidth": 0.9}
            walk_axes.plot(curve["distance"], curve["predicted"], "--", **look)
        draw_velocities(velocity_axes, ensemble)
    finish_walks(walk_axes, at_gamma_0[at_gamma_0["part"] == "long_survival"])
    finish_velocities(velocity_axes)
    return figure


def ensembles(table: pd.DataFrame, rows: pd.DataFrame) -> Iterator[Ensemble]:
    """Yield the ensemble of each row of ``rows``, until the colours or the markers are used up.

    table : all rows of the study with one boundary condition
    rows : those in its part "ensemble" that are drawn, one for each ensemble
    """
    looks = zip(COLOURS, ENSEMBLE_MARKERS, rows.iterrows(), strict=False)
    for colour, marker, (_, row) in looks:
        label = ", ".join(f"{row[name]:g}" for name in PARAMETERS)
        is_in_ensemble = (table[PARAMETERS] == row[PARAMETERS]).all(axis=1)
        yield Ensemble(colour, marker, label, row, table[is_in_ensemble])


def draw_survival(axes: Axes, ensemble: Ensemble) -> None:
    """Draw the fraction of pulses alive as a function of distance, with its confidence band."""
    curve = ensemble.part("survival")
    look: Look = {"color": ensemble.colour, "linewidth": 1.0, "label": ensemble.label}
    axes.step(curve["distance"], curve["survival"], where="post", **look)
    band: Look = {"color": ensemble.colour, "alpha": 0.15, "linewidth": 0.0, "step": "post"}
    axes.fill_between(curve["distance"], curve["low"], curve["high"], **band)


def finish_survival(axes: Axes, stop: float) -> None:
    """Set the axes of panel a; pulses are followed up to the distance ``stop``."""
    axes.set(xlabel="distance $x/H$", ylabel="fraction of pulses alive", title=r"$\Gamma = 1$")
    axes.set(ylim=(0.6, 1.01), xlim=(0.0, stop))
    axes.legend(
        title=LEGEND_TITLE, loc="lower left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT
    )


def draw_rate(axes: Axes, ensemble: Ensemble) -> None:
    """Mark the death rate of an ensemble and its confidence interval."""
    row = ensemble.row
    below, above = row["rate"] - row["rate_low"], row["rate_high"] - row["rate"]
    look: Look = {"color": ensemble.colour, "fmt": ensemble.marker} | OPEN_MARKER
    look |= {"capsize": 2.0, "markersize": 4.0}
    axes.errorbar(row["barrier_rate"], row["rate"], [[below], [above]], **look)


def finish_rates(axes: Axes, dying: pd.DataFrame) -> None:
    """Mark ensembles without a colour, and draw the line of equal rates.

    The band around the line is a factor of two to both sides.
    """
    others = dying.iloc[len(COLOURS) :]
    axes.plot(others["barrier_rate"], others["rate"], ".", color=GREY, zorder=1.0)
    ends = np.array([3e-5, max(1e-2, 1.2 * dying["barrier_rate"].max())])
    axes.plot(ends, ends, color=BLACK, linewidth=0.8)
    axes.fill_between(ends, 0.5 * ends, 2.0 * ends, color="0.9", linewidth=0.0, zorder=0.0)
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=(1e-5, 2.0 * ends[1]))
    axes.set(
        xlabel="predicted barriers that stop pulses, per $H$", ylabel="deaths of pulses per $H$"
    )
    axes.set_title(r"$\Gamma = 1$")


def finish_walks(axes: Axes, long_survival: pd.DataFrame) -> None:
    """Draw the survival over a long distance and a power law, and set the axes of panel c.

    This survival follows from the balance alone: a pulse dies where the integral of its pre-stress
    has fallen to 0. The power law has the exponent of a random walk.
    """
    axes.plot(
        long_survival["distance"],
        long_survival["survival"],
        color=GREY,
        label="balance, not simulated",
    )
    start = GUIDE_START * long_survival["distance"].max()
    tail = long_survival[long_survival["distance"] > start]
    first = tail.iloc[0]
    guide = GUIDE_OFFSET * first["survival"] * np.sqrt(first["distance"] / tail["distance"])
    axes.plot(tail["distance"], guide, ":", color=BLACK, label="power law $x^{-1/2}$")
    axes.set(xscale="log", yscale="log", xlim=(4.0, None), ylim=(0.05, 1.1))
    axes.set(xlabel="distance $x/H$", ylabel="fraction of pulses alive", title=r"$\Gamma = 0$")
    axes.legend(
        title=LEGEND_TITLE, loc="lower left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT
    )


def draw_velocities(axes: Axes, ensemble: Ensemble) -> None:
    """Mark the velocity of each pulse that is alive, as a function of its exact velocity."""
    pulses = ensemble.part("pulse")
    alive = pulses[~pulses["died"].astype(bool)]
    look: Look = {"color": ensemble.colour, "label": ensemble.label}
    look |= {"markersize": 2.5, "linestyle": "none"} | OPEN_MARKER
    # Ensembles with a smaller deviation are drawn on top of those with a larger one.
    look["zorder"] = 3.0 - ensemble.row["deviation"]
    axes.plot(alive["exact_velocity"], alive["velocity"], ensemble.marker, **look)


def finish_velocities(axes: Axes) -> None:
    """Draw the line on which both velocities are equal."""
    largest = float(axes.dataLim.x1)
    axes.plot([0.0, largest], [0.0, largest], color=BLACK, linewidth=0.8, zorder=0.0)
    axes.set(
        xlabel=r"half of the integral of $\tau$ behind the pulse (theory)", title=r"$\Gamma = 0$"
    )
    axes.set_ylabel("slip velocity of the pulse, simulated")
    axes.legend(
        title=LEGEND_TITLE, loc="upper left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT
    )
