"""The exact solution on piecewise-linear pre-stress, against closed forms, lattices and limits."""

import time
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

import slippulse as sp
from slippulse.theory import ArrestingCrack, Rupture

# The tail of this pre-stress ends, so that the left front arrives at x_minus = -4.5.
TAIL_THAT_ENDS = sp.Prestress.through([0.0, 0.0, 3.0, 3.0, 4.0], [-0.5, 1.0, 0.5, 0.0, 0.0])
# Damping ratio and the time at which the left front arrives.
ARREST_TIMES = ((0.0, 9.3426), (0.1, 9.1247), (0.2, 8.9504))
# The first random scenes are in every run of the tests, the others only in the slow tests.
SLOW_SCENES = [pytest.param(number, marks=pytest.mark.slow) for number in range(3, 10)]
SCENES = [*range(3), *SLOW_SCENES]
SPACINGS = (0.08, 0.04, 0.02)


def undamped_time(tau: np.ndarray) -> np.ndarray:
    """Return the arrival time of an undamped front on a ramp of slope 1, up to a constant."""
    return 0.5 * (tau * np.sqrt(1.0 - tau**2) + np.arcsin(tau))


def random_table(number: int) -> sp.Prestress:
    """Return a profile through a dozen points with one jump.

    Profiles with odd numbers have a Gaussian at x = 0 instead of a peak. The points are blocks of
    all lattices, so that the jump is at the same place in each of them.
    """
    rng = np.random.default_rng((number, 53))
    x = SPACINGS[0] * np.unique(np.append(rng.integers(-175, 176, 10), 0))
    tau = rng.uniform(0.25, 0.9, x.size)
    jump = int(rng.integers(8, 10))
    x, tau = np.insert(x, jump, x[jump]), np.insert(tau, jump, rng.uniform(0.25, 0.9))
    if number % 2:
        return sp.Prestress.through(x, tau, width=1.0)
    tau[x == 0.0] = 1.0
    return sp.Prestress.through(x, tau)


@pytest.mark.parametrize("gamma", [0.0, 0.65])
def test_an_undamped_front_over_a_ramp_is_the_closed_form(gamma):
    profile = sp.Prestress.through([-3.0, 0.0, 0.0, 6.0], [0.3, 1.0, 0.9, 0.2])
    rupture = Rupture(profile, gamma, 0.0, duration=9.0)
    x = np.linspace(0.0, 6.0, 13)
    exact = (undamped_time(profile(x[1:])) - undamped_time(0.9)) / (-0.7 / 6.0)
    assert rupture.release_time(x[1:]) == pytest.approx(exact, rel=1e-9)
    # Beyond the table the pre-stress is uniform.
    uniform = exact[-1] + np.sqrt(1.0 - 0.2**2) * np.array([0.5, 2.0])
    assert rupture.release_time([6.5, 8.0]) == pytest.approx(uniform, rel=1e-9)
    # On the left the front starts where the ramp itself is 1.
    left = (undamped_time(1.0) - undamped_time(profile(-x[1:7]))) / (0.7 / 3.0)
    assert rupture.release_time(-x[1:7]) == pytest.approx(left, rel=1e-8)


def test_slip_under_held_stress_is_a_polynomial_and_waves():
    """If tau is linear in x, u - tau t^2/2 is a solution of the wave equation.

    Every solution of the wave equation is a sum of two waves.
    """
    profile = sp.Prestress.through([-8.0, -1.0, 0.0, 2.0, 9.0], [0.2, 0.7, 1.0, 0.4, 0.8])
    rupture, h = Rupture(profile, 0.0, 0.1, duration=9.0), 0.3
    x, t = np.array([1.0, 4.0, -4.0, -0.5]), np.array([3.0, 5.5, 6.0, 4.0])
    waves = lambda x, t: rupture.slip(x, t) - 0.5 * profile(x) * t**2
    around = waves(x, t + h) + waves(x, t - h) - waves(x + h, t) - waves(x - h, t)
    assert around == pytest.approx(np.zeros(4), abs=1e-9)


def test_slip_under_held_displacement_is_the_integral_of_its_velocity():
    rupture = Rupture(random_table(1), 0.65, 0.1, duration=6.0)
    for x, end in ((0.5, 3.0), (-3.0, 4.0)):
        start = float(rupture.release_time(x))
        rate = lambda t, x=x: float(rupture.slip_velocity(x, t))
        slip = quad(rate, start, end, epsabs=1e-9, limit=200)[0]
        assert float(rupture.slip(x, end)) == pytest.approx(slip, abs=1e-7)


