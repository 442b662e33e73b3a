"""Arrival times, against the front law, quadrature, several nucleation points, and closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import slippulse as sp
from slippulse.model.balance import integral
from slippulse.theory import ArrestingCrack, Rupture, barrier_depth, front_speed
from slippulse.theory.curve import Point
from slippulse.theory.fast_front import FastFront
from slippulse.theory.part import Part
from slippulse.theory.slowness import slowness
from slippulse.theory.two_fronts import fast_fronts

# Allowed relative error of T(x).
ARRIVAL_TOLERANCE = 1e-8


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.01, 0.1, 1.0, 5.0])
def test_the_interpolated_front_law_is_the_front_law(ratio, release):
    tau = np.append(np.random.default_rng(1).uniform(0.0, 1.0, 12), [1e-4, 0.01, 0.99, 0.9999])
    exact = 1.0 / front_speed(tau, ratio, release)
    assert slowness(tau, ratio, release) == pytest.approx(exact, abs=2e-9)
    beyond = slowness(np.array([-1.0, 0.0, 1.0, 1.5]), ratio, release)
    assert beyond == pytest.approx([1, 1, 0, 0], abs=1e-12)


def test_arrival_times_are_integrals_of_the_slowness():
    profile = sp.Prestress(0.25, 0.6, 0.8, steps=((3.0, 0.4),), bumps=((-2.0, 0.3, 0.5),))
    rupture = Rupture(profile, 0.55, 0.1, "total", 8.0)
    rate = lambda x: 1.0 / front_speed(min(float(profile(x)), 1.0 - 1e-15), 0.1) if x else 0.0
    for x, *ends, mark in ((-3.0, -3.0, 0.0, -2.0), (4.0, 0.0, 4.0, 3.0)):
        exact = quad(rate, *ends, points=[mark], epsabs=1e-12, epsrel=1e-11, limit=200)[0]
        assert float(rupture.release_time(x)) == pytest.approx(exact, rel=ARRIVAL_TOLERANCE)


def test_the_earlier_front_counts_where_two_meet():
    profile = sp.Prestress(0.3, 0.3, bumps=((6.0, 0.9, 1.0),))
    rupture = Rupture(profile, 0.65, 0.1, "total", 3.0)
    start, edge = (
        brentq(lambda x: float(profile(x)) - 1.0, *ends, xtol=1e-14) for ends in ((4, 6), (6, 8))
    )
    assert rupture.release_time([6.0, edge]) == pytest.approx(0.0, abs=1e-12)
    (join,) = rupture.stretches[0].joins
    rate = lambda x: float(slowness(profile(np.asarray(x)), 0.1))
    times = [quad(rate, *ends, epsabs=1e-11)[0] for ends in ((0.0, join), (join, start))]
    assert times == pytest.approx([float(rupture.release_time(join))] * 2, rel=1e-7)


def test_a_slow_front_without_leaf_springs_is_the_closed_form():
    crack = ArrestingCrack(sp.Prestress(-0.5, 0.0), 0.1)
    rupture = Rupture(sp.Prestress(-0.5, 0.0), 0.0, 0.1, "total", 12.0)
    for x in (-3.5, -2.5, -1.5, -0.5):
        assert float(rupture.release_time(x)) == pytest.approx(
            crack.time_at(x), rel=ARRIVAL_TOLERANCE
        )
    ((left, _),) = rupture.front_ends
    assert left.reason == "duration" and abs(left.x) < abs(crack.balance_position)
    # With leaf springs the front stops.
    ((left, right),) = Rupture(sp.Prestress(-0.5, 0.5), 0.65, 0.1, "total", 8.0).front_ends
    assert (left.reason, right.reason) == ("stops", "duration")
    assert left.x == pytest.approx(-3.62, abs=0.005)


@pytest.mark.parametrize(
    "profile",
    [
        sp.Prestress(-0.5, 0.3, 0.2, steps=((15.0, 0.0),)),
        sp.Prestress(-0.5, 0.0, 0.2, bumps=((20.0, 0.3, 2.0),)),
    ],
)
def test_an_arresting_crack_includes_steps_and_bumps_far_from_the_nucleation(profile):
    """They lie beyond the end of the Gaussian at x = 0."""
    crack, rupture = ArrestingCrack(profile), Rupture(profile, 0.0, duration=60.0)
    for fraction in (0.5, 0.8):
        transition = crack.transition(fraction)
        left, right = rupture.fronts_at(transition.time)
        assert left == pytest.approx(fraction * crack.balance_position, rel=1e-8)
        assert transition.length == pytest.approx(right - left, rel=1e-8)
    _, velocity = crack.far_pulse()
    assert velocity[0] == pytest.approx(0.0, abs=1e-12)


def test_the_transition_includes_steps_far_from_the_nucleation():
    """Up to the steps the fronts run three times as fast as beyond them."""
    profile = sp.Prestress(0.95, 0.95, 0.05, steps=((-100.0, 0.1), (100.0, 0.1)))
    exact = sp.theory.exact_transition_displacement(profile, 0.01)
    transition = Rupture(profile, 0.01, duration=80.0).transition
    assert tuple(exact) == pytest.approx(tuple(transition), rel=1e-8)


@pytest.mark.parametrize(
    ("time", "levels"),
    [
        (6.088717, (0.4, 0.7, 0.05)),  # Between the arrivals of two waves it is briefly negative.
        (6.287809, (0.42, 0.7, 0.05)),  # It is positive during a whole period of the leaf springs.
    ],
)
def test_the_transition_is_at_the_first_zero_of_the_velocity(time, levels):
    positions = (1.9, 3.1, 3.2)
    steps = [(s * x, tau) for s in (-1.0, 1.0) for x, tau in zip(positions, levels, strict=True)]
    profile = sp.Prestress(0.03, 0.03, 1e-4, steps=tuple(steps))
    exact = sp.theory.exact_transition_displacement(profile, 1.0)
    assert exact.time == pytest.approx(time, rel=1e-6)
    part = Part(fast_fronts(profile, 0.0, "total", 8.0, 1.0), 1.0, until=8.0)
    times = np.append(np.linspace(0.01, exact.time - 1e-6, 5000), exact.time + 1e-6)
    velocity = part.velocity(np.zeros(times.size), times)
    assert np.all(velocity[:-1] > 0.0)
    assert velocity[-1] < 0.0


@pytest.mark.parametrize(
    ("edge", "ratio", "refinements"),
    [(8.0, 0.0, (1, 3)), (12.0, 0.0, (1, 3, 10)), (20.0, 0.1, (1, 3)), (50.0, 0.0, (1, 3))],
)
def test_a_slow_front_behind_a_stretch_of_nearly_no_prestress_is_exact(edge, ratio, refinements):
    """The characteristics that drive it entered where T - x is constant to rounding."""
    profile = sp.Prestress(-0.2, 0.0, 2.0, steps=((edge, -0.3),))
    entry = brentq(lambda e: integral(profile, e, edge + 2.0), 0.0, edge, xtol=1e-14)
    rate = lambda x: float(slowness(profile(np.asarray(x)), ratio))
    exact = quad(rate, 0.0, entry, epsabs=1e-12)[0] - entry + edge + 2.0
    panels = set()
    for refinement in refinements:
        rupture = Rupture(profile, 0.0, ratio, "total", edge + 3.0, refinement)
        assert float(rupture.release_time(edge + 2.0)) == pytest.approx(exact, rel=1e-9)
        assert rupture.limit is None
        panels.add(len(rupture.stretches[0].panels))
    assert len(panels) == len(refinements)


@pytest.mark.parametrize("gamma", [0.0, 0.65])
def test_the_number_of_panels_of_a_fast_front_is_proportional_to_the_refinement(gamma):
    counts = []
    for refinement in (1, 2, 5):
        front = FastFront(sp.Prestress(0.5, 0.5, width=None), gamma, 0.1, "total", refinement)
        panels, _ = front.panels_to_right(Point(0.0, 0.0), stop=30.0, until=np.inf)
        counts.append(len(panels))
    assert counts == [counts[0], 2 * counts[0], 5 * counts[0]]


@pytest.mark.parametrize("edge", [12.0, 20.0])
def test_leaf_springs_do_not_change_this_result(edge):
    profile = sp.Prestress(0.5, 0.0, 2.0, steps=((edge, -0.3),))
    times = []
    for refinement in (1, 3, 6):
        rupture = Rupture(profile, 0.1, 0.0, "total", edge + 1.0, refinement)
        times.append(float(rupture.release_time(edge + 1.0)))
        assert rupture.limit is None
    assert times == pytest.approx([times[-1]] * 3, rel=1e-9)


def test_a_front_that_rests_goes_on_when_prestress_far_away_moves_it():
    """Between the Gaussian and the far level the pre-stress is 0.

    No characteristic from there can move the front.
    """
    profile = sp.Prestress(-0.6, 0.0, steps=((15.0, 0.01),))
    rupture = Rupture(profile, 0.0, 0.1, "total", 60.0)
    for x in (-5.44, -5.5, -5.6):
        entry = brentq(lambda e, x=x: integral(profile, x, e), 0.0, 200.0, xtol=1e-14)
        rate = lambda x: float(slowness(profile(np.asarray(x)), 0.1))
        arrival = quad(rate, 0.0, 15.0, epsabs=1e-12, points=[4.0])[0]
        arrival += (entry - 15.0) * float(slowness(0.01, 0.1))
        exact = arrival + entry - x
        assert float(rupture.release_time(x)) == pytest.approx(exact, rel=1e-9)
    resting = rupture.fronts_at(25.0)[0]
    assert rupture.fronts_at(34.0)[0] == pytest.approx(resting, abs=1e-9)


@pytest.mark.parametrize(("ratio", "depth"), [(0.0, 3.617884220), (0.1, 3.036086347)])
def test_the_depth_of_a_barrier(ratio, depth):
    """Lattices with dx = 0.02, 0.01 and 0.005, extrapolated, give 3.62 and 3.03."""
    computed = barrier_depth(0.5, -0.5, 0.65, ratio)
    assert computed == pytest.approx(depth, abs=1e-8)
    # A pulse that has become steady within a scene stops at the same depth.
    scene = sp.Prestress(0.5, 0.5, steps=((20.0, -0.5),))
    ((_, right),) = Rupture(scene, 0.65, ratio, "total", 24.0).front_ends
    assert right.x - 20.0 == pytest.approx(computed, abs=1e-8)


def test_the_depth_scales_with_the_leaf_springs_and_falls_with_the_level():
    half = 0.5 * barrier_depth(0.4, -0.3, 0.25)
    assert barrier_depth(0.4, -0.3, 1.0) == pytest.approx(half, rel=1e-10)
    depths = [barrier_depth(0.4, level, 0.65, 0.1) for level in (-0.1, -0.3, -1.0, -3.0)]
    assert np.all(np.diff(depths) < 0.0)
    assert sp.theory.barrier_depth_estimate(0.5, -0.5, 0.65) == pytest.approx(2.1328, abs=1e-4)


def test_a_front_that_was_not_followed_is_unknown_afterwards():
    points = ((-9.34, 0.187), (-2.75, -0.0097), (-1.504, -0.711), (6.42, -0.368), (7.57, -0.46))
    prestress = sp.Prestress(0.187, -0.46, 0.9, points=points)
    rupture = Rupture(prestress, 0.65, 0.1, "total", 20.0)
    ((left_end, _),) = rupture.front_ends
    assert left_end.reason == "unresolved"
    known = rupture.fronts_at(0.99 * left_end.time)
    assert left_end.x < known[0] < 0.0 < known[1]
    left, right = rupture.fronts_at(20.0)
    assert np.isnan(left) and right > 0.0
