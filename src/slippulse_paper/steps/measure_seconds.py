"""Measure the seconds of the runs behind the study of accuracy, and draw its errors against them.

Seconds differ between machines and between runs of one machine. Therefore these files are in a
folder of their own, and are neither in the checksums nor in the manifest of results.
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from slippulse.data.tables import load_table, save_table
from slippulse.plotting.style import (
    PAGE_WIDTH,
    few_ticks,
    house_style,
    legend_above,
    new_panels,
    save_figure,
)

from ..figures.shared.error_panels import draw_errors, error_rows
from ..studies.accuracy_cost import DAMPING_RATIOS, Setting
from .inputs import load_inputs

# A run is repeated until it has taken this many seconds in total, but not more often than this.
MIN_TOTAL_SECONDS = 0.01
MAX_REPETITIONS = 3
# Seconds that have a number on the axis, as far as the axis reaches.
AXIS_TICKS = np.outer(10.0 ** np.arange(-5, 3), [1.0, 2.0, 5.0]).ravel()


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: studies (accuracy_cost). Outputs: csv, png, pdf."""
    study = load_inputs(files).tables["accuracy_cost"]
    trade = study[study["part"] == "trade"]
    save_table(timed(trade), outputs["csv"])
    with house_style():
        save_figure(draw(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])


def timed(trade: pd.DataFrame) -> pd.DataFrame:
    """Return the errors of a study with measured processor seconds of one run.

    These are seconds of the crack for its 95 % time, and the mean of the pulses otherwise.
    """
    settings = [
        Setting(row.scheme, int(row.order), row.step, row.dx)
        for row in trade[["scheme", "order", "step", "dx"]].itertuples()
    ]
    # Machine code and other things that only the first run needs are loaded before.
    for first in {setting.scheme: setting for setting in settings}.values():
        first.run_crack()
        first.run_pulse(0.0)
    crack = [shortest_seconds(setting.run_crack) for setting in settings]
    pulses = [
        sum(shortest_seconds(partial(setting.run_pulse, ratio)) for ratio in DAMPING_RATIOS)
        for setting in settings
    ]
    measured = trade.assign(
        crack=crack, pulse=[seconds / len(DAMPING_RATIOS) for seconds in pulses]
    )
    return error_rows(
        measured, "seconds", lambda quantity: "crack" if quantity == "share_time" else "pulse"
    )


def shortest_seconds(simulate: Callable[[], object]) -> float:
    """Return the processor time of a run, the shortest of some repetitions."""
    times: list[float] = []
    while len(times) < MAX_REPETITIONS and sum(times) < MIN_TOTAL_SECONDS:
        start = time.process_time()
        simulate()
        times.append(time.process_time() - start)
    return min(times)


def draw(table: pd.DataFrame) -> Figure:
    """Draw four errors against processor seconds."""
    figure, panels = new_panels(PAGE_WIDTH, 5.0, "ab;cd")
    draw_errors(panels, table, "seconds", "processor seconds for one run")
    for axes in panels:
        low, high = axes.get_xlim()
        few_ticks(axes.xaxis, AXIS_TICKS[(low < AXIS_TICKS) & (high > AXIS_TICKS)])
    legend_above(figure, panels[0])
    return figure
