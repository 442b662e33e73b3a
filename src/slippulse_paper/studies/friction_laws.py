"""Other laws of friction: which make pulses that stick or creep, and what selects front speeds.

Two laws depend on the slip rate and two on the slip. All ruptures have leaf springs and a uniform
pre-stress, and only their right side is measured.
"""

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

GAMMA = 2.0 / 3.0
# Damping beta/dx of laws of slip rate, and beta of slip weakening.
DAMPING_RATIO = 0.1
BETA = 0.05
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Limit F of laws of slip rate, divided by the pre-stress.
RELATIVE_LIMITS = (0.1, 0.3, 0.4, 0.5, 0.6, 0.9, 1.3)
# Velocity v_0 of rate strengthening, and slope a of rate weakening.
STRENGTHENING_VELOCITY = 0.1
WEAKENING_SLOPE = 1.5
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
MIN_GROWTH = 1.1
# Regime of a rupture that stops soon after its nucleation.
NO_RUPTURE = "no rupture"
# Front speed as a function of d_c/dx at fixed beta: levels, spacings, and values of d_c/dx.
SELECTION_LEVELS = (0.5, 0.8)
SELECTION_SPACINGS = (0.08, 0.04, 0.02)
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
    """Return the rows of four parts of the figure, which the column role names.

    plane : runs of all laws at all levels, for the regime as a function of level and strength
    selection : front speeds under slip weakening by spacing and d_c, with the exact speed
    case, theory : some runs at several spacings, and their exact numbers
    """
    still_fraction = settings["measure"]["still"]
    cases = [
        _run(level, law, dx=dx, step_over_dx=step_over_dx, still_fraction=still_fraction)
        for (level, law, step_over_dx), dx in product(CASES, SELECTION_SPACINGS)
    ]
    parts = {
        "plane": _plane(still_fraction),
        "selection": _selection(still_fraction),
        "case": cases,
        "theory": [_theory(level, law) for level, law, _ in CASES],
    }
    tables_by_role = [pd.DataFrame(rows).assign(role=role) for role, rows in parts.items()]
    return pd.concat(tables_by_role, ignore_index=True).assign(gamma=GAMMA)


def _plane(still_fraction: float) -> list[dict[str, Any]]:
    """Run all laws at all levels."""
    rows = []
    for level in LEVELS:
        laws: list[Friction] = []
        for relative_limit in RELATIVE_LIMITS:
            limit = relative_limit * level
            laws.append(BoundedRate(limit, STRENGTHENING_VELOCITY))
            laws.append(RateWeakening(WEAKENING_SLOPE, limit))
        for relative_distance in RELATIVE_DISTANCES:
            d_c = relative_distance * level**2 / GAMMA
            laws.append(SlipWeakening(d_c, NUCLEATION_HALF_LENGTH))
            laws.append(ExponentialWeakening(d_c, NUCLEATION_HALF_LENGTH))
        rows += [
            _run(level, law, dx=DX, step_over_dx=STEP_OVER_DX, still_fraction=still_fraction)
            for law in laws
        ]
    return rows


def _selection(still_fraction: float) -> list[dict[str, Any]]:
    """Run slip weakening at several spacings and d_c; NaN as exact speed if nothing ruptures."""
    rows = []
    for level, dx, spacings_per_distance in product(
        SELECTION_LEVELS, SELECTION_SPACINGS, SPACINGS_PER_DISTANCE
    ):
        law = SlipWeakening(spacings_per_distance * dx, NUCLEATION_HALF_LENGTH)
        exact_speed = np.nan
        if _strength(level, law) < 1.0:
            exact_speed = cached_pulse(level, GAMMA, BETA, law.d_c).speed
        row = _run(level, law, dx=dx, step_over_dx=STEP_OVER_DX, still_fraction=still_fraction)
        rows.append(row | {"d_c": law.d_c, "exact_speed": exact_speed})
    return rows


def _strength(level: float, law: Friction) -> float:
    """Return the strength of a law relative to the pre-stress level.

    This is d_c gamma/tau_0^2 for slip weakening, and F/tau_0 for rate strengthening. For rate
    weakening it is -F/tau_0, so that one axis can show both laws of slip rate.
    """
    parameters = law.mapping()
    if "d_c" in parameters:
        return parameters["d_c"] * GAMMA / level**2
    relative_limit = parameters["limit"] / level
    return -relative_limit if isinstance(law, RateWeakening) else relative_limit


