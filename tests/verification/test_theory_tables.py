"""The theory against tabulated values, closed forms and its own equations."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol
from scipy.integrate import quad

import slippulse as sp
from slippulse.model.balance import prestress_balance_position

GAMMA = 2.0 / 3.0


@pytest.mark.parametrize(
    ("tau0", "time", "length"), [(0.5, 3.7805, 10.3226), (0.2, 3.6006, 8.7692), (0.95, 3.9326, 26.952)]
)
def test_transition_under_displacement(tau0, time, length):
    profile = sp.Prestress(tau0, tau0)
    exact = sp.theory.exact_transition_displacement(profile, GAMMA)
    fronts = sp.theory.Fronts(profile, 0.0, "total", 8.0)
    assert sp.theory.slip_velocity(fronts, GAMMA, 0.0, exact.time) == pytest.approx(
        0.0, abs=tol.ALGEBRA * 1e3
    )
    assert exact.time == pytest.approx(time, rel=tol.TRANSITION_TABLE)
    assert exact.length == pytest.approx(length, rel=tol.TRANSITION_TABLE)


@pytest.mark.parametrize(
    ("left", "width", "table"),
    [(-1.0, 4.0, (1.3031, 1.5543, 1.9779)), (-0.5, 1.0, (1.1745, 1.3415, 1.6052))],
)
def test_share_times_under_stress(left, width, table):
    crack = sp.theory.ArrestingCrack(sp.Prestress(left, 0.0, width))
    distance = abs(crack.balance_position)
    for share, known in zip((0.90, 0.95, 0.99), table, strict=True):
        assert crack.share_time(share) / distance == pytest.approx(known, rel=tol.SHARE_TABLE)


@pytest.mark.parametrize("profile", [sp.Prestress(-0.75, 0.0, 5.0), sp.Prestress(-2.0, 0.0, 0.5)])
def test_the_prestress_balances_from_its_balance_position_on(profile):
    x = prestress_balance_position(profile)
    reach = 40.0 * profile.width
    total, _ = quad(lambda y: float(profile(y)), x, reach, points=[0.0], epsabs=1e-12, limit=400)
    assert x < 0.0
    assert total == pytest.approx(0.0, abs=tol.QUADRATURE)


@pytest.mark.parametrize("tau0", [0.1, 0.37, 0.5, 0.9])
@pytest.mark.parametrize("gamma", [1e-3, 0.65])
def test_the_undamped_pulse_is_the_closed_form_of_the_paper(tau0, gamma):
    speed = 1.0 / np.sqrt(1.0 - tau0**2)
    pulse = sp.theory.paper_pulse(tau0, gamma)
    assert pulse.speed == pytest.approx(speed, rel=tol.PULSE_THEORY)
    assert pulse.slip == pytest.approx(2.0 * tau0 / gamma, rel=tol.PULSE_THEORY)
    assert pulse.peak_velocity == pytest.approx(1.0 / np.sqrt(gamma), rel=tol.PULSE_THEORY)
    assert pulse.width == pytest.approx(np.pi * tau0 * speed / np.sqrt(gamma), rel=tol.PULSE_THEORY)
    assert pulse.stress_drop == pytest.approx(2.0 * tau0, rel=tol.PULSE_THEORY)


@pytest.mark.parametrize("beta", [0.0, 1e-3, 0.05])
def test_the_profile_of_the_pulse_obeys_its_equation(beta):
    """(v^2 - 1) U'' + gamma U + beta v U''' = tau_0, with U and U' from rest at the front and at rest behind."""
    tau0, gamma, speed = 0.25, 0.55, 1.0686
    pulse = sp.theory.steady_pulse(tau0, gamma, beta, speed)
    xi = np.linspace(-0.99, -0.01, 99) * pulse.width
    h = 1e-4
    slip, velocity, acceleration = pulse.profile(xi)
    change = [(b - a) / (2.0 * h) for a, b in zip(pulse.profile(xi - h), pulse.profile(xi + h), strict=True)]
    assert velocity == pytest.approx(-speed * change[0], abs=tol.PULSE_EQUATION)
    assert acceleration == pytest.approx(-speed * change[1], abs=tol.PULSE_EQUATION)
    third = change[2] / speed**2
    balance = (speed**2 - 1.0) * acceleration / speed**2 + gamma * slip + beta * speed * third
    assert balance == pytest.approx(tau0, abs=tol.PULSE_EQUATION)
    ends = pulse.profile(np.array([0.0, -pulse.width]))
    assert ends[0] == pytest.approx([0.0, pulse.slip], abs=tol.PULSE_EQUATION)
    assert ends[1] == pytest.approx([0.0, 0.0], abs=tol.PULSE_EQUATION)
    fine = pulse.profile(np.linspace(-pulse.width, 0.0, 20001))[1]
    assert pulse.peak_velocity == pytest.approx(fine.max(), rel=tol.PULSE_EQUATION)
