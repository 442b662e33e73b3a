"""What the shortcuts of the authors' published solver cost: their scheme, from its description, and exact numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..measure.fronts import straight_line
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..simulation.simulate import simulate
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_law import front_speed
from ..theory.pulse import pulse_behind_front

NEEDS = {"settings": ["measure.front_window"]}

# The scene of the authors' public notebook for the paper, and its lattice.
LEVEL, GAMMA, DURATION = 0.6, 0.65, 15.0
BLOCKS, SPACING, STEP, BETA = 1000, 0.05005, 1e-3, 0.01


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Numbers of one scene by the published scheme, by the localised one on the same lattice, and exactly.

    Returns
    -------
    DataFrame of quantity (front_speed, first_stick_time, pulse_slip), published, localised and exact

    Source: total force, released where it reaches 1 in size; Euler-Cromer steps of 1e-3, events at their ends.
    """
    profile, ratio = Prestress(LEVEL, LEVEL), BETA / SPACING
    run = simulate(Scene("displacement", profile, DURATION, SPACING, GAMMA, BETA, release="total"))
    ours = run["release_time"].values, run["stick_time"].values, run["slip"].values
    speed = float(front_speed(LEVEL, ratio))
    x = SPACING * (np.arange(BLOCKS) - BLOCKS // 2)
    window = settings["measure"]["front_window"]
    found = {
        "published": numbers(x, published_run(profile(x)), window),
        "localised": numbers(run["x"].values, ours, window),
        "exact": {
            "front_speed": speed,
            "first_stick_time": exact_transition_displacement(profile, GAMMA, ratio).time,
            "pulse_slip": pulse_behind_front(LEVEL, GAMMA, BETA, speed).slip,
        },
    }
    return pd.DataFrame(found).rename_axis("quantity").reset_index()


def published_run(tau: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Release and stick times and slip at the end; both ends of the lattice are held."""
    slip, velocity = np.zeros((2, tau.size))
    sliding = np.zeros(tau.size, dtype=bool)
    release, stick = np.full((2, tau.size), np.nan)
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
    return release, stick, slip


def numbers(x: np.ndarray, run: tuple[np.ndarray, np.ndarray, np.ndarray], window: float) -> dict[str, float]:
    """Of release, stick and slip: speed of the right front at the end of its path, first stick, slip left behind."""
    release, stick, slip = run
    passed = (x > (1.0 - window) * np.nanmax(np.where(np.isfinite(release), x, np.nan))) & np.isfinite(
        release
    )
    behind = np.isfinite(stick) & (x > 0.0)
    return {
        "front_speed": straight_line(release[passed], x[passed])[0],
        "first_stick_time": float(np.nanmin(stick)),
        "pulse_slip": float(slip[behind][-1]),
    }
