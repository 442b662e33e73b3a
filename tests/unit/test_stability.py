"""Stability bounds, compared with the amplification by one step and with runs that blow up."""

import math
from functools import partial

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.model.scene import ORDERS
from slippulse.model.stability import WEAKLY_UNSTABLE_ORDERS, largest_step
from slippulse.simulation.flags import flags_of
from slippulse.solver.fixed_step import solve_by_scheme

# Wave numbers of the lattice, as 4 sin^2(k/2).
MODES = np.linspace(0.0, 4.0, 401)
STRONG = {"boundary": "stress", "prestress": sp.Prestress(-0.5, 0.3), "duration": 60.0, "dx": 0.1}
STRONG["beta"] = 1.0


def taylor_amplification(order: int, step: float, ratio: float, gamma_dx2: float) -> float:
    """Return the largest amplification of a mode by one Taylor step.

    Slip is expanded to one order more than velocity.
    """
    stiffness, damping = MODES + gamma_dx2, ratio * MODES
    derivatives = [np.array([np.ones_like(MODES), np.zeros_like(MODES)])]
    derivatives.append(derivatives[0][::-1].copy())
    for _ in range(order):
        derivatives.append(-stiffness * derivatives[-2] - damping * derivatives[-1])
    slip = sum(step**k / math.factorial(k) * derivatives[k] for k in range(order + 2))
    velocity = sum(step**k / math.factorial(k) * derivatives[k + 1] for k in range(order + 1))
    return spectral_radius(slip[0], slip[1], velocity[0], velocity[1])


def euler_amplification(step: float, ratio: float, gamma_dx2: float) -> float:
    """Return the largest amplification by symplectic Euler, which updates velocity before slip."""
    stiffness, damping = MODES + gamma_dx2, ratio * MODES
    from_slip, from_velocity = -step * stiffness, 1.0 - step * damping
    return spectral_radius(1.0 + step * from_slip, step * from_velocity, from_slip, from_velocity)


def spectral_radius(a, b, c, d) -> float:
    half_trace, determinant = 0.5 * (a + d), a * d - b * c
    root = np.sqrt((half_trace**2 - determinant).astype(complex))
    return float(np.max(np.abs([half_trace + root, half_trace - root])))


# Scheme, order, stiffness gamma dx^2 of leaf springs, and a function of step, ratio, stiffness.
AMPLIFICATIONS = [
    *(("localised", order, 0.0, partial(taylor_amplification, order)) for order in ORDERS),
    *(("fixed_step", 4, leaf, euler_amplification) for leaf in (0.0, 0.3, 5.0)),
]


# Damping ratios of the shipped scenes, and larger ones.
@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0])
@pytest.mark.parametrize(("scheme", "order", "leaf", "growth"), AMPLIFICATIONS)
def test_no_mode_grows_below_the_bound_and_one_grows_above(scheme, order, leaf, growth, ratio):
    bound = largest_step(scheme, order, ratio, leaf)
    weak = scheme == "localised" and order in (5, 6)
    allowed = 1.0 + (tol.AMPLIFICATION_WEAK if weak else tol.AMPLIFICATION)
    for step in np.linspace(0.05, tol.BELOW_BOUND, 40) * bound:
        assert growth(float(step), ratio, leaf) <= allowed
    # The bound of the localised scheme is sharp at strong damping.
    if leaf == 0.0 and (scheme == "fixed_step" or ratio == 10.0):
        assert growth(tol.ABOVE_BOUND * bound, ratio, leaf) > 1.0 + tol.AMPLIFICATION


def test_a_localised_run_keeps_its_energy_balance_only_below_the_bound():
    """A growing mode reaches velocity 0 and sticks, which the energy balance shows."""
    runs = []
    for factor in (tol.BELOW_BOUND, tol.ABOVE_BOUND):
        scene = sp.Scene(**STRONG, max_step=1e-3)
        # A Scene refuses a step beyond the bound.
        object.__setattr__(scene, "max_step", factor * scene.largest_stable_step)
        run = solve_by_scheme(scene)
        runs.append((run.numbers, flags_of(scene, run)["run_flags"].split(",")))
    (sound, sound_flags), (broken, broken_flags) = runs
    assert sound["energy_residual"] < tol.ENERGY and sound["sticks"] == 0
    assert sound_flags == ["long_step"]
    assert broken["sticks"] > 0 and "energy" in broken_flags


def test_no_scheme_blows_up_below_its_bound(study):
    """With damping, runs above the bound blow up, at every order and with both schemes."""
    rows = study("stability")
    # No limit lies beyond the ends of the bisection.
    assert (rows[["measured_limit", "measured_rupture_limit"]] == "within").all(axis=None)
    measured = rows[["measured_ratio", "measured_rupture_ratio"]]
    assert measured.min(axis=None) >= 1.0 - tol.BOUNDARY_BELOW
    damped = rows[rows["damping_ratio"] >= 0.1]
    assert len(damped) == 28
    assert damped["measured_ratio"].max() <= 1.0 + tol.BOUNDARY_ABOVE
    undamped = rows[(rows["damping_ratio"] == 0.0) & (rows["order"] <= 4)]
    assert undamped["measured_ratio"].max() <= 1.0 + tol.BOUNDARY_ABOVE_UNDAMPED
    # Weak orders are held below the measured boundary.
    weak = rows[(rows["order"].isin(WEAKLY_UNSTABLE_ORDERS)) & (rows["damping_ratio"] == 0.0)]
    assert (weak["measured_ratio"] > 1.0).all()
