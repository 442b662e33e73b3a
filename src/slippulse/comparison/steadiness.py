"""Whether the leading pulse is the steady one, so that the numbers of steady pulses apply to it."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..measure.fronts import path
from ..measure.pulses import LeadingPulse, slip_variation
from ..theory.pulse import steady_pulse

# A width that differs from that of the steady pulse at the measured speed by more than this, the damped layer and the
# blocks that the front takes, or slip that still varies by more than this behind it, belongs to a pulse that changes.
CHANGE, WIDTH_BLOCKS = 0.05, 3.0
# The damped layer at the front over the width of the pulse: the front speed is computed without leaf springs, and its
# error grows as the square, to one per cent here.
LAYER_SHARE = 0.125


def pulse_state(run: xr.Dataset, pulse: LeadingPulse, side: str = "right") -> str:
    """What the leading pulse is.

    Parameters
    ----------
    run : one run with fronts and fields
    pulse : its leading pulse on ``side``

    Returns
    -------
    "steady"; "unsteady" when its width is not the steady one at its speed, the slip behind it varies, or it is slower
    than the waves;
    "thick_front" when the damped layer is not thin against it; "none" without a pulse or under a stress boundary

    Source: width and layer of the steady pulse, beta v U''' + (v^2 - 1) U'' + gamma U = tau_0.
    """
    if run.attrs["boundary"] != "displacement" or not np.isfinite([pulse.width, pulse.speed]).all():
        return "none"
    _, distance = path(run, side)
    sign = 1.0 if side == "right" else -1.0
    tau = float(run["prestress"].values[np.argmin(np.abs(sign * run["x"].values - distance[-1]))])
    if not 0.0 < tau < 1.0:
        return "none"
    if pulse.speed <= 1.0:
        return "unsteady"
    beta, dx = run.attrs["beta"], run.attrs["dx"]
    steady = steady_pulse(tau, run.attrs["gamma"], beta, pulse.speed)
    layer = beta * pulse.speed / (pulse.speed**2 - 1.0)
    if layer > LAYER_SHARE * steady.width:
        return "thick_front"
    allowed = CHANGE * steady.width + layer + WIDTH_BLOCKS * dx
    # A pulse too young to have left slip behind is judged by its width alone.
    varied = slip_variation(run, pulse, side)
    changes = abs(pulse.width - steady.width) > allowed or varied > CHANGE
    return "unsteady" if changes else "steady"