def _run(
    level: float, law: Friction, dx: float, step_over_dx: float, still_fraction: float
) -> dict[str, Any]:
    """Simulate one run and return its regime and pulse; width and slip are NaN if nothing sticks.

    step_over_dx : largest time step divided by dx
    still_fraction : fraction of the largest velocity below which the centre of a pulse counts as at
        rest
    """
    # The step must also resolve the law of friction.
    step_over_dx = min(step_over_dx, 0.9 * law.traits.longest_step / dx)
    # Slip weakening has a limit dx -> 0 at fixed beta, all other laws at fixed beta/dx.
    beta = BETA if isinstance(law, SlipWeakening) else DAMPING_RATIO * dx
    scene = Scene(
        boundary="displacement",
        prestress=Prestress(level, level),
        duration=DURATION,
        dx=dx,
        gamma=GAMMA,
        beta=beta,
        scheme="fixed_step",
        max_step=step_over_dx,
        friction=law,
    )
    run = recorded(scene, None, solve_by_scheme(scene)).dataset()
    right = right_of_centre(run)
    regime = _regime(right, level / GAMMA, still_fraction)
    pulse = pulse_at(right, DURATION) if regime == STICKING else PulseSize(np.nan, np.nan)
    return {
        "law": law.law,
        "level": level,
        "strength": _strength(level, law),
        "dx": dx,
        "beta": beta,
        "regime": regime,
        "speed": _late_front_speed(right),
        "pulse_width": pulse.width,
        "pulse_slip": pulse.slip,
        "energy_residual": run.attrs["energy_residual"],
        "run_flags": run.attrs["run_flags"],
    }


def _late_front_speed(right: xr.Dataset) -> float:
    """Return the front speed over the last third of a run; NaN if too few blocks are released."""
    release_time, x = right["release_time"].values, right["x"].values
    is_late = release_time > 2.0 / 3.0 * DURATION
    if is_late.sum() <= 2:
        return np.nan
    speed, _ = np.polyfit(release_time[is_late], x[is_late], 1)
    return float(speed)


def _regime(right: xr.Dataset, slip_at_rest: float, still_fraction: float) -> str:
    """Return the regime of a rupture, from its right side.

    - No rupture: the front hardly advances in the second half of the run.
    - Sticking pulse: the trailing edge advances, and the slip behind it is larger than at rest. So
      much slip remains only if friction holds the blocks against the springs.
    - Creeping pulse: the centre does not stick in this way, but is nearly at rest at the end.
    - Crack: the centre still slides at the end.

    slip_at_rest : slip at which the springs balance the pre-stress, tau_0/gamma
    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    halfway, end = sliding_part(right, 0.5 * DURATION), sliding_part(right, DURATION)
    # The path of the front is counted from the edge of the nucleation.
    path_halfway = halfway.front - NUCLEATION_HALF_LENGTH
    if end.front <= NUCLEATION_HALF_LENGTH + MIN_GROWTH * path_halfway:
        return NO_RUPTURE
    edge_advances = end.trailing_edge > MIN_GROWTH * halfway.trailing_edge
    if edge_advances and pulse_at(right, DURATION).slip > MIN_OVERSHOOT * slip_at_rest:
        return STICKING
    velocity = right["slip_velocity"].values
    return CREEPING if is_pulse(float(velocity[0]), velocity.max(), still_fraction) else CRACK


def _theory(level: float, law: Friction) -> dict:
    """Return the exact numbers of a case; width and slip are left out if its pulse never sticks."""
    if isinstance(law, SlipWeakening):
        pulse = cached_pulse(level, GAMMA, BETA, law.d_c)
    else:
        pulse = rate_pulse(level, GAMMA, DAMPING_RATIO, law)
    row = {"law": law.law, "level": level, "strength": _strength(level, law), "speed": pulse.speed}
    if pulse.sticks:
        row |= {"pulse_width": pulse.width, "pulse_slip": pulse.slip}
    return row
