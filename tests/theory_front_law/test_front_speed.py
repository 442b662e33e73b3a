"""The front law against limits, closed forms, its motion block by block, and lattices."""

import tracemalloc
from itertools import product

import numpy as np
import pytest

import slippulse as sp
from slippulse.measurement.front_paths import fit_front
from slippulse.theory import front_speed, lattice_front_speed, prestress_for_speed
from slippulse.theory.front_motion import steady_front

LEVELS = np.concatenate([np.geomspace(0.01, 0.5, 10), 1.0 - np.geomspace(0.4, 1e-4, 10)])
# Relative error of tau_0: the rounding of about 200 terms.
ROUNDING_ERROR = 1e-13
# Relative error of the speed: rounding divided by the slope, which is 1e4 next to tau_0 = 1.
SPEED_TOLERANCE = 1e-10
# The two computations share nothing but the equation of motion. Their difference is the rounding of
# a linear system of 200 equations.
BLOCKWISE_TOLERANCE = 1e-11
# With event times of order 8 and a steady pulse, only the sticking behind the front is neglected.
LATTICE_TOLERANCE = 3e-4
# Fraction of the path of a front over which its speed is measured.
MEASURED_FRACTION = 0.33


def test_damping_ratios_1_and_0_have_closed_forms():
    assert front_speed(LEVELS, 1.0) == pytest.approx(1.0 / (1.0 - LEVELS), rel=SPEED_TOLERANCE)
    v = 1.0 + np.geomspace(1e-9, 1e6, 31)
    assert prestress_for_speed(v, 1.0) == pytest.approx((v - 1.0) / v, rel=ROUNDING_ERROR)
    # The undamped case is a closed form too.
    for release in ("total", "elastic"):
        undamped = front_speed(LEVELS, 0.0, release)
        assert undamped == pytest.approx(1.0 / np.sqrt(1.0 - LEVELS**2), rel=1e-14)
        # The first-order change is at most 10 b.
        assert front_speed(LEVELS, 1e-14, release) == pytest.approx(undamped, rel=SPEED_TOLERANCE)


@pytest.mark.parametrize("ratio", [1e4, 1e6, 1e12])
@pytest.mark.parametrize("release", ["total", "elastic"])
def test_large_ratios_take_little_memory(ratio, release):
    tracemalloc.start()
    speed = front_speed(0.5, ratio, release)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50e6
    assert prestress_for_speed(speed, ratio, release) == pytest.approx(0.5, rel=ROUNDING_ERROR)


@pytest.mark.parametrize("ratio", [1e-6, 0.03, 0.99, 1.01, 7.0, 1e5])
@pytest.mark.parametrize("release", ["total", "elastic"])
def test_arrays_and_single_levels_agree(ratio, release):
    levels = np.linspace(0.01, 0.999, 60)
    many = front_speed(levels, ratio, release)
    one = [front_speed(level, ratio, release) for level in levels[::7]]
    assert many[::7] == pytest.approx(one, rel=SPEED_TOLERANCE)
    assert prestress_for_speed(many, ratio, release) == pytest.approx(levels, rel=SPEED_TOLERANCE)
    assert np.all(np.diff(many) > 0.0)


@pytest.mark.parametrize("release", ["total", "elastic"])
def test_series_next_to_tau_0_of_1(release):
    """The series in 1/v continues the quadrature without a jump."""
    edge, power = {"total": (1e-10, 1.0), "elastic": (1e-13, 0.5)}[release]
    levels = 1.0 - np.array([1.02, 0.98]) * edge
    scaled = front_speed(levels, 0.7, release) * (1.0 - levels) ** power
    # The rounding error of ln(tau_0), divided by 1 - tau_0.
    assert scaled[0] == pytest.approx(scaled[1], rel=10.0 * np.finfo(float).eps / edge)


def test_leaf_springs_without_damping_have_a_closed_form():
    for tau, gamma, dx in ((0.5, 0.65, 0.5), (0.3, 0.2, 0.2), (0.6, 0.3, 1.0), (0.98, 30.0, 1.0)):
        x = np.sqrt(gamma) * dx / (2.0 * tau)
        closed = x / np.arcsin(x * np.sqrt(1.0 - tau**2))
        assert lattice_front_speed(tau, gamma, dx) == pytest.approx(closed, rel=1e-14)
        damped = lattice_front_speed(tau, gamma, dx, 1e-15, "elastic")
        assert damped == pytest.approx(closed, rel=1e-11)


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.05, 0.1, 1.0, 6.0, 10.0])
def test_very_weak_leaf_springs_and_very_fast_fronts(ratio, release):
    """Leaf springs do not slow down fast fronts."""
    scenes = [(0.5, gamma, 1.0) for gamma in (1e-12, 1e-20, 1e-40)]
    scenes += [(1.0 - rest, 0.65, 0.01) for rest in (1e-10, 1e-12, 1e-14)]
    for tau, gamma, dx in scenes:
        free = front_speed(tau, ratio, release)
        speed = lattice_front_speed(tau, gamma, dx, ratio, release)
        assert speed == pytest.approx(free, rel=1e-10)


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize("ratio", [0.01, 0.1, 10.0])
def test_series_with_leaf_springs_next_to_tau_0_of_1(ratio, release):
    """The series continues the quadrature without a jump."""
    quadrature = lattice_front_speed(1.0 - 1.001e-7, 1.0, 1.0, ratio, release)
    series = lattice_front_speed(1.0 - 0.999e-7, 1.0, 1.0, ratio, release)
    free = front_speed(1.0 - 0.999e-7, ratio, release) / front_speed(1.0 - 1.001e-7, ratio, release)
    assert series / quadrature == pytest.approx(free, rel=1e-6)


