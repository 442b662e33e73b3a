"""Friction linear in slip rate: where pulses cease to stick, with and without leaf springs."""

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

GAMMA, RATIO = 0.65, 0.1
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Rate strengthening of the lattices, over the critical one at each level.
FRACTIONS = (-1.1, -1.05, -0.95, -0.9, -0.5, 0.0, 0.5, 0.9, 0.95, 1.05, 1.1, 1.5)
# Spacing over level, to which the width of a pulse is proportional.
SPACING = 0.12
# Such a step and order leave rounding, or the nucleation, to end the decay behind a crack.
ORDER, MAX_STEP = 8, 0.25
# The trailing edge learns of the front at the rate by which that outruns the waves: a pulse is
# steady after MEMORIES of the times that this takes over one thickness.
SHORTEST, MEMORIES = 30.0, 5.0
# The sliding part behind a front that nothing follows grows by more than this over the second half
# of a run, or its velocity decays below this fraction of the largest before it ends.
GROWTH, QUIET = 1.1, 1e-9
# Widths, slips and maps are shown at this level; the maps at these fractions, to this end.
LEVEL, END = 0.5, 14.0
MAPPED, MAP_SHAPE = {STICKING: 0.6, CREEPING: 1.5}, (57, 96)
# Without leaf springs: rate strengthening, pre-stress, spacings and times.
ALPHAS, ARRESTING = (0.0, 0.5, 2.0), Prestress(-0.5, 0.0)
SPACINGS, TIMES = (0.05, 0.025), np.geomspace(2.0, 100.0, 21)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Roles lattice, limit, steady and map (at LEVEL), arrest and asymptote (no leaf springs)."""
    lattices = []
    for level, fraction in product(LEVELS, FRACTIONS):
        # Slip runs away beyond this: the model refuses it.
        if fraction * _front(level)[1] > -2.0 * np.sqrt(GAMMA):
            lattices.append(_lattice(level, fraction, settings["measure"]["still"]))
    limit = [(level, _front(level)[1]) for level in np.linspace(0.05, 0.9, 60)]
    speed, critical = _front(LEVEL)
    alphas = critical * np.linspace(-0.97, 0.97, 80)
    pulses = [steady_pulse(LEVEL, GAMMA, 0.0, speed, rate_strengthening=one) for one in alphas]
    steady = [(pulse.rate_strengthening, pulse.width, pulse.slip) for pulse in pulses]
    maps = [_map(regime, fraction * critical) for regime, fraction in MAPPED.items()]
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
    return pd.concat(rows, ignore_index=True).assign(gamma=GAMMA, damping_ratio=RATIO)


@cache
def _front(level: float) -> tuple[float, float]:
    """Speed of a front, and the critical rate strengthening behind it."""
    speed = float(front_speed(level, RATIO))
    return speed, critical_rate_strengthening(GAMMA, speed)


def _lattice(level: float, fraction: float, still: float) -> dict[str, Any]:
    """One run, its regime and its pulse; NaN for the numbers of what does not stick."""
    speed, critical = _front(level)
    alpha, dx = fraction * critical, SPACING * level
    duration = SHORTEST + MEMORIES / (speed - 1.0)
    numbers: dict[str, Any] = {"order": ORDER, "max_step": MAX_STEP, "friction": LinearRate(alpha)}
    profile = Prestress(level, level)
    scene = Scene("displacement", profile, duration, dx, GAMMA, RATIO * dx, **numbers)
    run = simulate_on_lattice(scene)
    right = right_of_centre(run)
    (stuck, front), halfway = (sliding_part(right, time) for time in (duration, 0.5 * duration))
    velocity = right["slip_velocity"].values
    # The last block that slides, from the front backwards.
    slowest = velocity[velocity > 0.0][0] / velocity.max()
    regime, (width, slip) = STICKING, pulse_at(right, duration)
    if front - stuck >= GROWTH * (halfway[1] - halfway[0]) or slowest <= QUIET:
        centre = float(run["slip_velocity"].sel(x=0.0, method="nearest"))
        regime = CREEPING if is_pulse(centre, velocity.max(), still) else CRACK
        width = slip = np.nan
    row: dict[str, Any] = {"level": level, "rate_strengthening": alpha, "over_critical": fraction}
    row |= {"dx": dx, "regime": regime, "run_flags": run.attrs["run_flags"]}
    return row | {"pulse_width": width, "pulse_slip": slip}


def _map(regime: str, alpha: float) -> pd.DataFrame:
    """The exact rupture; to the left the sticking pulse, to the right the creeping one."""
    rupture = Rupture(Prestress(LEVEL, LEVEL), GAMMA, RATIO, duration=END, rate_strengthening=alpha)
    times = np.linspace(0.0, END, MAP_SHAPE[0])
    x = np.linspace(0.0, rupture.front_ends[0][1].x, MAP_SHAPE[1])
    velocity = rupture.map(times, x, ("slip_velocity",))["slip_velocity"]
    axes = [("time", times), ("position", x if regime == CREEPING else -x)]
    rows = xr.DataArray(velocity, axes, name="slip_velocity").to_series().reset_index()
    return rows.assign(regime=regime, rate_strengthening=alpha, level=LEVEL)


def _arrest(alpha: float, dx: float) -> pd.DataFrame:
    """A left front without leaf springs over time, on a lattice."""
    numbers: dict[str, Any] = {"friction": LinearRate(alpha), "max_step": 0.4}
    scene = Scene("stress", ARRESTING, float(TIMES[-1]), dx, 0.0, RATIO * dx, **numbers)
    run = simulate_on_lattice(scene, Samples(TIMES, np.arange(-8.0, TIMES[-1] + 10.0, 0.25)))
    x, release = run["x"].values, run["release_time"].values
    front = np.array([x[release <= time].min() for time in TIMES])
    velocity = run["sample_velocity"].values.max(axis=1)
    columns = {"time": TIMES, "largest_velocity": velocity}
    columns["gap"] = front - prestress_balance_position(ARRESTING)
    return pd.DataFrame(columns | {"rate_strengthening": alpha, "dx": dx})


def _asymptote(alpha: float) -> pd.DataFrame:
    """The limit of late times by diffusion: slip U erfc(y sqrt(alpha/t)/2), y from the balance."""
    balance = prestress_balance_position(ARRESTING)
    x = np.linspace(balance, 12.0, 20_001)
    slip = float(np.trapezoid((x - balance) * ARRESTING(x), x))
    velocity = slip / (np.sqrt(2.0 * np.pi * np.e) * TIMES)
    gap = -slip / ARRESTING.left * np.sqrt(alpha / (np.pi * TIMES))
    columns = {"time": TIMES, "largest_velocity": velocity, "gap": gap}
    return pd.DataFrame(columns | {"rate_strengthening": alpha})
