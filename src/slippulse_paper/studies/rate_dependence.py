"""Study ruptures under friction that is linear in the slip rate.

The equation of motion has an additional term -alpha du/dt, where alpha is the rate strengthening.
Beyond a critical alpha, pulses do not stick. Ruptures with and without leaf springs come from
lattices and from the exact solution.
"""

from functools import cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

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

from . import right_side
from .outermost_fronts import outermost_fronts
from .right_side import PulseSize

NEEDS = {"settings": ["measure"]}

GAMMA = 0.65
DAMPING_RATIO = 0.1
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Rate strengthening of the lattices, divided by the critical value at each level.
CRITICAL_FRACTIONS = (-1.1, -1.05, -0.95, -0.9, -0.5, 0.0, 0.5, 0.9, 0.95, 1.05, 1.1, 1.5)
# Spacing divided by the level, because the pulse width is proportional to the level.
SPACING_OVER_LEVEL = 0.12
# Order, and largest time step divided by dx. Both are chosen so accurate that velocities behind a
# crack decay until they are as small as rounding errors.
ORDER, MAX_STEP = 8, 0.25
# The time in which a pulse becomes steady is inversely proportional to v - 1, the excess of the
# front speed over the wave speed. A run lasts at least as long as MEMORY_TIMES/(v - 1), and at
# least MIN_DURATION.
MIN_DURATION = 30.0
MEMORY_TIMES = 5.0
# A rupture has no trailing edge if its sliding part grows by more than this factor in the second
# half of a run, or if its smallest velocity is below this fraction of its largest one.
MIN_GROWTH = 1.1
QUIET_VELOCITY = 1e-9
# Level at which the figure shows pulse widths, slips and maps of two ruptures. The maps have this
# end time, numbers of times and positions, and rate strengthening divided by the critical value.
SHOWN_LEVEL = 0.5
MAP_END = 14.0
MAP_TIME_COUNT, MAP_POSITION_COUNT = 57, 96
MAPPED_FRACTIONS = {right_side.STICKING: 0.6, right_side.CREEPING: 1.5}
# Runs without leaf springs: rate strengthening, pre-stress, spacings and times.
ALPHAS = (0.0, 0.5, 2.0)
ARRESTING_PRESTRESS = Prestress(-0.5, 0.0)
SPACINGS = (0.05, 0.025)
TIMES = np.geomspace(2.0, 100.0, 21)


class Front(NamedTuple):
    """The speed of a front, and the rate strengthening above which its pulse does not stick."""

    speed: float
    critical_alpha: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of the parts of the figure. The column ``role`` has the following values.

    With leaf springs:

    lattice : regime and pulse of lattice runs, by level and rate strengthening
    limit : the critical rate strengthening by level
    steady : exact pulses at SHOWN_LEVEL, by rate strengthening
    map : slip velocity of two exact ruptures

    Without leaf springs:

    arrest : left front and largest velocity as functions of time, on lattices
    asymptote : the same quantities, as theory predicts them for late times
    """
    # The centre of a pulse counts as at rest below this fraction of the largest velocity.
    still_fraction = settings["measure"]["still"]
    critical_alpha = _front_and_critical_alpha(SHOWN_LEVEL).critical_alpha
    maps = []
    for regime, fraction in MAPPED_FRACTIONS.items():
        maps.append(_velocity_map(regime, fraction * critical_alpha))
    arrests = [_simulated_arrest(alpha, dx) for alpha, dx in product(ALPHAS, SPACINGS)]
    parts = {
        "lattice": _lattice_rows(still_fraction),
        "limit": _critical_rate_strengthenings(),
        "steady": _steady_pulses(),
        "map": pd.concat(maps),
        "arrest": pd.concat(arrests),
        # Without rate strengthening slip spreads by waves, and there is no such asymptote.
        "asymptote": pd.concat([_asymptote(alpha) for alpha in ALPHAS if alpha > 0.0]),
    }
    tables_by_role = [rows.assign(role=role) for role, rows in parts.items()]
    table = pd.concat(tables_by_role, ignore_index=True)
    # The crack that is arrested has no leaf springs.
    is_arrest = table["role"].isin(["arrest", "asymptote"])
    return table.assign(gamma=np.where(is_arrest, 0.0, GAMMA), damping_ratio=DAMPING_RATIO)


@cache
def _front_and_critical_alpha(level: float) -> Front:
    """Return the front speed in a uniform pre-stress, and the critical rate strengthening.

    Rate strengthening does not change the front speed.
    """
    speed = float(front_speed(level, DAMPING_RATIO))
    return Front(speed, critical_rate_strengthening(GAMMA, speed))


def _lattice_rows(still_fraction: float) -> pd.DataFrame:
    """Return a row for each lattice run, at all levels and fractions of the critical alpha.

    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    # At a smaller rate strengthening slip grows without bound, and the model refuses it.
    smallest_alpha = -2.0 * np.sqrt(GAMMA)
    rows = []
    for level, fraction in product(LEVELS, CRITICAL_FRACTIONS):
        if fraction * _front_and_critical_alpha(level).critical_alpha > smallest_alpha:
            rows.append(_lattice_row(level, fraction, still_fraction))
    return pd.DataFrame(rows)


def _critical_rate_strengthenings() -> pd.DataFrame:
    """Return the critical rate strengthening as a function of the level."""
    levels = np.linspace(0.05, 0.9, 60)
    critical_alphas = [_front_and_critical_alpha(level).critical_alpha for level in levels]
    return pd.DataFrame({"level": levels, "rate_strengthening": critical_alphas})


