"""Each kernel of the Taylor step against numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tolerances as tol
from reference.from_python import from_python

from slippulse.model.scene import ORDERS
from slippulse.solver import polynomials, stencils

N = 37


@pytest.fixture
def random():
    return np.random.default_rng(7)


@pytest.mark.parametrize("leaf", [0.0, 0.65])
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_first_acceleration(random, leaf, damping):
    dx = 0.1
    w, tau = random.standard_normal((4, N)), random.standard_normal(N)
    start = w.copy()
    strain = np.append(np.diff(w[0]) / dx, 0.0)
    from_python(stencils.first_acceleration)(w, strain, tau, 1, N - 1, 1.0 / dx, leaf, damping)
    slip, velocity = start[:2]
    expected = np.diff(slip, 2) / dx**2 - leaf * slip[1:-1] + tau[1:-1] + damping * np.diff(velocity, 2)
    assert w[2, 1:-1] == pytest.approx(expected, rel=tol.STENCIL, abs=tol.STENCIL / dx**2)
    w[2, 1:-1] = start[2, 1:-1]
    assert np.array_equal(w, start)


@pytest.mark.parametrize("leaf", [0.0, 0.65])
@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_next_derivative(random, leaf, damping):
    w = random.standard_normal((6, N))
    start = w.copy()
    from_python(stencils.next_derivative)(w, 4, 3, N - 5, 25.0, leaf, damping)
    lower, upper = start[2], start[3]
    expected = 25.0 * np.diff(lower, 2) - leaf * lower[1:-1] + damping * np.diff(upper, 2)
    assert w[4, 3 : N - 5] == pytest.approx(expected[2 : N - 6], rel=tol.STENCIL, abs=25.0 * tol.STENCIL)
    w[4, 3 : N - 5] = start[4, 3 : N - 5]
    assert np.array_equal(w, start)


def test_no_block_is_passed_over_when_the_last_is_before_the_first(random):
    w = random.standard_normal((6, N))
    start = w.copy()
    from_python(stencils.next_derivative)(w, 4, 5, 5, 25.0, 0.1, 0.1)
    from_python(stencils.next_derivative)(w, 4, 5, 3, 25.0, 0.1, 0.1)
    assert np.array_equal(w, start)


@pytest.mark.parametrize("order", ORDERS)
def test_velocity_and_slip_are_the_taylor_polynomials(random, order):
    w = random.standard_normal((order + 2, N))
    first, last, step = 4, 30, 0.3
    taylor = [step**k / math.factorial(k) for k in range(order + 2)]
    velocity = sum(taylor[k] * w[k + 1] for k in range(order + 1))
    increment = sum(taylor[k] * w[k] for k in range(1, order + 2))
    start = w.copy()
    out = np.zeros(N)
    from_python(stencils.velocity_after)(out, w, first, last, step, order)
    assert out[first:last] == pytest.approx(velocity[first:last], rel=tol.STENCIL, abs=tol.STENCIL)
    assert not out[:first].any() and not out[last:].any()
    assert np.array_equal(w, start)

    from_python(stencils.advance_slip)(w, out, first, last, step, order)
    inside = slice(first, last)
    assert w[2, inside] == pytest.approx(increment[inside], rel=tol.STENCIL, abs=tol.STENCIL)
    assert w[0, inside] == pytest.approx((start[0] + increment)[inside], rel=tol.STENCIL, abs=tol.STENCIL)
    assert np.array_equal(w[1, inside], out[inside])
    for outside in (slice(0, first), slice(last, N)):
        assert np.array_equal(w[:, outside], start[:, outside])


def test_advance_strain(random):
    strain, w = random.standard_normal(N), random.standard_normal((4, N))
    expected = strain[:-1] + 10.0 * np.diff(w[2])
    from_python(stencils.advance_strain)(strain, w, 0, N - 1, 10.0)
    assert strain[:-1] == pytest.approx(expected, rel=tol.STENCIL, abs=10.0 * tol.STENCIL)


def test_stretching(random):
    w = random.standard_normal((3, N))
    velocity, acceleration = w[1], w[2]
    square, product = from_python(stencils.stretching)(w, 0, N - 1)
    assert square == pytest.approx(np.sum(np.diff(velocity) ** 2), rel=tol.STENCIL * N)
    assert product == pytest.approx(np.sum(np.diff(velocity) * np.diff(acceleration)), abs=tol.STENCIL * N)


@pytest.mark.parametrize("order", ORDERS)
def test_what_may_stop_is_counted(order):
    """Velocity 0 after the step, positive, negative, not a number, positive after a dip, and negative after another."""
    w, out, h = np.zeros((order + 2, 8)), np.zeros(8), 1.0
    w[1] = [0.0, 1.0, -1e-30, np.nan, 1.0, 1.0, 1.0, 1.0]
    w[2] = [0.0, 0.0, 0.0, 0.0, -1.1, -1.1, -1.0, -1.0 - 1e-15]
    w[3, 4:] = [2.0, 0.0, 0.0, 2.0]
    assert from_python(stencils.velocity_after)(out, w, 0, 8, h, order) == 5
    assert from_python(stencils.velocity_after)(out, w, 4, 7, h, order) == 2
    assert out[[4, 5, 6]] == pytest.approx([0.9, -0.1, 0.0], abs=tol.STENCIL)


def test_polynomial(random):
    coefficients = random.standard_normal(7)
    for h in (0.0, 0.3, -1.7):
        expected = np.polynomial.polynomial.polyval(h, coefficients)
        assert from_python(polynomials.polynomial)(coefficients, 6, h) == pytest.approx(
            expected, rel=tol.STENCIL
        )


def test_slope(random):
    coefficients = random.standard_normal(7)
    slope = np.polynomial.polynomial.polyder(coefficients)
    for h in (0.0, 0.3, -1.7):
        expected = np.polynomial.polynomial.polyval(h, slope)
        assert from_python(polynomials.slope)(coefficients, 6, h) == pytest.approx(expected, rel=tol.STENCIL)


@pytest.mark.parametrize("lower", [0.0, 0.01])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("seed", range(10))
def test_crossing_finds_the_one_root_between_the_ends(seed, sign, lower):
    """A polynomial with one real root in the interval, and others outside it and in the complex plane."""
    random = np.random.default_rng(seed)
    h = float(random.uniform(0.01, 2.0))
    inside = float(random.uniform(0.02, 0.98)) * h
    pair = complex(random.standard_normal(), random.uniform(0.3, 2.0))
    roots = [inside, -random.uniform(0.5, 2.0), h + random.uniform(0.5, 2.0), pair, pair.conjugate()]
    coefficients = sign * np.real(np.polynomial.polynomial.polyfromroots(roots))
    found = from_python(polynomials.crossing)(coefficients, 5, lower * h, h)
    assert found == pytest.approx(inside, abs=tol.ROOT)


def test_crossing_finds_a_root_with_zero_slope():
    assert from_python(polynomials.crossing)(
        np.array([-0.125, 0.75, -1.5, 1.0]), 3, 0.0, 1.0
    ) == pytest.approx(0.5, abs=tol.ROOT ** (1.0 / 3.0))


def test_crossing_finds_a_root_at_the_end():
    assert from_python(polynomials.crossing)(np.array([-1.0, 1.0]), 1, 0.0, 1.0) == pytest.approx(
        1.0, abs=tol.ROOT
    )
