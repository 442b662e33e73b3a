"""No answer of the exact theory hangs on the last bits: at the end of its duration, and for inputs nudged by some."""

import numpy as np
import pytest
from nudges import nudged
from tolerances import END, NUDGED, NUDGED_DOUBLE

from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import Rupture

# Some in each run of the tests, the others with the slow ones.
SCENES = [*range(18), *(pytest.param(number, marks=pytest.mark.slow) for number in range(18, 200))]
# How far before its end a rupture is looked at, relative.
BEFORE = 1e-7
# Ends at which the width of a pulse and the first stick have been wrong; a front 48 times as fast as the waves.
KNOWN = [
    {
        "prestress": profile,
        "gamma": gamma,
        "damping_ratio": ratio,
        "release": "total",
        "duration": duration,
    }
    for profile, gamma, ratio, durations in (
        (Prestress(0.63, 0.416, 1.352), 0.215, 1.703, (20.0, 30.0)),
        (Prestress(0.5, 0.91), 0.033, 4.5321, (16.77, 17.0)),
    )
    for duration in durations
]


def scene(number: int) -> dict:
    if number < 0:
        return KNOWN[number]
    rng = np.random.default_rng(number)
    left, right = rng.uniform(-0.8, 0.9, 2)
    if rng.random() < 0.4:
        left = right = abs(left)
    more = {}
    if rng.random() < 0.25:
        more["steps"] = ((rng.choice([-1, 1]) * rng.uniform(1.0, 4.0), rng.uniform(-0.5, 0.8)),)
    if rng.random() < 0.2:
        # Where they are felt at x = 0, they raise the peak.
        centre, amplitude, width = (
            rng.uniform(-4.0, 4.0),
            rng.uniform(-0.4, 0.4),
            rng.uniform(0.3, 1.5),
        )
        more["bumps"] = (
            (centre, amplitude if abs(centre) > 9.0 * width else abs(amplitude), width),
        )
    gamma = 0.0 if rng.random() < 0.2 else float(rng.choice([0.1, 0.65, rng.uniform(0.05, 1.0)]))
    return {
        "prestress": Prestress(left, right, rng.uniform(0.5, 2.0), **more),
        "gamma": gamma,
        "damping_ratio": float(rng.choice([0.0, 0.1, rng.uniform(0.01, 1.0)])),
        "release": str(rng.choice(["total", "elastic"])),
        # At times that mean something too: a peak's transition, an odd multiple of it.
        "duration": float(rng.choice([1.0, 1.5, rng.uniform(0.5, 2.5)]))
        * np.pi
        / np.sqrt(gamma or 0.5),
    }


def answers(rupture: Rupture, x: np.ndarray, time: float) -> dict[str, np.ndarray]:
    """Every method of a rupture, at positions, and at a time that is or was its end."""
    fields = {
        name: getattr(rupture, name)(x)
        for name in ("release_time", "stick_time", "final_slip", "horizon")
    }
    numbers = ("transition", "largest_velocity")
    found = fields | {name: getattr(rupture, name) for name in numbers} | at(rupture, x, time)
    found |= {
        "first_stick": (rupture.first_stick or (np.nan, np.nan))[1],
        "limit": (rupture.limit.x, rupture.limit.time) if rupture.limit else (np.nan, np.nan),
        "ends": [(end.x, end.time) for pair in rupture.front_ends for end in pair],
    }
    return {name: np.asarray(value, dtype=float) for name, value in found.items()}


def at(rupture: Rupture, x: np.ndarray, time: float) -> dict:
    return {
        "fronts_at": rupture.fronts_at(time),
        "pulse_width": [rupture.pulse_width(time, side) for side in ("left", "right")],
        **{name: getattr(rupture, name)(x, time) for name in ("slip_velocity", "slip", "strain")},
        "map": rupture.map([0.5 * time, time], x, ("slip_velocity",))["slip_velocity"],
    }


def reasons(rupture: Rupture) -> list[str]:
    limit = rupture.limit
    return [end.reason for pair in rupture.front_ends for end in pair] + [
        limit.reason if limit else ""
    ]


def positions(rupture: Rupture, number: int) -> np.ndarray:
    """Some, and those of the fronts at the end that have not stopped, where T(x) is a square root."""
    fronts = rupture.fronts_at(rupture.duration)
    inside = np.random.default_rng((number % 1000, 1)).uniform(*fronts, 6)
    going = [end.x for pair in rupture.front_ends for end in pair if end.reason == "duration"]
    return np.concatenate([inside, [0.0], going])


@pytest.mark.parametrize("number", SCENES)
def test_inputs_nudged_in_their_last_bits(number):
    """The error bounded is that of roots, 1e-11 in time over the slope of what is 0 there."""
    keys, rng = scene(number), np.random.default_rng((number, 2))
    rupture = Rupture(**keys)
    x = positions(rupture, number)
    expected = answers(rupture, x, rupture.duration)
    other = Rupture(**{name: nudged(value, rng) for name, value in keys.items()})
    found = answers(other, nudged(x, rng), nudged(rupture.duration, rng))
    assert reasons(other) == reasons(rupture)
    # Where a front has been slow and outruns the waves again its position is a double root too.
    again = any(part.restarts[side] for part in rupture.stretches for side in part.restarts)
    for name, value in expected.items():
        tolerance = (
            NUDGED_DOUBLE if again or name in ("first_stick", "limit", "horizon") else NUDGED
        )
        assert found[name] == pytest.approx(value, rel=tolerance, abs=tolerance, nan_ok=True), name


@pytest.mark.parametrize("number", [*range(-len(KNOWN), 0), *SCENES])
def test_the_end_is_a_time_like_any_other(number):
    """Answers at the end of a rupture are those of one that goes on, and their own limit from below."""
    keys = scene(number)
    rupture = Rupture(**keys)
    duration, x = rupture.duration, positions(rupture, number)
    inside, fronts = x[:7], x[7:]
    longer = Rupture(**keys | {"duration": 1.1 * duration})
    here = at(rupture, inside, duration)
    for name, value in at(longer, inside, duration).items():
        assert here[name] == pytest.approx(value, rel=END, abs=END, nan_ok=True), name
    for name in ("release_time", "stick_time"):
        value = getattr(longer, name)(inside)
        value = np.where(value <= duration, value, np.nan)
        assert getattr(rupture, name)(inside) == pytest.approx(
            value, rel=END, abs=END, nan_ok=True
        ), name
    first = longer.first_stick if longer.first_stick and longer.first_stick[0] <= duration else None
    assert (rupture.first_stick or (np.nan,)) == pytest.approx(
        first or (np.nan,), rel=END, nan_ok=True
    )
    # What the front has come to at the end is released then, and has not moved.
    known = np.isfinite(rupture.slip(fronts, duration))
    assert np.array_equal(np.isfinite(rupture.release_time(fronts)), known)
    assert np.all(rupture.release_time(fronts[known]) <= duration)
    # From below: what changes in the last moment is of the order of what changed in the two before.
    last, before, early = (at(rupture, inside, duration * (1.0 - n * BEFORE)) for n in (0, 1, 3))
    for name, value in before.items():
        change = np.nan_to_num(np.abs(np.asarray(last[name]) - value))
        allowed = 3.0 * np.abs(np.asarray(value) - early[name]) + END
        assert np.all(change <= np.nan_to_num(allowed, nan=np.inf)), (name, change, allowed)
        assert np.array_equal(np.isnan(last[name]), np.isnan(value)), name
