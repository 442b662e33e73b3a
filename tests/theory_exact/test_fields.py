"""Slip, velocity and strain behind the fronts, trailing edges, and limits of the construction."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import j0, jn_zeros

import slippulse as sp
from slippulse.model.balance import integral
from slippulse.theory import Rupture, uniform_transition_time
from slippulse.theory.part import Part
from slippulse.theory.two_fronts import fast_fronts

PUBLISHED_SCENE = (sp.Prestress(0.25, 0.25), 0.55, 0.1)
# Positions, stick times and slips of the published scene. Lattices with dx = 0.01, 0.005 and
# 0.0025, extrapolated, agree within 2.4e-5 and 4e-6.
STICK_POSITIONS = np.array([0.0, 1.0, 2.0, 3.2, 4.5, 6.0, 8.0, 9.6])
STICK_TIMES = np.array(
    [3.931228, 4.047665, 4.377168, 4.987691, 5.826132, 6.934555, 8.549606, 9.908655]
)
FINAL_SLIPS = np.array(
    [1.941664, 1.779533, 1.472257, 1.194463, 1.027645, 0.926688, 0.863650, 0.842801]
)
SCENES = {
    "symmetric": (sp.Prestress(0.4, 0.4), 0.65, 0.1),
    "asymmetric": (sp.Prestress(-0.5, 0.5), 0.65, 0.1),
    "stress": (sp.Prestress(-0.4, 0.3, 1.5), 0.0, 0.1),
    "step": (sp.Prestress(0.5, 0.5, steps=((2.0, 0.3),)), 0.65, 0.0),
}
# Scenes with a barrier and a step, at which panels of the fronts end.
REFINED_SCENES = SCENES | {
    f"fronts, {ratio}": (sp.Prestress(-0.5, 0.4, steps=((4.0, 0.7),)), 0.65, ratio)
    for ratio in (0.0, 0.01, 0.1)
}


def test_the_published_scene():
    rupture = Rupture(*PUBLISHED_SCENE, "total", 11.0)
    assert rupture.limit is None
    assert rupture.stick_time(STICK_POSITIONS) == pytest.approx(STICK_TIMES, abs=1e-6)
    assert rupture.final_slip(STICK_POSITIONS) == pytest.approx(FINAL_SLIPS, abs=1e-6)
    assert rupture.stick_time(-STICK_POSITIONS) == pytest.approx(
        rupture.stick_time(STICK_POSITIONS), abs=1e-12
    )
    assert rupture.first_stick == pytest.approx((STICK_TIMES[0], 0.0), abs=1e-6)
    width = rupture.fronts_at(STICK_TIMES[5])[1] - STICK_POSITIONS[5]
    assert rupture.pulse_width(STICK_TIMES[5]) == pytest.approx(width, abs=2e-6)
    assert np.isnan(rupture.pulse_width(2.0))
    # Nothing moves ahead of the fronts and behind the trailing edges.
    fields = rupture.map([1.0, 8.5], [-7.0, 0.0, 5.0, 12.0])
    velocity = fields["slip_velocity"]
    assert not velocity[0, [0, 2, 3]].any() and not velocity[1, 1:].any()
    assert fields["slip"][1, 1] == pytest.approx(FINAL_SLIPS[0], abs=1e-6)
    assert fields["strain"][1, 0] > 0.0 > fields["strain"][1, 2]


@pytest.mark.parametrize("name", REFINED_SCENES)
def test_times_and_slip_do_not_depend_on_the_panels(name):
    profile, gamma, ratio = REFINED_SCENES[name]
    x = np.linspace(-3.4, 6.0, 40)
    coarse, fine = (Rupture(profile, gamma, ratio, "total", 6.5, refinement=n) for n in (1, 2))
    assert np.isfinite(fine.release_time(x)).sum() > 30
    # The error of arrival times is a relative one.
    errors = (("release_time", 1e-8, 1e-13), ("stick_time", 0.0, 1e-8), ("final_slip", 0.0, 1e-8))
    for quantity, relative, error in errors:
        one, two = (getattr(rupture, quantity)(x) for rupture in (coarse, fine))
        assert one == pytest.approx(two, rel=relative, abs=error, nan_ok=True), quantity
    times = np.linspace(0.5, 6.0, 5)
    for field, values in coarse.map(times, x).items():
        assert values == pytest.approx(fine.map(times, x)[field], abs=1e-7, nan_ok=True), field


def riemanns_integral(rupture: Rupture, profile, gamma: float, x: float, time: float) -> float:
    """Return the slip velocity at a point by adaptive quadrature of Riemann's integral."""
    arrival = lambda z: float(rupture.release_time(z))
    meets = lambda z, side: time - arrival(z) - side * (z - x)
    on_front = abs(time - arrival(x)) < 1e-12
    left = x if on_front else brentq(meets, -3.4, x, args=(-1.0,), xtol=1e-13)
    right = brentq(meets, x + 0.05, 4.5, args=(1.0,), xtol=1e-13)

    def integrand(z: float) -> float:
        interval = max((time - arrival(z)) ** 2 - (z - x) ** 2, 0.0)
        return 0.5 * float(profile(z)) * j0(np.sqrt(gamma * interval))

    points = [z for z in (-1.3, 0.0, 2.0) if left < z < right]
    return quad(integrand, left, right, points=points, epsabs=1e-9, limit=100)[0]


