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
    """Return the FIELDS of each pulse by simulation, run and x, which is 0 at the peak."""
    parts = []
    for name, sweep in settings["sweeps"].items():
        for number, run in enumerate(runs(sweep)):
            rows = far_profile(run) if run.boundary == "stress" else profile(run)
            parts.append(rows.assign(simulation=name, run=number))
    return pd.concat(parts, ignore_index=True)


def profile(run: Run) -> pd.DataFrame:
    """Return a steady pulse with sharp corners at the front and at the trailing edge."""
    level, ratio = run.prestress.right, run.damping_ratio
    pulse = steady_pulse(level, run.gamma, run.beta, damping_ratio=ratio, release=run.release)
    even = np.linspace(-(1.0 + MARGIN_BEHIND), MARGIN_AHEAD, POINT_COUNT) * pulse.width
    edges = [-pulse.width, np.nextafter(-pulse.width, -np.inf), 0.0, 1e-12 * pulse.width]
    xi = np.unique(np.concatenate([even, edges]))
    fields = dict(zip(FIELDS, pulse.profile(xi), strict=True))
    return pd.DataFrame({"x": xi - pulse.peak_position} | fields)


def far_profile(run: Run) -> pd.DataFrame:
    """Return the pulse far from its nucleation under held stress, its integral and derivative."""
    crack = ArrestingCrack(run.prestress, run.damping_ratio, run.release)
    pulse = np.array(crack.far_pulse())
    delay, velocity = pulse[:, np.argsort(pulse[0], kind="stable")]
    start = max(0, int(np.argmax(velocity > TAIL_CUT * velocity.max())) - 1)
    x, v = delay[start:] - delay[np.argmax(velocity)], velocity[start:]
    apart = np.concatenate([[True], np.diff(x) > 1e-9 * np.ptp(x)])
    x, v = x[apart], v[apart]
    # The pulse moves unchanged at the wave speed, so slip is the integral of the velocity.
    slip = cumulative_trapezoid(v[::-1], -x[::-1], initial=0.0)[::-1]
    curves = (slip, v, -np.gradient(v, x))
    rows = pd.DataFrame({"x": x} | dict(zip(FIELDS, curves, strict=True)))
    return rows.iloc[:: max(1, len(rows) // (2 * POINT_COUNT))]
