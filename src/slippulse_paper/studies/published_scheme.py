"""Costs of the shortcuts in the authors' published solver: their scheme and exact numbers."""

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
PROFILE = Prestress(0.6, 0.6)
GAMMA, BETA = 0.65, 0.01
DURATION, STEP = 15.0, 1e-3
BLOCKS, SPACING = 1000, 0.05005


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Quantity, published, localised (on the same lattice) and exact."""
    pulse = steady_pulse(PROFILE.left, GAMMA, BETA, damping_ratio=BETA / SPACING)
    first_stick = exact_transition_displacement(PROFILE, GAMMA, BETA / SPACING).time
    localised = simulate_on_lattice(Scene("displacement", PROFILE, DURATION, SPACING, GAMMA, BETA))
    window = settings["measure"]["front_window"]
    rows = pd.DataFrame({"quantity": ["front_speed", "first_stick_time", "pulse_slip"]})
    published, ours = numbers(published_run(), window), numbers(localised, window)
    exact = [pulse.speed, first_stick, pulse.slip]
    return rows.assign(published=published, localised=ours, exact=exact)


def published_run() -> xr.Dataset:
    """A run of a lattice whose ends are both held: release and stick times, slip at the end.

    Source: total force, released where it reaches 1 in size; Euler-Cromer steps of 1e-3, events at
    their ends.
    """
    x = SPACING * (np.arange(BLOCKS) - BLOCKS // 2)
    tau, sliding = PROFILE(x), np.zeros(BLOCKS, dtype=bool)
    slip, velocity = np.zeros((2, BLOCKS))
    release, stick = np.full((2, BLOCKS), np.nan)
    for step in range(round(DURATION / STEP)):
        force = tau - GAMMA * slip
        force[1:-1] += np.diff(slip, 2) / SPACING**2 + BETA * np.diff(velocity, 2) / SPACING**2
        started = ~sliding & (np.abs(force) >= 1.0)
        release[started & np.isnan(release)] = step * STEP
        sliding |= started
        sliding[[0, -1]] = False
        before = velocity
        velocity = np.where(sliding, velocity + STEP * force, 0.0)
        stopped = sliding & (before * velocity < 0.0)
        velocity[stopped], sliding[stopped] = 0.0, False
        stick[stopped] = (step + 1) * STEP
        slip = slip + STEP * velocity
    fields = {"release_time": release, "stick_time": stick, "slip": slip}
    return xr.Dataset({name: ("x", field) for name, field in fields.items()}, {"x": x})


def numbers(run: xr.Dataset, window: float) -> list[float]:
    """Speed of the right front at the end of its path, first stick, slip left behind."""
    stick = run["stick_time"]
    left_behind = run["slip"][stick.notnull() & (run["x"] > 0.0)]
    return [fit_front(run, window)[0], float(stick.min()), float(left_behind[-1])]
