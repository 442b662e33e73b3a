"""The pre-stress profile: values, symmetry, steps, bumps, integral."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol
from scipy.integrate import quad

from slippulse import Prestress

STEPS = ((15.0, -0.1), (-4.0, 0.2), (20.0, 0.4))
PROFILES = {
    "even": Prestress(0.3, 0.3),
    "wide": Prestress(-0.75, 0.0, width=5.0),
    "low peak": Prestress(0.2, -0.4, width=0.5, peak=0.9),
    "steps": Prestress(-0.3, 0.0, steps=STEPS),
    "bumps": Prestress(0.3, 0.5, bumps=((6.0, -0.4, 0.5), (-3.0, 0.2, 1.5))),
    "both": Prestress(0.3, 0.3, 2.0, 1.0, ((-7.0, -0.2),), ((3.0, 0.1, 0.2), (0.0, 0.05, 4.0))),
}


@pytest.mark.parametrize("peak", [1.0, 0.1 + 0.2, 1.0 - 1e-16, 1.3])
@pytest.mark.parametrize(("left", "right"), [(0.1, 0.7), (-1.3, 0.0), (0.999999, 0.3)])
def test_the_value_at_the_nucleation_point_is_exactly_the_peak(left, right, peak):
    profile = Prestress(left, right, peak=peak)
    assert float(profile(0.0)) == profile(np.array([-0.1, 0.0, 0.1]))[1] == peak


def test_the_profile_is_a_gaussian_on_its_side_levels_and_bumps_are_added():
    x = np.linspace(-40.0, 40.0, 401)
    level = np.where(x < 0.0, -0.75, 0.25)
    expected = level + (1.0 - level) * np.exp(-(x**2) / 50.0)
    assert Prestress(-0.75, 0.25, width=5.0)(x) == pytest.approx(expected, abs=tol.STENCIL)
    assert Prestress(-0.75, 0.25, width=5.0)(np.array([-300.0, 300.0])).tolist() == [-0.75, 0.25]
    added = -0.4 * np.exp(-0.5 * ((x - 6.0) / 0.5) ** 2) + 0.2 * np.exp(-0.5 * ((x + 3.0) / 1.5) ** 2)
    assert PROFILES["bumps"](x) - Prestress(0.3, 0.5)(x) == pytest.approx(added, abs=tol.STENCIL)


@pytest.mark.parametrize("steps", [STEPS, STEPS[::-1]])
def test_a_step_replaces_the_level_beyond_its_position_on_its_side(steps):
    profile = Prestress(-0.3, 0.0, steps=steps)
    x = np.array([-50.0, -4.0, -3.999, 0.0, 14.999, 15.0, 19.999, 20.0, 99.0])
    assert profile.level(x).tolist() == [0.2, 0.2, -0.3, 0.0, 0.0, -0.1, -0.1, 0.4, 0.4]
    assert np.array_equal(profile(x), PROFILES["steps"](x))


@pytest.mark.parametrize(
    ("profile", "symmetric"),
    [
        (Prestress(0.3, 0.3), True),
        (Prestress(0.3, 0.300001), False),
        (Prestress(0.3, 0.3, steps=((5.0, 0.1),)), False),
        (Prestress(0.3, 0.3, steps=((5.0, 0.1), (-5.0, 0.2))), False),
        (Prestress(0.3, 0.3, steps=((5.0, 0.1), (-5.0, 0.1))), True),
        (Prestress(0.3, 0.3, bumps=((4.0, 0.1, 1.0),)), False),
        (Prestress(0.3, 0.3, bumps=((4.0, 0.1, 1.0), (-4.0, 0.1, 2.0))), False),
        (Prestress(0.3, 0.3, bumps=((-4.0, 0.1, 1.0), (4.0, 0.1, 1.0), (0.0, 0.1, 1.0))), True),
        (Prestress(0.0, -0.0), True),
    ],
)
def test_symmetry_is_what_the_values_say(profile, symmetric):
    x = np.linspace(0.0, 20.0, 2001)
    assert profile.symmetric is symmetric
    assert np.allclose(profile(x), profile(-x), rtol=0.0, atol=tol.STENCIL) is symmetric


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize(
    ("lower", "upper"), [(-9.0, 25.0), (2.0, 3.0), (4.0, -7.5), (1.0, 1.0), (15.0, 18.0)]
)
def test_the_integral_is_that_of_the_profile(name, lower, upper):
    profile = PROFILES[name]
    marks = [0.0, *(p for p, _ in profile.steps), *(c for c, _, _ in profile.bumps)]
    inside = [mark for mark in marks if min(lower, upper) < mark < max(lower, upper)] or None
    accuracy = {"points": inside, "epsabs": 1e-13, "epsrel": 1e-12, "limit": 400}
    expected, _ = quad(lambda x: float(profile(x)), lower, upper, **accuracy)
    assert profile.integral(lower, upper) == pytest.approx(expected, abs=tol.QUADRATURE)
