"""Study friction that is linear in slip rate: the limit beyond which pulses do not stick.

Ruptures have leaf springs or not, and come from lattices and from the exact solution.
"""

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.measurement.regime import is_pulse
from slippulse.model.balance import prestress_balance_position
from slippulse.model.friction_laws.rate import LinearRate
from slippulse.model.prestress import Prestress
from slippulse.model.samples import Samples
from slippulse.model.scene import Scene
from slippulse.simulation.sweep import simulate_on_lattice
from slippulse.theory.closed_pulse import critical_rate_strengthening
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.pulse import steady_pulse
from slippulse.theory.rupture import Rupture

from .right_side import CRACK, CREEPING, STICKING, pulse_at, right_of_centre, sliding_part

NEEDS = {"settings": ["measure"]}

GAMMA, DAMPING_RATIO = 0.65, 0.1
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Rate strengthening of the lattices, divided by the critical value at each level.
CRITICAL_FRACTIONS = (-1.1, -1.05, -0.95, -0.9, -0.5, 0.0, 0.5, 0.9, 0.95, 1.05, 1.1, 1.5)
# Spacing divided by the level, because the pulse width is proportional to the level.
SPACING_OVER_LEVEL = 0.12
# With this order and step the decay behind a crack ends by rounding or by the nucleation.
ORDER, MAX_STEP = 8, 0.25
# A pulse becomes steady over a time inversely proportional to the excess of the front speed over
# the wave speed; the run lasts MEMORY_TIMES such times, at least MIN_DURATION.
MIN_DURATION, MEMORY_TIMES = 30.0, 5.0
# A rupture without a trailing edge is recognised by its sliding region, which grows by more than
# this factor over the second half of a run, or by velocities below this fraction of the largest.
MIN_GROWTH, QUIET_VELOCITY = 1.1, 1e-9
# Level at which widths, slips and maps are shown; end time and critical fractions of the maps.
SHOWN_LEVEL, MAP_END = 0.5, 14.0
MAPPED_FRACTIONS, MAP_SHAPE = {STICKING: 0.6, CREEPING: 1.5}, (57, 96)
# Runs without leaf springs: rate strengthening, pre-stress, spacings and times.
ALPHAS, ARRESTING_PRESTRESS = (0.0, 0.5, 2.0), Prestress(-0.5, 0.0)
SPACINGS, TIMES = (0.05, 0.025), np.geomspace(2.0, 100.0, 21)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles lattice, limit, steady and map, and arrest and asymptote (no springs)."""
    lattices = []
    for level, fraction in product(LEVELS, CRITICAL_FRACTIONS):
        # Beyond this value slip grows without bound, and the model refuses it.
        if fraction * _front(level)[1] > -2.0 * np.sqrt(GAMMA):
            lattices.append(_lattice(level, fraction, settings["measure"]["still"]))
    limit = [(level, _front(level)[1]) for level in np.linspace(0.05, 0.9, 60)]
    speed, critical = _front(SHOWN_LEVEL)
    alphas = critical * np.linspace(-0.97, 0.97, 80)
    pulses = [
        steady_pulse(SHOWN_LEVEL, GAMMA, 0.0, speed, rate_strengthening=one) for one in alphas
    ]
    steady = [(pulse.rate_strengthening, pulse.width, pulse.slip) for pulse in pulses]
    maps = [_map(regime, fraction * critical) for regime, fraction in MAPPED_FRACTIONS.items()]
    arrests = [_arrest(alpha, dx) for alpha, dx in product(ALPHAS, SPACINGS)]
    parts = {
        "lattice": pd.DataFrame(lattices),
        "limit": pd.DataFrame(limit, columns=["level", "rate_strengthening"]),
        "steady": pd.DataFrame(steady, columns=["rate_strengthening", "pulse_width", "pulse_slip"]),
        "map": pd.concat(maps),
        "arrest": pd.concat(arrests),
        "asymptote": pd.concat([_asymptote(alpha) for alpha in ALPHAS if alpha]),
    }
    rows = [rows.assign(role=role) for role, rows in parts.items()]
    return pd.concat(rows, ignore_index=True).assign(gamma=GAMMA, damping_ratio=DAMPING_RATIO)


@cache
def _front(level: float) -> tuple[float, float]:
    """Return the speed of a front and the critical rate strengthening."""
    speed = float(front_speed(level, DAMPING_RATIO))
    return speed, critical_rate_strengthening(GAMMA, speed)


def _lattice(level: float, fraction: float, still: float) -> dict[str, Any]:
    """Simulate one run and return its regime and pulse; NaN if the pulse does not stick."""
    speed, critical = _front(level)
    alpha, dx = fraction * critical, SPACING_OVER_LEVEL * level
    duration = MIN_DURATION + MEMORY_TIMES / (speed - 1.0)
    numbers: dict[str, Any] = {"order": ORDER, "max_step": MAX_STEP, "friction": LinearRate(alpha)}
    profile = Prestress(level, level)
    scene = Scene("displacement", profile, duration, dx, GAMMA, DAMPING_RATIO * dx, **numbers)
    run = simulate_on_lattice(scene)
    right = right_of_centre(run)
    (stuck, front), halfway = (sliding_part(right, time) for time in (duration, 0.5 * duration))
    velocity = right["slip_velocity"].values
    # Find the last sliding block behind the front.
    slowest = velocity[velocity > 0.0][0] / velocity.max()
    regime, (width, slip) = STICKING, pulse_at(right, duration)
    if front - stuck >= MIN_GROWTH * (halfway[1] - halfway[0]) or slowest <= QUIET_VELOCITY:
        centre = float(run["slip_velocity"].sel(x=0.0, method="nearest"))
        regime = CREEPING if is_pulse(centre, velocity.max(), still) else CRACK
        width = slip = np.nan
    row: dict[str, Any] = {"level": level, "rate_strengthening": alpha, "over_critical": fraction}
    row |= {"dx": dx, "regime": regime, "run_flags": run.attrs["run_flags"]}
    return row | {"pulse_width": width, "pulse_slip": slip}


def _map(regime: str, alpha: float) -> pd.DataFrame:
    """Return the exact rupture: a sticking pulse to the left, a creeping one to the right."""
    rupture = Rupture(
        Prestress(SHOWN_LEVEL, SHOWN_LEVEL),
        GAMMA,
        DAMPING_RATIO,
        duration=MAP_END,
        rate_strengthening=alpha,
    )
    times = np.linspace(0.0, MAP_END, MAP_SHAPE[0])
    x = np.linspace(0.0, rupture.front_ends[0][1].x, MAP_SHAPE[1])
    velocity = rupture.map(times, x, ("slip_velocity",))["slip_velocity"]
    axes = [("time", times), ("position", x if regime == CREEPING else -x)]
    rows = xr.DataArray(velocity, axes, name="slip_velocity").to_series().reset_index()
    return rows.assign(regime=regime, rate_strengthening=alpha, level=SHOWN_LEVEL)


def _arrest(alpha: float, dx: float) -> pd.DataFrame:
    """Return the left front without leaf springs as a function of time, on a lattice."""
    numbers: dict[str, Any] = {"friction": LinearRate(alpha), "max_step": 0.4}
    scene = Scene(
        "stress", ARRESTING_PRESTRESS, float(TIMES[-1]), dx, 0.0, DAMPING_RATIO * dx, **numbers
    )
    run = simulate_on_lattice(scene, Samples(TIMES, np.arange(-8.0, TIMES[-1] + 10.0, 0.25)))
    x, release = run["x"].values, run["release_time"].values
    front = np.array([x[release <= time].min() for time in TIMES])
    velocity = run["sample_velocity"].values.max(axis=1)
    columns = {"time": TIMES, "largest_velocity": velocity}
    columns["gap"] = front - prestress_balance_position(ARRESTING_PRESTRESS)
    return pd.DataFrame(columns | {"rate_strengthening": alpha, "dx": dx})


def _asymptote(alpha: float) -> pd.DataFrame:
    """Return the limit at late times, by diffusion: slip U erfc(y sqrt(alpha/t)/2).

    The distance y is measured from x_minus.
    """
    balance = prestress_balance_position(ARRESTING_PRESTRESS)
    x = np.linspace(balance, 12.0, 20_001)
    slip = float(np.trapezoid((x - balance) * ARRESTING_PRESTRESS(x), x))
    velocity = slip / (np.sqrt(2.0 * np.pi * np.e) * TIMES)
    gap = -slip / ARRESTING_PRESTRESS.left * np.sqrt(alpha / (np.pi * TIMES))
    columns = {"time": TIMES, "largest_velocity": velocity, "gap": gap}
    return pd.DataFrame(columns | {"rate_strengthening": alpha})
