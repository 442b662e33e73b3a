"""The solver against exact results and the published figure."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.measure.fronts import arrival, front_speed, position_at
from slippulse.measure.pulses import leading_pulse

GAMMA = 2.0 / 3.0


def run_of(left, right=None, width=1.0, *, gamma=0.0, **values):
    """A run under a stress boundary, or with leaf springs under the other one."""
    boundary = "displacement" if gamma else "stress"
    prestress = sp.Prestress(left, left if right is None else right, width)
    return sp.simulate(sp.Scene(boundary=boundary, prestress=prestress, gamma=gamma, **values))


# Levels whose exact speeds are irrational, so that no locking on dx/(n dt) can pass for agreement.
@pytest.mark.parametrize("tau0", [0.23, 0.37, 0.5, 0.71, 0.9])
def test_undamped_front_speed_and_slip(tau0, paper_accuracy):
    run = run_of(tau0, gamma=0.65, dx=0.02, duration=120.0, **paper_accuracy)
    assert front_speed(run, 0.3)[0] == pytest.approx(1.0 / np.sqrt(1.0 - tau0**2), rel=tol.FRONT_SPEED)
    assert leading_pulse(run, 0.3).slip == pytest.approx(2.0 * tau0 / 0.65, rel=tol.PULSE_SLIP)
    assert run.attrs["run_flags"] == ""


@pytest.mark.parametrize(
    ("tau0", "ratio", "total", "elastic"),
    [
        (0.5, 0.05, 1.195467, 1.170395),
        (0.5, 0.2, 1.315836, 1.208446),
        (0.2, 0.2, 1.075091, 1.050926),
        (0.8, 1.0, 5.0, 1.892763),
    ],
)
def test_damped_front_speed_as_tabulated(tau0, ratio, total, elastic):
    for release, expected in (("total", total), ("elastic", elastic)):
        assert sp.theory.front_speed(tau0, ratio, release) == pytest.approx(expected, rel=tol.TABLE_DIGITS)
        run = run_of(
            tau0, gamma=0.1, dx=0.02, beta=0.02 * ratio, duration=40.0, release=release, max_step=0.1
        )
        assert front_speed(run, 0.3)[0] == pytest.approx(expected, rel=tol.DAMPED_SPEED)


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize(
    ("tau0", "ratio"),
    [
        (0.2, 0.02), (0.35, 0.05), (0.5, 0.1), (0.65, 0.2), (0.8, 0.3),
        (0.3, 0.5), (0.45, 1.0), (0.6, 1.5), (0.7, 2.0), (0.55, 3.0),
    ],
)  # fmt: skip
def test_damped_front_speed(tau0, ratio, release):
    run = run_of(tau0, dx=0.02, beta=0.02 * ratio, duration=14.0, release=release, max_step=0.05)
    exact = sp.theory.front_speed(tau0, ratio, release)
    assert front_speed(run, 0.2)[0] == pytest.approx(exact, rel=tol.FRONT_SPEED_THEORY)


@pytest.mark.parametrize(("tau0", "ratio"), [(0.3, 0.02), (0.45, 0.05), (0.6, 0.1), (0.7, 0.15), (0.85, 0.2)])
def test_steady_pulse(tau0, ratio):
    dx, gamma = 0.01, 0.65
    pulse = leading_pulse(run_of(tau0, gamma=gamma, dx=dx, beta=ratio * dx, duration=60.0, max_step=0.2), 0.3)
    theory = sp.theory.steady_pulse(tau0, gamma, ratio * dx, sp.theory.front_speed(tau0, ratio))
    assert pulse.slip == pytest.approx(theory.slip, rel=tol.PULSE_SLIP_THEORY)
    assert pulse.peak_velocity == pytest.approx(theory.peak_velocity, rel=tol.PULSE_PEAK_THEORY)
    assert pulse.width == pytest.approx(theory.width, abs=tol.PULSE_WIDTH_BLOCKS * dx)


def test_the_published_figure():
    run = run_of(0.25, gamma=0.55, beta=1e-3, dx=0.01, duration=10.8, release="total", max_step=0.5)
    speed, intercept, _ = front_speed(run, 0.6)
    assert speed == pytest.approx(1.070, rel=tol.PUBLISHED_FRONT_SPEED)
    assert intercept == pytest.approx(0.81, abs=tol.PUBLISHED_INTERCEPT)
    assert run.attrs["first_stick_time"] == pytest.approx(3.93, rel=tol.PUBLISHED_FRONT_SPEED)
    assert run.attrs["first_stick_position"] == 0.0
    edges = position_at(run, [5.0, 6.0, 7.0, 8.0, 9.0, 10.0], "right", "stick_time")
    assert edges == pytest.approx([3.19, 4.74, 6.03, 7.27, 8.48, 9.64], rel=tol.PUBLISHED_TRAILING)


@pytest.mark.parametrize(
    ("tau0", "gamma", "known"),
    [
        (0.5, GAMMA, (3.7945, 3.7863, 3.7835)),
        *((*case, ()) for case in ((0.2, GAMMA), (0.8, 0.1), (0.35, 1.0), (0.65, 0.3))),
    ],
)
def test_transition_converges_to_the_exact_theory_at_first_order(paper_accuracy, tau0, gamma, known):
    exact = sp.theory.exact_transition_displacement(sp.Prestress(tau0, tau0), gamma)
    found = []
    for dx in (0.05, 0.02, 0.01, 0.005):
        run = run_of(tau0, gamma=gamma, dx=dx, duration=1.2 * exact.time, **paper_accuracy)
        time = run.attrs["first_stick_time"]
        found.append((time, 2.0 * float(position_at(run, time))))
    truth = np.array([exact.time, exact.length])
    _, coarse, middle, fine = np.array(found) - truth
    assert [time for time, _ in found[: len(known)]] == pytest.approx(known, rel=tol.TRANSITION_TABLE)
    # L_trans can be converged to the error of the step already, and then has no order.
    low, high = tol.TRANSITION_HALVING
    for ratio in (coarse / middle, middle / fine):
        assert low < ratio[0] < high and (not known or low < ratio[1] < high)
    assert np.all(np.abs(2.0 * fine - middle) < tol.TRANSITION * truth)
    assert not known or np.all(np.abs(2.0 * middle - coarse) < tol.TRANSITION_EXTRAPOLATED * truth)


@pytest.mark.parametrize(
    ("left", "width", "ratio"),
    [(-0.75, 5.0, 0.1), (-1.0, 4.0, 0.1), (-1.0, 4.0, 0.0), (-0.5, 4.0, 0.1), (-0.5, 1.0, 0.1)],
)
def test_share_times_and_peak_under_stress_converge_at_first_order(left, width, ratio):
    crack = sp.theory.ArrestingCrack(sp.Prestress(left, 0.0, width), ratio)
    distance, shares = abs(crack.balance_position), np.array([0.5, 0.6, 0.7, 0.8, 0.9])
    duration, exact = 1.6 * distance, np.array([crack.share_time(share) for share in shares])
    errors = []
    for dx in np.array([4.0, 2.0, 1.0]) * min(0.01, 0.005 * width):
        run = run_of(left, 0.0, width, dx=dx, beta=ratio * dx, duration=duration, max_step=0.3, order=6)
        errors.append([arrival(run, share * distance, "left") for share in shares] / exact - 1.0)
    low, high = tol.TRANSITION_HALVING
    for coarse, fine in pairwise(errors):
        assert low < coarse[-1] / fine[-1] < high, errors
    assert abs(2.0 * errors[2][-1] - errors[1][-1]) < tol.SHARE_EXTRAPOLATED
    assert np.max(np.abs(errors[2])) < tol.SHARE_TIME
    assert leading_pulse(run, 0.3).peak_velocity == pytest.approx(crack.peak_velocity, rel=tol.STRESS_PEAK)
