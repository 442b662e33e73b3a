"""Compare the scheme of the authors' published solver with the exact solution."""

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

# The scene of the authors' public notebook for the paper, and its lattice.
PRESTRESS = Prestress(0.6, 0.6)
GAMMA, BETA = 0.65, 0.01
DURATION, TIME_STEP = 15.0, 1e-3
BLOCK_COUNT, SPACING = 1000, 0.05005


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the published, localised (same lattice) and exact values of each quantity."""
    pulse = steady_pulse(PRESTRESS.left, GAMMA, BETA, damping_ratio=BETA / SPACING)
    first_stick = exact_transition_displacement(PRESTRESS, GAMMA, BETA / SPACING).time
    localised = simulate_on_lattice(
        Scene("displacement", PRESTRESS, DURATION, SPACING, GAMMA, BETA)
    )
    window = settings["measure"]["front_window"]
    rows = pd.DataFrame({"quantity": ["front_speed", "first_stick_time", "pulse_slip"]})
    published, ours = numbers(published_run(), window), numbers(localised, window)
    exact = [pulse.speed, first_stick, pulse.slip]
    return rows.assign(published=published, localised=ours, exact=exact)


def published_run() -> xr.Dataset:
    """Simulate a lattice with both ends held; return release times, stick times and final slip.

    Source: total force, released where it reaches 1 in size; Euler-Cromer steps of 1e-3, events at
    their ends.
    """
    x = SPACING * (np.arange(BLOCK_COUNT) - BLOCK_COUNT // 2)
    tau, sliding = PRESTRESS(x), np.zeros(BLOCK_COUNT, dtype=bool)
    slip, velocity = np.zeros((2, BLOCK_COUNT))
    release, stick = np.full((2, BLOCK_COUNT), np.nan)
    for step in range(round(DURATION / TIME_STEP)):
        force = tau - GAMMA * slip
        force[1:-1] += np.diff(slip, 2) / SPACING**2 + BETA * np.diff(velocity, 2) / SPACING**2
        started = ~sliding & (np.abs(force) >= 1.0)
        release[started & np.isnan(release)] = step * TIME_STEP
        sliding |= started
        sliding[[0, -1]] = False
        before = velocity
        velocity = np.where(sliding, velocity + TIME_STEP * force, 0.0)
        stopped = sliding & (before * velocity < 0.0)
        velocity[stopped], sliding[stopped] = 0.0, False
        stick[stopped] = (step + 1) * TIME_STEP
        slip = slip + TIME_STEP * velocity
    fields = {"release_time": release, "stick_time": stick, "slip": slip}
    return xr.Dataset({name: ("x", field) for name, field in fields.items()}, {"x": x})


def numbers(run: xr.Dataset, window: float) -> list[float]:
    """Return the final speed of the right front, the first stick and the slip of the pulse."""
    stick = run["stick_time"]
    left_behind = run["slip"][stick.notnull() & (run["x"] > 0.0)]
    return [fit_front(run, window)[0], float(stick.min()), float(left_behind[-1])]
