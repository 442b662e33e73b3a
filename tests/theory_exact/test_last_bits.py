"""No result of the exact theory depends on the last bits of its inputs or on the final time."""

from itertools import chain

import numpy as np
import pytest
from theory_exact.conftest import nudged
from tolerances import END, NUDGED, NUDGED_DOUBLE

from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import FrontEnd, Rupture

# The first scenes are in every run of the tests, the others only in the slow tests.
SLOW_SCENES = [pytest.param(number, marks=pytest.mark.slow) for number in range(18, 200)]
SCENES = [*range(18), *SLOW_SCENES]
# Results are compared at this fraction of the duration before its end.
TIME_BEFORE_END = 1e-7
# Scenes and durations at which the pulse width and the first stick were once wrong. The front of
# the second scene is 48 times as fast as the waves.
WIDE_PULSE = {"prestress": Prestress(0.63, 0.416, 1.352), "gamma": 0.215, "damping_ratio": 1.703}
FAST_FRONT = {"prestress": Prestress(0.5, 0.91), "gamma": 0.033, "damping_ratio": 4.5321}
KNOWN_SCENES = [WIDE_PULSE | {"duration": end} for end in (20.0, 30.0)]
KNOWN_SCENES += [FAST_FRONT | {"duration": end} for end in (16.77, 17.0)]


def scene(number: int) -> dict:
    """Return the arguments of a rupture: a random one, or one of KNOWN_SCENES if number < 0."""
    if number < 0:
        return KNOWN_SCENES[number]
    rng = np.random.default_rng(number)
    left, right = rng.uniform(-0.8, 0.9, 2)
    if rng.random() < 0.4:
        left = right = abs(left)
    steps, bumps = (), ()
    if rng.random() < 0.25:
        steps = ((rng.choice([-1, 1]) * rng.uniform(1.0, 4.0), rng.uniform(-0.5, 0.8)),)
    if rng.random() < 0.2:
        centre, height, width = rng.uniform((-4.0, -0.4, 0.3), (4.0, 0.4, 1.5)).tolist()
        # A bump that is not negligible at x = 0 must raise the peak.
        bumps = ((centre, height if abs(centre) > 9.0 * width else abs(height), width),)
    gamma = 0.0 if rng.random() < 0.2 else float(rng.choice([0.1, 0.65, rng.uniform(0.05, 1.0)]))
    keys = {
        "prestress": Prestress(left, right, rng.uniform(0.5, 2.0), steps=steps, bumps=bumps),
        "gamma": gamma,
        "damping_ratio": float(rng.choice([0.0, 0.1, rng.uniform(0.01, 1.0)])),
        "release": str(rng.choice(["total", "elastic"])),
    }
    # Durations include special times, such as odd multiples of the half-period.
    half_periods = float(rng.choice([1.0, 1.5, rng.uniform(0.5, 2.5)]))
    return keys | {"duration": half_periods * np.pi / np.sqrt(gamma or 0.5)}


def answers(rupture: Rupture, x: np.ndarray, time: float) -> dict:
    """Return all results of a rupture, at positions and at a time that is or was its final one."""
    values = {
        "release_time": rupture.release_time(x),
        "stick_time": rupture.stick_time(x),
        "final_slip": rupture.final_slip(x),
        "horizon": rupture.horizon(x),
        # pytest prints tuples and lists, but not a NamedTuple that differs from the expected one.
        "transition": tuple(rupture.transition),
        "largest_velocity": rupture.largest_velocity,
        "first_stick": (rupture.first_stick or (np.nan, np.nan))[1],
        "limit": (rupture.limit.x, rupture.limit.time) if rupture.limit else (np.nan, np.nan),
        "ends": np.array([(end.x, end.time) for end in front_ends(rupture)]),
    }
    return values | answers_at(rupture, x, time)


def answers_at(rupture: Rupture, x: np.ndarray, time: float) -> dict:
    """Return the results of a rupture that belong to a time."""
    return {
        "fronts_at": rupture.fronts_at(time),
        "pulse_width": [rupture.pulse_width(time, side) for side in ("left", "right")],
        "slip_velocity": rupture.slip_velocity(x, time),
        "slip": rupture.slip(x, time),
        "strain": rupture.strain(x, time),
        "map": np.array([*rupture.map([0.5 * time, time], x).values()]),
    }


def front_ends(rupture: Rupture) -> list[FrontEnd]:
    """Return the ends of all fronts."""
    return list(chain.from_iterable(rupture.front_ends))


