"""The front law against its limits, its closed forms and the textbook integral; large ratios; what it refuses."""

from __future__ import annotations

import time
import tracemalloc
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from slippulse.theory import (
    continuum_front_speed,
    front_speed,
    lattice_front_speed,
    prestress_for_speed,
)
from slippulse.theory.front_law import _nearly_free

LEVELS = np.concatenate([np.geomspace(0.01, 0.5, 10), 1.0 - np.geomspace(0.4, 1e-4, 10)])
# In tau_0, relative: rounding of some 200 terms.
ROUNDING = 1e-13
# Speed against pre-stress: rounding over the slope, 1e4 next to tau_0 = 1.
SPEED = 1e-10
# Adaptive quadrature of the oscillating textbook integral over its first 300 periods, and its averaged tail.
TEXTBOOK = 2e-8
MEGABYTES = 50.0
SECONDS = 0.5


def test_ratio_one_is_a_closed_form():
    assert front_speed(LEVELS, 1.0) == pytest.approx(1.0 / (1.0 - LEVELS), rel=SPEED)
    v = 1.0 + np.geomspace(1e-9, 1e6, 31)
    assert prestress_for_speed(v, 1.0) == pytest.approx((v - 1.0) / v, rel=ROUNDING)


def test_no_damping():
    for release in ("total", "elastic"):
        assert front_speed(LEVELS, 0.0, release) == pytest.approx(1.0 / np.sqrt(1.0 - LEVELS**2), rel=1e-14)
        # The first order in b is within 10 b of it.
        assert front_speed(LEVELS, 1e-14, release) == pytest.approx(front_speed(LEVELS, 0.0), rel=SPEED)


def test_strong_damping():
    levels = np.linspace(0.05, 0.95, 7)
    elastic = front_speed(levels, 1e12, "elastic")
    assert elastic == pytest.approx(1.0 / np.sqrt(1.0 - levels), rel=1e-10)
    # Rule "total": the speed is in proportion to b.
    ratio = front_speed(levels, 1e13) / front_speed(levels, 1e12)
    assert ratio == pytest.approx(10.0, rel=1e-5)


@pytest.mark.parametrize("ratio", [1e4, 1e6, 1e12])
@pytest.mark.parametrize("release", ["total", "elastic"])
def test_cost_at_large_ratios(ratio, release):
    front_speed(0.4, ratio, release)
    tracemalloc.start()
    try:
        start = time.perf_counter()
        speed = front_speed(0.5, ratio, release)
        seconds = time.perf_counter() - start
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert seconds < SECONDS and peak < 1e6 * MEGABYTES
    assert prestress_for_speed(speed, ratio, release) == pytest.approx(0.5, rel=ROUNDING)


@pytest.mark.parametrize("ratio", [1e-6, 0.03, 0.99, 1.01, 7.0, 1e5])
@pytest.mark.parametrize("release", ["total", "elastic"])
def test_many_levels_and_one_by_one_agree(ratio, release):
    levels = np.linspace(0.01, 0.999, 60)
    many = front_speed(levels, ratio, release)
    one = [front_speed(level, ratio, release) for level in levels[::7]]
    assert many[::7] == pytest.approx(one, rel=SPEED)
    assert prestress_for_speed(many, ratio, release) == pytest.approx(levels, rel=SPEED)
    assert np.all(np.diff(many) > 0.0)


@pytest.mark.parametrize("release", ["total", "elastic"])
def test_next_to_one(release):
    """The first terms in 1/v take over from the quadrature without a jump."""
    edge = {"total": 1e-10, "elastic": 1e-13}[release]
    rest = np.array([1.02, 0.98]) * edge
    levels = 1.0 - rest
    speeds = front_speed(levels, 0.7, release)
    power = {"total": 1.0, "elastic": 0.5}[release]
    scaled = speeds * (1.0 - levels) ** power
    # One rounding of ln(tau_0) over 1 - tau_0.
    assert scaled[0] == pytest.approx(scaled[1], rel=10.0 * np.finfo(float).eps / edge)


