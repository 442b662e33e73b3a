"""Pre-stress through points: values, mirror images, balance, sampled functions, data files."""

import dataclasses
import json
import math

import numpy as np
import pytest
import tolerances as tol
import xarray as xr
from scipy.integrate import quad

import slippulse as sp
from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.model.balance import integral
from slippulse.model.cost import bound_cost
from slippulse.prediction.comparison import measured_table

X = [-9.0, -4.0, -4.0, -1.5, 0.5, 3.0, 3.0, 8.0]
TAU = [0.1, 0.4, -0.2, 0.3, 1.0, 0.2, 0.6, 0.35]
BUMPS = ((5.0, -0.3, 0.5),)


def mirrored(profile):
    """Return the mirror image of a profile with a table."""
    x, tau = np.array(profile.points[::-1]).T
    bumps = tuple((-centre, *rest) for centre, *rest in profile.bumps)
    return sp.Prestress.through(-x, tau, profile.width, profile.peak, bumps)


def test_a_table_is_linear_between_its_points_and_constant_beyond():
    profile = sp.Prestress.through(X, TAU)
    x = np.array([-20.0, -9.0, -6.5, -2.75, 0.5, 1.75, 5.5, 8.0, 99.0])
    expected = [0.1, 0.1, 0.25, 0.05, 1.0, 0.6, 0.475, 0.35, 0.35]
    assert profile(x) == pytest.approx(expected, abs=tol.STENCIL)
    assert (profile.left, profile.right, profile.width) == (0.1, 0.35, None)
    added = sp.Prestress.through(X, TAU, width=2.0, peak=1.1, bumps=BUMPS)
    gaussian, level = np.exp(-0.125 * x**2), profile.level(x)
    bump = -0.3 * np.exp(-2.0 * (x - 5.0) ** 2)
    assert added(x) == pytest.approx(level + (1.1 - level) * gaussian + bump, abs=tol.STENCIL)
    assert added(0.0) == 1.1 + BUMPS[0][1] * math.exp(-50.0)


def test_levels_and_steps_are_special_cases_of_a_table():
    """At a jump, the value on the side away from x = 0 holds; at x = 0 the larger one."""
    steps = ((5.0, 0.3), (-4.0, 0.7))
    levels = sp.Prestress(0.6, 0.5, steps=steps)
    x, tau = [-4.0, -4.0, 0.0, 0.0, 5.0, 5.0], [0.7, 0.6, 0.6, 0.5, 0.5, 0.3]
    table = sp.Prestress.through(x, tau, width=1.0)
    positions = np.linspace(-9.0, 9.0, 361)
    assert np.array_equal(table(positions), levels(positions))
    constant = [one for one in table.intervals if one.left_value == one.right_value]
    assert (*constant,) == table.intervals == levels.intervals
    assert table.level(np.array([0.0, -4.0, 5.0])).tolist() == [0.6, 0.7, 0.3]


def test_intervals_connect_the_points_and_leave_out_jumps():
    intervals = sp.Prestress.through(X, TAU).intervals
    assert intervals[0] == (-math.inf, -9.0, 0.1, 0.1)
    assert intervals[-1] == (8.0, math.inf, 0.35, 0.35)
    inner = [(-9.0, -4.0, 0.1, 0.4), (-4.0, -1.5, -0.2, 0.3), (-1.5, 0.5, 0.3, 1.0)]
    assert [*intervals[1:-1]] == [*inner, (0.5, 3.0, 1.0, 0.2), (3.0, 8.0, 0.6, 0.35)]


@pytest.mark.parametrize("width", [None, 1.5])
def test_a_mirrored_table_is_mirrored_to_the_last_bit(width):
    rng = np.random.default_rng(5)
    x = np.sort(rng.uniform(-20.0, 20.0, 301))
    x[100] = x[101]
    profile = sp.Prestress.through(x, rng.uniform(-0.5, 0.9, 301), width, bumps=BUMPS)
    positions = np.append(rng.uniform(-25.0, 25.0, 5001), [0.0, *x])
    assert np.array_equal(mirrored(profile)(-positions), profile(positions))
    even = sp.Prestress.through([-3.0, -3.0, 0.0, 3.0, 3.0], [0.2, 0.4, 1.0, 0.4, 0.2])
    assert even.symmetric and mirrored(even) == even
    assert not profile.symmetric and mirrored(mirrored(profile)) == profile
    uneven = sp.Prestress.through([-3.0, 0.0, 3.0], [0.2, 1.0, 0.2], bumps=BUMPS)
    assert not uneven.symmetric


