"""The regime that a rupture ends in, against the exact solution followed until it shows."""

import numpy as np
import pytest

from slippulse.measurement.regime import REGIMES
from slippulse.model.prestress import Prestress
from slippulse.predict.final_regime import UNDECIDED, final_regime, growth_beyond
from slippulse.theory.rupture import Rupture

STILL, RATIO = 0.05, 0.1


def regime(left: float, right: float, gamma: float) -> str:
    return final_regime(left, right, gamma, RATIO, "total", STILL)


def rupture(left: float, right: float, gamma: float, duration: float) -> Rupture:
    found = Rupture(Prestress(left, right), gamma, RATIO, "total", duration)
    assert found.limit is None
    return found


# Both levels, gamma and a duration, by the regime; the last two arrests are long after the runs of the phase diagram.
CASES = {
    "arrested": [
        (-0.2, -0.2, 1.0, 10.0), (-0.1, -0.1, 0.1, 20.0), (-0.6, -0.1, 0.65, 12.0), (-0.1, -0.1, 1e-3, 40.0),
        (-0.9, -0.9, 0.0, 10.0), (-0.9, -0.02, 0.0, 120.0), (-0.02, -0.02, 0.0, 150.0),
    ],
    "pulses, two-way": [
        (level, level, gamma, 1.5 * np.pi / np.sqrt(gamma))
        for level, gamma in ((0.1, 1.0), (0.5, 0.1), (0.9, 1e-3))
    ],
    "pulse, one-way, steady": [(-0.6, 0.8, 0.65, 40.0), (-0.1, 0.5, 1.0, 40.0), (-0.3, 0.3, 0.3, 40.0)],
}  # fmt: skip


@pytest.mark.parametrize(("name", "case"), [(name, case) for name in CASES for case in CASES[name]])
def test_fronts_into_negative_levels_stop_and_all_behind_sticks(name, case):
    *levels, gamma, duration = case
    assert regime(*levels, gamma) == regime(*levels[::-1], gamma) == name
    found = rupture(*case)
    ((left, right),) = found.front_ends
    ends = ["stops" if level < 0.0 else "duration" for level in levels]
    assert [left.reason, right.reason] == ends
    x = np.linspace(left.x, right.x, 31)[1:-1] if name == "arrested" else 0.0
    assert np.isfinite(found.stick_time(x)).all()
    if name != "arrested":
        assert found.pulse_width(duration) > 0.0
    if "steady" in name:
        assert found.pulse_width(duration) == pytest.approx(found.pulse_width(30.0), rel=5e-3)


@pytest.mark.parametrize("gamma", [0.1, 1.0])
def test_with_leaf_springs_a_pulse_without_prestress_gets_ever_narrower_and_slower(gamma):
    assert regime(-0.3, 0.0, gamma) == "pulse, one-way, decaying"
    found = rupture(-0.3, 0.0, gamma, 40.0)
    peaks, widths = [], []
    for time in (20.0, 40.0):
        front, width = found.fronts_at(time)[1], found.pulse_width(time)
        peaks.append(np.nanmax(found.slip_velocity(np.linspace(front - width, front, 201), time)))
        widths.append(width)
    assert widths[1] == pytest.approx(0.5 * widths[0], rel=0.15)
    assert 0.4 < peaks[1] / peaks[0] < 0.8


# The last two have a weak drive behind a barrier: the longest to compute.
LEVELS = [(-0.02, 0.1), (-0.6, 0.6), (-0.1, 0.02), (-0.9, 0.02)]
LATE = [pytest.param(*levels, 3000.0, marks=pytest.mark.slow) for levels in LEVELS]


@pytest.mark.parametrize(
    ("left", "right", "end"), [*((*levels, 800.0) for levels in LEVELS[:2]), *LATE]
)
def test_without_leaf_springs_a_barrier_leaves_the_centre_part_of_the_velocity(left, right, end):
    """Which fraction for large times, a crack or a pulse as it is above or below what counts as still."""
    times = np.array([0.5 * end, end])
    found = rupture(left, right, 0.0, times[1])
    speed = (found.front_ends[0][1].x - found.fronts_at(times[0])[1]) / np.diff(times)[0]
    slope = right / -left
    expected = slope / (1.0 + 1.0 / speed + 2.0 * slope)
    off = []
    for time in times:
        largest = np.max(found.slip_velocity(np.linspace(0.8, speed, 301) * time, time))
        off.append(abs(float(found.slip_velocity(0.0, time)) / largest / expected - 1.0))
    # What the Gaussian adds is forgotten like 1/t.
    assert off[1] < 0.1 and off[1] < 0.6 * off[0]
    found = "crack-like, one-way" if expected >= STILL else "pulse, one-way, growing"
    assert regime(left, right, 0.0) == found


@pytest.mark.parametrize(("left", "right"), [(0.0, 0.0), (0.02, 0.9), (0.3, 0.3)])
def test_without_leaf_springs_the_centre_never_slows_down_between_levels_that_are_not_negative(
    left, right
):
    assert regime(left, right, 0.0) == "crack-like, two-way"
    found = rupture(left, right, 0.0, 80.0)
    velocity = found.slip_velocity(0.0, np.linspace(5.0, 80.0, 31))
    assert (np.diff(velocity) > -1e-9).all()
    assert np.isnan(found.transition.time)


def test_a_pulse_grows_by_half_of_the_prestress_on_its_way():
    assert growth_beyond(0.0) == "pulse, one-way, steady"
    for level, end in ((-0.01, "decaying"), (0.01, "growing")):
        found = Rupture(Prestress(-0.6, 0.0, steps=((15.0, level),)), 0.0, RATIO, "total", 30.0)
        times = np.array([20.0, 30.0])
        x = np.outer(times, np.linspace(0.6, 1.05, 401))
        early, late = np.max(found.slip_velocity(x, times[:, None]), axis=1)
        assert (
            growth_beyond(level) == f"pulse, one-way, {end}"
            and (late - early) * np.sign(level) > 0.02
        )


def test_every_answer_is_a_regime_and_a_level_at_the_threshold_is_refused():
    levels = (-0.9, -0.02, 0.0, 0.02, 0.9)
    found = {
        regime(left, right, gamma) for left in levels for right in levels for gamma in (0.0, 0.65)
    }
    assert found == {*REGIMES, UNDECIDED}
    assert regime(0.0, 0.0, 0.65) == regime(0.0, 0.3, 0.65) == UNDECIDED
    with pytest.raises(ValueError, match="right"):
        regime(0.1, 1.0, 0.65)
