"""Tabulate the exact pulses for figures 3, 8 and 9 by distance from their largest velocity."""

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid

from slippulse.model.run import Run
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.pulse import steady_pulse

from ..configuration.runs import runs

NEEDS = {"sweeps": ["steady_displacement", "steady_stress"]}

POINT_COUNT = 200
# A curve extends ahead of the pulse and behind it by these fractions of the pulse width.
MARGIN_AHEAD, MARGIN_BEHIND = 0.08, 0.25
# An infinite tail is cut off below this fraction of the largest velocity.
TAIL_CUT = 1e-3
FIELDS = ("slip", "slip_velocity", "slip_acceleration")


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return slip, velocity and acceleration of each pulse, as functions of the position x.

    The largest velocity is at x = 0. The columns simulation and run name the pulse.
    """
    parts = []
    for name, sweep in settings["sweeps"].items():
        for number, run in enumerate(runs(sweep)):
            rows = stress_profile(run) if run.boundary == "stress" else displacement_profile(run)
            parts.append(rows.assign(simulation=name, run=number))
    return pd.concat(parts, ignore_index=True)


def displacement_profile(run: Run) -> pd.DataFrame:
    """Return the exact steady pulse under a displacement boundary.

    It has sharp corners at the front and at the trailing edge, so both sides of each are included.
    """
    level, ratio = run.prestress.right, run.damping_ratio
    pulse = steady_pulse(level, run.gamma, run.beta, damping_ratio=ratio, release=run.release)
    relative = np.linspace(-(1.0 + MARGIN_BEHIND), MARGIN_AHEAD, POINT_COUNT)
    trailing_edge = -pulse.width
    corners = [
        trailing_edge,
        np.nextafter(trailing_edge, -np.inf),
        0.0,
        1e-12 * pulse.width,
    ]
    # The distance xi from the front is negative behind it.
    xi = np.unique(np.concatenate([relative * pulse.width, corners]))
    fields = dict(zip(FIELDS, pulse.profile(xi), strict=True))
    return pd.DataFrame({"x": xi - pulse.peak_position} | fields)


def stress_profile(run: Run) -> pd.DataFrame:
    """Return the exact pulse under a stress boundary, far from its nucleation.

    Its velocity is known; slip is the integral of the velocity, and acceleration its derivative.
    """
    crack = ArrestingCrack(run.prestress, run.damping_ratio, run.release)
    delay, velocity = crack.far_pulse()
    # x - t in ascending order, from the tail to the front
    order = np.argsort(delay, kind="stable")
    delay, velocity = delay[order], velocity[order]
    first_fast = int(np.argmax(velocity > TAIL_CUT * velocity.max()))
    start = max(0, first_fast - 1)
    peak = delay[np.argmax(velocity)]
    x, velocity = delay[start:] - peak, velocity[start:]
    # A derivative needs points that are apart.
    is_apart = np.concatenate([[True], np.diff(x) > 1e-9 * np.ptp(x)])
    x, velocity = x[is_apart], velocity[is_apart]
    # The pulse moves unchanged at the wave speed 1, so du/dt = -du/dx. The integral begins at the
    # front, where the slip is 0.
    slip = cumulative_trapezoid(velocity[::-1], -x[::-1], initial=0.0)[::-1]
    acceleration = -np.gradient(velocity, x)
    curves = dict(zip(FIELDS, (slip, velocity, acceleration), strict=True))
    rows = pd.DataFrame({"x": x} | curves)
    stride = max(1, len(rows) // (2 * POINT_COUNT))
    return rows.iloc[::stride]