def test_additional_points_on_a_line_change_nothing_except_rounding():
    profile = sp.Prestress.through(X, TAU)
    extra = np.array([-8.1, -7.7, -2.2, 1.1, 6.0])
    x, tau = np.append(X, extra), np.append(TAU, profile(extra))
    order = np.argsort(x, kind="stable")
    positions = np.linspace(-12.0, 12.0, 2401)
    finer = sp.Prestress.through(x[order], tau[order])
    assert finer(positions) == pytest.approx(profile(positions), abs=tol.STENCIL)


@pytest.mark.parametrize("width", [None, 0.7])
@pytest.mark.parametrize("ends", [(-12.0, 25.0), (1.0, 2.0), (3.0, -7.5)])
def test_the_integral_of_a_table_equals_a_numerical_integral(width, ends):
    profile = sp.Prestress.through(X, TAU, width, bumps=BUMPS)
    marks = [x for x in {*X, 5.0, 0.0} if min(ends) < x < max(ends)] or None
    accuracy = {"points": marks, "epsabs": 1e-13, "epsrel": 1e-12, "limit": 400}
    expected, _ = quad(lambda x: float(profile(x)), *ends, **accuracy)
    assert integral(profile, *ends) == pytest.approx(expected, abs=tol.QUADRATURE)


BALANCED = {
    "a trapezoid, and a level of -1/2": ([-2.0, -1.0, 1.0, 2.0], [-0.5, 1.0, 1.0, 0.0], -7.5),
    "jumps": ([0.0, 0.0, 3.0, 3.0], [-0.5, 1.0, 0.5, 0.0], -4.5),
    "a root on a ramp": ([-4.0, -2.0, 0.0, 2.0], [-1.0, -1.0, 1.0, 0.0], -3.0),
    "the first of three roots": (
        [-20.0, -20.0, -6.0, -6.0, -1.0, -1.0, 1.0, 1.0],
        [-2.0, 0.5, 0.5, -1.0, -1.0, 1.0, 1.0, 0.0],
        -3.0,
    ),
}


@pytest.mark.parametrize("case", BALANCED)
@pytest.mark.parametrize("shift", [0.0, 7.25])
def test_the_balance_of_a_table_is_exact_and_shifts_with_the_table(case, shift):
    """Without a Gaussian, it is the nearest one on the left of the nucleation."""
    x, tau, expected = BALANCED[case]
    profile = sp.Prestress.through(np.array(x) + shift, tau)
    balance = sp.theory.prestress_balance_position(profile)
    assert balance == pytest.approx(expected + shift, rel=tol.ALGEBRA)


def test_a_table_of_a_gaussian_has_the_balance_of_the_gaussian():
    gaussian = sp.Prestress(-0.5, 0.0)
    expected = sp.theory.prestress_balance_position(gaussian)
    ramp = sp.Prestress.through([0.0, 0.0], [-0.5, 0.0], width=1.0)
    balance = sp.theory.prestress_balance_position
    assert balance(ramp) == pytest.approx(expected, rel=tol.ALGEBRA)
    errors = []
    for spacing in (0.2, 0.1):
        x = spacing * np.arange(-100, 101)
        errors.append(balance(sp.Prestress.through(x, gaussian(x))) - expected)
    # The errors of lines through an analytic function cancel in part.
    assert math.log2(errors[0] / errors[1]) > 1.9 and abs(errors[1]) < 1e-4


def test_a_function_is_sampled_within_the_tolerance():
    gaussian = sp.Prestress(0.3, 0.5, width=0.4)
    x = np.linspace(-11.0, 11.0, 4001)
    coarse, fine = (
        sp.Prestress.from_function(gaussian, -10.0, 10.0, error) for error in (1e-3, 1e-5)
    )
    assert np.max(np.abs(fine(x) - gaussian(x))) <= 1e-5 < np.max(np.abs(coarse(x) - gaussian(x)))
    assert len(coarse.points) < len(fine.points) < 4001
    jump = sp.Prestress.from_function(lambda x: 0.5 if x < 1.0 / 3.0 else 0.2, -2.0, 2.0, 1e-3)
    assert jump(np.array([0.333, 0.3334])).tolist() == [0.5, 0.2]


def test_a_seed_gives_the_same_rough_field_on_every_machine():
    """The values are from numpy 2. Every version of numpy makes the same normal numbers."""
    field = sp.rough(0.4, 0.1, 1.0, 0.5, start=-2.0, stop=2.0, spacing=1.0, seed=7)
    assert field.x.tolist() == [-2.0, -1.0, 0.0, 1.0, 2.0]
    assert field.tau == pytest.approx(PINNED, abs=1e-9)
    assert not np.allclose(field.tau, sp.rough(0.4, 0.1, 1.0, 0.5, -2.0, 2.0, 1.0, seed=8).tau)


