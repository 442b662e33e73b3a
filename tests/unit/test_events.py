"""What a release or a stick changes, against the whole lattice."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tolerances as tol
from reference.from_python import from_python

from slippulse.model.scene import ORDERS
from slippulse.solver import arrays, events, stencils


@pytest.mark.parametrize("order", ORDERS)
def test_a_difference_some_time_later(order):
    """Every derivative of a polynomial a time later, against numpy."""
    top, s = order + 1, -0.3
    difference = np.random.default_rng(order).standard_normal((top + 1, arrays.COLUMNS))
    values = np.zeros(arrays.COLUMNS)
    for lowest in range(top + 1):
        from_python(events.evaluate)(values, difference, lowest, top, s)
        for p in range(arrays.COLUMNS - 1):
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
        from_python(stencils.velocity_after)(self.velocity, self.w, inside[0], inside[-1] + 1, self.h, order)

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
        """Take the event. Returns the first block that changed and the one after the last, ..., and the kink."""
        found = np.flatnonzero(np.diff(np.concatenate([[0.0], self.after, [0.0]]))).reshape(-1, 2)
        segments = arrays.make_segments(self.size)
        n = segments.count.n = len(found)
        segments.starts[:n], segments.ends[:n] = found.T
        strain = np.append(np.diff(self.slip) / self.dx, 0.0)
        finite, *rest = from_python(events.change_course)(
            arrays.make_medium(self.dx, self.leaf, self.beta, False, True),
            arrays.Motion(self.w, self.offset, self.velocity, strain, self.tau),
            segments,
            arrays.make_forecast(self.size, self.top - 1),
            arrays.make_scratch(self.size, self.top - 1).difference,
            arrays.Event(self.block, self.now, self.stuck),
            self.h,
            self.top,
        )
        assert finite
        return rest

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
    first, last, *_ = event.happen()
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
