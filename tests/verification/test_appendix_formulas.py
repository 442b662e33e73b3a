"""Formulas of the report's appendix, each written again as printed there, against the theory code."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import tolerances
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import j0

import slippulse as sp
from slippulse.theory import Fronts, slip_velocity


def symbol(k: complex, v: float, b: float) -> complex:
    """M(k)."""
    return 1.0 - 4.0 * np.sin(k / 2.0) ** 2 * (1.0 + 1j * b * v * k) / (v * k) ** 2


@pytest.mark.parametrize("v", [1.05, 1.5, 4.0])
def test_the_factors_at_damping_ratio_one(v):
    def factor(k: complex, sign: int) -> complex:
        return 1.0 - sign / v * (np.exp(sign * 1j * k) - 1.0) / (sign * 1j * k)

    for k in (0.3, 2.0, -7.5, 0.4 + 0.0j):
        assert factor(k, 1) * factor(k, -1) == pytest.approx(symbol(k, v, 1.0), rel=tolerances.PULSE_THEORY)
    # No zero in its own half plane: on a large half circle and the axis the factor stays near 1.
    half_plane = [x + 1j * y for x in np.linspace(-30, 30, 61) for y in (1e-9, 0.1, 1.0, 10.0)]
    assert max(abs(factor(k, 1) - 1.0) for k in half_plane if k != 0) <= 1.0 / v + 1e-12
    assert sp.theory.prestress_for_speed(v, 1.0) == pytest.approx(1.0 - 1.0 / v, rel=tolerances.QUADRATURE)
    assert sp.theory.prestress_for_speed(v, 1.0, "elastic") == pytest.approx(
        (1.0 - 1.0 / v) * np.exp(1.0 / v), rel=tolerances.QUADRATURE
    )


@pytest.mark.parametrize("v", [1.02, 1.3, 3.0])
@pytest.mark.parametrize("b", [0.05, 0.7, 5.0])
def test_the_symbol_does_not_wind_around_zero(v, b):
    k = np.linspace(1e-3, 200.0, 20001)
    assert np.min(symbol(k, v, b).real) >= 1.0 - 1.0 / v**2 - 1e-9


@pytest.mark.parametrize("v", [1.2, 2.0])
def test_the_factor_by_cauchys_integral(v):
    """ln M_+(0) by adaptive quadrature of the formula as printed, against the code's own."""
    b = 0.3

    def phase(z: float) -> float:
        return float(np.angle(symbol(z, v, b))) / z

    edges = np.concatenate([[1e-9, 0.5], np.arange(1.0, 400.0) * 2.0 * np.pi])
    integral = sum(quad(phase, lo, hi, epsabs=1e-13)[0] for lo, hi in itertools.pairwise(edges))
    # Beyond the last edge the mean of -b 4 sin^2(z/2)/(v z) is -2 b/(v z).
    integral += -2.0 * b / (v * edges[-1])
    found = np.exp(0.5 * np.log(1.0 - 1.0 / v**2) + integral / np.pi)
    assert sp.theory.prestress_for_speed(v, b) == pytest.approx(found, rel=tolerances.CAUCHY_BY_PANELS)


@pytest.mark.parametrize("v", [1.2, 2.0])
def test_strong_damping_under_the_elastic_rule(v):
    """tau tends to 1 - 1/v^2 as 1/b."""
    errors = [
        abs(sp.theory.prestress_for_speed(v, b, "elastic") - (1.0 - 1.0 / v**2)) for b in (4.0, 20.0, 100.0)
    ]
    assert errors[1] < 0.3 * errors[0] and errors[2] < 0.3 * errors[1]


@pytest.mark.parametrize("v", [1.2, 3.0])
def test_strong_damping_under_the_total_rule(v):
    """b tau tends to v - 1/v at fixed speed, with a correction that falls as 1/sqrt(b)."""
    products = [sp.theory.prestress_for_speed(v, b) * b for b in (100.0, 400.0, 1600.0)]
    first, second = np.diff(products)
    assert second / first == pytest.approx(0.5, abs=tolerances.STRONG_DAMPING_ORDER)
    # Halved by each factor of 4: what is left is as much again.
    assert products[2] + second == pytest.approx(v - 1.0 / v, rel=tolerances.STRONG_DAMPING_LIMIT)