PINNED = [0.388905282, 0.412092875784, 0.354833795798, 0.295509910493, 0.313468016576]


def test_rough_fields_have_the_requested_deviation_and_spectrum():
    """At short wavelengths the amplitude falls with the power hurst + 1/2 of the wave number."""
    spacing, seeds = 0.05, range(300)
    shape = 0.2, 0.1, 2.0, 0.7, -25.0, 25.0, spacing
    fields = np.array([sp.rough(*shape, seed).tau for seed in seeds])
    # Three hundred fields of some ten independent lengths.
    assert np.std(fields) == pytest.approx(0.1, rel=0.05)
    assert np.mean(fields) == pytest.approx(0.2, abs=0.01)
    window = np.hanning(fields.shape[1])
    power = np.mean(np.abs(np.fft.rfft((fields - 0.2) * window)) ** 2, axis=0)
    k = 2.0 * np.pi * np.fft.rfftfreq(fields.shape[1], spacing)
    short = (k > 5.0) & (k < 30.0)
    slope, _ = np.polyfit(np.log(k[short]), 0.5 * np.log(power[short]), 1)
    assert slope == pytest.approx(-1.2, abs=0.05)
    assert np.max(sp.rough(0.6, 0.3, 1.0, 0.5, -50.0, 50.0, 0.1, 1).tau) == 0.95


LONG = sp.Prestress.through(*sp.rough(0.3, 0.1, 1.0, 0.5, -100.0, 100.0, 0.02, 3), width=1.0)
SHORT = sp.Prestress.through(X, TAU, bumps=BUMPS)


def test_a_scene_with_a_table_can_be_read_from_its_data(config, tmp_path):
    """This includes a text of more than 64 kB. A measured row has only a digest of a long table."""
    settings = {"duration": 0.2, "dx": 0.02, "gamma": 0.65, "beta": 2e-3}
    plain = sp.Prestress(0.3, 0.3)
    scenes = [sp.Scene("displacement", one, **settings) for one in (LONG, plain, SHORT)]
    assert len(scenes[0].attributes()["steps_and_bumps"]) > 64 * 1024
    save_dataset(sp.run_sweep(scenes, record=("fronts",)), tmp_path / "data.nc")
    data = load_dataset(tmp_path / "data.nc")
    runs = [sp.point(data, number) for number in range(3)]
    assert [sp.Scene.from_attributes(run.attrs) for run in runs] == scenes
    sp.simulate(scenes[0]).to_netcdf(tmp_path / "one.nc")
    with xr.open_dataset(tmp_path / "one.nc") as one:
        assert sp.Scene.from_attributes(one.attrs) == scenes[0]
    long, _, short = measured_table(data, config["measure"]).to_dict("records")
    assert sp.Scene.from_attributes(short) == scenes[2]
    assert len(long["steps_and_bumps"]) < 100
    with pytest.raises(ValueError, match=r"'10001 points, \w+'; allowed: the points themselves"):
        sp.Scene.from_attributes(long)
    assert json.loads(scenes[1].attributes()["steps_and_bumps"]) == {"steps": [], "bumps": []}


def test_the_level_ahead_is_known_once_a_front_has_left_the_table(config):
    ramp = sp.Prestress.through([-3.0, 0.0, 3.0], [0.5, 0.3, 0.6], width=1.0)
    scene = sp.Scene("displacement", ramp, duration=2.0, dx=0.05, gamma=0.65)
    for duration, levels in ((2.0, (np.nan, np.nan)), (20.0, (0.5, 0.6))):
        numbers = sp.measure(sp.simulate(dataclasses.replace(scene, duration=duration)))
        ahead = [numbers[f"level_ahead_{side}"] for side in ("left", "right")]
        assert np.array_equal(ahead, levels, equal_nan=True)


def test_the_cost_bound_of_a_table_holds_and_is_not_too_high():
    table = sp.Prestress.through([-1.0, 0.0, 1.0, 5.0, 5.0], [0.3, 1.0, 0.3, 0.9, 0.3])
    scene = sp.Scene("displacement", table, duration=20.0, dx=0.1, gamma=0.65, beta=0.02)
    bound, run = bound_cost(scene), sp.simulate(scene)
    assert run.attrs["block_updates"] < bound.block_updates
    high = sp.Scene("displacement", sp.Prestress(0.9, 0.3), 20.0, 0.1, gamma=0.65, beta=0.02)
    assert bound.block_updates < 0.5 * bound_cost(high).block_updates


