"""The solver against exact results and the published figure."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.measure.fronts import arrival, front_speed, position_at
from slippulse.measure.pulses import leading_pulse
from slippulse.measure.uncertainty import grid_study

# Levels whose exact speeds are irrational, so that no locking on dx/(n dt) can pass for agreement.
IRRATIONAL = (0.23, 0.37, 0.5, 0.71, 0.9)


@pytest.mark.parametrize("tau0", IRRATIONAL)
def test_undamped_front_speed_and_slip(tau0, paper_accuracy):
    scene = sp.Scene(
        boundary="displacement", gamma=0.65, dx=0.02, duration=120.0, prestress=sp.Prestress(tau0, tau0),
        **paper_accuracy,
    )  # fmt: skip
    run = sp.simulate(scene)
    speed, _, _ = front_speed(run, 0.3)
    assert speed == pytest.approx(1.0 / np.sqrt(1.0 - tau0**2), rel=tol.FRONT_SPEED)
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
def test_damped_front_speed(tau0, ratio, total, elastic):
    for release, expected in (("total", total), ("elastic", elastic)):
        theory = sp.theory.front_speed(tau0, ratio, release)
        assert theory == pytest.approx(expected, rel=tol.TABLE_DIGITS)
        scene = sp.Scene(
            boundary="displacement", gamma=0.1, dx=0.02, beta=0.02 * ratio, duration=40.0, release=release,
            prestress=sp.Prestress(tau0, tau0), max_step=0.1,
        )  # fmt: skip
        measured, _, _ = front_speed(sp.simulate(scene), 0.3)
        assert measured == pytest.approx(theory, rel=tol.DAMPED_SPEED)


def test_release_rules_differ_where_damping_acts():
    for release, other in (("total", "elastic"), ("elastic", "total")):
        assert sp.theory.front_speed(0.5, 0.0, release) == sp.theory.front_speed(0.5, 0.0, other)
    assert sp.theory.front_speed(0.5, 0.1, "total") > 1.03 * sp.theory.front_speed(0.5, 0.1, "elastic")


def test_limits_of_the_front_speed():
    tau = np.array([0.1, 0.5, 0.9])
    assert sp.theory.front_speed(tau, 0.0) == pytest.approx(1.0 / np.sqrt(1.0 - tau**2), rel=1e-13)
    # At beta/dx = 1 the total rule gives 1/(1 - tau) to every digit computed.
    assert sp.theory.front_speed(tau, 1.0) == pytest.approx(1.0 / (1.0 - tau), rel=1e-12)
    strong = sp.theory.front_speed(tau, np.array([10.0, 10.0, 10.0]), "elastic")
    stronger = sp.theory.front_speed(tau, np.array([100.0, 100.0, 100.0]), "elastic")
    limit = 1.0 / np.sqrt(1.0 - tau)
    assert np.all(np.abs(stronger - limit) < 0.25 * np.abs(strong - limit))
    back = sp.theory.prestress_for_speed(sp.theory.front_speed(tau, 0.3), 0.3)
    assert back == pytest.approx(tau, rel=1e-10)


@pytest.fixture(scope="module")
def published_run():
    scene = sp.Scene(
        boundary="displacement", gamma=0.55, beta=1e-3, dx=0.01, duration=10.8, release="total", max_step=0.5,
        prestress=sp.Prestress(0.25, 0.25),
    )  # fmt: skip
    return sp.simulate(scene)


def test_published_front(published_run):
    speed, intercept, _ = front_speed(published_run, 0.6)
    assert speed == pytest.approx(1.070, rel=tol.PUBLISHED_FRONT_SPEED)
    assert intercept == pytest.approx(0.81, abs=tol.PUBLISHED_INTERCEPT)


def test_published_sticking(published_run):
    assert published_run.attrs["first_stick_time"] == pytest.approx(3.93, rel=tol.PUBLISHED_FRONT_SPEED)
    assert published_run.attrs["first_stick_position"] == 0.0
    edges = position_at(published_run, [5.0, 6.0, 7.0, 8.0, 9.0, 10.0], "right", "stick_time")
    assert edges == pytest.approx([3.19, 4.74, 6.03, 7.27, 8.48, 9.64], rel=tol.PUBLISHED_TRAILING)


@pytest.mark.parametrize("gamma", [0.05, 0.3])
def test_burridge_knopoff_speed(gamma):
    scene = sp.Scene(
        boundary="displacement", gamma=gamma, dx=1.0, duration=400.0, prestress=sp.Prestress(0.6, 0.6), max_step=0.2
    )  # fmt: skip
    speed, _, _ = front_speed(sp.simulate(scene), 0.5)
    assert speed == pytest.approx(sp.theory.lattice_front_speed(0.6, gamma, 1.0), rel=tol.FRONT_SPEED)


@pytest.mark.parametrize(
    ("tau0", "gamma"), [(0.5, 2 / 3), (0.2, 2 / 3), (0.8, 0.1), (0.35, 1.0), (0.65, 0.3)]
)
def test_transition_converges_to_the_exact_theory(tau0, gamma):
    exact = sp.theory.exact_transition_displacement(sp.Prestress(tau0, tau0), gamma)
    times, lengths, spacings = [], [], (0.02, 0.01, 0.005)
    for dx in spacings:
        scene = sp.Scene(
            boundary="displacement", gamma=gamma, dx=dx, duration=1.2 * exact.time, max_step=0.3,
            prestress=sp.Prestress(tau0, tau0),
        )  # fmt: skip
        run = sp.simulate(scene)
        times.append(run.attrs["first_stick_time"])
        lengths.append(2.0 * float(position_at(run, times[-1])))
    assert grid_study(times[::-1], (2.0, 4.0)).order == pytest.approx(1.0, abs=tol.ORDER_BAND)
    # L_trans can be converged to the error of the step already, and then has no order to extrapolate by.
    for values, theory in ((times, exact.time), (lengths, exact.length)):
        assert grid_study(values[::-1], (2.0, 4.0)).extrapolated == pytest.approx(theory, rel=tol.TRANSITION)


@pytest.mark.parametrize(("left", "width"), [(-0.75, 5.0), (-1.0, 4.0), (-0.5, 4.0)])
def test_share_times_and_peak_under_stress(left, width):
    profile = sp.Prestress(left, 0.0, width)
    crack = sp.theory.ArrestingCrack(profile, damping_ratio=0.1)
    shares = np.array([0.5, 0.6, 0.7, 0.8, 0.9])
    exact = np.array([crack.share_time(share) for share in shares])
    errors = []
    for dx in (0.02, 0.01):
        scene = sp.Scene(
            boundary="stress", dx=dx, beta=0.1 * dx, duration=2.0 * abs(crack.balance_position), max_step=0.5,
            prestress=profile,
        )  # fmt: skip
        run = sp.simulate(scene)
        measured = np.array([arrival(run, share * abs(crack.balance_position), "left") for share in shares])
        errors.append(np.max(np.abs(measured / exact - 1.0)))
    assert errors[1] < tol.SHARE_TIME
    assert errors[1] < errors[0]
    assert leading_pulse(run, 0.3).peak_velocity == pytest.approx(crack.peak_velocity, rel=tol.STRESS_PEAK)
