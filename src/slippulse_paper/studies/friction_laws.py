"""Other laws of friction: which make pulses that stick or creep, and what selects front speeds."""

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.measurement.regime import is_pulse
from slippulse.model.friction_laws.law import Friction
from slippulse.model.friction_laws.rate import BoundedRate, RateWeakening
from slippulse.model.friction_laws.weakening import ExponentialWeakening, SlipWeakening
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.simulation.sweep import recorded
from slippulse.solver.fixed_step import solve_by_scheme
from slippulse.theory.law_pulses import rate_pulse, weakening_pulse

from .right_side import CRACK, CREEPING, STICKING, pulse_at, right_of_centre, sliding_part

NEEDS = {"settings": ["measure"]}

GAMMA = 2.0 / 3.0
# Damping beta/dx of laws of slip rate, and beta of slip weakening.
DAMPING_RATIO, BETA = 0.1, 0.05
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Limit F of laws of slip rate, divided by the pre-stress; v_0 of strengthening and a of weakening.
RELATIVE_LIMITS = (0.1, 0.3, 0.4, 0.5, 0.6, 0.9, 1.3)
V_0, SLOPE = 0.1, 1.5
# d_c of slip weakening, divided by tau_0^2/gamma; at larger d_c the fracture energy stops ruptures.
RELATIVE_DISTANCES = (0.1, 0.2, 0.4, 0.6, 0.8, 0.95)
# There is no friction within this distance of x = 0, which nucleates the rupture.
NUCLEATION_HALF_LENGTH = 2.0
DX, DURATION = 0.08, 40.0
# Time steps divided by dx. Sharp fronts, as under laws of slip rate, lock onto a fraction of dx
# divided by the step, so these laws need the fine step.
STEP_OVER_DX, FINE_STEP_OVER_DX = 0.1, 0.0127
# A pulse counts as sticking if its slip exceeds tau_0/gamma by this factor. With less overshoot
# the remaining motion of the nucleation makes blocks stick at irregular times.
MIN_OVERSHOOT = 1.01
# In a running rupture, front and trailing edge advance by more than this factor during the second
# half of the run.
MIN_GROWTH, NO_RUPTURE = 1.1, "no rupture"
# Front speed as a function of d_c/dx at fixed beta: levels, spacings, and values of d_c/dx.
SELECTION_LEVELS, SELECTION_SPACINGS = (0.5, 0.8), (0.08, 0.04, 0.02)
SPACINGS_PER_DISTANCE = (1.0, 2.0, 4.0, 8.0)
# Cases with exact numbers, on lattices of these spacings: level, law, and step divided by dx.
CASES: tuple[tuple[float, Friction, float], ...] = (
    (0.5, BoundedRate(0.3, 1.0), FINE_STEP_OVER_DX),
    (0.5, RateWeakening(1.5, 0.3), FINE_STEP_OVER_DX),
    (0.8, SlipWeakening(0.1, NUCLEATION_HALF_LENGTH), STEP_OVER_DX),
    (0.5, SlipWeakening(0.2, NUCLEATION_HALF_LENGTH), STEP_OVER_DX),
    (0.5, SlipWeakening(0.3, NUCLEATION_HALF_LENGTH), STEP_OVER_DX),
)
# The exact pulse is cached, because lattices of several spacings share it.
cached_pulse = cache(weakening_pulse)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles plane, selection (with d_c and exact_speed), case and theory."""
    still = settings["measure"]["still"]
    plane, selection = [], []
    for level in LEVELS:
        laws: list[Friction] = []
        for limit in RELATIVE_LIMITS:
            laws += [BoundedRate(limit * level, V_0), RateWeakening(SLOPE, limit * level)]
        for distance, weakening in product(
            RELATIVE_DISTANCES, (SlipWeakening, ExponentialWeakening)
        ):
            laws.append(weakening(distance * level**2 / GAMMA, NUCLEATION_HALF_LENGTH))
        plane += [_run(level, law, STEP_OVER_DX, DX, still) for law in laws]
    for level, dx, resolution in product(
        SELECTION_LEVELS, SELECTION_SPACINGS, SPACINGS_PER_DISTANCE
    ):
        law = SlipWeakening(resolution * dx, NUCLEATION_HALF_LENGTH)
        ruptures = _strength(level, law) < 1.0
        speed = cached_pulse(level, GAMMA, BETA, law.d_c).speed if ruptures else np.nan
        known = {"d_c": law.d_c, "exact_speed": speed}
        selection.append(_run(level, law, STEP_OVER_DX, dx, still) | known)
    parts = {
        "plane": plane,
        "selection": selection,
        "case": [_run(*case, dx, still) for case, dx in product(CASES, SELECTION_SPACINGS)],
        "theory": [_theory(level, law) for level, law, _ in CASES],
    }
    rows = [pd.DataFrame(rows).assign(role=role) for role, rows in parts.items()]
    return pd.concat(rows, ignore_index=True).assign(gamma=GAMMA)


def _strength(level: float, law: Friction) -> float:
    parameters = law.mapping()
    if "d_c" in parameters:
        return parameters["d_c"] * GAMMA / level**2
    limit = parameters["limit"] / level
    return -limit if isinstance(law, RateWeakening) else limit


def _run(level: float, law: Friction, step: float, dx: float, still: float) -> dict[str, Any]:
    """Simulate one run and return its regime and pulse; width and slip are NaN if nothing sticks.

    Strength is F/tau_0 (< 0: weakening), or d_c gamma/tau_0^2.
    """
    step = min(step, 0.9 * law.traits.longest_step / dx)
    # Slip weakening has a limit dx -> 0 at fixed beta, all other laws at fixed beta/dx.
    beta = BETA if isinstance(law, SlipWeakening) else DAMPING_RATIO * dx
    profile = Prestress(level, level)
    values: dict[str, Any] = {"scheme": "fixed_step", "max_step": step, "friction": law}
    scene = Scene("displacement", profile, DURATION, dx, GAMMA, beta, **values)
    run = recorded(scene, None, solve_by_scheme(scene)).dataset()
    right = right_of_centre(run)
    # The front speed is measured over the last third of the run.
    time, x = right["release_time"].values, right["x"].values
    late = time > 2.0 / 3.0 * DURATION
    speed = float(np.polyfit(time[late], x[late], 1)[0]) if late.sum() > 2 else np.nan
    regime = _regime(right, level / GAMMA, still)
    width, slip = pulse_at(right, DURATION) if regime == STICKING else (np.nan, np.nan)
    strength = _strength(level, law)
    row = {"law": law.law, "level": level, "strength": strength, "dx": dx, "beta": beta}
    row |= {"regime": regime, "speed": speed, "pulse_width": width, "pulse_slip": slip}
    return row | {name: run.attrs[name] for name in ("energy_residual", "run_flags")}


def _regime(right: xr.Dataset, rest: float, still: float) -> str:
    """Classify a rupture; ``rest`` is the slip at which it would rest without overshoot."""
    before, after = (sliding_part(right, time) for time in (0.5 * DURATION, DURATION))
    if after[1] <= NUCLEATION_HALF_LENGTH + MIN_GROWTH * (before[1] - NUCLEATION_HALF_LENGTH):
        return NO_RUPTURE
    if after[0] > MIN_GROWTH * before[0] and pulse_at(right, DURATION)[1] > MIN_OVERSHOOT * rest:
        return STICKING
    velocity = right["slip_velocity"].values
    return CREEPING if is_pulse(float(velocity[0]), velocity.max(), still) else CRACK


def _theory(level: float, law: Friction) -> dict:
    """Return the exact numbers of a case."""
    if isinstance(law, SlipWeakening):
        pulse = cached_pulse(level, GAMMA, BETA, law.d_c)
    else:
        pulse = rate_pulse(level, GAMMA, DAMPING_RATIO, law)
    row = {"law": law.law, "level": level, "strength": _strength(level, law), "speed": pulse.speed}
    sizes = {"pulse_width": pulse.width, "pulse_slip": pulse.slip} if pulse.sticks else {}
    return row | sizes
