"""Pulses on a rough pre-stress, which is a random field: how far they run before they die.

With the displacement held (Gamma = 1), barriers of the pre-stress stop pulses. With the stress held
(Gamma = 0), the velocity of a pulse performs a random walk. An ensemble is a set of runs whose
pre-stress is drawn from the same random field. An ensemble has one colour and one marker, and is
named by the four parameters of the field.
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

# Parameters of the random field of an ensemble: mean, standard deviation, correlation length and
# Hurst exponent. The title of the legend has their symbols.
PARAMETERS = ["level", "deviation", "correlation_length", "hurst"]
LEGEND_TITLE = r"$\tau_0$, $\sigma$, $\ell$, Hurst"
# If there are more ensembles than colours, only the death rates of the others are drawn.
COLOURS = (style.BLUE, style.GREEN, style.PURPLE, style.YELLOW, style.ORANGE, style.SKY, BLACK)
ENSEMBLE_MARKERS = (*MARKERS, "X")
# With the stress held, survival is drawn only if more than this fraction of the pulses has died.
MIN_DEAD_FRACTION = 0.1
# The line of the power law begins at this fraction of the largest distance. It lies above the curve
# by the second factor.
GUIDE_START, GUIDE_OFFSET = 0.2, 1.5


class Ensemble(NamedTuple):
    """One ensemble of the study, with its look and its rows of the table."""

    colour: str
    marker: str
    label: str
    row: pd.Series  # its row of the part "ensemble", which has its death rate
    rows: pd.DataFrame  # all its rows

    def part(self, name: str) -> pd.DataFrame:
        """Return the rows of the ensemble in one part of the study."""
        return self.rows[self.rows["part"] == name]


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return the table of the study rough_prestress, with NaN in place of infinite numbers.

    The column balance has the position at which the integral of the pre-stress has fallen to 0. It
    is infinite if the integral stays positive.
    """
    return style.as_given(data, tables, settings).replace(np.inf, np.nan)


def draw(table: pd.DataFrame) -> Figure:
    """Draw the two boundary conditions in two rows of panels.

    Displacement held: (a) survival, (b) death rate. Stress held: (c) survival, (d) velocity. The
    survival is the fraction of pulses that are alive, as a function of the distance that they run.
    """
    figure, panels = style.new_panels(PAGE_WIDTH, 5.6, "ab;cd")
    survival_axes, rate_axes, walk_axes, velocity_axes = panels
    held_top = table[table["boundary"] == "displacement"]
    ensembles_of_held_top = held_top[held_top["part"] == "ensemble"]
    with_deaths = ensembles_of_held_top[ensembles_of_held_top["deaths"] > 0.0]
    for ensemble in ensembles(held_top, with_deaths):
        draw_survival(survival_axes, ensemble)
        draw_rate(rate_axes, ensemble)
    # Pulses are followed up to the distance stop, at which the rough pre-stress ends. If no pulse
    # dies, panel a is empty, but its axis still has an end.
    stops = ensembles_of_held_top["stop"] if with_deaths.empty else with_deaths["stop"]
    finish_survival(survival_axes, stops.max())
    finish_rates(rate_axes, with_deaths)
    held_stress = table[table["boundary"] == "stress"]
    for ensemble in ensembles(held_stress, held_stress[held_stress["part"] == "ensemble"]):
        dead_fraction = ensemble.row["deaths"] / ensemble.row["pulses"]
        # If few pulses die, the survival stays close to 1, and is not drawn.
        if dead_fraction > MIN_DEAD_FRACTION:
            draw_survival(walk_axes, ensemble)
            # The survival that theory predicts is a dashed line.
            curve = ensemble.part("survival")
            look: Look = {"color": ensemble.colour, "linewidth": 0.9}
            walk_axes.plot(curve["distance"], curve["predicted"], "--", **look)
        draw_velocities(velocity_axes, ensemble)
    finish_walks(walk_axes, held_stress[held_stress["part"] == "long_survival"])
    finish_velocities(velocity_axes)
    return figure


def ensembles(table: pd.DataFrame, rows: pd.DataFrame) -> Iterator[Ensemble]:
    """Yield the ensemble of each row of ``rows``, until the colours or the markers are used up.

    table : all rows of the study with one boundary condition
    rows : its rows of the part "ensemble" that are to be drawn, one for each ensemble
    """
    looks = zip(COLOURS, ENSEMBLE_MARKERS, rows.iterrows(), strict=False)
    for colour, marker, (_, row) in looks:
        label = ", ".join(f"{row[name]:g}" for name in PARAMETERS)
        is_in_ensemble = (table[PARAMETERS] == row[PARAMETERS]).all(axis=1)
        yield Ensemble(colour, marker, label, row, table[is_in_ensemble])


def draw_survival(axes: Axes, ensemble: Ensemble) -> None:
    """Draw the fraction of pulses that are alive as a function of distance.

    A band shows its confidence interval.
    """
    curve = ensemble.part("survival")
    look: Look = {"color": ensemble.colour, "linewidth": 1.0, "label": ensemble.label}
    axes.step(curve["distance"], curve["survival"], where="post", **look)
    band: Look = {"color": ensemble.colour, "alpha": 0.15, "linewidth": 0.0, "step": "post"}
    axes.fill_between(curve["distance"], curve["low"], curve["high"], **band)


