"""Pulses on rough pre-stress: survival, death rate and barriers (Gamma = 1), random walks (0)."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, GREY, MARKERS, OPEN_MARKER, PAGE_WIDTH, SMALL_TEXT, Look

NEEDS = {"studies": ["rough_prestress"]}
KEYS = ["level", "deviation", "correlation_length", "hurst"]
COLOURS = (style.BLUE, style.GREEN, style.PURPLE, style.YELLOW, style.ORANGE, style.SKY, BLACK)
# Ensembles beyond these colours, as in a larger study, have only their death rate drawn, in grey.
SHAPES = (*MARKERS, "X")
HEAD = r"$\tau_0$, $\sigma$, $\ell$, Hurst"


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the table of the study; the balance is NaN if it is not reached within the table."""
    return style.as_given(data, tables, settings).replace(np.inf, np.nan)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) survival and (b) death rate with the displacement held, (c, d) the stress held."""
    figure, (lives, rates, walks, velocities) = style.new_panels(PAGE_WIDTH, 5.6, "ab;cd")
    held = table[table["boundary"] == "displacement"]
    ensembles = held[(held["part"] == "ensemble") & (held["deaths"] > 0.0)]
    for colour, marker, (_, row) in zip(COLOURS, SHAPES, ensembles.iterrows(), strict=False):
        label = ", ".join(f"{row[key]:g}" for key in KEYS)
        _survival(lives, _of(held, row, "survival"), colour, label)
        errors = [[row["rate"] - row["rate_low"]], [row["rate_high"] - row["rate"]]]
        bars: Look = {"color": colour, "capsize": 2.0, "fmt": marker, "markersize": 4.0}
        rates.errorbar(row["barrier_rate"], row["rate"], errors, **bars)
    lives.set(xlabel="distance $x$", ylabel="fraction of pulses alive", title=r"$\Gamma = 1$")
    lives.set(ylim=(0.6, 1.01), xlim=(0.0, ensembles["stop"].max()))
    lives.legend(title=HEAD, loc="lower left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT)
    others = ensembles.iloc[len(COLOURS) :]
    rates.plot(others["barrier_rate"], others["rate"], ".", color=GREY, zorder=1.0)
    ends = np.array([3e-5, max(1e-2, 1.2 * ensembles["barrier_rate"].max())])
    rates.plot(ends, ends, color=BLACK, linewidth=0.8)
    rates.fill_between(ends, 0.5 * ends, 2.0 * ends, color="0.9", linewidth=0.0, zorder=0.0)
    rates.set(
        xscale="log", yscale="log", xlim=ends, ylim=(1e-5, 2.0 * ends[1]), title=r"$\Gamma = 1$"
    )
    rates.set(
        xlabel="predicted fatal barriers for each $H$", ylabel="deaths of pulses for each $H$"
    )
    stress = table[table["boundary"] == "stress"]
    ensembles = stress[stress["part"] == "ensemble"]
    for colour, marker, (_, row) in zip(COLOURS, SHAPES, ensembles.iterrows(), strict=False):
        label = ", ".join(f"{row[key]:g}" for key in KEYS)
        if row["deaths"] > 0.1 * row["pulses"]:
            curve = _of(stress, row, "survival")
            _survival(walks, curve, colour, label)
            walks.plot(curve["distance"], curve["predicted"], "--", color=colour, linewidth=0.9)
        pulses = _of(stress, row, "pulse")
        pulses = pulses[~pulses["died"].astype(bool)]
        look: Look = {"color": colour, "label": label, "markersize": 2.5, "linestyle": "none"}
        # The pulses that differ least are drawn last.
        look["zorder"] = 3.0 - row["deviation"]
        velocities.plot(pulses["exact_velocity"], pulses["velocity"], marker, **look, **OPEN_MARKER)
    long = stress[stress["part"] == "long_survival"]
    walks.plot(long["distance"], long["survival"], color=GREY, label="balance, not simulated")
    tail = long[long["distance"] > 0.2 * long["distance"].max()]
    guide = 1.5 * tail["survival"].iloc[0] * np.sqrt(tail["distance"].iloc[0] / tail["distance"])
    walks.plot(tail["distance"], guide, ":", color=BLACK, label="power law $x^{-1/2}$")
    walks.set(xscale="log", yscale="log", xlim=(4.0, None), ylim=(0.05, 1.1))
    walks.set(xlabel="distance $x$", ylabel="fraction of pulses alive", title=r"$\Gamma = 0$")
    walks.legend(loc="lower left", fontsize=SMALL_TEXT)
    top = float(velocities.dataLim.x1)
    velocities.plot([0.0, top], [0.0, top], color=BLACK, linewidth=0.8, zorder=0.0)
    velocities.set(
        xlabel="slip velocity by theory, half of the integral of $\\tau$", title=r"$\Gamma = 0$"
    )
    velocities.set_ylabel("slip velocity of the pulse, simulated")
    velocities.legend(title=HEAD, loc="upper left", fontsize=SMALL_TEXT, title_fontsize=SMALL_TEXT)
    return figure


def _of(table: pd.DataFrame, row: pd.Series, part: str) -> pd.DataFrame:
    """Rows of one part and of the ensemble of a row."""
    same = (table[KEYS] == row[KEYS]).all(axis=1)
    return table[same & (table["part"] == part)]


def _survival(axes: Axes, curve: pd.DataFrame, colour: str, label: str) -> None:
    """Draw the fraction alive in steps, with its band."""
    look: Look = {"color": colour, "linewidth": 1.0, "label": label}
    axes.step(curve["distance"], curve["survival"], where="post", **look)
    band: Look = {"color": colour, "alpha": 0.15, "linewidth": 0.0, "step": "post"}
    axes.fill_between(curve["distance"], curve["low"], curve["high"], **band)
