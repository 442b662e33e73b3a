"""Events within a step: when they happen, and what they change."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tolerances as tol

from slippulse.lattice import events, stencils
from slippulse.model import ORDERS


def stopping_time(velocity_coefficients: np.ndarray, h: float) -> tuple[int, float]:
    """What `find_sticks` says of one block whose velocity is this polynomial: how many sticks, and when."""
    top = velocity_coefficients.size
    w = np.zeros((top + 1, 3))
    w[1:, 1] = [c * math.factorial(k) for k, c in enumerate(velocity_coefficients)]
    velocity = np.zeros(3)
    stencils.velocity_after(velocity, w, 1, 2, h, top - 1)
    blocks, times, scratch = np.zeros(3, dtype=np.int64), np.zeros(3), np.zeros((2, top + 1))
    number = events.find_sticks(w, velocity, 1, 2, blocks, times, 0, scratch[0], scratch[1], 40, 2.0, top, h)
    assert number != 1 or blocks[0] == 41
    return number, times[0] - 2.0


def test_find_sticks_finds_the_zero_of_a_velocity():
    coefficients = np.array([0.5, -1.0, -0.2, 0.1, 0.05])
    roots = np.roots(coefficients[::-1])
    expected = min(root.real for root in roots if abs(root.imag) < 1e-12 and root.real > 0.0)
    number, first = stopping_time(coefficients, 0.8)
    assert number == 1
    assert first == pytest.approx(expected, abs=tol.ROOT)


def test_find_sticks_skips_the_zero_at_the_start_of_a_block_just_released():
    number, first = stopping_time(np.array([0.0, 1.0, -2.0, 0.0, 0.0]), 0.8)
    assert number == 1
    assert first == pytest.approx(0.5, abs=tol.ROOT)


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
        if stencils.polynomial(coefficients, 4, 1.0) >= 0.0:
            continue
        root = stencils.crossing(coefficients, 4, 1.0)
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


def stressed(height: float, speed: float, slowing: float, h: float, dx: float = 1.0) -> float:
    """When a stuck block is released whose neighbour moves with ``speed`` and ``slowing``."""
    w = np.zeros((6, 5))
    w[1, 1], w[2, 1] = speed, -slowing
    tau = np.array([0.0, 0.0, height, 0.0, 0.0])
    scratch = np.zeros((2, 6))
    return events.foresee_release(scratch[0], scratch[1], w, np.zeros(5), tau, 2, h, dx, 0.0, 0.0, True, 5)


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


@pytest.mark.parametrize("order", ORDERS)
def test_translation_there_and_back(order):
    """Derivatives of a polynomial a time later, against numpy; and back again."""
    top, s = order + 1, 0.3
    random = np.random.default_rng(order)
    w, patch, back = random.standard_normal((top + 1, 40)), *np.zeros((2, top + 1, events.COLUMNS))
    share, gained, lost = np.zeros(top + 1), *np.zeros((2, events.COLUMNS))
    share[1:] = s / np.arange(1, top + 1)
    events.translate(patch, 0, w, 11, share, gained, top)
    for p in range(events.COLUMNS):
        row = np.polynomial.Polynomial([w[k, p + 11] / math.factorial(k) for k in range(top + 1)])
        for k in range(1, top + 1):
            assert patch[k, p] == pytest.approx(row.deriv(k)(s), rel=tol.STENCIL, abs=tol.STENCIL)
        assert gained[p] == pytest.approx(row(s) - row(0.0), rel=tol.STENCIL, abs=tol.STENCIL)
    events.translate(back, 0, patch, 0, -share, lost, top)
    assert back[1:] == pytest.approx(w[1:, 11 : 11 + events.COLUMNS], abs=10.0 * tol.STENCIL)
    assert lost == pytest.approx(-gained, abs=10.0 * tol.STENCIL)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("stuck", [False, True])
def test_an_event_expands_its_reach_as_the_whole_lattice_would_be(order, stuck):
    """Polynomials after an event against those of the whole lattice expanded at that instant."""
    top, size, dx, leaf, beta, now, h = order + 1, 60, 1.0, 0.3, 0.1, 0.2, 0.5
    first, last = 10, 40
    block = 38 if stuck else last
    random = np.random.default_rng(order)
    tau = random.uniform(0.2, 0.5, size)
    slip, velocity = np.zeros(size), np.zeros(size)
    slip[first:last], velocity[first:last] = np.array([[0.5], [1.0]]) + random.uniform(
        0.0, 0.1, (2, last - first)
    )

    def expanded(slip, velocity, sliding):
        w = np.zeros((top + 1, size))
        w[0], w[1] = slip, velocity * sliding
        for k in range(2, top + 1):
            force = np.diff(w[k - 2], 2) / dx**2 - leaf * w[k - 2, 1:-1] + beta * np.diff(w[k - 1], 2) / dx**2
            w[k, 1:-1] = sliding[1:-1] * (force + (tau[1:-1] if k == 2 else 0.0))
        return w

    def at(w, time, derivative):
        powers = [
            time ** (k - derivative) / math.factorial(k - derivative) for k in range(derivative, top + 1)
        ]
        return np.tensordot(powers, w[derivative:], 1)

    sliding = np.zeros(size)
    sliding[first:last] = 1.0
    w = expanded(slip, velocity, sliding)
    before = w.copy()
    after = sliding.copy()
    after[block] = 0.0 if stuck else 1.0
    expected = expanded(at(w, now, 0), at(w, now, 1), after)

    starts, ends = np.zeros(size, dtype=np.int64), np.zeros(size, dtype=np.int64)
    runs = [(first, block), (block + 1, last)] if stuck else [(first, last + 1)]
    for r, (a, b) in enumerate(runs):
        starts[r], ends[r] = a, b
    strain = np.append(np.diff(slip) / dx, 0.0)
    offset, release_at, times = np.zeros(size), np.full(size, np.inf), np.zeros(size)
    foreseen = np.zeros(size, dtype=np.int64)
    scratch = np.zeros((2, top + 1))
    events.expand_anew(
        w, offset, strain, tau, np.zeros(size), starts, ends, len(runs), block, stuck, now, h, release_at, foreseen,
        times, 0, np.zeros((top + 1, events.COLUMNS)), np.zeros((8, events.COLUMNS)), scratch[0], scratch[1], False,
        True, dx, leaf, beta, top,
    )  # fmt: skip

    reach = slice(block - events.REACH, block + events.REACH + 1)
    outside = np.ones(size, dtype=bool)
    outside[reach] = False
    rounding = 100.0 * tol.STENCIL
    assert (w - before)[:, outside] == pytest.approx(0.0, abs=rounding)
    assert offset[outside] == pytest.approx(0.0, abs=rounding)
    # Inside, the polynomials about the start of the step say at the event what those about the event say there: all of
    # them but for the highest derivatives next to blocks that were not expanded anew.
    inner = (
        slice(block - events.REACH + order, block + events.REACH + 1 - order)
        if order < 7
        else slice(block, block + 1)
    )
    for k in range(1, top + 1):
        assert at(w, now, k)[inner] == pytest.approx(expected[k, inner], rel=rounding, abs=rounding)
    assert (offset + at(w, now, 0))[reach] == pytest.approx(at(before, now, 0)[reach], abs=rounding)
