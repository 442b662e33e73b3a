"""The regime that a rupture ends in, against the exact solution followed until it shows."""

from itertools import product

import numpy as np
import pytest

from slippulse.measurement.regime import REGIMES
from slippulse.model.prestress import Prestress
from slippulse.model.run import Run
from slippulse.prediction.predicted_regime import UNDECIDED, final_regime, predictions
from slippulse.theory.rupture import Rupture

STILL, RATIO = 0.05, 0.1


def regime(left: float, right: float, gamma: float) -> str:
    return final_regime(left, right, gamma, RATIO, "total", STILL)


def rupture(left: float, right: float, gamma: float, duration: float) -> Rupture:
    exact = Rupture(Prestress(left, right), gamma, RATIO, "total", duration)
    assert exact.limit is None
    return exact


ARRESTED, TWO_WAY = "arrested", "pulses, two-way"
ONE_WAY = "pulse, one-way, steady"
# How the fronts end: they stop, or go on to the end of the duration.
ENDS = {
    ARRESTED: ["stops", "stops"],
    TWO_WAY: ["duration", "duration"],
    ONE_WAY: ["stops", "duration"],
}
# Regime, both levels, gamma and a duration; two are longer than the runs of the phase diagram.
CASES = [
    (ARRESTED, -0.2, -0.2, 1.0, 10.0),
    (ARRESTED, -0.1, -0.1, 0.1, 20.0),
    (ARRESTED, -0.6, -0.1, 0.65, 12.0),
    (ARRESTED, -0.1, -0.1, 1e-3, 40.0),
    (ARRESTED, -0.9, -0.9, 0.0, 10.0),
    (ARRESTED, -0.9, -0.02, 0.0, 120.0),
    (ARRESTED, -0.02, -0.02, 0.0, 150.0),
    (TWO_WAY, 0.1, 0.1, 1.0, 4.71),
    (TWO_WAY, 0.5, 0.5, 0.1, 14.9),
    (TWO_WAY, 0.9, 0.9, 1e-3, 149.0),
    (ONE_WAY, -0.6, 0.8, 0.65, 40.0),
    (ONE_WAY, -0.1, 0.5, 1.0, 40.0),
    (ONE_WAY, -0.3, 0.3, 0.3, 40.0),
]


@pytest.mark.parametrize(("end", "left", "right", "gamma", "duration"), CASES)
def test_the_exact_solution_ends_in_its_regime(end, left, right, gamma, duration):
    """All sticks between fronts that stop; behind others pulses form, steady next to a stop."""
    assert regime(left, right, gamma) == regime(right, left, gamma) == end
    exact = rupture(left, right, gamma, duration)
    (fronts,) = exact.front_ends
    assert [front.reason for front in fronts] == ENDS[end]
    x = np.linspace(fronts[0].x, fronts[1].x, 31)[1:-1] if end == ARRESTED else 0.0
    assert np.isfinite(exact.stick_time(x)).all()
    assert end == ARRESTED or exact.pulse_width(duration) > 0.0
    if end == ONE_WAY:
        earlier = exact.pulse_width(0.75 * duration)
        assert exact.pulse_width(duration) == pytest.approx(earlier, rel=5e-3)


@pytest.mark.parametrize("gamma", [0.1, 1.0])
def test_with_leaf_springs_a_pulse_without_prestress_gets_ever_narrower_and_slower(gamma):
    assert regime(-0.3, 0.0, gamma) == "pulse, one-way, decaying"
    exact = rupture(-0.3, 0.0, gamma, 40.0)
    peaks, widths = [], []
    for time in (20.0, 40.0):
        front, width = exact.fronts_at(time)[1], exact.pulse_width(time)
        peaks.append(np.nanmax(exact.slip_velocity(np.linspace(front - width, front, 201), time)))
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
    """The rupture is a crack or a pulse as that part, for large times, is above STILL or below."""
    times = np.array([0.5 * end, end])
    exact = rupture(left, right, 0.0, times[1])
    speed = (exact.front_ends[0][1].x - exact.fronts_at(times[0])[1]) / np.diff(times)[0]
    slope = right / -left
    expected = slope / (1.0 + 1.0 / speed + 2.0 * slope)
    errors = []
    for time in times:
        largest = np.max(exact.slip_velocity(np.linspace(0.8, speed, 301) * time, time))
        errors.append(abs(float(exact.slip_velocity(0.0, time)) / largest / expected - 1.0))
    # The contribution of the Gaussian decays like 1/t.
    assert errors[1] < 0.1 and errors[1] < 0.6 * errors[0]
    pulse = expected < STILL
    assert regime(left, right, 0.0) == (
        "pulse, one-way, growing" if pulse else "crack-like, one front slow"
    )


def test_a_front_into_a_barrier_runs_for_ever_at_a_speed_below_that_of_waves():
    exact, times = rupture(-0.3, 0.9, 0.0, 400.0), np.array([300.0, 400.0])
    left, right = np.diff([exact.fronts_at(time) for time in times], axis=0)[0] / np.diff(times)
    ratio = 0.9 / 0.3
    assert -left == pytest.approx(ratio / (ratio + 1.0 + 1.0 / right), rel=2e-3)
    assert regime(-0.3, 0.9, 0.0) == "crack-like, one front slow"


@pytest.mark.parametrize(("left", "right"), [(0.0, 0.0), (0.02, 0.9), (0.3, 0.3)])
def test_without_leaf_springs_the_centre_never_slows_down_between_levels_that_are_not_negative(
    left, right
):
    assert regime(left, right, 0.0) == "crack-like, two-way"
    exact = rupture(left, right, 0.0, 80.0)
    velocity = exact.slip_velocity(0.0, np.linspace(5.0, 80.0, 31))
    assert (np.diff(velocity) > -1e-9).all()
    assert np.isnan(exact.transition.time)


def test_a_pulse_grows_by_half_of_the_prestress_on_its_way():
    for level, end in ((-0.01, "decaying"), (0.0, "steady"), (0.01, "growing")):
        profile = Prestress(-0.6, 0.0, steps=((15.0, level),))
        run = Run("stress", profile, 0.0, 1.0, RATIO, "total", {})
        assert predictions([run], {"still": STILL}).squeeze() == f"pulse, one-way, {end}"
        exact = Rupture(profile, 0.0, RATIO, "total", 30.0)
        times = np.array([20.0, 30.0])
        x = np.outer(times, np.linspace(0.6, 1.05, 101))
        early, late = np.max(exact.slip_velocity(x, times[:, None]), axis=1)
        assert late - early == pytest.approx(0.5 * level * np.diff(times)[0], abs=3e-4)


def test_every_answer_is_a_regime():
    levels = (-0.9, -0.02, 0.0, 0.02, 0.9)
    answers = {regime(*scene) for scene in product(levels, levels, (0.0, 0.65))}
    # A front that has stopped leaves a pulse, if one waits for long enough.
    assert answers == {*REGIMES, UNDECIDED} - {"crack-like, one-way"}
    assert regime(0.0, 0.0, 0.65) == regime(0.0, 0.3, 0.65) == UNDECIDED