@pytest.mark.parametrize(("ratio", "arrest"), ARREST_TIMES)
def test_a_tail_that_ends_stops_the_left_front_at_x_minus_in_finite_time(ratio, arrest):
    ((left, _),) = Rupture(TAIL_THAT_ENDS, 0.0, ratio, duration=12.0).front_ends
    assert left.reason == "stops"
    assert (left.x, left.time) == pytest.approx((-4.5, arrest), abs=1e-4)
    crack = ArrestingCrack(TAIL_THAT_ENDS, ratio)
    assert crack.balance_position == pytest.approx(-4.5, abs=1e-12)
    times = [crack.time_at(x) for x in (-4.4, -1.0)]
    rupture = Rupture(TAIL_THAT_ENDS, 0.0, ratio, duration=12.0)
    assert rupture.release_time([-4.4, -1.0]) == pytest.approx(times, rel=1e-8)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("level", "length", "tail"), [(-0.36, 0.942, 1.432), (-0.442, 0.721, 1.484), (-0.2, 1.43, 0.58)]
)
def test_rounding_does_not_decide_whether_blocks_stick_after_all_waves(level, length, tail, side):
    """The velocity behind the stopped front is 0, and no block slides backwards."""
    x, tau = np.array([-length - 0.2, -0.2, 0.2, tail + 0.2]), np.array([level, 1.0, 1.0, 0.0])
    if side < 0.0:
        x, tau = -x[::-1], tau[::-1]
    for shift in (0.0, -17.0, 24.0):
        rupture = Rupture(sp.Prestress.through(x + shift, tau), 0.0, 0.1, duration=20.0)
        assert rupture.limit is None and rupture.first_stick is None
        ends = [abs(end.x - shift) for end in rupture.front_ends[0]]
        position = shift - 0.9 * side * min(ends)
        assert float(rupture.slip_velocity(position, 20.0)) == pytest.approx(0.0, abs=1e-12)


def test_x_minus_of_a_trapezoid_is_the_root_of_a_quadratic():
    """The area is 1.75 to the right of x = 0, and 0 on the ramp from -0.4 to 0.4."""
    x, tau = [-1.0, 0.0, 0.0, 1.0, 2.5, 3.0], [-0.4, 0.4, 1.0, 1.0, 0.0, 0.0]
    position = sp.theory.prestress_balance_position(sp.Prestress.through(x, tau))
    assert position == pytest.approx(-1.0 - 1.75 / 0.4, abs=1e-12)
    # A steeper ramp balances the area by itself: tau is -4 y at x = -y, and 1.75 - 2 y^2 = 0.
    x, tau = [-2.0, 0.0, 0.0, 1.0, 2.5, 3.0], [-8.0, 0.0, 1.0, 1.0, 0.0, 0.0]
    position = sp.theory.prestress_balance_position(sp.Prestress.through(x, tau))
    assert position == pytest.approx(-np.sqrt(1.75 / 2.0), abs=1e-12)


@pytest.mark.parametrize("boundary", ["displacement", "stress"])
@pytest.mark.parametrize("number", SCENES)
def test_lattices_tend_to_the_exact_solution_at_first_order(number, boundary):
    profile, ratio = random_table(number), (0.1, 0.3)[number % 2]
    gamma, duration = (0.65, 7.0) if boundary == "displacement" else (0.0, 6.0)
    rupture = Rupture(profile, gamma, ratio, duration=duration)
    x = 0.08 * np.arange(-60, 61, 6)
    exact = {"release_time": rupture.release_time(x), "slip": rupture.slip(x, duration)}
    exact["stick_time"] = np.where(rupture.horizon(x) > duration, rupture.stick_time(x), np.nan)
    errors = {name: [] for name in exact}
    for dx in SPACINGS:
        scene = sp.Scene(boundary, profile, duration, dx, gamma, ratio * dx)
        run = sp.simulate(scene).sel(x=x, method="nearest")
        for name, values in exact.items():
            is_compared = np.isfinite(run[name].values) & np.isfinite(values)
            # Near the end of the run one of the two events may not have happened yet.
            is_compared &= (name == "slip") | (values < duration - 0.2)
            errors[name].append(np.where(is_compared, run[name].values - values, np.nan))
    for name, (coarse, middle, fine) in errors.items():
        known = np.isfinite(coarse) & np.isfinite(middle) & np.isfinite(fine)
        if boundary == "displacement" or name != "stick_time":
            assert known.sum() >= 5 or rupture.limit, name
        size = max(1.0, float(np.max(np.abs(exact[name][known]), initial=0.0)))
        # The remaining error, after extrapolation of the error of first order.
        remaining_error = np.max(np.abs(2.0 * fine - middle)[known], initial=0.0)
        assert remaining_error < 1.5e-3 * size, name
        assert np.max(np.abs(fine[known]), initial=0.0) < 0.02 * size, name


