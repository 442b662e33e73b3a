"""Study friction that is linear in slip rate: the limit beyond which pulses do not stick.

The friction has a term -alpha du/dt, where alpha is the rate strengthening. Some ruptures have leaf
springs and some do not. They come from lattices and from the exact solution.
"""

from functools import cache
from itertools import product
from typing import Any, NamedTuple

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

from .right_side import (
    CRACK,
    CREEPING,
    STICKING,
    PulseSize,
    pulse_at,
    right_of_centre,
    sliding_part,
)

NEEDS = {"settings": ["measure"]}

GAMMA = 0.65
DAMPING_RATIO = 0.1
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Rate strengthening of the lattices, divided by the critical value at each level.
CRITICAL_FRACTIONS = (-1.1, -1.05, -0.95, -0.9, -0.5, 0.0, 0.5, 0.9, 0.95, 1.05, 1.1, 1.5)
# Spacing divided by the level, because the pulse width is proportional to the level.
SPACING_OVER_LEVEL = 0.12
# With this order and step the decay behind a crack ends by rounding or by the nucleation.
ORDER, MAX_STEP = 8, 0.25
# A pulse becomes steady over a time inversely proportional to the excess of the front speed over
# the wave speed; the run lasts MEMORY_TIMES such times, at least MIN_DURATION.
MIN_DURATION = 30.0
MEMORY_TIMES = 5.0
# A rupture without a trailing edge is recognised by its sliding region, which grows by more than
# this factor over the second half of a run, or by velocities below this fraction of the largest.
MIN_GROWTH = 1.1
QUIET_VELOCITY = 1e-9
# Level at which widths, slips and maps are shown; end time and critical fractions of the maps.
SHOWN_LEVEL = 0.5
MAP_END = 14.0
MAPPED_FRACTIONS = {STICKING: 0.6, CREEPING: 1.5}
# Numbers of times and of positions of a map.
MAP_SHAPE = (57, 96)
# Runs without leaf springs: rate strengthening, pre-stress, spacings and times.
ALPHAS = (0.0, 0.5, 2.0)
ARRESTING_PRESTRESS = Prestress(-0.5, 0.0)
SPACINGS = (0.05, 0.025)
TIMES = np.geomspace(2.0, 100.0, 21)