@pytest.mark.parametrize(("tau", "gamma", "dx"), [(0.5, 0.65, 0.5), (0.3, 0.2, 0.2), (0.6, 0.3, 1.0)])
def test_leaf_springs(tau, gamma, dx):
    """The zero of the symbol found by a root finder instead of the closed form."""
    v = sp.theory.lattice_front_speed(tau, gamma, dx)

    def square(k: float) -> float:
        return (v * k) ** 2 - 4.0 * np.sin(k / 2.0) ** 2 - gamma * dx**2

    k0 = brentq(square, 1e-6, np.pi, xtol=1e-15)
    assert np.sqrt(gamma) * dx / (v * k0) == pytest.approx(tau, rel=tolerances.PULSE_THEORY * 10)


@pytest.mark.parametrize(("b", "release"), [(0.0, "total"), (0.1, "total"), (0.3, "elastic")])
def test_the_damped_pulse_as_printed(b, release):
    tau, gamma, dx = 0.4, 0.65, 0.01
    beta, v = b * dx, sp.theory.front_speed(0.4, b, release)
    pulse = sp.theory.steady_pulse(tau, gamma, beta, v)
    p, q = pulse.growth, pulse.wavenumber
    for root in (p + 1j * q, p - 1j * q):
        assert abs(beta * v * root**3 + (v**2 - 1.0) * root**2 + gamma) < tolerances.QUADRATURE
    if beta:
        # The third root is negative: its solution grows away from the front.
        assert -(v**2 - 1.0) / (beta * v) - 2.0 * p < 0.0
    xi = -np.linspace(0.0, 1.0, 101) * pulse.width
    slip = tau / gamma * (1.0 - np.exp(p * xi) * (np.cos(q * xi) - p / q * np.sin(q * xi)))
    velocity = -v * tau * (p**2 + q**2) / (gamma * q) * np.exp(p * xi) * np.sin(q * xi)
    found = pulse.profile(xi)
    np.testing.assert_allclose(found[0], slip, atol=tolerances.QUADRATURE)
    np.testing.assert_allclose(found[1], velocity, atol=tolerances.QUADRATURE)
    assert pulse.slip == pytest.approx(tau / gamma * (1.0 + np.exp(-p * pulse.width)))
    assert pulse.peak_velocity >= velocity.max()
    assert pulse.peak_velocity == pytest.approx(velocity.max(), rel=1e-3)


@pytest.mark.parametrize("b", [0.0, 0.1])
@pytest.mark.parametrize("time", [1.0, 3.0])
def test_uniform_pre_stress_in_closed_form(b, time):
    """A narrow Gaussian in place of none; what is left falls with its width."""
    tau, gamma = 0.5, 0.6
    v = sp.theory.front_speed(tau, b)
    shrink = np.sqrt(1.0 - v**-2)
    reach = time / shrink
    inner = quad(lambda s: j0(np.sqrt(gamma * max(reach**2 - s**2, 0.0))), 0.0, reach / v)[0]
    printed = tau / shrink * (np.sin(np.sqrt(gamma) * reach) / np.sqrt(gamma) - inner)
    errors = []
    for width in (4e-3, 1e-3):
        fronts = Fronts(sp.Prestress(tau, tau, width=width), b, "total", 8.0)
        errors.append(abs(slip_velocity(fronts, gamma, 0.0, time) - printed))
    assert errors[1] < tolerances.NARROW_GAUSSIAN
    assert errors[1] < 0.3 * errors[0]


def test_the_left_front_takes_for_ever():
    """Each tenth part of the way left takes more time than the one before, and the time exceeds the entry point."""
    crack = sp.theory.ArrestingCrack(sp.Prestress(-0.75, 0.0, width=5.0), 0.1)
    shares = 1.0 - 10.0 ** -np.arange(1.0, 6.0)
    times = np.array([crack.share_time(float(share)) for share in shares])
    entries = np.array([crack.entry_for(float(share * crack.balance_position)) for share in shares])
    assert np.all(np.diff(times) > 0.0)
    assert np.all(times > entries - shares * crack.balance_position)
    for share, entry in zip(shares, entries, strict=True):
        assert crack.prestress.integral(share * crack.balance_position, entry) == pytest.approx(0.0, abs=1e-9)
