"""Scenes off the beaten path that once gave wrong answers without a flag: right now, or flagged."""

from dataclasses import replace

import numpy as np
import pytest

from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import Rupture

# Lattices tend to this end of the front that rests and goes on; the grid of their blocks is 0.01.
END, LATTICE = 8.72, 0.01
SAME = 1e-6


def test_a_front_that_rests_goes_on():
    """The characteristic that comes to it next entered where the pre-stress is positive."""
    bump = (3.27, 1.25, 0.715)
    for refinement in (1, 2, 3):
        keys = Prestress(-0.45, -0.45, 0.95, bumps=(bump,)), 0.108, 0.1, "total", 11.565
        ((_, right),) = Rupture(*keys, refinement).front_ends
        assert right.reason == "stops"
        assert right.x == pytest.approx(END, abs=LATTICE)


def test_slip_is_never_negative_before_a_limit():
    """Next to a front that has stopped du/dt is below 0 for a short while only."""
    profile = Prestress(-0.854, 0.417, 30.0, 1.0, ((114.0, -0.189),), ((26.7, 0.269, 4.96),))
    for refinement in (1, 2):
        rupture = Rupture(profile, 0.00102, 2.0, "elastic", 110.0, refinement)
        assert rupture.limit.time == pytest.approx(92.196663, abs=1e-5)
        assert np.isnan(rupture.slip(-79.5, 110.0))
        x = np.linspace(*(end.x for end in rupture.front_ends[0]), 200)
        # Slip is of the order of 20, and 0 at the ends but for rounding.
        assert np.nanmin(rupture.slip(x, 110.0)) >= -1e-9


def test_the_first_stick_is_the_first():
    """A dip of the trailing edge that is much narrower than the rupture."""
    profile = Prestress(0.4314, 0.4314, 4.43, steps=((7.21, 0.893), (-6.456, -1.177)))
    for refinement in (1, 2):
        rupture = Rupture(profile, 0.0242, 2.0, "total", 76.8, refinement)
        assert rupture.first_stick == pytest.approx((16.331963629, -8.390786526), abs=SAME)
        x = np.linspace(-12.0, 0.0, 200)
        assert np.nanmin(rupture.stick_time(x)) >= rupture.first_stick.time
        assert rupture.first_stick.time <= rupture.limit.time


def test_a_first_stick_at_the_centre_of_symmetry():
    """There the pace of the trailing edge is rounding, of either sign."""
    bump = -0.8827475088463022, 0.43810831317438026
    bumps = (11.132018776746689, *bump), (-11.132018776746689, *bump)
    level = 0.5828621621834829
    profile = Prestress(level, level, 3.158165039598508, 1.000000000001, bumps=bumps)
    rupture = Rupture(profile, 0.0760121501359528, 1.0, "elastic", 25.693078285585813)
    assert rupture.first_stick == pytest.approx((11.290149, 0.0), abs=SAME)


def test_mirrored_parts_that_have_not_met():
    """A scene that misses symmetry by less than rounding is solved on both sides."""
    profile = Prestress(-0.3, -0.3, bumps=((10.0, 1.5, 1.0), (-10.0, 1.5, 1.0)))
    other = replace(profile, bumps=(*profile.bumps, (50.0, 1e-14, 1.0)))
    x = np.linspace(-14.0, 14.0, 57)
    for duration in (2.0, 5.0):
        one, two = (Rupture(tau, 0.65, 0.1, duration=duration) for tau in (profile, other))
        assert len(one.front_ends) == 3
        assert (one.limit is None) == (two.limit is None)
        assert one.largest_velocity == pytest.approx(two.largest_velocity, rel=SAME)
        assert one.transition == pytest.approx(two.transition, rel=SAME, nan_ok=True)
        assert one.stick_time(x) == pytest.approx(two.stick_time(x), abs=SAME, nan_ok=True)
        for name, values in one.map([0.7 * duration, duration], x).items():
            assert values == pytest.approx(two.map([0.7 * duration, duration], x)[name], abs=SAME)
