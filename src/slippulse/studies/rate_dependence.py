"""Friction that depends linearly on slip rate: where pulses end, and what becomes of them without leaf springs."""

import numpy as np
import pandas as pd
import xarray as xr

from ..model.prestress import Prestress, prestress_balance_position
from ..model.samples import Samples
from ..model.scene import Scene
from ..simulation.runs import simulate_on_lattice
from ..theory.front_law import front_speed
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


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Lattices of both boundaries, and the exact theory.

    Returns role: lattice (level, rate_strengthening, over_critical: over the critical one, regime, run_flags, and of
    pulses pulse_width, pulse_slip), limit (level, rate_strengthening: the critical one), steady (rate_strengthening,
    pulse_width, pulse_slip), map (regime, time, position, slip_velocity), arrest (dx, rate_strengthening, time,
    largest_velocity, gap: distance of the left front from the balance of the pre-stress) and asymptote (the same)
    """
    # Slip runs away where the model refuses a scene.
    lattices = [
        _lattice(level, speed, fraction, alpha)
        for level, speed, critical in _fronts(LEVELS)
        for fraction, alpha in zip(FRACTIONS, np.multiply(FRACTIONS, critical).tolist(), strict=True)
        if alpha > -2.0 * np.sqrt(GAMMA)
    ]
    limit = [(level, critical) for level, _, critical in _fronts(np.linspace(0.05, 0.9, 60))]
    ((_, speed, critical),) = _fronts([LEVEL])
    pulses = [
        pulse_behind_front(LEVEL, GAMMA, 0.0, speed, each * critical) for each in np.linspace(-0.97, 0.97, 80)
    ]
    steady = [(each.rate_strengthening, each.width, each.slip) for each in pulses]
    parts = {
        "lattice": pd.DataFrame(lattices),
        "limit": pd.DataFrame(limit, columns=["level", "rate_strengthening"]),
        "steady": pd.DataFrame(steady, columns=["rate_strengthening", "pulse_width", "pulse_slip"]),
        "map": pd.concat([_map(regime, fraction * critical) for regime, fraction in MAPPED.items()]),
        "arrest": pd.concat([_arrest(alpha, dx) for alpha in ALPHAS for dx in SPACINGS]),
        "asymptote": pd.concat([_asymptote(alpha) for alpha in ALPHAS if alpha]),
    }
    rows = [rows.assign(role=role) for role, rows in parts.items()]
    return pd.concat(rows, ignore_index=True).assign(gamma=GAMMA, damping_ratio=RATIO)


def _fronts(levels) -> list[tuple[float, float, float]]:
    """Levels, each with its front speed and its critical rate strengthening."""
    speeds = front_speed(np.array(levels), RATIO).tolist()
    return [
        (level, speed, critical_rate_strengthening(GAMMA, speed))
        for level, speed in zip(levels, speeds, strict=True)
    ]


def _lattice(level: float, speed: float, fraction: float, alpha: float) -> dict:
    """One run, its regime and its pulse."""
    dx, duration = SPACING * level, SHORTEST + MEMORIES / (speed - 1.0)
    of = ("displacement", Prestress(level, level), duration, dx, GAMMA, RATIO * dx)
    run = simulate_on_lattice(Scene(*of, order=ORDER, max_step=MAX_STEP, rate_strengthening=alpha))
    right = run["x"].values > 0.5 * dx
    names = ("x", "stick_time", "release_time", "slip_velocity", "slip")
    x, stick, release, velocity, slip = (run[name].values[right] for name in names)
    (start, end), (earlier_start, earlier_end) = (
        # The outermost blocks that have stuck and that have been released.
        [float(x[times <= time].max(initial=0.0)) for times in (stick, release)]
        for time in (duration, 0.5 * duration)
    )
    # From the front backwards, the last that slides.
    slowest = velocity[velocity > 0.0][0] / velocity.max()
    pulse = end - start < GROWTH * (earlier_end - earlier_start) and slowest > QUIET
    found = {"pulse_width": end - start, "pulse_slip": float(slip[np.argmin(np.abs(x - start))])}
    return {
        "level": level, "rate_strengthening": alpha, "over_critical": fraction, "dx": dx,
        "regime": "pulse" if pulse else "crack", "run_flags": run.attrs["run_flags"], **(found if pulse else {}),
    }  # fmt: skip


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
    left = run.where(run["x"] < 0.0, drop=True)
    front = np.array([float(left["x"].values[left["release_time"].values <= time].min()) for time in TIMES])
    values = {"time": TIMES, "largest_velocity": run["sample_velocity"].values.max(axis=1)}
    values["gap"] = front - prestress_balance_position(ARRESTING)
    return pd.DataFrame(values).assign(rate_strengthening=alpha, dx=dx)


def _asymptote(alpha: float) -> pd.DataFrame:
    """What diffusion makes of it: slip U erfc(y sqrt(alpha/t)/2) at y from the balance of the pre-stress."""
    balance = prestress_balance_position(ARRESTING)
    x = np.linspace(balance, 12.0, 20_001)
    slip = float(np.trapezoid((x - balance) * ARRESTING(x), x))
    values = {"time": TIMES, "largest_velocity": slip / (np.sqrt(2.0 * np.pi * np.e) * TIMES)}
    values["gap"] = -slip / ARRESTING.left * np.sqrt(alpha / (np.pi * TIMES))
    return pd.DataFrame(values).assign(rate_strengthening=alpha)
