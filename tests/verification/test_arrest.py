"""A left front arrests in finite time where the positive tail of the pre-stress ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import slippulse as sp

# Level on the left; the pre-stress falls from 1 to half of it over this length on the right, and is 0 beyond.
LEVEL, LENGTH = -0.5, 3.0
RATIO, X_MINUS, ARREST = 0.1, -4.5, 9.1247


class EndingTail(sp.Prestress):
    """A ramp, which no Gaussian can be."""

    def __call__(self, x):
        x = np.asarray(x, dtype=float)
        return np.where(x < 0.0, LEVEL, np.where(x < LENGTH, 1.0 - 0.5 * x / LENGTH, 0.0))


def test_the_arrest_of_a_tail_that_ends():
    """t = T(3) + 3 - x_minus, the last characteristic entering where the tail ends."""
    crossing, _ = quad(lambda x: 1.0 / sp.theory.front_speed(1.0 - 0.5 * x / LENGTH, RATIO), 0.0, LENGTH)
    assert crossing + LENGTH - X_MINUS == pytest.approx(ARREST, abs=1e-4)
    gaps = []
    for dx in (0.04, 0.02):
        tail = EndingTail(LEVEL, 0.0)
        run = sp.simulate(
            sp.Scene("stress", prestress=tail, duration=1.5 * ARREST, dx=dx, beta=RATIO * dx, max_step=1.0)
        )
        left = run["release_time"].where(run["x"] < 0.0)
        assert float(left.max()) == pytest.approx(ARREST, rel=0.01)
        gaps.append(float(run["x"].where(left.notnull()).min()) - X_MINUS)
    # It stops short by a few blocks, and by less on the finer lattice.
    assert 0.0 < gaps[1] < gaps[0] < 3.0 * 0.04
