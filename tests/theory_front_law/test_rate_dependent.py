"""Steady pulses under friction that depends on slip rate, against closed forms and trials."""

import math

import pytest

import slippulse as sp
from slippulse import theory

GAMMA = 2.0 / 3.0


@pytest.mark.parametrize("alpha", [-0.3, 0.0, 0.5])
def test_a_law_linear_in_slip_rate_gives_the_pulse_in_closed_form(alpha):
    pulse = theory.rate_pulse(0.5, GAMMA, 0.0, sp.friction("linear_rate", alpha=alpha))
    exact = theory.steady_pulse(0.5, GAMMA, 0.0, theory.front_speed(0.5, 0.0), alpha)
    for name in ("speed", "width", "slip", "peak_velocity"):
        assert getattr(pulse, name) == pytest.approx(getattr(exact, name), rel=1e-7), name
    assert pulse.sticks


def test_bounded_laws_give_the_numbers_of_trials():
    pulse = theory.rate_pulse(0.5, GAMMA, 0.1, sp.friction("bounded_rate", limit=0.3, v_0=1.0))
    numbers = pulse.slip, pulse.width, pulse.peak_velocity, pulse.speed
    assert numbers == pytest.approx((1.1605, 2.829, 0.8028, 1.2358), rel=1e-4)
    weaker = sp.friction("rate_weakening", slope=1.5, limit=0.3)
    assert theory.rate_pulse(0.5, GAMMA, 0.0, weaker).slip == pytest.approx(2.3984, abs=5e-5)


def test_strong_strengthening_creeps_and_strong_weakening_slips_by_the_whole_drop():
    creeping = theory.rate_pulse(0.5, GAMMA, 0.1, sp.friction("bounded_rate", limit=0.45, v_0=0.1))
    assert (creeping.sticks, creeping.width) == (False, math.inf)
    steep = sp.friction("rate_weakening", slope=1e3, limit=0.3)
    slip = theory.rate_pulse(0.5, GAMMA, 0.1, steep).slip
    assert slip == pytest.approx(2.0 * (0.5 + 0.3) / GAMMA, rel=1e-3)


def test_laws_that_depend_on_slip_are_refused():
    law = sp.friction("slip_weakening", d_c=0.1, nucleation=2.0)
    with pytest.raises(ValueError, match="law: 'slip_weakening'; allowed: laws that depend"):
        theory.rate_pulse(0.5, GAMMA, 0.1, law)


@pytest.mark.parametrize("alpha", [-1.2, -50.0])
def test_slip_velocity_that_grows_without_bound_is_no_pulse(alpha):
    law = sp.friction("linear_rate", alpha=alpha)
    with pytest.raises(ValueError, match=f"'alpha': {alpha}}}; allowed: laws whose slip velocity"):
        theory.rate_pulse(0.5, GAMMA, 0.1, law)
