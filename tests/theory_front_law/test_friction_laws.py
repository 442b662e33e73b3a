"""Steady ruptures under other friction laws, against closed forms, scaling laws and limits."""

import math

import numpy as np
import pytest

import slippulse as sp
from slippulse.theory import law_pulses, rate_pulse, steady_pulse, weakening_pulse
from slippulse.theory.law_pulses import undamped_weakening_slip

GAMMA = 2.0 / 3.0
# tau_0^2/(gamma d_c) at which the front runs at the wave speed, and below which nothing sticks, for
# each tau_0.
WAVE_SPEED_RATIOS = {0.2: 11.45, 0.5: 3.687, 0.8: 1.7205, 0.95: 1.169}
MAX_STICKING_RATIOS = {0.2: 3.44, 0.5: 1.52, 0.8: 1.09}
weakening_for = lambda tau0, ratio: tau0**2 / (GAMMA * ratio)


@pytest.mark.parametrize(
    ("tau0", "weakening", "speed", "width", "slip"),
    [(0.8, 0.1, 1.1079, 2.43, 1.9165), (0.5, 0.2, 0.9304, 2.41, 0.7626)],
)
def test_pulses_that_stick(tau0, weakening, speed, width, slip):
    pulse = weakening_pulse(tau0, GAMMA, 0.05, weakening)
    assert pulse.sticks and pulse.speed == pytest.approx(speed, abs=6e-5)
    assert pulse.width == pytest.approx(width, abs=6e-3)
    assert pulse.slip == pytest.approx(slip, abs=1.5e-4)


def test_a_crack_with_a_decaying_tail():
    crack = weakening_pulse(0.5, GAMMA, 0.05, 0.3)
    assert not crack.sticks and math.isinf(crack.width)
    assert crack.speed == pytest.approx(0.8192, abs=6e-5)
    assert crack.slip == pytest.approx(0.5 / GAMMA)


@pytest.mark.parametrize(("tau0", "ratio"), WAVE_SPEED_RATIOS.items())
@pytest.mark.parametrize("beta", [0.02, 0.3])
def test_front_runs_at_wave_speed_at_any_damping(tau0, ratio, beta):
    pulse = weakening_pulse(tau0, GAMMA, beta, weakening_for(tau0, ratio))
    assert pulse.speed == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(("tau0", "ratio"), MAX_STICKING_RATIOS.items())
def test_nothing_sticks_if_friction_weakens_too_slowly(tau0, ratio):
    assert weakening_pulse(tau0, GAMMA, 0.05, weakening_for(tau0, 1.03 * ratio)).sticks
    assert not weakening_pulse(tau0, GAMMA, 0.05, weakening_for(tau0, 0.97 * ratio)).sticks


@pytest.mark.parametrize(("tau0", "factor"), [(0.2, 0.15448), (0.5, 0.43475), (0.8, 0.8419)])
@pytest.mark.parametrize(("beta", "weakening"), [(0.05, 0.1), (0.3, 0.02)])
def test_a_front_without_springs_follows_the_scaling_law(tau0, factor, beta, weakening):
    speed = weakening_pulse(tau0, 1e-6, beta, weakening).speed
    scale = (beta * speed) ** (2.0 / 3.0) * weakening ** (-1.0 / 3.0)
    assert (speed**2 - 1.0) / scale == pytest.approx(factor, abs=1e-5)


def test_slip_does_not_depend_on_damping_and_releases_the_fracture_energy():
    # Lengths scale with (beta v)^(1/3), and so does every term.
    slips = [weakening_pulse(0.5, GAMMA, beta, 0.2).slip for beta in (0.02, 0.05, 0.3)]
    np.testing.assert_allclose(slips, slips[0], rtol=1e-9)
    slip = undamped_weakening_slip(0.5, GAMMA, 0.2)
    assert 0.5 * slip - 0.5 * GAMMA * slip**2 == pytest.approx(0.1)


@pytest.mark.parametrize("alpha", [-0.3, 0.0, 0.5])
def test_a_law_linear_in_slip_rate_gives_the_pulse_in_closed_form(alpha):
    pulse = rate_pulse(0.5, GAMMA, 0.0, sp.friction("linear_rate", alpha=alpha))
    exact = steady_pulse(0.5, GAMMA, damping_ratio=0.0, rate_strengthening=alpha)
    for name in ("speed", "width", "slip", "peak_velocity"):
        assert getattr(pulse, name) == pytest.approx(getattr(exact, name), rel=1e-7), name
    assert pulse.sticks


def test_bounded_laws_give_known_values():
    pulse = rate_pulse(0.5, GAMMA, 0.1, sp.friction("bounded_rate", limit=0.3, v_0=1.0))
    computed = pulse.slip, pulse.width, pulse.peak_velocity, pulse.speed
    assert computed == pytest.approx((1.1605, 2.829, 0.8028, 1.2358), rel=1e-4)
    weaker = sp.friction("rate_weakening", slope=1.5, limit=0.3)
    assert rate_pulse(0.5, GAMMA, 0.0, weaker).slip == pytest.approx(2.3984, abs=5e-5)


def test_strong_strengthening_creeps_and_strong_weakening_slips_by_the_whole_drop():
    creeping = rate_pulse(0.5, GAMMA, 0.1, sp.friction("bounded_rate", limit=0.45, v_0=0.1))
    assert (creeping.sticks, creeping.width) == (False, math.inf)
    steep = sp.friction("rate_weakening", slope=1e3, limit=0.3)
    slip = rate_pulse(0.5, GAMMA, 0.1, steep).slip
    assert slip == pytest.approx(2.0 * (0.5 + 0.3) / GAMMA, rel=1e-3)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (
            sp.friction("slip_weakening", d_c=0.1, nucleation=2.0),
            "law: 'slip_weakening'; .* depend",
        ),
        (
            sp.friction("linear_rate", alpha=-1.2),
            "'alpha': -1.2}; allowed: laws whose slip velocity",
        ),
        (sp.friction("linear_rate", alpha=-50.0), "'alpha': -50.0}; allowed: laws whose slip vel"),
    ],
)
def test_laws_without_a_pulse_are_refused(law, message):
    with pytest.raises(ValueError, match=message):
        rate_pulse(0.5, GAMMA, 0.1, law)


def test_a_stiff_law_with_weak_leaf_springs_is_refused_in_one_line(monkeypatch):
    """The computation takes 2.4 s at gamma = 1e-6, and a thousand times longer at 1e-12."""
    law = sp.friction("bounded_rate", limit=0.3, v_0=0.2)
    monkeypatch.setattr(law_pulses, "MAX_EVALUATIONS", 20_000)
    with pytest.raises(ValueError, match=r"^gamma: 1e-12, where .*; allowed: [^\n]*$"):
        rate_pulse(0.5, 1e-12, 0.5, law)
    assert rate_pulse(0.5, 0.1, 0.5, law).sticks
