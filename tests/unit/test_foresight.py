"""When a stuck block is released and a sliding one sticks."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tolerances as tol
from reference.from_python import from_python

from slippulse.solver import arrays, foresight, polynomials, stencils


def blocks_at(w: np.ndarray) -> arrays.Motion:
    """Blocks with these derivatives of slip, nothing else."""
    motion = arrays.make_motion(*w.shape)
    motion.w[:] = w
    return motion


def found_sticks(w: np.ndarray, last: int, suspects: int, h: float, now: float = 0.0):
    """Blocks 1..last-1 whose velocity passes 0 between ``now`` and h, and when; None if one is not finite."""
    motion, forecast = blocks_at(w), arrays.make_forecast(w.shape[1], w.shape[0] - 2)
    from_python(stencils.velocity_after)(motion.velocity, motion.w, 1, last, h, w.shape[0] - 2)
    finite = from_python(foresight.find_sticks)(motion, forecast, 1, last, suspects, now, h, w.shape[0] - 1)
    n = forecast.sticks.n
    return (forecast.stick_block[:n], forecast.stick_time[:n]) if finite else None


def stopping_time(velocity_coefficients: np.ndarray, h: float, now: float = 0.0) -> tuple[int, float]:
    """How many sticks (-1: not finite) `find_sticks` says of one block whose velocity is this polynomial, and when."""
    top = velocity_coefficients.size
    w = np.zeros((top + 1, 3))
    w[1:, 1] = [c * math.factorial(k) for k, c in enumerate(velocity_coefficients)]
    found = found_sticks(w, 2, 1, h, now)
    if found is None:
        return -1, math.nan
    blocks, times = found
    assert list(blocks) in ([], [1])
    return len(blocks), times[0] if len(times) else math.nan


def test_find_sticks_finds_the_zero_of_a_velocity():
    coefficients = np.array([0.5, -1.0, -0.2, 0.1, 0.05])
    roots = np.roots(coefficients[::-1])
    expected = min(root.real for root in roots if abs(root.imag) < 1e-12 and root.real > 0.0)
    number, first = stopping_time(coefficients, 0.8)
    assert number == 1
    assert first == pytest.approx(expected, abs=tol.ROOT)


@pytest.mark.parametrize("released", [0.0, 0.1, 0.17])
@pytest.mark.parametrize("rounding", [-1e-15, 0.0, 1e-15])
def test_find_sticks_skips_the_zero_at_the_start_of_a_block_just_released(released, rounding):
    """Velocity (t - t_r) - 2 (t - t_r)^2 is 0 half a unit after the release, and, but for rounding, at the release."""
    coefficients = np.array([-released - 2.0 * released**2 + rounding, 1.0 + 4.0 * released, -2.0, 0.0, 0.0])
    number, first = stopping_time(coefficients, 0.8, released)
    assert number == 1
    assert first == pytest.approx(released + 0.5, abs=tol.ROOT)


def test_find_sticks_of_many_stops_at_the_last_that_may():
    """Of four blocks that all stop it looks at no more than it is told there are."""
    w = np.zeros((6, 6))
    w[1], w[2] = 1.0, -2.0
    blocks, times = found_sticks(w, 5, 4, 1.0)
    assert list(blocks) == [1, 2, 3, 4] and times == pytest.approx(0.5, abs=tol.ROOT)
    assert list(found_sticks(w, 5, 2, 1.0)[0]) == [1, 2]


def test_find_sticks_reports_a_velocity_that_is_not_finite():
    number, _ = stopping_time(np.array([np.nan, 1.0, 0.0, 0.0, 0.0]), 0.8)
    assert number == -1


def test_find_sticks_places_a_stick_at_the_end_of_the_step_there():
    """The two evaluations of the velocity, nested differently, need not agree on the sign of a rounding error."""
    random = np.random.default_rng(0)
    for _ in range(2000):
        coefficients = np.array(
            [random.uniform(0.1, 1.0), random.uniform(-3.0, -1.0), *random.uniform(-1, 1, 3)]
        )
        if from_python(polynomials.polynomial)(coefficients, 4, 1.0) >= 0.0:
            continue
        root = from_python(polynomials.crossing)(coefficients, 4, 0.0, 1.0)
        for h in (np.nextafter(root, 0.0), root, np.nextafter(root, 2.0)):
            number, first = stopping_time(coefficients, h)
            if number:
                assert first == pytest.approx(root, abs=1e3 * tol.ROOT)


def test_find_sticks_finds_a_dip_between_the_ends():
    """(s - 0.3)(s - 0.31)(1 + s^2) is below 0 for a hundredth of the time only."""
    coefficients = np.polynomial.polynomial.polyfromroots([0.3, 0.31, 1j, -1j]).real
    number, first = stopping_time(coefficients, 0.9)
    assert number == 1
    assert first == pytest.approx(0.3, abs=1e3 * tol.ROOT)
    number, _ = stopping_time(
        np.polynomial.polynomial.polyfromroots([0.3 + 0.01j, 0.3 - 0.01j, 1j, -1j]).real, 0.9
    )
    assert number == 0


@pytest.mark.parametrize("velocity", [1e-14, 1e-13])
def test_a_block_released_at_the_end_of_a_step_does_not_stick(velocity):
    """Its acceleration is the rounding of its stress, of either sign."""
    number, _ = stopping_time(np.array([0.0, -1e-16, 0.0, 3.0 * velocity, 0.0]), 1.0)
    assert number == 0


def stressed(height: float, speed: float, slowing: float, h: float, now: float = 0.0) -> float:
    """When a stuck block is released whose neighbour moves with ``speed`` and ``slowing``."""
    w = np.zeros((6, 5))
    w[1, 1], w[2, 1] = speed, -slowing
    motion, forecast = blocks_at(w), arrays.make_forecast(5, 4)
    motion.tau[2] = height
    medium = arrays.make_medium(1.0, 0.0, 0.0, False, True)
    when, stress = from_python(foresight.foresee_release)(medium, motion, forecast, 2, now, h, 5)
    assert stress == pytest.approx(height + speed * now - slowing * now**2 / 2.0, rel=tol.STENCIL)
    return when


def test_a_stress_that_passes_the_threshold_within_the_step_releases():
    """Between blocks with opposite accelerations: stress 0.9 + 3.2 h (1 - h/0.5) passes 1 at h = 0.0335."""
    expected = min(np.roots([-6.4, 3.2, -0.1]))
    assert stressed(0.9, 3.2, 12.8, 0.5) == pytest.approx(expected, abs=tol.ROOT)


def test_a_stress_that_passes_the_threshold_for_a_moment_releases():
    """Stress 0.9 + 0.9 h - 2 h^2 is at most 1.00125, between two of the instants at which it is looked at."""
    expected = min(np.roots([-2.0, 0.9, -0.1]))
    assert stressed(0.9, 0.9, 4.0, 1.0) == pytest.approx(expected, abs=tol.ROOT)
    assert stressed(0.898, 0.9, 4.0, 1.0) == math.inf


def test_a_stress_above_the_threshold_releases_at_once():
    assert stressed(1.0, 0.0, 0.0, 0.5) == 0.0
    assert stressed(0.9, 1.0, 0.0, 0.5, 0.2) == 0.2


def test_only_what_comes_later_than_an_event_is_foreseen():
    """The same stress passes the threshold at h = 0.0335 and comes back below it at 0.4665."""
    assert stressed(0.9, 3.2, 12.8, 0.6, 0.47) == math.inf
