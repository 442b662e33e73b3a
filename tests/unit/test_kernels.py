"""The kernels find roots of polynomials, releases and sticks, also in the limiting cases."""

import math
from functools import cache

import numba
import numpy as np
import pytest
import tolerances as tol
from numpy.polynomial.polynomial import polyfromroots

import slippulse as sp
from slippulse.solver import arrays, event_prediction, stencils
from slippulse.solver.lattice import Lattice


@cache
def from_python(kernel):
    """Return a compiled function that calls a kernel, since compilation can change the rounding."""
    return numba.njit(lambda *arguments: kernel(*arguments))


def test_crossing_finds_a_root_of_zero_slope_and_one_at_the_end():
    hard = ([-0.125, 0.75, -1.5, 1.0], 0.5, tol.ROOT ** (1.0 / 3.0)), ([-1.0, 1.0], 1.0, tol.ROOT)
    crossing = from_python(event_prediction.find_crossing)
    for coefficients, expected, accuracy in hard:
        root = crossing(np.array(coefficients), len(coefficients) - 1, 0.0, 1.0)
        assert root == pytest.approx(expected, abs=accuracy)


def stick_times(coefficients, h: float, now: float = 0.0):
    """Return the times at which a block with this velocity sticks, None if it is not finite.

    The velocity is a polynomial; ``now`` is the time at which the block was released.
    """
    top = len(coefficients)
    motion, prediction = arrays.make_motion(top + 1, 3), arrays.make_scratch(3, top - 1).prediction
    motion.derivatives[1:, 1] = [c * math.factorial(k) for k, c in enumerate(coefficients)]
    from_python(stencils.compute_velocities)(
        motion.end_velocity, motion.derivatives, 1, 2, h, top - 1
    )
    finite = from_python(event_prediction.predict_sticks)(motion, prediction, 1, 2, 1, now, h, top)
    return tuple(prediction.event_time[: prediction.event_count.n]) if finite else None


# Velocities of degree 4: one is negative for a hundredth of the time, the other one never.
DIP = polyfromroots([0.3, 0.31, 1j, -1j]).real
NO_DIP = polyfromroots([0.3 + 0.01j, 0.3 - 0.01j, 1j, -1j]).real
STOPS = {
    "plain": ([0.5, -1.0, 0.0, 0.0, 0.0], 0.8, (0.5,)),
    "dip": (DIP, 0.9, (0.3,)),
    "none": (NO_DIP, 0.9, ()),
    # A block released at the end of the last step: its acceleration is a rounding error.
    "just released": ([0.0, -1e-16, 0.0, 3e-14, 0.0], 1.0, ()),
}


@pytest.mark.parametrize(("coefficients", "h", "stops"), STOPS.values(), ids=STOPS)
def test_a_block_sticks_where_its_velocity_passes_zero(coefficients, h, stops):
    assert stick_times(coefficients, h) == pytest.approx(stops, abs=1e3 * tol.ROOT)
    assert stick_times([np.nan, *coefficients[1:]], h) is None


@pytest.mark.parametrize("released", [0.0, 0.1, 0.17])
@pytest.mark.parametrize("rounding", [-1e-15, 0.0, 1e-15])
def test_the_zero_at_the_start_of_a_block_just_released_is_no_stick(released, rounding):
    """The velocity (t - t_r) - 2 (t - t_r)^2 is 0 at the release t_r and at t_r + 0.5."""
    coefficients = [-released - 2.0 * released**2 + rounding, 1.0 + 4.0 * released, -2.0, 0.0, 0.0]
    assert stick_times(coefficients, 0.8, released) == pytest.approx(
        (released + 0.5,), abs=tol.ROOT
    )


def test_a_stick_at_the_end_of_the_step_is_found_there():
    """The two evaluations of the velocity may differ in the sign of a rounding error."""
    random = np.random.default_rng(0)
    for _ in range(2000):
        coefficients = random.uniform([0.1, -3, -1, -1, -1], [1, -1, 1, 1, 1])
        if from_python(event_prediction.evaluate_polynomial)(coefficients, 4, 1.0) < 0.0:
            root = from_python(event_prediction.find_crossing)(coefficients, 4, 0.0, 1.0)
            for h in (np.nextafter(root, 0.0), root, np.nextafter(root, 2.0)):
                assert stick_times(coefficients, h) in (
                    (),
                    (pytest.approx(root, abs=1e3 * tol.ROOT),),
                )


# Initial stress of a block, speed and deceleration of its neighbour, end of the step, time of the
# search, and expected release time.
RELEASES = [
    # The stress 0.9 + 3.2 t - 6.4 t^2 passes 1 and falls below 1 again at 0.4665.
    (0.9, 3.2, 12.8, 0.5, 0.0, min(np.roots([-6.4, 3.2, -0.1]))),
    (0.9, 3.2, 12.8, 0.6, 0.47, math.inf),
    # The stress is at most 1.00125 (next line: 0.99925), between two times of evaluation.
    (0.9, 0.9, 4.0, 1.0, 0.0, min(np.roots([-2.0, 0.9, -0.1]))),
    (0.898, 0.9, 4.0, 1.0, 0.0, math.inf),
    # The stress is above the threshold from the start.
    (1.0, 0.0, 0.0, 0.5, 0.0, 0.0),
    (0.9, 1.0, 0.0, 0.5, 0.2, 0.2),
]


@pytest.mark.parametrize("case", RELEASES)
def test_a_block_is_released_when_its_stress_passes_the_threshold(case):
    (height, speed, slowing), (h, now, release) = case[:3], case[3:]
    motion, prediction = arrays.make_motion(6, 5), arrays.make_scratch(5, 4).prediction
    (
        motion.derivatives[arrays.VELOCITY, 1],
        motion.derivatives[arrays.ACCELERATION, 1],
        motion.tau[2],
    ) = (
        speed,
        -slowing,
        height,
    )
    medium = Lattice(sp.Scene("stress", sp.Prestress(0.5, 0.5), 1.0, dx=1.0), None, 0.0).medium
    time, stress = from_python(event_prediction.predict_release)(
        medium, motion, prediction, 2, now, h, 5
    )
    assert time == pytest.approx(release, abs=tol.ROOT)
    assert stress == pytest.approx(height + speed * now - slowing * now**2 / 2.0, rel=tol.STENCIL)
