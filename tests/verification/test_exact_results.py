"""Theory compared with tables and equations; runs compared with theory and a published figure."""

from itertools import pairwise

import numpy as np
import pytest
import tolerances as tol
from scipy.integrate import quad

import slippulse as sp
from slippulse.measurement.front_paths import arrival, fit_front, front_position
from slippulse.measurement.pulses import leading_pulse
from slippulse.model.balance import integral
from slippulse.theory.part import Part
from slippulse.theory.two_fronts import fast_fronts

GAMMA = 2.0 / 3.0
SPEED = sp.theory.front_speed(0.4, 0.3, "elastic")
STEADY = [(0.25, 0.55, beta, 1.0686) for beta in (0.0, 1e-3, 0.05)] + [(0.4, 0.65, 3e-3, SPEED)]
# On the right the pre-stress falls from 1 to 1/2 within TAIL_LENGTH, and is 0 beyond it.
TAIL_LEVEL, TAIL_LENGTH, TAIL_RATIO = -0.5, 3.0, 0.1
X_MINUS, ARREST = -4.5, 9.1247


def run_of(left, right=None, width=1.0, *, gamma=0.0, **values):
    """Return a run under a stress boundary, or under a displacement boundary if gamma is given."""
    boundary = "displacement" if gamma else "stress"
    prestress = sp.Prestress(left, left if right is None else right, width)
    return sp.simulate(sp.Scene(boundary=boundary, prestress=prestress, gamma=gamma, **values))


# The exact speeds of these levels are irrational, so a front locked to dx/(n dt) cannot agree.
@pytest.mark.parametrize("tau0", [0.23, 0.37, 0.5, 0.71, 0.9])
def test_undamped_front_speed_and_slip(tau0, paper_accuracy):
    run = run_of(tau0, gamma=0.65, dx=0.02, duration=120.0, **paper_accuracy)
    speed = fit_front(run, 0.3)[0]
    assert speed == pytest.approx(1.0 / np.sqrt(1.0 - tau0**2), rel=tol.FRONT_SPEED)
    assert leading_pulse(run, 0.3).slip == pytest.approx(2.0 * tau0 / 0.65, rel=tol.PULSE_SLIP)
    assert run.attrs["run_flags"] == ""


def test_damped_front_speed_as_tabulated():
    level, ratio = np.array([(0.5, 0.05), (0.5, 0.2), (0.2, 0.2), (0.8, 1.0)]).T
    tables = {"total": [1.195467, 1.315836, 1.075091, 5.0]}
    tables["elastic"] = [1.170395, 1.208446, 1.050926, 1.892763]
    for release, speeds in tables.items():
        exact = sp.theory.front_speed(level, ratio, release)
        assert exact == pytest.approx(speeds, rel=tol.TABLE_DIGITS)


def test_the_published_figure():
    run = run_of(0.25, gamma=0.55, beta=1e-3, dx=0.01, duration=10.8, release="total", max_step=0.5)
    speed, intercept, _ = fit_front(run, 0.6)
    assert speed == pytest.approx(1.070, rel=tol.PUBLISHED_FRONT_SPEED)
    assert intercept == pytest.approx(0.81, abs=tol.PUBLISHED_INTERCEPT)
    assert run.attrs["first_stick_time"] == pytest.approx(3.93, rel=tol.PUBLISHED_FRONT_SPEED)
    assert run.attrs["first_stick_position"] == 0.0
    edges = front_position(run, [5.0, 6.0, 7.0, 8.0, 9.0, 10.0], "right", "stick_time")
    assert edges == pytest.approx([3.19, 4.74, 6.03, 7.27, 8.48, 9.64], rel=tol.PUBLISHED_TRAILING)


# Level, gamma, tabulated T_trans and L_trans, and first stick times of lattices with dx = 0.05,
# 0.02 and 0.01 (None if no lattice is solved).
TRANSITIONS = [
    (0.5, GAMMA, (3.7805, 10.3226), (3.7945, 3.7863, 3.7835)),
    (0.2, GAMMA, (3.6006, 8.7692), ()),
    (0.95, GAMMA, (3.9326, 26.952), None),
    (0.8, 0.1, (), ()),
    (0.35, 1.0, (), ()),
    (0.65, 0.3, (), ()),
]


@pytest.mark.parametrize(("tau0", "gamma", "table", "known"), TRANSITIONS)
def test_lattices_converge_to_tabulated_transitions(paper_accuracy, tau0, gamma, table, known):
    profile = sp.Prestress(tau0, tau0)
    exact = sp.theory.exact_transition_displacement(profile, gamma)
    fronts = fast_fronts(profile, 0.0, "total", 1.1 * exact.time)
    left = Part(fronts, gamma, exact.time).velocity(np.zeros(1), np.array([exact.time]))
    assert abs(left) < tol.ALGEBRA * 1e3
    truth = np.array([exact.time, exact.length])
    assert truth[: len(table)] == pytest.approx(table, rel=tol.TRANSITION_TABLE)
    if known is None:
        return
    measured = []
    for dx in (0.05, 0.02, 0.01, 0.005):
        run = run_of(tau0, gamma=gamma, dx=dx, duration=1.2 * exact.time, **paper_accuracy)
        time = run.attrs["first_stick_time"]
        measured.append((time, 2.0 * float(front_position(run, time))))
    _, coarse, middle, fine = np.array(measured) - truth
    first_sticks = [time for time, _ in measured[: len(known)]]
    assert first_sticks == pytest.approx(known, rel=tol.TRANSITION_TABLE)
    # If L_trans has converged to the error of the step, no order can be measured.
    low, high = tol.TRANSITION_HALVING
    for ratio in (coarse / middle, middle / fine):
        assert low < ratio[0] < high and (not known or low < ratio[1] < high)
    assert np.all(np.abs(2.0 * fine - middle) < tol.TRANSITION * truth)
    assert not known or np.all(np.abs(2.0 * middle - coarse) < tol.TRANSITION_EXTRAPOLATED * truth)