UNRESOLVED = {
    "noise between blocks": (np.arange(-10.0, 10.0, 0.01), None, "a smaller dx or fewer points"),
    "a spike between blocks": ([-9.0, 3.01, 3.02, 3.03, 9.0], [0.4, 0.4, 0.9, 0.4, 0.4], "x: 3.02"),
    "a start between blocks": (
        [-9.0, 3.02, 9.0],
        [0.4, 1.0, 0.2],
        "the stress 1 releases no block at x: 3.02; allowed: a value",
    ),
}


@pytest.mark.parametrize("case", UNRESOLVED)
def test_a_table_that_the_lattice_does_not_resolve_is_refused(case):
    x, tau, words = UNRESOLVED[case]
    noise = 0.4 + 0.2 * np.random.default_rng(1).uniform(-1.0, 1.0, len(x))
    profile = sp.Prestress.through(x, noise if tau is None else tau)
    with pytest.raises(ValueError, match=words) as refusal:
        sp.Scene("displacement", profile, duration=1.0, dx=0.05, gamma=0.65)
    assert "\n" not in str(refusal.value)
    sp.Scene("displacement", profile, duration=1.0, dx=0.01, gamma=0.65)


@pytest.mark.parametrize("width", [0.0, 1e-3])
def test_a_jump_and_a_steep_ramp_are_resolved_by_any_lattice(width):
    profile = sp.Prestress.through([-9.0, 3.01, 3.01 + width, 9.0], [0.4, 0.4, -0.3, 0.2], 1.0)
    sp.Scene("displacement", profile, duration=1.0, dx=0.05, gamma=0.65)


def test_a_rough_field_is_resolved_on_the_lattices_of_a_grid_study():
    field = sp.rough(0.4, 0.2, 0.5, 0.5, -50.0, 50.0, 0.1, seed=2)
    profile = sp.Prestress.through(*field, width=1.0)
    for dx in (0.1, 0.15, 0.2):
        sp.Scene("displacement", profile, duration=1.0, dx=dx, gamma=0.65)


through = sp.Prestress.through
REFUSED = {
    "points x: 1; allowed: 2 to 100000": lambda: through([0.0], [0.5]),
    "points: 2; allowed: 3 values": lambda: through([0.0, 1.0, 2.0], [0.5, 0.2]),
    "points x in row 3: 0.0; allowed: >= 1": lambda: through([0, 1, 0], [0, 0, 0]),
    "points x in row 3: 1.0; allowed: at most 2 rows": lambda: through([1, 1, 1], [0, 0.1, 0.2]),
    "points tau in row 2: 'a'": lambda: through([0, 1], [0, "a"]),
    "points tau in row 1: nan": lambda: through([0.0, 1.0], np.array([np.nan, 0.0])),
    "points x: 0; allowed": lambda: through(5.0, [0.1]),
    "prestress.right: 1.2; allowed": lambda: through([0, 1], [0.5, 1.2]),
    "prestress.left: 0.1; allowed: 0.5": lambda: sp.Prestress(
        0.1, 0.2, points=((0, 0.5), (1, 0.2))
    ),
    "prestress.steps: ": lambda: sp.Prestress(0, 0, steps=((1, 0),), points=((0, 0), (1, 0))),
    "prestress.points: 3; allowed: a list": lambda: sp.Prestress(0, 0, points=3),
    "prestress.peak: 0.9; allowed: 1 unless a width is given": lambda: through(
        [0, 1], [0, 0], peak=0.9
    ),
    "points x: 100001; allowed: 2 to 100000": lambda: through(range(100001), [0.0] * 100001),
    "tolerance: 0.0": lambda: sp.Prestress.from_function(math.cos, 0.0, 1.0, 0.0),
    "function(0)": lambda: sp.Prestress.from_function(lambda x: math.nan, 0.0, 1.0, 0.1),
    "samples": lambda: sp.Prestress.from_function(lambda x: math.sin(1e6 * x), 0.0, 9.0, 1e-5),
    "seed: 1.5": lambda: sp.rough(0.1, 0.1, 1.0, 0.5, 0.0, 1.0, 0.1, 1.5),
    "hurst: 2": lambda: sp.rough(0.1, 0.1, 1.0, 2, 0.0, 1.0, 0.1, 1),
    "points: 1": lambda: sp.rough(0.1, 0.1, 1.0, 0.5, 0.0, 1.0, 1e-9, 1),
}


