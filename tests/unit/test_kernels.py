"""Roots of polynomials, and releases and sticks within a step, at their edges."""

import math
from functools import cache

import numba
import numpy as np
import pytest
import tolerances as tol
from numpy.polynomial.polynomial import polyfromroots

import slippulse as sp
from slippulse.solver import arrays, foresight, stencils
from slippulse.solver.lattice import Lattice


@cache
def from_python(kernel):
    """A function that calls a kernel as another kernel would, where rounding matters: compiled."""
    return numba.njit(lambda *arguments: kernel(*arguments))


def test_crossing_finds_a_root_of_zero_slope_and_one_at_the_end():
    hard = ([-0.125, 0.75, -1.5, 1.0], 0.5, tol.ROOT ** (1.0 / 3.0)), ([-1.0, 1.0], 1.0, tol.ROOT)
    crossing = from_python(foresight.crossing)
    for coefficients, expected, accuracy in hard:
        root = crossing(np.array(coefficients), len(coefficients) - 1, 0.0, 1.0)
        assert root == pytest.approx(expected, abs=accuracy)


def stop(coefficients, h: float, now: float = 0.0):
    """Time at which a block of this velocity sticks, () if never; None if it is not finite."""
    top = len(coefficients)
    motion, forecast = arrays.make_motion(top + 1, 3), arrays.make_scratch(3, top - 1).forecast
    motion.w[1:, 1] = [c * math.factorial(k) for k, c in enumerate(coefficients)]
    from_python(stencils.velocity_after)(motion.velocity, motion.w, 1, 2, h, top - 1)
    finite = from_python(foresight.find_sticks)(motion, forecast, 1, 2, 1, now, h, top)
    return tuple(forecast.stick_time[: forecast.sticks.n]) if finite else None


# Products with a positive polynomial; the dip is below 0 for a hundredth of the time only.
DIP = polyfromroots([0.3, 0.31, 1j, -1j]).real
NO_DIP = polyfromroots([0.3 + 0.01j, 0.3 - 0.01j, 1j, -1j]).real
STOPS = {
    "plain": ([0.5, -1.0, 0.0, 0.0, 0.0], 0.8, (0.5,)),
    "dip": (DIP, 0.9, (0.3,)),
    "none": (NO_DIP, 0.9, ()),
    # Released at the end of the last step: the acceleration is the rounding of the stress.
    "just released": ([0.0, -1e-16, 0.0, 3e-14, 0.0], 1.0, ()),
}


@pytest.mark.parametrize(("coefficients", "h", "stops"), STOPS.values(), ids=STOPS)
def test_a_block_sticks_where_its_velocity_passes_zero(coefficients, h, stops):
    assert stop(coefficients, h) == pytest.approx(stops, abs=1e3 * tol.ROOT)
    assert stop([np.nan, *coefficients[1:]], h) is None


@pytest.mark.parametrize("released", [0.0, 0.1, 0.17])
@pytest.mark.parametrize("rounding", [-1e-15, 0.0, 1e-15])
def test_the_zero_at_the_start_of_a_block_just_released_is_no_stick(released, rounding):
    """Velocity (t - t_r) - 2 (t - t_r)^2 is 0 at the release, but for rounding, and 0.5 later."""
    coefficients = [-released - 2.0 * released**2 + rounding, 1.0 + 4.0 * released, -2.0, 0.0, 0.0]
    assert stop(coefficients, 0.8, released) == pytest.approx((released + 0.5,), abs=tol.ROOT)


def test_a_stick_at_the_end_of_the_step_is_found_there():
    """The two evaluations of the velocity may differ in the sign of a rounding error."""
    random = np.random.default_rng(0)
    for _ in range(2000):
        coefficients = random.uniform([0.1, -3, -1, -1, -1], [1, -1, 1, 1, 1])
        if from_python(foresight.polynomial)(coefficients, 4, 1.0) < 0.0:
            root = from_python(foresight.crossing)(coefficients, 4, 0.0, 1.0)
            for h in (np.nextafter(root, 0.0), root, np.nextafter(root, 2.0)):
                assert stop(coefficients, h) in ((), (pytest.approx(root, abs=1e3 * tol.ROOT),))


# Stress, speed and slowing of a neighbour, step, time, and the release.
RELEASES = [
    # Stress 0.9 + 3.2 t - 6.4 t^2 passes 1, and comes back below it at 0.4665.
    (0.9, 3.2, 12.8, 0.5, 0.0, min(np.roots([-6.4, 3.2, -0.1]))),
    (0.9, 3.2, 12.8, 0.6, 0.47, math.inf),
    # Stress of at most 1.00125, between two instants at which it is evaluated; and 0.99925.
    (0.9, 0.9, 4.0, 1.0, 0.0, min(np.roots([-2.0, 0.9, -0.1]))),
    (0.898, 0.9, 4.0, 1.0, 0.0, math.inf),
    # Above from the start.
    (1.0, 0.0, 0.0, 0.5, 0.0, 0.0),
    (0.9, 1.0, 0.0, 0.5, 0.2, 0.2),
]


@pytest.mark.parametrize("case", RELEASES)
def test_a_block_is_released_when_its_stress_passes_the_threshold(case):
    (height, speed, slowing), (h, now, release) = case[:3], case[3:]
    motion, forecast = arrays.make_motion(6, 5), arrays.make_scratch(5, 4).forecast
    motion.w[1, 1], motion.w[2, 1], motion.tau[2] = speed, -slowing, height
    medium = Lattice(sp.Scene("stress", sp.Prestress(0.5, 0.5), 1.0, dx=1.0), None, 0.0).medium
    time, stress = from_python(foresight.foresee_release)(medium, motion, forecast, 2, now, h, 5)
    assert time == pytest.approx(release, abs=tol.ROOT)
    assert stress == pytest.approx(height + speed * now - slowing * now**2 / 2.0, rel=tol.STENCIL)
