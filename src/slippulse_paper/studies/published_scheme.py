"""Compare the numerical scheme of the authors' published solver with ours and with exact theory."""

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.measurement.front_paths import fit_front
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.simulation.sweep import simulate_on_lattice
from slippulse.theory.exact_transition import exact_transition_displacement
from slippulse.theory.pulse import steady_pulse

NEEDS = {"settings": ["measure.front_window"]}

# The scene of the authors' public notebook for the paper, its time step and its lattice.
PRESTRESS = Prestress(0.6, 0.6)
GAMMA = 0.65
BETA = 0.01
DURATION = 15.0
TIME_STEP = 1e-3
BLOCK_COUNT = 1000
SPACING = 0.05005
QUANTITIES = ("front_speed", "first_stick_time", "pulse_slip")


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each of QUANTITIES, with three values.

    published : computed by the scheme of the authors' solver
    localised : computed by our localised scheme, on a lattice with the same spacing
    exact : from exact theory
    """
    front_window = settings["measure"]["front_window"]
    damping_ratio = BETA / SPACING
    pulse = steady_pulse(PRESTRESS.left, GAMMA, BETA, damping_ratio=damping_ratio)
    first_stick = exact_transition_displacement(PRESTRESS, GAMMA, damping_ratio).time
    scene = Scene(
        boundary="displacement",
        prestress=PRESTRESS,
        duration=DURATION,
        dx=SPACING,
        gamma=GAMMA,
        beta=BETA,
    )
    columns = {
        "quantity": QUANTITIES,
        "published": measured_quantities(published_run(), front_window),
        "localised": measured_quantities(simulate_on_lattice(scene), front_window),
        "exact": [pulse.speed, first_stick, pulse.slip],
    }
    return pd.DataFrame(columns)


def published_run() -> xr.Dataset:
    """Simulate a lattice by the published scheme.

    The steps are those of the Euler-Cromer method. A stuck block is released at the end of the step
    in which the absolute value of its total force, damping included, has reached 1. The blocks at
    both ends of the lattice are held.

    Returns release times, stick times and final slip.
    """
    x = SPACING * (np.arange(BLOCK_COUNT) - BLOCK_COUNT // 2)
    tau = PRESTRESS(x)
    is_sliding = np.zeros(BLOCK_COUNT, dtype=bool)
    slip, velocity = np.zeros((2, BLOCK_COUNT))
    release_time, stick_time = np.full((2, BLOCK_COUNT), np.nan)
    for step in range(round(DURATION / TIME_STEP)):
        force = tau - GAMMA * slip
        coupling = np.diff(slip, 2) / SPACING**2
        damping = BETA * np.diff(velocity, 2) / SPACING**2
        force[1:-1] += coupling + damping
        is_released = ~is_sliding & (np.abs(force) >= 1.0)
        # Only the first release of a block is recorded.
        release_time[is_released & np.isnan(release_time)] = step * TIME_STEP
        is_sliding |= is_released
        is_sliding[[0, -1]] = False
        previous_velocity = velocity
        velocity = np.where(is_sliding, velocity + TIME_STEP * force, 0.0)
        # A block sticks where its velocity has changed sign.
        is_stopped = is_sliding & (previous_velocity * velocity < 0.0)
        velocity[is_stopped] = 0.0
        is_sliding[is_stopped] = False
        stick_time[is_stopped] = (step + 1) * TIME_STEP
        slip = slip + TIME_STEP * velocity
    fields = {
        "release_time": ("x", release_time),
        "stick_time": ("x", stick_time),
        "slip": ("x", slip),
    }
    return xr.Dataset(fields, {"x": x})


def measured_quantities(run: xr.Dataset, front_window: float) -> list[float]:
    """Return the values of QUANTITIES on a lattice.

    QUANTITIES are the speed of the right front over the last part of its path, the time of the
    first stick, and the slip of the outermost block on the right that has stuck.

    front_window : last fraction of the path over which the front speed is measured
    """
    speed = fit_front(run, front_window).slope
    stick_time = run["stick_time"]
    is_behind_pulse = stick_time.notnull() & (run["x"] > 0.0)
    slip_behind_pulse = run["slip"][is_behind_pulse][-1]
    return [speed, float(stick_time.min()), float(slip_behind_pulse)]