@pytest.mark.parametrize("words", REFUSED)
def test_a_bad_table_is_refused_in_one_line(words):
    with pytest.raises(ValueError, match="allowed") as refusal:
        REFUSED[words]()
    assert words in str(refusal.value) and "\n" not in str(refusal.value)


def test_the_balance_is_the_nearest_one_if_bumps_or_steps_balance_the_pre_stress_again():
    """The rupture stops at the first position from which the integral to infinity is 0."""
    level, bump = -0.5, ((-40.0, 40.0, 2.0),)
    nearest = sp.theory.prestress_balance_position(sp.Prestress(level, 0.0))
    assert sp.theory.prestress_balance_position(
        sp.Prestress(level, 0.0, bumps=bump)
    ) == pytest.approx(nearest)
    table = ((-100.0, level), (0.0, level), (0.0, 0.0))
    with_points = sp.Prestress(level, 0.0, points=table, bumps=bump)
    assert sp.theory.prestress_balance_position(with_points) == pytest.approx(nearest)
    steps = ((-9.0, 0.8), (-30.0, level))
    assert sp.theory.prestress_balance_position(
        sp.Prestress(level, 0.0, steps=steps)
    ) == pytest.approx(nearest)


@pytest.mark.parametrize("far_level", [0.0, 0.3])
def test_a_level_far_on_the_left_does_not_matter_if_a_nearer_part_balances(far_level):
    """The step lies behind the balance, at about -6.3, where the rupture stops."""
    balance = sp.theory.prestress_balance_position
    nearest = balance(sp.Prestress(-0.5, 0.0))
    assert balance(sp.Prestress(-0.5, 0.0, steps=((-20.0, far_level),))) == pytest.approx(nearest)
    table = ((-20.0, far_level), (-20.0, -0.5), (0.0, -0.5), (0.0, 0.0))
    assert balance(sp.Prestress(far_level, 0.0, points=table)) == pytest.approx(nearest)
    # In front of the balance, the step prevents it.
    with pytest.raises(ValueError, match=r"prestress\.left: .*never balanced"):
        balance(sp.Prestress(-0.5, 0.0, steps=((-3.0, far_level),)))


@pytest.mark.parametrize("points", [(), ((-50.0, -0.5), (0.0, -0.5), (0.0, 0.0), (9.0, 0.0))])
def test_a_bump_can_nucleate_the_rupture_without_a_gaussian_and_without_a_table(points):
    """The bump at x = 3 has the area 1.2 sqrt(2 pi), which the level -0.5 on the left balances."""
    bumps = ((3.0, 1.2, 1.0),)
    prestress = sp.Prestress(-0.5, 0.0, width=None, bumps=bumps, points=points)
    balance = sp.theory.prestress_balance_position(prestress)
    assert balance == pytest.approx(-2.4 * np.sqrt(2.0 * np.pi), rel=tol.ALGEBRA)


def test_a_gaussian_with_a_low_peak_does_not_nucleate_the_rupture():
    lower = sp.Prestress(-0.3, 0.0, peak=0.6, bumps=((6.0, 1.2, 0.5),))
    balance = sp.theory.prestress_balance_position(lower)
    assert integral(lower, balance, 60.0) == pytest.approx(0.0, abs=tol.QUADRATURE)
    # Only the bump nucleates. On its left, the pre-stress is balanced at a positive position.
    barrier = dataclasses.replace(lower, bumps=((6.0, 1.2, 0.5), (3.5, -2.5, 0.5)))
    assert 2.0 < sp.theory.prestress_balance_position(barrier) < 5.0


@pytest.mark.parametrize("seed", range(20))
def test_the_balance_of_random_bumps_is_that_of_a_running_sum(seed):
    rng = np.random.default_rng(seed)
    bumps = zip(
        rng.uniform(-60.0, -2.0, 3),
        rng.uniform(-1.5, 3.0, 3),
        rng.uniform(0.3, 6.0, 3),
        strict=True,
    )
    prestress = sp.Prestress(-rng.uniform(0.1, 0.9), 0.0, rng.uniform(0.5, 5.0), bumps=tuple(bumps))
    x = np.linspace(-400.0, 400.0, 400_001)
    integral_from = np.cumsum(prestress(x)[::-1])[::-1] * (x[1] - x[0])
    if integral_from[x > 0.0][0] < 0.0:
        with pytest.raises(ArithmeticError, match="no balance"):
            sp.theory.prestress_balance_position(prestress)
    else:
        expected = x[(x < 0.0) & (integral_from < 0.0)].max()
        assert sp.theory.prestress_balance_position(prestress) == pytest.approx(expected, abs=5e-3)