def test_a_sampled_gaussian_converges_at_second_order():
    smooth = sp.Prestress(0.4, 0.4)
    exact, x = Rupture(smooth, 0.65, 0.1, duration=7.0), np.linspace(-5.0, 5.0, 21)
    errors = []
    for spacing in (0.2, 0.1, 0.05):
        at = spacing * np.arange(-int(7.0 / spacing), int(7.0 / spacing) + 1)
        table = Rupture(sp.Prestress.through(at, smooth(at)), 0.65, 0.1, duration=7.0)
        slip = table.slip(x, 5.0) - exact.slip(x, 5.0)
        release = table.release_time(x) - exact.release_time(x)
        stick = table.stick_time(x) - exact.stick_time(x)
        errors.append([np.nanmax(np.abs(error)) for error in (slip, release, stick)])
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert np.all((ratios > 3.6) & (ratios < 4.4))


def test_points_on_a_line_change_nothing():
    profile = random_table(0)
    x, tau = np.array(profile.points).T
    more = np.linspace(-12.0, 12.0, 25)
    more = more[np.min(np.abs(more[:, None] - x), axis=1) > 1e-3]
    at = np.append(x, more)
    order = np.argsort(at, kind="stable")
    denser = sp.Prestress.through(at[order], np.append(tau, profile(more))[order])
    assert len(denser.points) > len(profile.points) + 10
    positions = np.linspace(-5.0, 5.0, 31)
    for gamma in (0.0, 0.65):
        one, two = (Rupture(each, gamma, 0.1, duration=6.0) for each in (profile, denser))
        for name in ("release_time", "stick_time"):
            expected = pytest.approx(getattr(one, name)(positions), abs=1e-8, nan_ok=True)
            assert getattr(two, name)(positions) == expected
        assert two.slip(positions, 6.0) == pytest.approx(one.slip(positions, 6.0), abs=1e-8)


def test_a_mirrored_table_gives_the_mirrored_rupture():
    profile = random_table(2)
    points = tuple((-x, tau) for x, tau in profile.points[::-1])
    mirrored = replace(profile, left=profile.right, right=profile.left, points=points)
    x = np.linspace(-5.0, 5.0, 31)
    one, two = (Rupture(each, 0.65, 0.1, duration=6.0) for each in (profile, mirrored))
    assert two.release_time(-x) == pytest.approx(one.release_time(x), abs=1e-10)
    assert two.stick_time(-x) == pytest.approx(one.stick_time(x), abs=1e-8, nan_ok=True)
    assert two.slip(-x, 5.0) == pytest.approx(one.slip(x, 5.0), abs=1e-9)


def test_each_stretch_of_a_table_that_reaches_1_nucleates():
    """One nucleation is an interval, one is a point, and a bump on the table adds a third."""
    x, tau = [-9.0, -6.0, -5.0, -1.0, 0.0, 1.0, 4.0], [0.3, 1.2, 0.4, 0.3, 1.0, 0.4, 0.3]
    profile = sp.Prestress.through(x, tau, bumps=((9.0, 0.9, 0.5),))
    rupture = Rupture(profile, 0.65, 0.1, duration=0.6)
    assert len(rupture.front_ends) == 3
    assert rupture.release_time([-6.0, -5.8, 0.0, 9.0]) == pytest.approx(np.zeros(4), abs=1e-12)
    assert float(rupture.release_time(0.2)) > 0.0
    edge = -9.0 + 3.0 * (1.0 - 0.3) / 0.9
    assert float(rupture.release_time(edge)) == pytest.approx(0.0, abs=1e-12)
    assert float(rupture.release_time(edge - 0.1)) > 0.0
    lattice = sp.simulate(sp.Scene("displacement", profile, 0.6, 0.01, 0.65, 1e-3))
    at = np.array([-7.0, -5.0, -0.5, 0.6, 9.5])
    released = lattice.release_time.sel(x=at, method="nearest").values
    assert rupture.release_time(at) == pytest.approx(released, abs=0.02)


def seconds_of_solution(profile):
    """Return the least processor time of several solutions, since other work only adds to it."""
    seconds = []
    for _ in range(3):
        start = time.process_time()
        rupture = Rupture(profile, 0.65, 0.1, duration=8.0)
        rupture.final_slip(np.linspace(-4.0, 4.0, 41))
        seconds.append(time.process_time() - start)
    return min(seconds)


def test_the_cost_grows_in_proportion_to_the_pieces_at_most():
    rng, seconds = np.random.default_rng(3), []
    for count in (50, 1000):
        x = np.sort(np.append(rng.uniform(-25.0, 25.0, count - 1), 0.0))
        rough = rng.standard_normal(count).cumsum() / np.sqrt(count)
        tau = np.where(x == 0.0, 1.0, 0.5 + 0.2 * np.tanh(rough - rough.mean()))
        seconds.append(seconds_of_solution(sp.Prestress.through(x, tau)))
    assert seconds[1] < 20.0 * seconds[0]
