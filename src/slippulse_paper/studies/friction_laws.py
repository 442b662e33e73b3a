"""Simulate ruptures under other friction laws, to find out which of them become pulses.

Two laws depend on the slip rate and two on the slip. All ruptures have leaf springs and a uniform
pre-stress, and only their right side is measured. The study also compares front speeds with theory.
"""

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.model.friction_laws.law import Friction
from slippulse.model.friction_laws.rate import BoundedRate, RateWeakening
from slippulse.model.friction_laws.weakening import ExponentialWeakening, SlipWeakening
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.simulation.sweep import recorded
from slippulse.solver.fixed_step import solve_by_scheme
from slippulse.theory.law_pulses import rate_pulse, weakening_pulse

from . import right_side
from .right_side import PulseSize

NEEDS = {"settings": ["measure"]}

GAMMA = 2.0 / 3.0
# Damping: beta/dx under laws of slip rate, and beta under slip weakening.
DAMPING_RATIO = 0.1
BETA = 0.05
LEVELS = (0.2, 0.35, 0.5, 0.65, 0.8)
# Laws of slip rate: limit F of the friction divided by the pre-stress, velocity v_0 of rate
# strengthening, and slope a of rate weakening.
RELATIVE_LIMITS = (0.1, 0.3, 0.4, 0.5, 0.6, 0.9, 1.3)
STRENGTHENING_VELOCITY = 0.1
WEAKENING_SLOPE = 1.5
# Slip weakening: slip d_c over which friction falls, divided by tau_0^2/gamma. At larger d_c the
# fracture energy stops ruptures. There is no friction within the half-length of x = 0, so that the
# rupture starts there.
RELATIVE_DISTANCES = (0.1, 0.2, 0.4, 0.6, 0.8, 0.95)
NUCLEATION_HALF_LENGTH = 2.0
DX, DURATION = 0.08, 40.0
# Time steps divided by dx. Under laws of slip rate the front is sharp, and a coarse step would
# change its speed to a fraction of dx divided by the step.
STEP_OVER_DX, FINE_STEP_OVER_DX = 0.1, 0.0127
# A pulse counts as sticking if its slip is larger than tau_0/gamma by this factor. With less slip,
# waves that remain from the nucleation make blocks stick at irregular times.
MIN_OVERSHOOT = 1.01
# In a running rupture, the path of the front becomes longer by more than this factor during the
# second half of the run. The same holds for the distance of the trailing edge from the centre.
MIN_GROWTH = 1.1
# Regime of a rupture that stops soon after its nucleation.
NO_RUPTURE = "no rupture"
# Spacings of the runs that are repeated on finer lattices.
REFINED_SPACINGS = (0.08, 0.04, 0.02)
# Front speeds selected by d_c/dx at fixed beta, at each of these spacings: levels, and values
# of d_c/dx.
SELECTION_LEVELS = (0.5, 0.8)
DISTANCES_OVER_DX = (1.0, 2.0, 4.0, 8.0)
# Cases with exact numbers: level, law, and step divided by dx. Each is run at REFINED_SPACINGS.
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
    """Return the rows of four parts of the figure. The column ``role`` has these values:

    plane : runs of all laws at all levels, with the regime of each run
    selection : front speeds under slip weakening, by the spacing and by d_c, the slip over which
        friction falls, and the exact front speed
    case, theory : the runs of CASES at several spacings, and their exact numbers
    """
    # The centre of a pulse counts as at rest below this fraction of the largest velocity.
    still_fraction = settings["measure"]["still"]
    cases = [
        _simulated_row(level, law, dx=dx, step_over_dx=step_over_dx, still_fraction=still_fraction)
        for (level, law, step_over_dx), dx in product(CASES, REFINED_SPACINGS)
    ]
    parts = {
        "plane": _rows_of_all_laws(still_fraction),
        "selection": _rows_by_weakening_distance(still_fraction),
        "case": cases,
        "theory": [_exact_row(level, law) for level, law, _ in CASES],
    }
    tables_by_role = [pd.DataFrame(rows).assign(role=role) for role, rows in parts.items()]
    return pd.concat(tables_by_role, ignore_index=True).assign(gamma=GAMMA)


def _rows_of_all_laws(still_fraction: float) -> list[dict[str, Any]]:
    """Simulate ruptures under all laws at all levels, and return one row for each.

    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    rows = []
    for level in LEVELS:
        laws: list[Friction] = []
        for relative_limit in RELATIVE_LIMITS:
            limit = relative_limit * level
            laws.append(BoundedRate(limit, STRENGTHENING_VELOCITY))
            laws.append(RateWeakening(WEAKENING_SLOPE, limit))
        for relative_distance in RELATIVE_DISTANCES:
            d_c = relative_distance * level**2 / GAMMA
            laws.append(SlipWeakening(d_c, nucleation=NUCLEATION_HALF_LENGTH))
            laws.append(ExponentialWeakening(d_c, nucleation=NUCLEATION_HALF_LENGTH))
        rows += [
            _simulated_row(
                level, law, dx=DX, step_over_dx=STEP_OVER_DX, still_fraction=still_fraction
            )
            for law in laws
        ]
    return rows


def _rows_by_weakening_distance(still_fraction: float) -> list[dict[str, Any]]:
    """Simulate ruptures under slip weakening at several spacings and d_c, with the exact speed.

    The exact speed is NaN if the fracture energy is too large for a rupture.

    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    rows = []
    for level, dx, distance_over_dx in product(
        SELECTION_LEVELS, REFINED_SPACINGS, DISTANCES_OVER_DX
    ):
        law = SlipWeakening(d_c=distance_over_dx * dx, nucleation=NUCLEATION_HALF_LENGTH)
        exact_speed = np.nan
        # At a relative strength of 1 the fracture energy is as large as the released energy. From
        # there on, no rupture exists.
        if _relative_strength(level, law) < 1.0:
            exact_speed = cached_pulse(level, GAMMA, BETA, law.d_c).speed
        row = _simulated_row(
            level, law, dx=dx, step_over_dx=STEP_OVER_DX, still_fraction=still_fraction
        )
        rows.append(row | {"d_c": law.d_c, "exact_speed": exact_speed})
    return rows