@pytest.mark.parametrize("name", SCENES)
def test_velocity_is_riemanns_integral(name):
    profile, gamma, ratio = SCENES[name]
    fronts = fast_fronts(profile, ratio, "total", 8.0)
    rupture = Rupture(profile, gamma, ratio, "total", 8.0)
    for x, time in ((0.3, 1.5), (1.0, 3.0), (-0.8, 2.5)):
        exact = riemanns_integral(rupture, profile, gamma, x, time)
        assert float(rupture.slip_velocity(x, time)) == pytest.approx(exact, abs=1e-8)
        if name != "asymmetric":
            velocity = Part(fronts, gamma, 8.0).velocity(np.array([x]), np.array([time]))
            assert velocity == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize(("gamma", "ratio"), [(0.65, 0.1), (0.65, 0.0), (0.0, 0.1)])
def test_velocity_vanishes_on_a_slow_front(gamma, ratio):
    """Check the integral equation of the free boundary."""
    profile = sp.Prestress(-0.5, 0.5)
    rupture = Rupture(profile, gamma, ratio, "total", 4.0)
    assert rupture.limit is None
    for x in (-3.0, -2.2, -1.7):
        time = float(rupture.release_time(x))
        total = riemanns_integral(rupture, profile, gamma, x, time)
        assert total == pytest.approx(0.0, abs=5e-9)
        assert float(rupture.release_time(x - 1e-4)) - time > 1e-4


@pytest.mark.parametrize("name", SCENES)
def test_slip_and_strain_belong_to_the_velocity_and_obey_the_equation(name):
    """Slip is the time integral of the velocity, and strain the derivative of slip.

    The three have separate formulas.
    """
    profile, gamma, ratio = SCENES[name]
    rupture = Rupture(profile, gamma, ratio, "total", 6.0)
    h = 1e-4
    for x, time in ((0.7, 3.0), (-1.1, 2.6), (2.5, 3.4)):
        release = float(rupture.release_time(x))
        # du/dt has kinks where characteristics from the nucleation and from the step pass.
        kinks = [float(rupture.release_time(p)) + abs(x - p) for p in (0.0, 2.0)]
        inner = [t for t in kinks if release < t < time]
        velocity = lambda t, x=x: float(rupture.slip_velocity(x, t))
        total = quad(velocity, release, time, points=inner, epsabs=1e-9, limit=200)[0]
        assert float(rupture.slip(x, time)) == pytest.approx(total, abs=1e-7)
        difference = np.diff(rupture.slip(np.array([x - h, x + h]), time))[0] / (2.0 * h)
        strain = rupture.map([time], [x], ("strain",))["strain"]
        assert strain.item() == pytest.approx(difference, abs=1e-6)
    h = 1e-3
    for x, time in ((0.7, 2.5), (-1.5, 2.8), (2.2, 3.0)) if name.endswith("symmetric") else ():
        u = rupture.slip(x + h * np.array([-1, 0, 1, 0, 0]), time + h * np.array([0, -1, 0, 1, 0]))
        balance = (u[1] + u[3] - u[0] - u[2]) / h**2 + gamma * u[4]
        assert balance == pytest.approx(float(profile(x)), abs=1e-5)


@pytest.mark.parametrize("tau0", [1e-320, 1e-5, 3e-3, 1e-2])
def test_transition_behind_a_front_that_hardly_outruns_the_waves(tau0):
    """At v = 1 the integral is J1(2q), where 2q = sqrt(gamma) t."""
    first_zero = pytest.approx(jn_zeros(1, 1)[0], rel=tau0**2 + 1e-12)
    assert uniform_transition_time(tau0, 1.0) == first_zero


