"""Measure the computing times of the study of accuracy, and draw errors as a function of time.

Computing times differ between machines, and between runs on the same machine. Therefore these files
are in a separate folder, and neither the checksums nor the manifest of the results contain them.
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

# A simulation is repeated until all its repetitions have taken this many seconds in total, but at
# most this many times.
MIN_TOTAL_SECONDS = 0.01
MAX_REPETITIONS = 3
# Computing times in seconds that are labelled on the axis.
AXIS_TICKS = np.outer(10.0 ** np.arange(-5, 3), [1.0, 2.0, 5.0]).ravel()


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the table ``csv`` of errors and computing times, and the figure ``png`` and ``pdf``.

    The files ``studies`` contain the table of the study `accuracy_cost`.
    """
    study = load_inputs(files).tables["accuracy_cost"]
    # These rows are for the trade-off between time and errors. Each has all errors of one setting.
    errors_by_setting = study[study["part"] == "trade"]
    save_table(timed(errors_by_setting), outputs["csv"])
    with house_style():
        save_figure(draw(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])


def timed(errors_by_setting: pd.DataFrame) -> pd.DataFrame:
    """Time the simulations of each setting, and return its errors with the processor seconds.

    The result has the rows that the figure draws, each with one error of a setting. One error is
    measured in the simulation of a crack, and has the seconds of this simulation. All others are
    measured in simulations of a pulse, and have the mean seconds over its damping ratios.

    errors_by_setting : one row for each setting (scheme, order, step, dx)
    """
    settings = [
        Setting(row.scheme, int(row.order), row.step, row.dx)
        for row in errors_by_setting[["scheme", "order", "step", "dx"]].itertuples()
    ]
    # The first simulation of a scheme also loads machine code, which should not be timed.
    one_setting_per_scheme = {setting.scheme: setting for setting in settings}
    for setting in one_setting_per_scheme.values():
        setting.run_crack()
        setting.run_pulse(0.0)
    crack_seconds = [shortest_seconds(setting.run_crack) for setting in settings]
    pulse_seconds = [_mean_pulse_seconds(setting) for setting in settings]
    # `error_rows` takes the seconds of each error from the column "crack" or the column "pulse".
    with_seconds = errors_by_setting.assign(crack=crack_seconds, pulse=pulse_seconds)
    return error_rows(with_seconds, "seconds", cost_column_of=_simulation_with_quantity)


def _mean_pulse_seconds(setting: Setting) -> float:
    """Return the processor time of a pulse, averaged over the damping ratios."""
    runs = [partial(setting.run_pulse, ratio) for ratio in DAMPING_RATIOS]
    return sum(map(shortest_seconds, runs)) / len(runs)


def _simulation_with_quantity(quantity: str) -> str:
    """Return the simulation that gives a quantity, "crack" or "pulse"."""
    # The quantity share_time is the time at which a crack's left front has covered 95 % of its
    # path.
    return "crack" if quantity == "share_time" else "pulse"


def shortest_seconds(simulate: Callable[[], object]) -> float:
    """Return the processor time of a simulation: the shortest of some repetitions."""
    times: list[float] = []
    while len(times) < MAX_REPETITIONS and sum(times) < MIN_TOTAL_SECONDS:
        start = time.process_time()
        simulate()
        times.append(time.process_time() - start)
    return min(times)


def draw(table: pd.DataFrame) -> Figure:
    """Draw four errors as functions of the processor seconds."""
    figure, panels = new_panels(PAGE_WIDTH, 5.0, "ab;cd")
    draw_errors(panels, table, "seconds", "processor seconds for one run")
    for axes in panels:
        # Label only ticks inside the axis.
        low, high = axes.get_xlim()
        few_ticks(axes.xaxis, [tick for tick in AXIS_TICKS if low < tick < high])
    legend_above(figure, panels[0])
    return figure
