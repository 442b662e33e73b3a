"""What the shortcuts of the authors' published solver cost: their scheme, from its description, and exact numbers."""

import numpy as np
import pandas as pd

from ..measure.fronts import straight_line
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..simulation.runs import simulate_on_lattice
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_speeds import steady_pulse

NEEDS = {"settings": ["measure.front_window"]}

# The scene of the authors' public notebook for the paper, and its lattice.
PROFILE, GAMMA, DURATION = Prestress(0.6, 0.6), 0.65, 15.0
BLOCKS, SPACING, STEP, BETA = 1000, 0.05005, 1e-3, 0.01


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Quantity (front_speed, first_stick_time, pulse_slip), published, localised (on the same lattice) and exact."""
    pulse = steady_pulse(PROFILE.left, GAMMA, BETA, damping_ratio=BETA / SPACING)
    first_stick = exact_transition_displacement(PROFILE, GAMMA, BETA / SPACING).time
    run = simulate_on_lattice(Scene("displacement", PROFILE, DURATION, SPACING, GAMMA, BETA))
    ours = [run[name].values for name in ("x", "release_time", "stick_time", "slip")]
    window = settings["measure"]["front_window"]
    published, localised = numbers(published_run(), window), numbers(ours, window)
    found = {
        "published": published,
        "localised": localised,
        "exact": [pulse.speed, first_stick, pulse.slip],
    }
    return pd.DataFrame({"quantity": ["front_speed", "first_stick_time", "pulse_slip"]} | found)


def published_run() -> list[np.ndarray]:
    """Positions, release and stick times, and slip at the end; both ends of the lattice are held.

    Source: total force, released where it reaches 1 in size; Euler-Cromer steps of 1e-3, events at their ends.
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
    return [x, release, stick, slip]


def numbers(run: list[np.ndarray], window: float) -> list[float]:
    """Speed of the right front at the end of its path, first stick, slip left behind."""
    x, release, stick, slip = run
    released = np.isfinite(release)
    passed = released & (x > (1.0 - window) * x[released].max())
    behind = np.isfinite(stick) & (x > 0.0)
    return [
        straight_line(release[passed], x[passed])[0],
        float(np.nanmin(stick)),
        float(slip[behind][-1]),
    ]