def textbook(v: float, b: float, g: float, release: str) -> float:
    """M_+(0) by the integrals of the factorisation over the real axis, leaf springs by the waves' zeros taken out."""
    s = np.sqrt(g)
    # k^2/((k - is)^2) is analytic and free of zeros below the axis: it leaves M_+ alone, and takes the pole out.

    def symbol(z: float) -> complex:
        fan = 4.0 * np.sin(0.5 * z) ** 2
        m = 1.0 - (fan * (1.0 + 1j * b * v * z) + g) / (v * z) ** 2
        return m * (z / (z - 1j * s)) ** 2

    edges = np.concatenate([[1e-9], np.geomspace(1e-3, np.pi, 12), np.pi * np.arange(2, 601)])

    def log(z: float) -> complex:
        return np.log(symbol(z))

    angle = sum(quad(lambda z: log(z).imag / z, a, c, epsabs=1e-13)[0] for a, c in pairwise(edges))
    # Beyond: arg M = -(2 b/v - 2 s)/z on the average.
    angle += (-2.0 * b / v + 2.0 * s) / edges[-1]
    value = (0.5 * np.log(g / (v * s) ** 2) if g else 0.5 * np.log(1.0 - 1.0 / v**2)) + angle / np.pi
    if release == "elastic":
        y = 1.0 / (b * v)

        def shifted(z: float) -> float:
            f = log(z)
            return (y * f.real + z * f.imag) / (z * z + y * y)

        value -= sum(quad(shifted, a, c, epsabs=1e-13)[0] for a, c in pairwise(edges)) / np.pi
        value -= (-2.0 * b / v + 2.0 * s) / edges[-1] / np.pi
    return float(np.exp(value))


@pytest.mark.parametrize(
    ("v", "b", "g", "release"),
    [
        (1.3, 0.2, 0.0, "total"),
        (1.3, 0.2, 0.0, "elastic"),
        (1.2, 0.5, 0.4, "total"),
        (1.7, 0.5, 0.4, "elastic"),
        (1.1, 1.5, 1.0, "total"),
    ],
)
def test_the_textbook_integral(v, b, g, release):
    tau = textbook(v, b, g, release)
    if g == 0.0:
        assert prestress_for_speed(v, b, release) == pytest.approx(tau, rel=1e3 * TEXTBOOK)
    elif (v, b, g) != (1.1, 1.5, 1.0):
        assert lattice_front_speed(tau, g, 1.0, b, release) == pytest.approx(v, rel=1e3 * TEXTBOOK)
    else:
        # Below the fold: the same pre-stress drives a faster front, which is the one returned.
        assert lattice_front_speed(tau, g, 1.0, b, release) > 1.2


def test_springs_without_damping():
    for tau, gamma, dx in ((0.5, 0.65, 0.5), (0.3, 0.2, 0.2), (0.6, 0.3, 1.0), (0.98, 30.0, 1.0)):
        x = np.sqrt(gamma) * dx / (2.0 * tau)
        closed = x / np.arcsin(x * np.sqrt(1.0 - tau**2))
        assert lattice_front_speed(tau, gamma, dx) == pytest.approx(closed, rel=1e-14)
        assert lattice_front_speed(tau, gamma, dx, 1e-15, "elastic") == pytest.approx(closed, rel=1e-11)


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize("ratio", [0.0, 0.05, 1.0, 6.0])
def test_springs_of_no_strength(ratio, release):
    for gamma in (1e-12, 1e-20, 1e-40):
        assert lattice_front_speed(0.5, gamma, 1.0, ratio, release) == pytest.approx(
            front_speed(0.5, ratio, release), rel=1e-10
        )


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize("ratio", [0.01, 0.1, 10.0])
def test_springs_next_to_one(ratio, release):
    """Fast fronts outrun what leaf springs do, and nothing jumps where the series takes over from the quadrature."""
    for rest in (1e-10, 1e-12, 1e-14):
        free = front_speed(1.0 - rest, ratio, release)
        assert lattice_front_speed(1.0 - rest, 0.65, 0.01, ratio, release) == pytest.approx(free, rel=1e-10)
    quadrature = lattice_front_speed(1.0 - 1.001e-7, 1.0, 1.0, ratio, release)
    series = lattice_front_speed(1.0 - 0.999e-7, 1.0, 1.0, ratio, release)
    free = front_speed(1.0 - 0.999e-7, ratio, release) / front_speed(1.0 - 1.001e-7, ratio, release)
    assert series / quadrature == pytest.approx(free, rel=1e-6)


