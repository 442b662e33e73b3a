"""Invariants of the model in hundreds of random valid scenes, including extreme ones."""

import collections
import dataclasses
import math

import numpy as np
import pytest
import tolerances as tol
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from reference.lattice_state import sliding, threshold_stress, total_stress

import slippulse as sp
from slippulse.model.cost import bound_cost
from slippulse.model.release import RELEASES
from slippulse.model.scene import ORDERS
from slippulse.model.stability import largest_step
from slippulse.solver.fixed_step import LATTICES

FIELDS = ("release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration")
COUNTS = ("releases", "sticks", "re_releases")
ENERGIES = ("work_of_prestress", "kinetic_energy", "elastic_energy", "leaf_spring_energy")
NUMBERS = (*ENERGIES, "viscous_loss", "min_stuck_stress", "first_stick_time")
SAME = {"derandomize": True, "deadline": None, "database": None}
SETTINGS = settings(max_examples=600, suppress_health_check=list(HealthCheck), **SAME)
# The number of scenes of each kind.
seen: collections.Counter = collections.Counter()
# In this scene, a front of the textbook scheme moves by one block per step near the end of its
# lattice.
FAST_PROFILE = sp.Prestress(-3.0, 0.95, 1.0, bumps=((0.0, 1.0, 0.5),))
FAST_STEP = {"scheme": "fixed_step", "max_step": 0.07284750148033359, "order": 3}
FAST = sp.Scene("displacement", FAST_PROFILE, 5.0, 0.1, gamma=1.0, beta=0.3, **FAST_STEP)
# Profiles with bumps, symmetric and asymmetric, on lattices of about 400 blocks.
BUMPS = ((5.0, -0.5, 0.7), (-5.0, -0.5, 0.7))
EVEN = sp.Prestress(0.4, 0.4, peak=1.05, bumps=BUMPS)
UNEVEN = sp.Prestress(0.25, 0.6, peak=1.05, steps=((4.0, 0.4),), bumps=BUMPS[1:])
LARGE = [
    sp.Scene("displacement", EVEN, 8.0, 0.05, gamma=0.65, beta=0.005, max_step=0.3),
    sp.Scene("stress", EVEN, 8.0, 0.05, scheme="fixed_step", max_step=0.3),
    sp.Scene("stress", UNEVEN, 8.0, 0.05, beta=0.005, max_step=0.3),
    sp.Scene("displacement", UNEVEN, 8.0, 0.05, 0.65, scheme="fixed_step", max_step=0.3),
]


def real(low: float, high: float, *extremes: float) -> st.SearchStrategy[float]:
    anywhere = st.floats(low, high, allow_subnormal=False)
    return st.one_of(st.sampled_from(extremes), anywhere) if extremes else anywhere


# The extremes are levels far below and just below the threshold, at 0 and next to 0.
LEVELS = real(-3.0, 0.95, -3.0, -1.0, -1e-9, 0.0, 1e-9, 0.5, 0.95)
RATIOS = real(0.0, 1.0, 0.0, 1e-6, 0.1, 1.0, 1.5, 2.0, 3.0)
STEP = st.tuples(st.one_of(real(-15.0, -0.5), real(0.5, 15.0)), real(-3.0, 0.95))
BUMP = st.tuples(real(-15.0, 15.0), real(-2.0, 1.5), real(0.5, 3.0))


@st.composite
def random_scenes(draw) -> sp.Scene:
    dx = draw(st.sampled_from([0.1, 0.2, 0.37, 1.0]))
    boundary = draw(st.sampled_from(["displacement", "stress"]))
    exponent = draw(st.one_of(real(-1.0, 1.0), real(-6.0, 1.0)))
    gamma = 10.0**exponent if boundary == "displacement" else 0.0
    left = draw(LEVELS)
    right, width = draw(st.one_of(st.just(left), LEVELS)), max(dx, draw(real(0.1, 5.0)))
    peak = draw(st.sampled_from([1.0, 1.5, 1.0, 0.99]))
    steps = tuple(draw(st.lists(STEP, max_size=2, unique_by=lambda step: step[0])))
    profile = sp.Prestress(left, right, width, peak, steps, tuple(draw(st.lists(BUMP, max_size=2))))
    ratio, order = draw(RATIOS), draw(st.sampled_from(ORDERS))
    scheme = draw(st.sampled_from([*LATTICES]))
    bound = largest_step(scheme, order, ratio, gamma * dx**2)
    duration = draw(st.one_of(real(0.5, 3.0), real(5.0, 10.0)))
    release = draw(st.sampled_from(RELEASES))
    how = release, scheme, min(0.5, 0.9 * bound) * draw(st.sampled_from([0.25, 0.5, 1.0])), order
    return sp.Scene(boundary, profile, duration, dx, gamma, ratio * dx, *how)


