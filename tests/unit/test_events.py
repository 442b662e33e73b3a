"""Events within a step: when they happen, and what they change."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tolerances as tol

from slippulse.lattice import events, stencils
from slippulse.model import ORDERS


def stopping_time(velocity_coefficients: np.ndarray, h: float, now: float = 0.0) -> tuple[int, float]:
    """What `find_sticks` says of one block whose velocity is this polynomial: how many sticks, and when."""
    top = velocity_coefficients.size
    w = np.zeros((top + 1, 3))
    w[1:, 1] = [c * math.factorial(k) for k, c in enumerate(velocity_coefficients)]
    velocity = np.zeros(3)
    stencils.velocity_after(velocity, w, 1, 2, h, top - 1)
    blocks, times, scratch = np.zeros(3, dtype=np.int64), np.zeros(3), np.zeros((2, top + 1))
    number = events.find_sticks(w, velocity, 1, 2, 1, blocks, times, 0, scratch[0], scratch[1], now, top, h)
    assert number != 1 or blocks[0] == 1
    return number, times[0]


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
    w, velocity = np.zeros((6, 6)), np.zeros(6)
    w[1], w[2] = 1.0, -2.0
    stencils.velocity_after(velocity, w, 1, 5, 1.0, 4)
    blocks, times, scratch = np.zeros(6, dtype=np.int64), np.zeros(6), np.zeros((2, 6))
    assert (
        events.find_sticks(w, velocity, 1, 5, 4, blocks, times, 0, scratch[0], scratch[1], 0.0, 5, 1.0) == 4
    )
    assert list(blocks[:4]) == [1, 2, 3, 4] and times[:4] == pytest.approx(0.5, abs=tol.ROOT)
    assert (
        events.find_sticks(w, velocity, 1, 5, 2, blocks, times, 0, scratch[0], scratch[1], 0.0, 5, 1.0) == 2
    )


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
        root = stencils.crossing(coefficients, 4, 0.0, 1.0)
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
    tau = np.array([0.0, 0.0, height, 0.0, 0.0])
    scratch, zeros = np.zeros((2, 6)), np.zeros(5)
    when, stress = events.foresee_release(
        scratch[0], scratch[1], w, zeros, zeros, tau, 2, now, h, 1.0, 0.0, 0.0, True, 5
    )
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


@pytest.mark.parametrize("order", ORDERS)
def test_a_difference_some_time_later(order):
    """Every derivative of a polynomial a time later, against numpy."""
    top, s = order + 1, -0.3
    difference = np.random.default_rng(order).standard_normal((top + 1, events.COLUMNS))
    values = np.zeros(events.COLUMNS)
    for lowest in range(top + 1):
        events.evaluate(values, difference, lowest, top, s)
        for p in range(events.COLUMNS - 1):
            row = np.polynomial.Polynomial([difference[k, p] / math.factorial(k) for k in range(top + 1)])
            expected = row.deriv(lowest)(s) if lowest else row(s)
            assert values[p] == pytest.approx(expected, rel=tol.STENCIL, abs=tol.STENCIL)


class Event:
    """Twenty sliding blocks with random slip and velocity, and an event among them, on its own and expanded anew."""

    size, dx, leaf, now, h = 60, 1.0, 0.3, 0.2, 0.5

    def __init__(self, order: int, stuck: bool, beta: float, block: int, first: int, last: int) -> None:
        self.top, self.beta, self.block, self.stuck = order + 1, beta, block, stuck
        random = np.random.default_rng(order)
        self.tau = random.uniform(0.2, 0.5, self.size)
        self.slip, velocity = np.zeros(self.size), np.zeros(self.size)
        self.slip[first:last] = random.uniform(0.5, 0.6, last - first)
        velocity[first:last] = random.uniform(1.0, 1.1, last - first)
        self.sliding = np.zeros(self.size)
        self.sliding[first:last] = 1.0
        if stuck:
            # Its velocity passes 0 at the event.
            self.sliding[block] = 1.0
            w = self.expanded(self.slip, velocity, self.sliding)
            for _ in range(60):
                velocity[block] -= self.at(w, self.now, 1)[block]
                w = self.expanded(self.slip, velocity, self.sliding)
        self.w = self.expanded(self.slip, velocity, self.sliding)
        self.before = self.w.copy()
        self.after = self.sliding.copy()
        self.after[block] = 0.0 if stuck else 1.0
        self.offset, self.velocity = np.zeros(self.size), np.zeros(self.size)
        inside = np.flatnonzero(self.sliding)
        stencils.velocity_after(self.velocity, self.w, inside[0], inside[-1] + 1, self.h, order)

    def expanded(self, slip, velocity, sliding):
        """Derivatives of slip of the whole lattice."""
        w = np.zeros((self.top + 1, self.size))
        w[0], w[1] = slip, velocity * sliding
        for k in range(2, self.top + 1):
            force = np.diff(w[k - 2], 2) / self.dx**2 - self.leaf * w[k - 2, 1:-1]
            force += self.beta * np.diff(w[k - 1], 2) / self.dx**2
            w[k, 1:-1] = sliding[1:-1] * (force + (self.tau[1:-1] if k == 2 else 0.0))
        return w

    def at(self, w, time, derivative):
        """One derivative of slip a time after ``w``."""
        powers = [
            time ** (k - derivative) / math.factorial(k - derivative) for k in range(derivative, self.top + 1)
        ]
        return np.tensordot(powers, w[derivative:], 1)

    def happen(self):
        """Take the event. Returns the first block that changed and the one after the last, and the kink."""
        runs = np.flatnonzero(np.diff(np.concatenate([[0.0], self.after, [0.0]]))).reshape(-1, 2)
        starts, ends = np.zeros((2, self.size), dtype=np.int64)
        starts[: len(runs)], ends[: len(runs)] = runs.T
        strain = np.append(np.diff(self.slip) / self.dx, 0.0)
        top, scratch = self.top, np.zeros((2, self.top + 1))
        return events.change_course(
            self.w, self.offset, strain, self.tau, self.velocity, starts, ends, len(runs), self.block, self.stuck,
            self.now, self.h, np.full(self.size, np.inf), np.zeros(self.size, dtype=np.int64), np.zeros(self.size), 0,
            np.zeros((top + 1, events.COLUMNS)), np.zeros(top + 3), np.zeros(events.COLUMNS), scratch[0], scratch[1],
            False, True, self.dx, self.leaf, self.beta, top,
        )  # fmt: skip

    def difference(self):
        """Derivatives at the event of what it changes, over the whole lattice, from the polynomials before it."""
        found = np.zeros((self.top + 1, self.size))
        highest = np.zeros((2, self.size))
        before = np.concatenate([[self.at(self.before, self.now, k) for k in range(self.top + 1)], highest])

        def force(derivatives, k):
            slip, velocity = derivatives[k - 2], derivatives[k - 1]
            out = np.zeros(self.size)
            out[1:-1] = (np.diff(slip, 2) + self.beta * np.diff(velocity, 2)) / self.dx**2
            return out - self.leaf * slip

        for k in range(2, self.top + 1):
            found[k] = self.after * force(found, k)
            if self.stuck:
                found[k, self.block] = -before[k, self.block]
            else:
                pull = force(before, k)[self.block] + (self.tau[self.block] if k == 2 else 0.0)
                found[k, self.block] += pull
        return found


@pytest.mark.parametrize("beta", [0.0, 0.1])
@pytest.mark.parametrize("stuck", [False, True])
@pytest.mark.parametrize("order", ORDERS)
def test_an_event_changes_what_the_whole_lattice_would_change(order, stuck, beta):
    """What spreads from an event over the whole lattice, within reach and beyond it."""
    event = Event(order, stuck, beta, 25 if stuck else 40, 20, 40)
    expected = event.difference()
    _, first, last, *_ = event.happen()
    change = event.w - event.before
    change[0] = event.offset
    reach = order - 1 if beta else (order - 1) // 2
    assert last - first <= 2 * reach + 1
    rounding = 1e3 * tol.STENCIL
    beside = np.arange(event.size) != event.block
    for k in range(event.top + 1):
        assert event.at(change, event.now, k)[beside] == pytest.approx(expected[k][beside], abs=rounding)
    changed = np.flatnonzero(np.abs(change).max(axis=0) > rounding)
    assert changed.min() >= first and changed.max() < last
    after = event.at(event.w, event.h, 1)
    assert event.velocity[first:last] == pytest.approx(after[first:last], abs=rounding)


@pytest.mark.parametrize("order", ORDERS)
def test_a_released_block_sets_off_as_its_neighbours_pull(order):
    """Its polynomial holds slip, velocity 0 and the force of the neighbours at the event."""
    event = Event(order, False, 0.1, 40, 20, 40)
    slip, velocity = event.at(event.w, event.now, 0), event.at(event.w, event.now, 1)
    expected = event.expanded(slip, velocity, event.after)
    event.happen()
    found = [event.at(event.w, event.now, k)[40] for k in range(1, 3)]
    assert found == pytest.approx([0.0, expected[2, 40]], abs=1e3 * tol.STENCIL)
    assert event.offset[40] + event.at(event.w, event.now, 0)[40] == pytest.approx(0.0, abs=1e3 * tol.STENCIL)


@pytest.mark.parametrize("order", ORDERS)
def test_a_block_that_sticks_stays_where_it_is(order):
    event = Event(order, True, 0.1, 25, 20, 40)
    where = event.at(event.before, event.now, 0)[25]
    event.happen()
    assert np.all(event.w[1:, 25] == 0.0) and event.velocity[25] == 0.0
    assert event.w[0, 25] + event.offset[25] == pytest.approx(where, rel=tol.STENCIL)


@pytest.mark.parametrize("stuck", [False, True])
def test_an_event_bends_the_dissipation(stuck):
    """Sum over neighbours of dv times the change of da, over the whole lattice."""
    event = Event(8, stuck, 0.1, 25 if stuck else 40, 20, 40)
    velocity, change = event.at(event.w, event.now, 1), event.difference()[2]
    *_, kink = event.happen()
    assert kink == pytest.approx(np.sum(np.diff(velocity) * np.diff(change)), rel=1e3 * tol.STENCIL)