def reasons(rupture: Rupture) -> list[str]:
    """Return the reasons why fronts end, and the reason of the first limit."""
    return [end.reason for end in (*front_ends(rupture), rupture.limit) if end]


def positions(rupture: Rupture, number: int) -> np.ndarray:
    """Return seven positions, and those of fronts that still move.

    At the moving fronts T(x) behaves like a square root.
    """
    fronts = rupture.fronts_at(rupture.duration)
    inside = np.random.default_rng((number % 1000, 1)).uniform(*fronts, 6)
    going = [end.x for end in front_ends(rupture) if end.reason == "duration"]
    return np.concatenate([inside, [0.0], going])


@pytest.mark.parametrize("number", SCENES)
def test_inputs_nudged_in_their_last_bits(number):
    """The allowed change is the error of roots, 1e-11 in time divided by the slope there."""
    keys, rng = scene(number), np.random.default_rng((number, 2))
    rupture = Rupture(**keys)
    x = positions(rupture, number)
    expected = answers(rupture, x, rupture.duration)
    other = Rupture(**{name: nudged(value, rng) for name, value in keys.items()})
    moved = answers(other, nudged(x, rng), nudged(rupture.duration, rng))
    assert reasons(other) == reasons(rupture)
    # The position of a front that has become fast again is a double root too.
    restarted = any(any(stretch.restarts.values()) for stretch in rupture.stretches)
    for name, value in expected.items():
        double = restarted or name in ("first_stick", "limit", "horizon")
        tolerance = NUDGED_DOUBLE if double else NUDGED
        assert moved[name] == pytest.approx(value, rel=tolerance, abs=tolerance, nan_ok=True), name


def test_a_first_stick_where_a_slow_front_stops_is_the_end_of_the_front():
    """Next to it du/dt falls through 0 so slowly that its zeros have errors of 1e-6."""
    keys = scene(163)
    rupture = Rupture(**keys)
    ((_, end),) = rupture.front_ends
    assert end.reason == "stops"
    assert rupture.first_stick == pytest.approx((end.time, end.x), rel=NUDGED)
    for seed in range(3):
        moved = {name: nudged(value, np.random.default_rng(seed)) for name, value in keys.items()}
        assert Rupture(**moved).transition.time == pytest.approx(end.time, rel=NUDGED)


@pytest.mark.parametrize("number", [*range(-len(KNOWN_SCENES), 0), *SCENES])
def test_the_end_is_a_time_like_any_other(number):
    """Results at the end are equal to those of a longer rupture.

    They are also the limit of results just before the end.
    """
    keys = scene(number)
    rupture = Rupture(**keys)
    duration, x = rupture.duration, positions(rupture, number)
    inside, fronts = x[:7], x[7:]
    longer = Rupture(**keys | {"duration": 1.1 * duration})
    at_end = answers_at(rupture, inside, duration)
    for name, value in answers_at(longer, inside, duration).items():
        assert at_end[name] == pytest.approx(value, rel=END, abs=END, nan_ok=True), name
    for name in ("release_time", "stick_time"):
        value = getattr(longer, name)(inside)
        value = np.where(value <= duration, value, np.nan)
        time = getattr(rupture, name)(inside)
        assert time == pytest.approx(value, rel=END, abs=END, nan_ok=True), name
    first = longer.first_stick or (np.inf,)
    first = first if first[0] <= duration else (np.nan,)
    assert (rupture.first_stick or (np.nan,)) == pytest.approx(first, rel=END, nan_ok=True)
    # A position that a front reaches at the final time is released, and has not moved.
    known = np.isfinite(rupture.slip(fronts, duration))
    assert np.array_equal(np.isfinite(rupture.release_time(fronts)), known)
    assert np.all(rupture.release_time(fronts[known]) <= duration)
    # The change in the last moment is at most of the order of the change in the two moments before.
    times = duration * (1.0 - TIME_BEFORE_END * np.array([1, 3]))
    before, early = (answers_at(rupture, inside, time) for time in times.tolist())
    for name, value in before.items():
        change = np.nan_to_num(np.abs(np.asarray(at_end[name]) - value))
        allowed = 3.0 * np.abs(np.asarray(value) - early[name]) + END
        assert np.all(change <= np.nan_to_num(allowed, nan=np.inf)), (name, change, allowed)
        assert np.array_equal(np.isnan(at_end[name]), np.isnan(value)), name