def finish_survival(axes: Axes, largest_distance: float) -> None:
    """Set the axes of panel a; pulses are followed up to ``largest_distance``."""
    axes.set(xlabel="distance $x/H$", ylabel="fraction of pulses alive", title=r"$\Gamma = 1$")
    axes.set(ylim=(0.6, 1.01), xlim=(0.0, largest_distance))
    # The panel is empty if no pulse has died.
    if axes.lines:
        axes.legend(
            title=LEGEND_TITLE, loc="lower left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT
        )


def draw_rate(axes: Axes, ensemble: Ensemble) -> None:
    """Draw one point: the death rate of an ensemble as a function of the predicted rate.

    An error bar shows the confidence interval of the death rate. Both rates are numbers of events
    for each layer thickness that a pulse runs. The predicted one counts barriers that stop pulses.
    """
    row = ensemble.row
    # The error bars below and above the mark.
    below, above = row["rate"] - row["rate_low"], row["rate_high"] - row["rate"]
    look: Look = {"color": ensemble.colour, "fmt": ensemble.marker} | OPEN_MARKER
    look |= {"capsize": 2.0, "markersize": 4.0}
    axes.errorbar(row["barrier_rate"], row["rate"], [[below], [above]], **look)


def finish_rates(axes: Axes, with_deaths: pd.DataFrame) -> None:
    """Complete panel b: add ensembles without a colour, the line of equal rates, and the axes.

    On the line, death rate and predicted rate are equal. Within the band around it, they differ by
    less than a factor of two.

    with_deaths : one row for each ensemble in which a pulse died, with its death rate (column rate)
        and predicted rate (barrier_rate). The first rows, one for each of COLOURS, have been drawn
        already (see `draw_rate`)
    """
    # Ensembles without a colour are small grey points.
    uncoloured = with_deaths.iloc[len(COLOURS) :]
    axes.plot(uncoloured["barrier_rate"], uncoloured["rate"], ".", color=GREY, zorder=1.0)
    ends = np.array([3e-5, max(1e-2, 1.2 * with_deaths["barrier_rate"].max())])
    axes.plot(ends, ends, color=BLACK, linewidth=0.8)
    axes.fill_between(ends, 0.5 * ends, 2.0 * ends, color="0.9", linewidth=0.0, zorder=0.0)
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=(1e-5, 2.0 * ends[1]))
    axes.set(
        xlabel="predicted barriers that stop pulses, per $H$", ylabel="deaths of pulses per $H$"
    )
    axes.set_title(r"$\Gamma = 1$")


def finish_walks(axes: Axes, long_survival: pd.DataFrame) -> None:
    """Draw the survival over a long distance and a power law, and set the axes of panel c.

    The survival is the fraction of pulses that are alive. Over a long distance it is not simulated:
    it follows from the pre-stress alone, because a pulse dies where the integral of the pre-stress
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
    # At the first point, the power law is GUIDE_OFFSET times the survival.
    power_law = GUIDE_OFFSET * first["survival"] * np.sqrt(first["distance"] / tail["distance"])
    axes.plot(tail["distance"], power_law, ":", color=BLACK, label="power law $x^{-1/2}$")
    axes.set(xscale="log", yscale="log", xlim=(4.0, None), ylim=(0.05, 1.1))
    axes.set(xlabel="distance $x/H$", ylabel="fraction of pulses alive", title=r"$\Gamma = 0$")
    axes.legend(
        title=LEGEND_TITLE, loc="lower left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT
    )


def draw_velocities(axes: Axes, ensemble: Ensemble) -> None:
    """Mark simulated and exact slip velocity of each pulse that is alive at the end."""
    pulses = ensemble.part("pulse")
    alive = pulses[~pulses["died"].astype(bool)]
    look: Look = {"color": ensemble.colour, "label": ensemble.label}
    look |= {"markersize": 2.5, "linestyle": "none"} | OPEN_MARKER
    # Ensembles with a smaller deviation of the pre-stress are drawn on top of the others.
    look["zorder"] = 3.0 - ensemble.row["deviation"]
    axes.plot(alive["exact_velocity"], alive["velocity"], ensemble.marker, **look)


def finish_velocities(axes: Axes) -> None:
    """Draw the line of equal simulated and exact velocity, and set the axes of panel d.

    The exact velocity of a pulse is half of the integral of the pre-stress behind it.
    """
    # The line ends at the largest exact velocity that has been drawn.
    largest = float(axes.dataLim.x1)
    axes.plot([0.0, largest], [0.0, largest], color=BLACK, linewidth=0.8, zorder=0.0)
    axes.set(
        xlabel=r"half of the integral of $\tau$ behind the pulse (theory)", title=r"$\Gamma = 0$"
    )
    axes.set_ylabel("slip velocity of the pulse, simulated")
    axes.legend(
        title=LEGEND_TITLE, loc="upper left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT
    )
