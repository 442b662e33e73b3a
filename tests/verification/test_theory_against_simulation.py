"""The theory with damping against direct simulation: front speed under both rules, and the steady pulse."""

from __future__ import annotations

import pytest
import tolerances as tol

import slippulse as sp
from slippulse.measure.fronts import front_speed
from slippulse.measure.pulses import leading_pulse

# (tau_0, beta/dx), ten pairs over the whole range.
PAIRS = [
    (0.2, 0.02), (0.35, 0.05), (0.5, 0.1), (0.65, 0.2), (0.8, 0.3),
    (0.3, 0.5), (0.45, 1.0), (0.6, 1.5), (0.7, 2.0), (0.55, 3.0),
]  # fmt: skip
PULSES = [(0.3, 0.02), (0.45, 0.05), (0.6, 0.1), (0.7, 0.15), (0.85, 0.2)]


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize(("tau0", "ratio"), PAIRS)
def test_front_speed(tau0, ratio, release):
    scene = sp.Scene(
        boundary="stress", dx=0.02, beta=0.02 * ratio, duration=14.0, release=release, max_step=0.05,
        prestress=sp.Prestress(tau0, tau0),
    )  # fmt: skip
    measured, _, _ = front_speed(sp.simulate(scene), 0.2)
    assert measured == pytest.approx(sp.theory.front_speed(tau0, ratio, release), rel=tol.FRONT_SPEED_THEORY)


@pytest.mark.parametrize(("tau0", "ratio"), PULSES)
def test_steady_pulse(tau0, ratio):
    dx, gamma = 0.01, 0.65
    scene = sp.Scene(
        boundary="displacement", gamma=gamma, dx=dx, beta=ratio * dx, duration=60.0, max_step=0.2,
        prestress=sp.Prestress(tau0, tau0),
    )  # fmt: skip
    pulse = leading_pulse(sp.simulate(scene), 0.3)
    theory = sp.theory.steady_pulse(tau0, gamma, ratio * dx, sp.theory.front_speed(tau0, ratio))
    assert pulse.slip == pytest.approx(theory.slip, rel=tol.PULSE_SLIP_THEORY)
    assert pulse.peak_velocity == pytest.approx(theory.peak_velocity, rel=tol.PULSE_PEAK_THEORY)
    assert pulse.width == pytest.approx(theory.width, abs=tol.PULSE_WIDTH_BLOCKS * dx)