# Level, width, damping ratio, and tabulated times without damping at which the front has covered
# 0.9, 0.95 and 0.99 of |x_minus|, divided by |x_minus|.
CRACKS = [
    (-0.75, 5.0, 0.1, ()),
    (-1.0, 4.0, 0.1, ()),
    (-1.0, 4.0, 0.0, (1.3031, 1.5543, 1.9779)),
    (-0.5, 4.0, 0.1, ()),
    (-0.5, 1.0, 0.1, (1.1745, 1.3415, 1.6052)),
]


@pytest.mark.parametrize(("left", "width", "ratio", "table"), CRACKS)
def test_share_times_and_peak_under_stress_as_tabulated_to_first_order(left, width, ratio, table):
    profile = sp.Prestress(left, 0.0, width)
    crack, undamped = (sp.theory.ArrestingCrack(profile, b) for b in (ratio, 0.0))
    distance, shares = abs(crack.balance_position), np.array([0.5, 0.6, 0.7, 0.8, 0.9])
    assert abs(integral(profile, crack.balance_position, 40.0 * width)) <= tol.QUADRATURE
    for share, known in zip((0.9, 0.95, 0.99), table, strict=False):
        time = undamped.transition(share).time
        assert time / distance == pytest.approx(known, rel=tol.SHARE_TABLE)
    exact, errors = np.array([crack.transition(share).time for share in shares]), []
    for dx in np.array([4.0, 2.0, 1.0]) * min(0.01, 0.005 * width):
        values = {"dx": dx, "beta": ratio * dx, "duration": 1.6 * distance}
        run = run_of(left, 0.0, width, max_step=0.3, order=6, **values)
        errors.append([arrival(run, share * distance, "left")[0] for share in shares] / exact - 1.0)
    low, high = tol.TRANSITION_HALVING
    for coarse, fine in pairwise(errors):
        assert low < coarse[-1] / fine[-1] < high, errors
    assert abs(2.0 * errors[2][-1] - errors[1][-1]) < tol.SHARE_EXTRAPOLATED
    assert np.max(np.abs(errors[2])) < tol.SHARE_TIME
    peak = leading_pulse(run, 0.3).peak_velocity
    assert peak == pytest.approx(crack.peak_velocity, rel=tol.STRESS_PEAK)


@pytest.mark.parametrize(("tau", "gamma", "beta", "v"), STEADY)
def test_the_pulse_solves_its_equation(tau, gamma, beta, v):
    """(v^2 - 1) U'' + gamma U + beta v U''' = tau_0, with U = U' = 0 at the front."""
    pulse = sp.theory.steady_pulse(tau, gamma, beta, v)
    root = complex(pulse.growth, pulse.wavenumber)
    assert abs(beta * v * root**3 + (v**2 - 1.0) * root**2 + gamma) < tol.QUADRATURE
    # The third root is negative: its solution grows away from the front.
    assert beta == 0.0 or -(v**2 - 1.0) / (beta * v) - 2.0 * root.real < 0.0
    xi = -np.linspace(0.0, 1.0, 20001) * pulse.width
    part = tau / gamma * (1.0 + 1j * root.real / root.imag) * np.exp(root * xi)
    expected = tau / gamma - part.real, (v * root * part).real, -((v * root) ** 2 * part).real
    slip, velocity, _ = fields = pulse.profile(xi)
    np.testing.assert_allclose(fields, expected, rtol=tol.QUADRATURE, atol=tol.QUADRATURE)
    assert (velocity[-1], slip[-1]) == pytest.approx((0.0, pulse.slip), abs=tol.QUADRATURE / gamma)
    assert pulse.stress_drop == pytest.approx(gamma * pulse.slip, rel=tol.PULSE_THEORY)
    assert pulse.peak_velocity == pytest.approx(velocity.max(), rel=tol.PULSE_EQUATION)


class EndingTail(sp.Prestress):
    """Pre-stress with a linear ramp, which `Prestress` cannot have."""

    def __call__(self, x):
        x = np.asarray(x, dtype=float)
        ramp = np.where(x < TAIL_LENGTH, 1.0 - 0.5 * x / TAIL_LENGTH, 0.0)
        return np.where(x < 0.0, TAIL_LEVEL, ramp)


def test_the_arrest_of_a_tail_that_ends():
    """The front stops at t = T(3) + 3 - x_minus.

    The last characteristic starts at the end of the tail, at x = 3 and t = T(3).
    """
    slowness = lambda x: 1.0 / sp.theory.front_speed(1.0 - 0.5 * x / TAIL_LENGTH, TAIL_RATIO)
    arrest = quad(slowness, 0.0, TAIL_LENGTH)[0] + TAIL_LENGTH - X_MINUS
    assert arrest == pytest.approx(ARREST, abs=1e-4)
    gaps, tail = [], EndingTail(TAIL_LEVEL, 0.0)
    for dx in (0.04, 0.02):
        beta = TAIL_RATIO * dx
        run = sp.simulate(sp.Scene("stress", tail, 1.5 * ARREST, dx, beta=beta, max_step=1.0))
        left = run["release_time"].where(run["x"] < 0.0)
        assert float(left.max()) == pytest.approx(ARREST, rel=0.01)
        gaps.append(float(run["x"].where(left.notnull()).min()) - X_MINUS)
    # The front stops a few blocks too early, and fewer on the finer lattice.
    assert 0.0 < gaps[1] < gaps[0] < 3.0 * 0.04