class Front(NamedTuple):
    """The speed of a front, and the rate strengthening above which its pulse does not stick."""

    speed: float
    critical: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of the parts of the figure, which the column role names.

    With leaf springs:

    lattice : regime and pulse of lattice runs, by level and rate strengthening
    limit : the critical rate strengthening by level
    steady : exact pulses at SHOWN_LEVEL, by rate strengthening
    map : slip velocity of two exact ruptures

    Without leaf springs:

    arrest : left front and largest velocity as functions of time, on lattices
    asymptote : the same two, as theory predicts them for late times
    """
    still_fraction = settings["measure"]["still"]
    critical = _front(SHOWN_LEVEL).critical
    maps = [_map(regime, fraction * critical) for regime, fraction in MAPPED_FRACTIONS.items()]
    arrests = [_arrest(alpha, dx) for alpha, dx in product(ALPHAS, SPACINGS)]
    parts = {
        "lattice": _lattices(still_fraction),
        "limit": _limit(),
        "steady": _steady_pulses(),
        "map": pd.concat(maps),
        "arrest": pd.concat(arrests),
        "asymptote": pd.concat([_asymptote(alpha) for alpha in ALPHAS if alpha > 0.0]),
    }
    tables_by_role = [rows.assign(role=role) for role, rows in parts.items()]
    table = pd.concat(tables_by_role, ignore_index=True)
    return table.assign(gamma=GAMMA, damping_ratio=DAMPING_RATIO)


@cache
def _front(level: float) -> Front:
    """Return the front in a uniform pre-stress; rate strengthening does not change its speed."""
    speed = float(front_speed(level, DAMPING_RATIO))
    return Front(speed, critical_rate_strengthening(GAMMA, speed))


def _lattices(still_fraction: float) -> pd.DataFrame:
    """Run lattices at all levels and fractions of the critical rate strengthening."""
    # Below this value slip grows without bound, and the model refuses it.
    smallest_alpha = -2.0 * np.sqrt(GAMMA)
    rows = []
    for level, fraction in product(LEVELS, CRITICAL_FRACTIONS):
        if fraction * _front(level).critical > smallest_alpha:
            rows.append(_lattice(level, fraction, still_fraction))
    return pd.DataFrame(rows)


def _limit() -> pd.DataFrame:
    """Return the critical rate strengthening as a function of the level."""
    levels = np.linspace(0.05, 0.9, 60)
    critical = [_front(level).critical for level in levels]
    return pd.DataFrame({"level": levels, "rate_strengthening": critical})


def _steady_pulses() -> pd.DataFrame:
    """Return width and slip of steady pulses at SHOWN_LEVEL, up to near the critical value."""
    speed, critical = _front(SHOWN_LEVEL)
    rows = []
    for alpha in critical * np.linspace(-0.97, 0.97, 80):
        # In the limit dx -> 0 damping acts only through the front speed.
        pulse = steady_pulse(SHOWN_LEVEL, GAMMA, 0.0, speed, rate_strengthening=alpha)
        rows.append((pulse.rate_strengthening, pulse.width, pulse.slip))
    return pd.DataFrame(rows, columns=["rate_strengthening", "pulse_width", "pulse_slip"])


def _lattice(level: float, fraction: float, still_fraction: float) -> dict[str, Any]:
    """Simulate one run and return its regime and pulse; NaN if the pulse does not stick.

    fraction : rate strengthening divided by the critical value
    still_fraction : fraction of the largest velocity below which the centre of a pulse counts as at
        rest
    """
    speed, critical = _front(level)
    alpha, dx = fraction * critical, SPACING_OVER_LEVEL * level
    duration = MIN_DURATION + MEMORY_TIMES / (speed - 1.0)
    scene = Scene(
        boundary="displacement",
        prestress=Prestress(level, level),
        duration=duration,
        dx=dx,
        gamma=GAMMA,
        beta=DAMPING_RATIO * dx,
        order=ORDER,
        max_step=MAX_STEP,
        friction=LinearRate(alpha),
    )
    run = simulate_on_lattice(scene)
    regime, pulse = _regime_and_pulse(run, duration, still_fraction)
    return {
        "level": level,
        "rate_strengthening": alpha,
        "over_critical": fraction,
        "dx": dx,
        "regime": regime,
        "run_flags": run.attrs["run_flags"],
        "pulse_width": pulse.width,
        "pulse_slip": pulse.slip,
    }


def _regime_and_pulse(
    run: xr.Dataset, duration: float, still_fraction: float
) -> tuple[str, PulseSize]:
    """Return the regime at the end of a run, and the pulse; its size is NaN if it does not stick.

    If no block sticks behind the pulse, the sliding part keeps growing, or ends in a tail of tiny
    velocities.
    """
    right = right_of_centre(run)
    halfway, end = sliding_part(right, 0.5 * duration), sliding_part(right, duration)
    velocity = right["slip_velocity"].values
    largest = velocity.max()
    # The innermost block that still slides is the first one with a velocity above 0.
    innermost_velocity = velocity[velocity > 0.0][0]
    keeps_growing = end.width >= MIN_GROWTH * halfway.width
    has_quiet_tail = innermost_velocity / largest <= QUIET_VELOCITY
    if not keeps_growing and not has_quiet_tail:
        return STICKING, pulse_at(right, duration)
    centre_velocity = float(run["slip_velocity"].sel(x=0.0, method="nearest"))
    regime = CREEPING if is_pulse(centre_velocity, largest, still_fraction) else CRACK
    return regime, PulseSize(np.nan, np.nan)


def _map(regime: str, alpha: float) -> pd.DataFrame:
    """Return slip velocities of an exact rupture by time and position.

    A sticking pulse runs to the left and a creeping one to the right, so that both fit into one
    map.
    """
    prestress = Prestress(SHOWN_LEVEL, SHOWN_LEVEL)
    rupture = Rupture(prestress, GAMMA, DAMPING_RATIO, duration=MAP_END, rate_strengthening=alpha)
    time_count, position_count = MAP_SHAPE
    times = np.linspace(0.0, MAP_END, time_count)
    right_end = rupture.front_ends[0][1].x
    x = np.linspace(0.0, right_end, position_count)
    velocity = rupture.map(times, x, ("slip_velocity",))["slip_velocity"]
    drawn_x = x if regime == CREEPING else -x
    grid = xr.DataArray(velocity, [("time", times), ("position", drawn_x)], name="slip_velocity")
    rows = grid.to_series().reset_index()
    return rows.assign(regime=regime, rate_strengthening=alpha, level=SHOWN_LEVEL)


def _arrest(alpha: float, dx: float) -> pd.DataFrame:
    """Return the left front and the largest velocity at TIMES, on a lattice without leaf springs.

    The column gap has the distance that the front has yet to run to its final position x_minus.
    """
    duration = float(TIMES[-1])
    scene = Scene(
        boundary="stress",
        prestress=ARRESTING_PRESTRESS,
        duration=duration,
        dx=dx,
        gamma=0.0,
        beta=DAMPING_RATIO * dx,
        friction=LinearRate(alpha),
        max_step=0.4,
    )
    sampled_x = np.arange(-8.0, duration + 10.0, 0.25)
    run = simulate_on_lattice(scene, Samples(TIMES, sampled_x))
    x, release_time = run["x"].values, run["release_time"].values
    left_front = np.array([x[release_time <= time].min() for time in TIMES])
    columns = {
        "time": TIMES,
        "largest_velocity": run["sample_velocity"].values.max(axis=1),
        "gap": left_front - prestress_balance_position(ARRESTING_PRESTRESS),
    }
    return pd.DataFrame(columns | {"rate_strengthening": alpha, "dx": dx})


def _asymptote(alpha: float) -> pd.DataFrame:
    """Return the left front and the largest velocity that `_arrest` approaches at late times.

    Then slip spreads by diffusion from x_minus: it is U erfc(y sqrt(alpha/t)/2) at the distance y
    from there.
    """
    x_minus = prestress_balance_position(ARRESTING_PRESTRESS)
    x = np.linspace(x_minus, 12.0, 20_001)
    # U is the first moment of the pre-stress about x_minus.
    final_slip = float(np.trapezoid((x - x_minus) * ARRESTING_PRESTRESS(x), x))
    columns = {
        "time": TIMES,
        "largest_velocity": final_slip / (np.sqrt(2.0 * np.pi * np.e) * TIMES),
        "gap": -final_slip / ARRESTING_PRESTRESS.left * np.sqrt(alpha / (np.pi * TIMES)),
    }
    return pd.DataFrame(columns | {"rate_strengthening": alpha})
