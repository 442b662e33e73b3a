"""Friction that depends linearly on slip rate: where pulses end, and what becomes of them without leaf springs."""

from functools import cache

import numpy as np
import pandas as pd
import xarray as xr

from ..model.prestress import Prestress, prestress_balance_position
from ..model.samples import Samples
from ..model.scene import Scene
from ..simulation.runs import simulate_on_lattice
from ..theory.front_speeds import front_speed
from ..theory.pulse import critical_rate_strengthening, pulse_behind_front
from ..theory.rupture import Rupture

NEEDS = {}  # type: dict[str, list[str]]

GAMMA, RATIO = 0.65, 0.1
# Rate strengthening of the lattices, over the critical one at each pre-stress.
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
FRACTIONS = (-1.1, -1.05, -0.95, -0.9, -0.5, 0.0, 0.5, 0.9, 0.95, 1.05, 1.1, 1.5)
# Spacing over pre-stress, to which the width of a pulse is proportional; and a step so short and of such an order that
# rounding, or what the nucleation leaves behind, ends the exponential decay behind a crack.
SPACING, ORDER, MAX_STEP = 0.12, 8, 0.25
# Long enough for the trailing edge to be steady: it learns of the front at the rate by which that outruns the waves.
SHORTEST, MEMORIES = 30.0, 5.0
# A sliding part that grows by more than this over the second half of a run, or whose velocity decays below this
# fraction of the largest before it ends, is a crack.
GROWTH, QUIET = 1.1, 1e-9
# The level at which widths, slips and maps are shown; the maps' fractions, end and samples.
LEVEL, MAPPED, END, MAP = 0.5, {"pulse": 0.6, "crack": 1.5}, 14.0, (57, 96)
# Without leaf springs: rate strengthening, pre-stress, spacings and times.
ALPHAS, ARRESTING, SPACINGS = (0.0, 0.5, 2.0), Prestress(-0.5, 0.0), (0.05, 0.025)
TIMES = np.geomspace(2.0, 100.0, 21)
LATTICE = [
    "level", "rate_strengthening", "over_critical", "dx", "regime", "run_flags", "pulse_width", "pulse_slip"
]  # fmt: skip


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Role: lattice (LATTICE; over_critical: over the critical one, which limit has at each level), steady
    (rate_strengthening, pulse_width, pulse_slip), map (regime, time, position, slip_velocity), arrest (dx,
    rate_strengthening, time, largest_velocity, gap: distance of the left front from the balance of the pre-stress) and
    asymptote (the same).
    """
    lattices = [row for level in LEVELS for each in FRACTIONS if (row := _lattice(level, each))]
    limit = [(level, _front(level)[1]) for level in np.linspace(0.05, 0.9, 60)]
    speed, critical = _front(LEVEL)
    alphas = critical * np.linspace(-0.97, 0.97, 80)
    pulses = [pulse_behind_front(LEVEL, GAMMA, 0.0, speed, alpha) for alpha in alphas]
    steady = [(each.rate_strengthening, each.width, each.slip) for each in pulses]
    parts = {
        "lattice": pd.DataFrame(lattices, columns=LATTICE),
        "limit": pd.DataFrame(limit, columns=["level", "rate_strengthening"]),
        "steady": pd.DataFrame(steady, columns=["rate_strengthening", "pulse_width", "pulse_slip"]),
        "map": pd.concat(
            [_map(regime, fraction * critical) for regime, fraction in MAPPED.items()]
        ),
        "arrest": pd.concat([_arrest(alpha, dx) for alpha in ALPHAS for dx in SPACINGS]),
        "asymptote": pd.concat([_asymptote(alpha) for alpha in ALPHAS if alpha]),
    }
    rows = [rows.assign(role=role) for role, rows in parts.items()]
    return pd.concat(rows, ignore_index=True).assign(gamma=GAMMA, damping_ratio=RATIO)


@cache
def _front(level: float) -> tuple[float, float]:
    """Speed of a front, and the critical rate strengthening behind it."""
    speed = float(front_speed(level, RATIO))
    return speed, critical_rate_strengthening(GAMMA, speed)


def _lattice(level: float, fraction: float) -> tuple:
    """One run, its regime and its pulse; empty where the model refuses it, since slip runs away."""
    speed, critical = _front(level)
    alpha, dx, duration = fraction * critical, SPACING * level, SHORTEST + MEMORIES / (speed - 1.0)
    if alpha <= -2.0 * np.sqrt(GAMMA):
        return ()
    of = ("displacement", Prestress(level, level), duration, dx, GAMMA, RATIO * dx)
    run = simulate_on_lattice(Scene(*of, order=ORDER, max_step=MAX_STEP, rate_strengthening=alpha))
    right = run["x"].values > 0.5 * dx
    names = ("x", "stick_time", "release_time", "slip_velocity", "slip")
    x, stick, release, velocity, slip = (run[name].values[right] for name in names)
    # Between the outermost blocks that have stuck and that have been released, at the end and half-way to it.
    times = duration, 0.5 * duration
    stuck, released = (
        [x[known <= time].max(initial=0.0) for time in times] for known in (stick, release)
    )
    width, earlier = np.subtract(released, stuck)
    # From the front backwards, the last that slides.
    slowest = velocity[velocity > 0.0][0] / velocity.max()
    pulse = width < GROWTH * earlier and slowest > QUIET
    shape = (width, slip[np.argmin(np.abs(x - stuck[0]))]) if pulse else (np.nan, np.nan)
    return level, alpha, fraction, dx, "pulse" if pulse else "crack", run.attrs["run_flags"], *shape


def _map(regime: str, alpha: float) -> pd.DataFrame:
    """The exact rupture; to the left the pulse, to the right the crack."""
    rupture = Rupture(Prestress(LEVEL, LEVEL), GAMMA, RATIO, duration=END, rate_strengthening=alpha)
    times, x = np.linspace(0.0, END, MAP[0]), np.linspace(0.0, rupture.front_ends[0][1].x, MAP[1])
    velocity = rupture.map(times, x, ("slip_velocity",))["slip_velocity"]
    axes = [("time", times), ("position", x if regime == "crack" else -x)]
    rows = xr.DataArray(velocity, axes, name="slip_velocity").to_series().reset_index()
    return rows.assign(regime=regime, rate_strengthening=alpha, level=LEVEL)


def _arrest(alpha: float, dx: float) -> pd.DataFrame:
    of = ("stress", ARRESTING, float(TIMES[-1]), dx, 0.0, RATIO * dx)
    samples = Samples(TIMES, np.arange(-8.0, TIMES[-1] + 10.0, 0.25))
    run = simulate_on_lattice(Scene(*of, rate_strengthening=alpha, max_step=0.4), samples)
    x, release = run["x"].values, run["release_time"].values
    front = np.array([x[release <= time].min() for time in TIMES])
    found = {"time": TIMES, "largest_velocity": run["sample_velocity"].values.max(axis=1)}
    found["gap"] = front - prestress_balance_position(ARRESTING)
    return pd.DataFrame(found | {"rate_strengthening": alpha, "dx": dx})


def _asymptote(alpha: float) -> pd.DataFrame:
    """What diffusion makes of it: slip U erfc(y sqrt(alpha/t)/2) at y from the balance of the pre-stress."""
    balance = prestress_balance_position(ARRESTING)
    x = np.linspace(balance, 12.0, 20_001)
    slip = float(np.trapezoid((x - balance) * ARRESTING(x), x))
    found = {"time": TIMES, "largest_velocity": slip / (np.sqrt(2.0 * np.pi * np.e) * TIMES)}
    found["gap"] = -slip / ARRESTING.left * np.sqrt(alpha / (np.pi * TIMES))
    return pd.DataFrame(found | {"rate_strengthening": alpha})