def _steady_pulses() -> pd.DataFrame:
    """Return width and slip of exact steady pulses at the pre-stress SHOWN_LEVEL.

    The rate strengthening alpha goes up to nearly the critical one, at which the width is infinite.
    Friction with a negative alpha weakens with the slip rate.
    """
    speed, critical_alpha = _front_and_critical_alpha(SHOWN_LEVEL)
    rows = []
    for alpha in critical_alpha * np.linspace(-0.97, 0.97, 80):
        # In the limit dx -> 0 damping acts only through the front speed, so beta is 0.
        pulse = steady_pulse(SHOWN_LEVEL, GAMMA, beta=0.0, speed=speed, rate_strengthening=alpha)
        row = {"rate_strengthening": pulse.rate_strengthening}
        rows.append(row | {"pulse_width": pulse.width, "pulse_slip": pulse.slip})
    return pd.DataFrame(rows)


def _lattice_row(level: float, fraction: float, still_fraction: float) -> dict[str, Any]:
    """Simulate one run, and return its regime and the width and slip of its pulse.

    Width and slip are NaN if the pulse does not stick.

    fraction : rate strengthening divided by the critical value
    still_fraction : fraction of the largest velocity below which the centre of a pulse counts as at
        rest
    """
    front_speed_at_level, critical_alpha = _front_and_critical_alpha(level)
    alpha = fraction * critical_alpha
    # The pulse width is proportional to the level.
    dx = SPACING_OVER_LEVEL * level
    # The time in which a pulse becomes steady is proportional to 1/(v - 1).
    duration = MIN_DURATION + MEMORY_TIMES / (front_speed_at_level - 1.0)
    scene = Scene(
        boundary="displacement",
        gamma=GAMMA,
        friction=LinearRate(alpha),
        prestress=Prestress(level, level),
        dx=dx,
        beta=DAMPING_RATIO * dx,
        duration=duration,
        order=ORDER,
        max_step=MAX_STEP,
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
    """Return the regime at the end of a run, and the size of the pulse; NaN if it does not stick.

    A pulse sticks if its sliding part has stopped growing and ends at a trailing edge. Without a
    trailing edge, velocities decrease towards the centre, to less than QUIET_VELOCITY times the
    largest velocity.

    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    right = right_side.right_of_centre(run)
    halfway = right_side.sliding_part(right, 0.5 * duration)
    end = right_side.sliding_part(right, duration)
    keeps_growing = end.width >= MIN_GROWTH * halfway.width
    velocity = right["slip_velocity"].values
    largest_velocity = velocity.max()
    # The sliding block that is nearest to the centre is the first one with a velocity above 0.
    velocity_near_centre = velocity[velocity > 0.0][0]
    has_endless_tail = velocity_near_centre / largest_velocity <= QUIET_VELOCITY
    if not keeps_growing and not has_endless_tail:
        return right_side.STICKING, right_side.pulse_at(right, duration)
    centre_velocity = float(run["slip_velocity"].sel(x=0.0, method="nearest"))
    regime = right_side.regime_without_sticks(centre_velocity, largest_velocity, still_fraction)
    return regime, PulseSize(np.nan, np.nan)


def _velocity_map(regime: str, alpha: float) -> pd.DataFrame:
    """Return slip velocities of the right half of an exact rupture, by time and position.

    One map shows two ruptures, so the positions of the sticking pulse get a minus sign.
    """
    prestress = Prestress(SHOWN_LEVEL, SHOWN_LEVEL)
    rupture = Rupture(prestress, GAMMA, DAMPING_RATIO, duration=MAP_END, rate_strengthening=alpha)
    times = np.linspace(0.0, MAP_END, MAP_TIME_COUNT)
    right_end = outermost_fronts(rupture).right
    x = np.linspace(0.0, right_end.x, MAP_POSITION_COUNT)
    velocity = rupture.map(times, x, ("slip_velocity",))["slip_velocity"]
    drawn_x = x if regime == right_side.CREEPING else -x
    grid = xr.DataArray(velocity, [("time", times), ("position", drawn_x)], name="slip_velocity")
    rows = grid.to_series().reset_index()
    return rows.assign(regime=regime, rate_strengthening=alpha, level=SHOWN_LEVEL)


def _simulated_arrest(alpha: float, dx: float) -> pd.DataFrame:
    """Simulate a rupture without leaf springs, and return its left front and largest velocity.

    There is one row for each of TIMES. The column gap has the distance from the left front to
    x_minus, the position that the front approaches.
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
    # The samples cover the paths of both fronts.
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
    """Return the left front and the largest velocity at TIMES, by theory for late times.

    The column gap has the distance from the left front to x_minus, the position that the front
    approaches. At late times t the slip spreads by diffusion: at the distance y from x_minus it is
    U erfc(y sqrt(alpha/t)/2), where U is the final slip.
    """
    x_minus = prestress_balance_position(ARRESTING_PRESTRESS)
    # Beyond x = 12 the pre-stress is 0 to within rounding.
    x = np.linspace(x_minus, 12.0, 20_001)
    # The final slip is the integral of y times the pre-stress over y.
    final_slip = float(np.trapezoid((x - x_minus) * ARRESTING_PRESTRESS(x), x))
    columns = {
        "time": TIMES,
        # The largest time derivative of the slip over all y.
        "largest_velocity": final_slip / (np.sqrt(2.0 * np.pi * np.e) * TIMES),
        # The pre-stress in the gap balances the strain at x_minus, U sqrt(alpha/(pi t)).
        "gap": -final_slip / ARRESTING_PRESTRESS.left * np.sqrt(alpha / (np.pi * TIMES)),
    }
    return pd.DataFrame(columns | {"rate_strengthening": alpha})