def test_the_continuum_is_the_limit_of_the_lattice():
    """The error is of first order in dx as dx -> 0 at fixed beta."""
    tau, gamma, beta = 0.5, 1.0, 0.3
    limit = sp.theory.continuum_front_speed(tau, gamma, beta)
    assert limit == pytest.approx(1.3545709229571927, rel=1e-15)
    spacings = np.array([4e-4, 2e-4, 1e-4])
    speeds = [lattice_front_speed(tau, gamma, dx, beta / dx, "elastic") for dx in spacings]
    errors = np.array(speeds) - limit
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=1e-2)
    assert abs(2.0 * errors[2] - errors[1]) < 1e-6
    free = sp.theory.continuum_front_speed(0.3, 0.0, 1.0)
    assert free == pytest.approx(1.0 / np.sqrt(0.7), rel=1e-15)


def test_the_higher_of_two_speeds_is_returned():
    """With strong damping and rule "total" the front with the least pre-stress is faster than 1."""
    speeds = [lattice_front_speed(tau, 0.5, 1.0, 3.0) for tau in (0.33655, 0.34, 0.4, 0.6, 0.9)]
    assert speeds[0] > 1.39 and np.all(np.diff(speeds) > 0.0)


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize(
    ("v", "b", "g"),
    [(1.2, 0.1, 0.01), (1.05, 0.3, 0.3), (2.0, 1.0, 0.65), (1.5, 0.3, 3.0), (1.2, 0.1, 0.0)],
)
def test_front_law_agrees_with_motion_block_by_block(v, b, g, release):
    front = steady_front(v, b, g, release)
    if g == 0.0:
        expected = prestress_for_speed(v, b, release)
        assert front.prestress == pytest.approx(expected, rel=BLOCKWISE_TOLERANCE)
    else:
        speed = lattice_front_speed(front.prestress, g, 1.0, b, release)
        assert speed == pytest.approx(v, rel=BLOCKWISE_TOLERANCE)
    assert front.admissible and front.ahead[-1] == pytest.approx(1.0)
    assert np.all(np.diff(front.ahead) > 0.0)


# Level, gamma, dx, damping ratio, release and rate strengthening.
LATTICE_SCENES = [
    *((0.6, 0.05, 1.0, *rule, 0.0) for rule in ((0.0, "total"), (0.1, "total"), (0.1, "elastic"))),
    *((0.6, 0.3, 1.0, *rule, 0.0) for rule in ((0.0, "total"), (0.1, "elastic"))),
    *((0.8, 0.5, 1.0, 0.2, "total", 0.0), (0.9, 1.0, 1.0, 0.3, "elastic", 0.0)),
    *((0.5, 0.5, 1.0, 3.0, "total", 0.0), (0.5, 0.65, 0.2, 0.3, "total", 0.0)),
    (0.4, 1.0, 0.1, 1.0, "elastic", 0.0),
    *product([0.5], [0.65], [0.4], [0.1], ["total", "elastic"], [0.9, -0.6]),
]


@pytest.mark.parametrize(("tau", "gamma", "dx", "ratio", "release", "alpha"), LATTICE_SCENES)
def test_front_law_agrees_with_pulses_on_lattices(tau, gamma, dx, ratio, release, alpha):
    law = lattice_front_speed(tau, gamma, dx, ratio, release, alpha)
    friction = {"release": release, "friction": sp.friction("linear_rate", alpha=alpha)}
    accuracy = {"order": 8, "max_step": 0.15, "resolved_blocks": 1}
    scene = sp.Scene(
        boundary="displacement",
        prestress=sp.Prestress(tau, tau),
        duration=600.0 * dx / law,
        dx=dx,
        gamma=gamma,
        beta=ratio * dx,
        **accuracy,
        **friction,
    )
    assert fit_front(sp.simulate(scene), MEASURED_FRACTION)[0] == pytest.approx(
        law, rel=LATTICE_TOLERANCE
    )