def test_springs_on_fast_fronts():
    """The first order in g/v^2, where the quadrature still sees it."""
    for ratio, release in ((0.1, "total"), (10.0, "total"), (0.1, "elastic")):
        free, tau = front_speed(1.0 - 1e-4, ratio, release), 1.0 - 1e-4
        full = lattice_front_speed(tau, 1.0, 1.0, ratio, release)
        series = _nearly_free(free, 1.0, ratio if release == "total" else 0.0)
        assert 1.0 - full / free == pytest.approx(1.0 - series / free, rel=0.05, abs=1e-10)


def test_the_continuum_is_the_limit_of_the_lattice():
    """dx -> 0 at fixed beta, first order in dx."""
    tau, gamma, beta = 0.5, 1.0, 0.3
    limit = continuum_front_speed(tau, gamma, beta)
    assert limit == pytest.approx(1.3545709229571927, rel=1e-15)
    errors = [lattice_front_speed(tau, gamma, dx, beta / dx, "elastic") - limit for dx in (4e-4, 2e-4, 1e-4)]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=1e-2)
    assert abs(2.0 * errors[2] - errors[1]) < 1e-6
    assert continuum_front_speed(0.3, 0.0, 1.0) == pytest.approx(1.0 / np.sqrt(0.7), rel=1e-15)


def test_a_fold():
    """Strong damping under the rule "total": the speed at the least pre-stress is above 1, and grows from there."""
    with pytest.raises(ValueError, match=r"tau0: 0.33; allowed: > 0.336545"):
        lattice_front_speed(0.33, 0.5, 1.0, 3.0)
    speeds = [lattice_front_speed(tau, 0.5, 1.0, 3.0) for tau in (0.33655, 0.34, 0.4, 0.6, 0.9)]
    assert speeds[0] > 1.39 and np.all(np.diff(speeds) > 0.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: front_speed(0.5, -1.0), "damping_ratio: -1.0; allowed: a finite number and >= 0"),
        (lambda: front_speed(0.5, np.nan), "damping_ratio: nan; allowed"),
        (lambda: front_speed(0.5, [0.1, np.inf]), "damping_ratio: inf; allowed"),
        (lambda: front_speed(0.5, 1e200), "damping_ratio: 1e[+]200; allowed: .*<= 1e[+]100"),
        (lambda: front_speed([0.5, 1.0], 0.1), "tau0: 1.0; allowed: .*< 1"),
        (lambda: front_speed(0.0, 0.1), "tau0: 0.0; allowed: .*> 0"),
        (lambda: front_speed(0.5, 0.1, "other"), "release: 'other'; allowed: total, elastic"),
        (lambda: prestress_for_speed(1.0, 0.1), "speed: 1.0; allowed: .*> 1"),
        (lambda: prestress_for_speed(1e200, 0.1), "speed: 1e[+]200; allowed"),
        (
            lambda: lattice_front_speed(0.3, 1.0, 1.0, 0.1),
            "tau0: 0.3; allowed: > 0.50849, values whose front outruns",
        ),
        (lambda: lattice_front_speed(0.5, 1e300, 1e300), "tau0: 0.5; allowed: > 1"),
        (lambda: lattice_front_speed(0.5, 1.0, 0.0), "dx: 0.0; allowed"),
        (lambda: lattice_front_speed(0.5, 0.0, 1.0), "gamma: 0.0; allowed"),
        (lambda: continuum_front_speed(0.3, 2.0, 0.3), "tau0: 0.3; allowed: values whose front outruns"),
        (lambda: continuum_front_speed(0.3, 2.0, 0.0), "beta: 0.0; allowed"),
    ],
)
def test_refused(call, message):
    with pytest.raises(ValueError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