@pytest.mark.parametrize(("tau0", "expected"), [(0.1, 1.219), (0.4, 1.206), (0.9, 1.112)])
def test_transition_in_uniform_prestress(tau0, expected):
    """T_trans is proportional to 1/sqrt(gamma), also with damping and soft leaf springs."""
    time, rate = uniform_transition_time(tau0, 1.0), np.sqrt(1.0 - tau0**2)
    assert time / np.pi == pytest.approx(expected, abs=5e-4)
    integrand = lambda x, t: j0(np.sqrt(max((t - rate * x) ** 2 - x**2, 0.0)))
    velocity = lambda t: quad(integrand, 0.0, t / (1.0 + rate), args=(t,))[0]
    assert time == pytest.approx(brentq(velocity, 2.0, 5.0), abs=1e-8)
    damped = uniform_transition_time(tau0, 1.0, 0.1)
    assert uniform_transition_time(tau0, 4.0, 0.1) == pytest.approx(0.5 * damped)
    gaussian = sp.theory.exact_transition_displacement(sp.Prestress(tau0, tau0), 1e-12, 0.1)
    assert 1e-6 * gaussian.time == pytest.approx(damped, rel=1e-4)


@pytest.mark.parametrize("right", [0.1, 0.5, 0.9])
def test_a_weaker_barrier_lets_a_one_way_pulse_come_later_and_farther(right):
    ends_and_transitions = []
    for left in (-1.0, -0.3, -0.1):
        rupture = Rupture(sp.Prestress(left, right), 0.65, 0.1, duration=9.0)
        end = rupture.front_ends[0][0]
        assert end.reason == "stops" and rupture.limit is None
        ends_and_transitions.append((-end.x, *rupture.transition))
    assert (np.diff(ends_and_transitions, axis=0) > 0.0).all()


def test_a_crack_with_two_slow_fronts_is_arrested():
    """Without leaf springs each front stops where Int_X^e tau dx = 0.

    There e is the point at which the other front becomes slow.
    """
    profile = sp.Prestress(-0.5, -0.5)
    rupture = Rupture(profile, 0.0, 0.1, "total", 9.0)
    zero = brentq(lambda x: float(profile(x)), 0.5, 3.0, xtol=1e-14)
    stop = brentq(lambda x: integral(profile, x, zero), -20.0, -zero - 0.1, xtol=1e-13)
    ((left, right),) = rupture.front_ends
    assert (left.reason, right.reason) == ("stops", "stops")
    assert (left.x, right.x) == pytest.approx((stop, -stop), abs=1e-8)
    assert left.time == pytest.approx(float(rupture.release_time(zero)) + zero - stop, abs=1e-7)


def test_the_end_of_the_construction_is_reported():
    """Two ruptures meet, and the waves of one push what has just stuck in the other."""
    profile = sp.Prestress(0.4, 0.4, bumps=((5.0, 0.7, 1.0),))
    rupture = Rupture(profile, 0.65, 0.1, "total", 5.0)
    limit, x = rupture.limit, np.linspace(-8.0, 13.0, 30)
    assert "slower than the waves" in limit.reason
    assert float(rupture.horizon(limit.x)) == pytest.approx(limit.time, abs=1e-9)
    is_known = np.isfinite(rupture.slip(limit.x, limit.time + np.array([-0.1, 0.1])))
    assert is_known.tolist() == [True, False]
    for values in rupture.map([4.9], x).values():
        assert np.array_equal(np.isnan(values[0]), rupture.horizon(x) <= 4.9)
    assert not np.any(rupture.stick_time(np.linspace(-3.0, 8.0, 40)) > 5.0)


@pytest.mark.parametrize("levels", [(0.25, 0.25), (-0.5, 0.5)])
def test_nothing_slips_faster_than_the_largest_velocity(levels):
    """The largest velocity lies on a ridge, which is searched along its whole length here."""
    rupture = Rupture(sp.Prestress(*levels), 0.55, 0.1, "total", 10.8)
    times, positions = np.linspace(0.5, 10.8, 500), np.linspace(-12.0, 14.0, 800)
    largest = np.nanmax(rupture.map(times, positions, ("slip_velocity",))["slip_velocity"])
    assert largest * (1.0 - 1e-12) <= rupture.largest_velocity < 1.002 * largest
    if levels[0] < 0.0:
        # The ridge rises until the end.
        at_end = rupture.slip_velocity(np.linspace(12.6, 12.8, 401), 10.8)
        assert rupture.largest_velocity == pytest.approx(np.max(at_end), rel=1e-8)
