"""Each kernel of the Taylor step against numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tolerances as tol

from slippulse.lattice import localised, stencils
from slippulse.model import ORDERS

N = 37


@pytest.fixture
def random():
    return np.random.default_rng(7)


@pytest.mark.parametrize("leaf", [0.0, 0.65])
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_first_acceleration(random, leaf, damping):
    dx = 0.1
    slip, velocity, tau = random.standard_normal((3, N))
    strain = np.diff(slip) / dx
    out = np.empty(N - 2)
    stencils.first_acceleration(out, strain, velocity, slip, tau, 1.0 / dx, leaf, damping)
    expected = np.diff(slip, 2) / dx**2 - leaf * slip[1:-1] + tau[1:-1] + damping * np.diff(velocity, 2)
    assert out == pytest.approx(expected, rel=tol.STENCIL, abs=tol.STENCIL / dx**2)


@pytest.mark.parametrize("leaf", [0.0, 0.65])
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_next_derivative(random, leaf, damping):
    lower, upper = random.standard_normal((2, N))
    out = np.empty(N - 2)
    stencils.next_derivative(out, lower, upper, 25.0, leaf, damping)
    expected = 25.0 * np.diff(lower, 2) - leaf * lower[1:-1] + damping * np.diff(upper, 2)
    assert out == pytest.approx(expected, rel=tol.STENCIL, abs=25.0 * tol.STENCIL)


@pytest.mark.parametrize("order", ORDERS)
def test_velocity_and_slip_are_the_taylor_polynomials(random, order):
    w = random.standard_normal((order + 2, N))
    first, last, step = 4, 30, 0.3
    taylor = [step**k / math.factorial(k) for k in range(order + 2)]
    velocity = sum(taylor[k] * w[k + 1] for k in range(order + 1))
    increment = sum(taylor[k] * w[k] for k in range(1, order + 2))
    start = w.copy()
    out = np.zeros(N)
    stencils.velocity_after(out, w, first, last, step, order)
    assert out[first:last] == pytest.approx(velocity[first:last], rel=tol.STENCIL, abs=tol.STENCIL)
    assert not out[:first].any() and not out[last:].any()
    assert np.array_equal(w, start)

    stencils.advance_slip(w, out, first, last, step, order)
    inside = slice(first, last)
    assert w[2, inside] == pytest.approx(increment[inside], rel=tol.STENCIL, abs=tol.STENCIL)
    assert w[0, inside] == pytest.approx((start[0] + increment)[inside], rel=tol.STENCIL, abs=tol.STENCIL)
    assert np.array_equal(w[1, inside], out[inside])
    for outside in (slice(0, first), slice(last, N)):
        assert np.array_equal(w[:, outside], start[:, outside])


def test_advance_strain(random):
    strain, increment = random.standard_normal(N - 1), random.standard_normal(N)
    expected = strain + 10.0 * np.diff(increment)
    stencils.advance_strain(strain, increment, 10.0)
    assert strain == pytest.approx(expected, rel=tol.STENCIL, abs=10.0 * tol.STENCIL)


def test_stretching(random):
    velocity, acceleration = random.standard_normal((2, N))
    square, product = stencils.stretching(velocity, acceleration)
    assert square == pytest.approx(np.sum(np.diff(velocity) ** 2), rel=tol.STENCIL * N)
    assert product == pytest.approx(np.sum(np.diff(velocity) * np.diff(acceleration)), abs=tol.STENCIL * N)


def test_count_stopping_counts_what_ends_or_dips_below_and_what_is_not_a_number():
    after = np.array([0.0, -1e-30, 1.0, np.nan, -np.inf, np.inf])
    still, steady = np.zeros(6), np.ones(6)
    assert stencils.count_stopping(after, steady, still, 0.1, 0.0) == 3
    assert stencils.count_stopping(after, steady, still, 0.1, -1.0) == 2
    slowing = np.array([0.0, 0.0, -11.0, 0.0, 0.0, -9.0])
    assert stencils.count_stopping(after, steady, slowing, 0.1, 0.0) == 4


def test_polynomial(random):
    coefficients = random.standard_normal(7)
    for h in (0.0, 0.3, -1.7):
        expected = np.polynomial.polynomial.polyval(h, coefficients)
        assert stencils.polynomial(coefficients, 6, h) == pytest.approx(expected, rel=tol.STENCIL)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("seed", range(10))
def test_crossing_finds_the_one_root_between_the_ends(seed, sign):
    """A polynomial with one real root in the interval, and others outside it and in the complex plane."""
    random = np.random.default_rng(seed)
    h = float(random.uniform(0.01, 2.0))
    inside = float(random.uniform(0.02, 0.98)) * h
    pair = complex(random.standard_normal(), random.uniform(0.3, 2.0))
    roots = [inside, -random.uniform(0.5, 2.0), h + random.uniform(0.5, 2.0), pair, pair.conjugate()]
    coefficients = sign * np.real(np.polynomial.polynomial.polyfromroots(roots))
    found = stencils.crossing(coefficients, 5, h)
    assert found == pytest.approx(inside, abs=tol.ROOT)


def test_crossing_finds_a_root_with_zero_slope():
    assert stencils.crossing(np.array([-0.125, 0.75, -1.5, 1.0]), 3, 1.0) == pytest.approx(
        0.5, abs=tol.ROOT ** (1.0 / 3.0)
    )


def test_crossing_finds_a_root_at_the_end():
    assert stencils.crossing(np.array([-1.0, 1.0]), 1, 1.0) == pytest.approx(1.0, abs=tol.ROOT)


def stopping_time(velocity_coefficients: np.ndarray, h: float) -> tuple[int, float]:
    """What `find_sticks` says of one block whose velocity is this polynomial."""
    top = velocity_coefficients.size
    w = np.zeros((top + 1, 3))
    w[1:, 1] = [c * math.factorial(k) for k, c in enumerate(velocity_coefficients)]
    velocity = np.zeros(3)
    stencils.velocity_after(velocity, w, 1, 2, h, top - 1)
    blocks, times = np.zeros(3, dtype=np.int64), np.zeros(3)
    return localised.find_sticks(w, velocity, np.array([1]), np.array([2]), 1, blocks, times, top, h)


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


def test_a_stress_that_passes_the_threshold_within_the_step_releases():
    """Between blocks with opposite accelerations: stress 0.9 + 3.2 h (1 - h/0.5) passes 1 at h = 0.0335."""
    dx = 1.0
    w = np.zeros((6, 5))
    w[1, 1], w[2, 1] = 3.2, -12.8
    tau = np.array([0.0, 0.0, 0.9, 0.0, 0.0])
    edges, times, totals = np.zeros(7, dtype=np.int64), np.zeros(7), np.zeros(7)
    _, first = localised.find_releases(
        w, np.zeros(5), tau, np.array([1]), np.array([2]), 1, edges, times, totals,
        True, dx, 0.0, 0.0, True, 5, 0.5, 1e-12,
    )  # fmt: skip
    expected = min(np.roots([-6.4, 3.2, -0.1]))
    assert first == pytest.approx(expected, abs=tol.ROOT)