@SETTINGS
@example(FAST)
@example(LARGE[0])
@example(LARGE[1])
@example(LARGE[2])
@example(LARGE[3])
@given(random_scenes())
def check_invariants(scene):
    reach = math.ceil(scene.duration) + 2.0
    samples = sp.Samples(np.linspace(0.0, scene.duration, 25), np.linspace(-reach, reach, 41))
    run, bound = sp.simulate(scene, samples), bound_cost(scene, samples)
    assert run.attrs["block_updates"] < tol.BOUND_FACTOR * bound.block_updates
    assert run.nbytes < bound.bytes
    kinds = {
        "scenes": True,
        "in which blocks slip": np.isfinite(run["release_time"].values).any(),
        "in which blocks stick": np.isfinite(run["stick_time"].values).any(),
        "asymmetric": not scene.symmetric,
        "stress boundary": scene.boundary == "stress",
        "textbook scheme": scene.scheme == "fixed_step",
        "strongly damped": scene.damping_ratio >= 1.0,
    }
    seen.update(kind for kind, held in kinds.items() if held)
    check_motion(run)
    # With any scheme, either the energy balances or the run is flagged.
    flagged = "energy" in run.attrs["run_flags"]
    assert flagged == (run.attrs["energy_residual"] > tol.RANDOM_ENERGY)
    if scene.scheme == "localised":
        check_equation(run)
        # Only coarse or strongly damped scenes are flagged. A lattice is coarse if the Gaussian of
        # the pre-stress is hardly wider than a block.
        narrow = scene.prestress.width < 1.5 * scene.dx
        coarse = run.attrs["steps"] < 20 or scene.order == 3 or narrow
        assert not flagged or coarse or scene.damping_ratio >= 1.0
        seen["flagged for energy"] += flagged
    check_mirror(scene, run)


def check_motion(run) -> None:
    """Slip velocity is never negative, slip never decreases, and fronts run outwards."""
    release, stick = run["release_time"].values, run["stick_time"].values
    for name in ("slip_velocity", "sample_velocity"):
        assert np.nanmin(run[name].values) >= 0.0
    assert np.nanmin(np.diff(run["sample_slip"].values, axis=0)) >= 0.0
    # Except at the start, no block is released before both of its neighbours.
    late = np.where(np.isfinite(release), release, np.inf)
    after = np.flatnonzero(np.isfinite(release) & (release > 0.0))
    assert np.all(np.minimum(late[after - 1], late[after + 1]) <= release[after])
    assert np.all(stick[np.isfinite(stick)] >= release[np.isfinite(stick)])
    assert not any(run[name].values[np.isnan(release)].any() for name in FIELDS[2:])


def check_equation(run) -> None:
    """Stuck blocks are at rest below the threshold. Sliding blocks obey the equation of motion."""
    moving, total = sliding(run)[1:-1], total_stress(run)[1:-1]
    assert np.max(threshold_stress(run)[1:-1][~moving], initial=-np.inf) <= 1.0 + tol.STRESS_AT_END
    assert not run["slip_velocity"].values[1:-1][~moving].any()
    force = np.where(moving, total, 0.0)
    assert np.max(np.abs(run["slip_acceleration"].values[1:-1] - force)) < tol.STRESS_AT_END


def check_mirror(scene, run) -> None:
    """A mirrored scene has the mirrored motion. Half a lattice and a whole one agree."""
    tau = scene.prestress
    steps = tuple((-position, level) for position, level in tau.steps)
    bumps = tuple((-centre, *rest) for centre, *rest in tau.bumps)
    turned = sp.Prestress(tau.right, tau.left, tau.width, tau.peak, steps, bumps)
    mirrored = dataclasses.replace(scene, prestress=turned, half_lattice=False)
    other = sp.simulate(mirrored).isel(x=slice(None, None, -1))
    assert (
        run.attrs["half_lattice_used"] == scene.symmetric and not other.attrs["half_lattice_used"]
    )
    for name in FIELDS:
        np.testing.assert_allclose(other[name], run[name], rtol=0.0, atol=tol.MIRROR)
    for name in NUMBERS:
        expected = pytest.approx(run.attrs[name], rel=1e3 * tol.MIRROR, nan_ok=True)
        assert other.attrs[name] == expected, name
    for name in () if scene.symmetric else COUNTS:
        assert other.attrs[name] == run.attrs[name], name


def test_invariants_hold_over_varied_scenes():
    check_invariants()
    assert seen["scenes"] >= 500
    assert seen["in which blocks slip"] > 0.5 * seen["scenes"]
    assert seen["flagged for energy"] < tol.RANDOM_ENERGY_FLAGGED * seen["scenes"]
    for kind in set(seen) - {"scenes", "in which blocks slip", "flagged for energy"}:
        assert tol.RANDOM_SHARE * seen["scenes"] < seen[kind] < 0.95 * seen["scenes"], (kind, seen)
    assert len(seen) == 8