def _relative_strength(level: float, law: Friction) -> float:
    """Return how strong a friction law is compared with the pre-stress tau_0 = ``level``.

    For slip weakening this is d_c/(tau_0^2/gamma), where d_c is the slip over which friction falls.
    For laws of slip rate it is the limit of friction at high rates, divided by tau_0. It has a
    minus sign for rate weakening, so that one axis can show both laws.
    """
    parameters = law.mapping()
    if "d_c" in parameters:
        return parameters["d_c"] * GAMMA / level**2
    relative_limit = parameters["limit"] / level
    return -relative_limit if isinstance(law, RateWeakening) else relative_limit


def _simulated_row(
    level: float, law: Friction, dx: float, step_over_dx: float, still_fraction: float
) -> dict[str, Any]:
    """Simulate a rupture, and return its parameters, its regime and the size of its pulse.

    The size is NaN if no block sticks behind the pulse.

    level : uniform pre-stress outside the nucleation
    step_over_dx : largest time step divided by dx
    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    # The step must also resolve the friction law, with a margin.
    step_over_dx = min(step_over_dx, 0.9 * law.traits.longest_step / dx)
    # Slip weakening has a limit dx -> 0 at fixed beta, all other laws have it at fixed beta/dx.
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
    run = recorded(scene, samples=None, solution=solve_by_scheme(scene)).dataset()
    right = right_side.right_of_centre(run)
    regime = _regime(right, balance_slip=level / GAMMA, still_fraction=still_fraction)
    pulse = PulseSize(np.nan, np.nan)
    if regime == right_side.STICKING:
        pulse = right_side.pulse_at(right, DURATION)
    return {
        "law": law.law,
        "level": level,
        "strength": _relative_strength(level, law),
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
    """Return the front speed over the last third of a run; NaN if it has fewer than 3 releases.

    right : the right side of the run
    """
    release_time, x = right["release_time"].values, right["x"].values
    is_late = release_time > 2.0 / 3.0 * DURATION
    if is_late.sum() <= 2:
        return np.nan
    speed, _ = np.polyfit(release_time[is_late], x[is_late], 1)
    return float(speed)


def _regime(right: xr.Dataset, balance_slip: float, still_fraction: float) -> str:
    """Return the regime of a rupture, from its right side.

    - No rupture: the front hardly advances in the second half of the run. At the end its path is
      at most MIN_GROWTH times as long as halfway.
    - Sticking pulse: the trailing edge advances by a larger factor than MIN_GROWTH, and the slip
      behind it is larger than MIN_OVERSHOOT times ``balance_slip``. So much slip remains only if
      friction holds the blocks against the springs.
    - Creeping pulse: blocks do not stick in this way, but the centre is nearly at rest at the end.
    - Crack: the centre still slides at the end.

    balance_slip : slip at which the springs balance the pre-stress, tau_0/gamma
    still_fraction : fraction of the largest velocity below which the centre counts as at rest
    """
    halfway = right_side.sliding_part(right, 0.5 * DURATION)
    end = right_side.sliding_part(right, DURATION)
    # Lengths of the path of the front, which begins at the edge of the nucleation.
    path_halfway = halfway.front - NUCLEATION_HALF_LENGTH
    path_at_end = end.front - NUCLEATION_HALF_LENGTH
    if path_at_end <= MIN_GROWTH * path_halfway:
        return NO_RUPTURE
    trailing_edge_advances = end.trailing_edge > MIN_GROWTH * halfway.trailing_edge
    slip_behind_pulse = right_side.pulse_at(right, DURATION).slip
    if trailing_edge_advances and slip_behind_pulse > MIN_OVERSHOOT * balance_slip:
        return right_side.STICKING
    velocity = right["slip_velocity"].values
    centre_velocity = float(velocity[0])
    return right_side.regime_without_sticks(centre_velocity, velocity.max(), still_fraction)


def _exact_row(level: float, law: Friction) -> dict[str, Any]:
    """Return speed, width and slip of an exact pulse, in the limit dx -> 0.

    The column strength is the strength of the law, relative to the pre-stress ``level``. Width and
    slip are left out if the pulse never sticks.
    """
    # Slip weakening has a limit dx -> 0 at fixed beta, all other laws have it at fixed beta/dx.
    if isinstance(law, SlipWeakening):
        pulse = cached_pulse(level, GAMMA, BETA, law.d_c)
    else:
        pulse = rate_pulse(level, GAMMA, DAMPING_RATIO, law)
    row = {
        "law": law.law,
        "level": level,
        "strength": _relative_strength(level, law),
        "speed": pulse.speed,
    }
    if pulse.sticks:
        row |= {"pulse_width": pulse.width, "pulse_slip": pulse.slip}
    return row
