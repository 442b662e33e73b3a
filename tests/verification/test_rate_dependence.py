"""Friction that is linear in slip rate: numbers of the exact solution, and the end of pulses."""

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse import theory

GAMMA, LEVEL = 0.65, 0.5
RATIO = 0.1
PROFILE, SPEED = sp.Prestress(LEVEL, LEVEL), theory.front_speed(LEVEL, RATIO)
CRITICAL = theory.critical_rate_strengthening(GAMMA, SPEED)


def run(alpha, dx=0.04, duration=20.0, **values):
    law = sp.friction("linear_rate", alpha=alpha)
    values = {"gamma": GAMMA, "beta": RATIO * dx, "friction": law} | values
    return sp.simulate(sp.Scene("displacement", PROFILE, duration, dx, **values))


def rupture_of(alpha: float, duration: float) -> theory.Rupture:
    return theory.Rupture(PROFILE, GAMMA, RATIO, duration=duration, rate_strengthening=alpha)


@pytest.mark.parametrize(("alpha", "time"), [(0.4, 4.02063), (0.7, 4.4913), (0.9, 5.1196)])
def test_first_sticks_are_those_derived_independently(alpha, time):
    assert rupture_of(alpha, 6.0).transition.time == pytest.approx(time, rel=1e-5)


def test_the_steady_pulse_and_its_end_are_those_derived_independently():
    pulse = theory.steady_pulse(LEVEL, GAMMA, damping_ratio=RATIO, rate_strengthening=0.4)
    assert pulse.slip == pytest.approx(0.94727, abs=5e-6)
    assert pulse.width / pulse.speed == pytest.approx(2.5255, abs=5e-5)
    assert pytest.approx(0.9473, abs=5e-5) == CRITICAL
    velocity = pulse.profile([-pulse.width, 0.5 * -pulse.width, 0.0])[1]
    np.testing.assert_allclose(velocity[[0, 2]], 0.0, atol=tol.ALGEBRA)
    for alpha in (CRITICAL, -CRITICAL):
        with pytest.raises(
            ValueError, match=r"rate_strengthening: .*; allowed: less than 0.947322"
        ):
            theory.steady_pulse(LEVEL, GAMMA, 0.0, SPEED, rate_strengthening=1.01 * alpha)


@pytest.mark.parametrize(("alpha", "time"), [(1.2, 19.71489), (1.3, None)])
def test_beyond_the_critical_rate_strengthening_the_nucleation_alone_may_stick(alpha, time):
    """Below alpha = 2 sqrt(gamma/(1 + 1/v^2)), an oscillation at the nucleation makes it stick.

    The oscillation lasts longer than the motion behind the front. A coarse lattice misses it.
    """
    bound = 2.0 * np.sqrt(GAMMA / (1.0 + 1.0 / SPEED**2))
    assert alpha > CRITICAL and (alpha < bound) == (time is not None)
    assert rupture_of(alpha, 24.0).first_stick == (time and pytest.approx((time, 0.0), abs=1e-4))
    if time:
        lag = [run(alpha, dx, 24.0).attrs["first_stick_time"] - time for dx in (0.02, 0.01)]
        assert 0.0 < lag[1] < 0.5 * lag[0] < 0.25
        assert np.isnan(run(alpha, 0.04, 24.0).attrs["first_stick_time"])


@pytest.mark.parametrize(
    "options", [{}, {"order": 8, "half_lattice": False}, {"scheme": "fixed_step"}]
)
def test_without_rate_dependence_the_kernels_give_the_same_bits(options):
    plain, least = run(0.0, duration=9.0, **options), run(1e-300, duration=9.0, **options)
    for name in ("release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration"):
        assert plain[name].equals(least[name])


@pytest.mark.parametrize("scheme", ["localised", "fixed_step"])
def test_a_step_just_below_the_bound_is_stable_with_strong_strengthening(scheme):
    """At alpha dx = 8, the drag alone decides the bound."""
    values = {"dx": 0.5, "beta": 0.0, "scheme": scheme, "duration": 200.0}
    bound = run(16.0, **values | {"max_step": 1e-3, "duration": 0.1}).attrs
    scene = sp.Scene.from_attributes(bound)
    assert scene.largest_stable_step < 0.4
    stable = run(16.0, **values, max_step=0.98 * scene.largest_stable_step)
    assert float(stable["slip"].max()) < 1.2 / GAMMA
    with pytest.raises(ValueError, match=r"max_step: .*linear_rate"):
        run(16.0, **values, max_step=1.03 * scene.largest_stable_step)


@pytest.mark.parametrize(
    ("fraction", "scheme", "flag"),
    [
        (0.8, "localised", ""),
        (0.8, "continuum", ""),
        (1.2, "localised", "nothing_sticks"),
        # The exact solution does not know what slides behind a slow trailing edge.
        (1.2, "continuum", "construction_ended"),
    ],
)
def test_a_run_in_which_nothing_sticks_any_more_is_flagged(fraction, scheme, flag):
    flags = run(fraction * CRITICAL, duration=16.0, scheme=scheme).attrs["run_flags"]
    assert flags == flag
