"""The regime in which a rupture ends, against the exact solution."""

from itertools import product

import numpy as np
import pytest

from slippulse.measurement.regime import REGIMES
from slippulse.model.prestress import Prestress
from slippulse.model.run import Run
from slippulse.prediction.predicted_regime import UNDECIDED, final_regime, predictions
from slippulse.theory.rupture import Rupture

# Velocity at the centre below which it counts as still, as a fraction of the largest velocity.
STILL_FRACTION, DAMPING_RATIO = 0.05, 0.1


def regime(left: float, right: float, gamma: float) -> str:
    """Return the predicted regime of a scene with these levels on the left and on the right."""
    return final_regime(left, right, gamma, DAMPING_RATIO, "total", STILL_FRACTION)


def rupture(left: float, right: float, gamma: float, duration: float) -> Rupture:
    """Return the exact rupture of a scene, which must have no limit."""
    exact = Rupture(Prestress(left, right), gamma, DAMPING_RATIO, "total", duration)
    assert exact.limit is None
    return exact


ARRESTED, TWO_WAY = "arrested", "pulses, two-way"
ONE_WAY = "pulse, one-way, steady"
# Reasons why the left and right fronts end: they stop, or go on until the end of the duration.
END_REASONS = {
    ARRESTED: ["stops", "stops"],
    TWO_WAY: ["duration", "duration"],
    ONE_WAY: ["stops", "duration"],
}
# Regime, left and right level, gamma and duration. Two are longer than the runs of the phase
# diagram.
REGIME_CASES = [
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


@pytest.mark.parametrize(("end", "left", "right", "gamma", "duration"), REGIME_CASES)
def test_the_exact_solution_ends_in_its_regime(end, left, right, gamma, duration):
    """Everything sticks between fronts that stop; other fronts leave pulses behind.

    A pulse is steady if the front on the other side has stopped.
    """
    assert regime(left, right, gamma) == regime(right, left, gamma) == end
    exact = rupture(left, right, gamma, duration)
    (fronts,) = exact.front_ends
    assert [front.reason for front in fronts] == END_REASONS[end]
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


# The last two have a weak drive behind a barrier and take longest to compute.
BARRIER_LEVELS = [(-0.02, 0.1), (-0.6, 0.6), (-0.1, 0.02), (-0.9, 0.02)]
LATE_SCENES = [pytest.param(*levels, 3000.0, marks=pytest.mark.slow) for levels in BARRIER_LEVELS]


@pytest.mark.parametrize(
    ("left", "right", "end"), [*((*levels, 800.0) for levels in BARRIER_LEVELS[:2]), *LATE_SCENES]
)
def test_without_leaf_springs_a_barrier_leaves_a_known_velocity_at_the_centre(left, right, end):
    """The centre keeps a fraction of the largest velocity, for which there is a formula.

    The rupture is a crack if this fraction is above STILL_FRACTION for large times, else a pulse.
    """
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
    pulse = expected < STILL_FRACTION
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
        run = Run("stress", profile, 0.0, 1.0, DAMPING_RATIO, "total", {})
        assert predictions([run], {"still": STILL_FRACTION}).squeeze() == f"pulse, one-way, {end}"
        exact = Rupture(profile, 0.0, DAMPING_RATIO, "total", 30.0)
        times = np.array([20.0, 30.0])
        x = np.outer(times, np.linspace(0.6, 1.05, 101))
        early, late = np.max(exact.slip_velocity(x, times[:, None]), axis=1)
        assert late - early == pytest.approx(0.5 * level * np.diff(times)[0], abs=3e-4)


def test_the_regime_is_undecided_if_a_barrier_may_stop_the_pulse():
    for barrier, expected in ((0.1, "pulse, one-way, steady"), (-0.9, UNDECIDED)):
        profile = Prestress(-0.6, 0.0, steps=((30.0, 0.0), (15.0, barrier)))
        run = Run("stress", profile, 0.0, 1.0, DAMPING_RATIO, "total", {})
        assert predictions([run], {"still": STILL_FRACTION}).squeeze() == expected


@pytest.mark.parametrize(
    ("left", "beyond", "expected"),
    [(-0.1, 0.8, "crack-like, one front slow"), (-0.9, 0.03, "pulse, one-way, growing")],
)
def test_a_pulse_that_enters_a_high_level_becomes_a_crack(left, beyond, expected):
    """Waves from the front in the high level set the nucleation point in motion again."""
    exact = Rupture(
        Prestress(left, 0.0, steps=((5.0, beyond),)), 0.0, DAMPING_RATIO, "total", 200.0
    )
    x = np.linspace(0.0, exact.fronts_at(200.0)[1], 301)
    largest = np.max(exact.slip_velocity(x, 200.0))
    is_crack = float(exact.slip_velocity(0.0, 200.0)) >= STILL_FRACTION * largest
    assert is_crack == (expected == "crack-like, one front slow")
    for sides in ((left, 0.0, 5.0), (0.0, left, -5.0)):
        profile = Prestress(*sides[:2], steps=((sides[2], beyond),))
        run = Run("stress", profile, 0.0, 1.0, DAMPING_RATIO, "total", {})
        assert predictions([run], {"still": STILL_FRACTION}).squeeze() == expected


def test_a_run_in_which_nothing_reaches_the_threshold_is_at_rest():
    for profile in (Prestress(0.5, 0.5, peak=0.9), Prestress(0.5, 0.5, width=None)):
        run = Run("stress", profile, 0.0, 1.0, DAMPING_RATIO, "total", {})
        assert predictions([run], {"still": STILL_FRACTION}).squeeze() == "arrested"


def test_every_answer_is_a_regime():
    levels = (-0.9, -0.02, 0.0, 0.02, 0.9)
    answers = {regime(*scene) for scene in product(levels, levels, (0.0, 0.65))}
    # A front that has stopped leaves a pulse behind, after a sufficiently long time.
    assert answers == {*REGIMES, UNDECIDED} - {"crack-like, one-way"}
    assert regime(0.0, 0.0, 0.65) == regime(0.0, 0.3, 0.65) == UNDECIDED
