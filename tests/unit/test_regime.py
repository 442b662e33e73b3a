"""The rule that names a regime: each class and each threshold, on made-up runs and on simulated ones."""

import numpy as np
import pytest
import xarray as xr

from slippulse.measure.regime import REGIMES, classify
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.simulation.simulate import Samples, simulate

STILL, TOLERANCE, DURATION = 0.05, 0.02, 30.0


def made_up(
    centre=0.0, left=0.0, right=1.0, before=1.0, speeds=(0.0, 1.0), last_release=DURATION, ever=1.0
) -> xr.Dataset:
    """A run with given velocities at x = 0 and on both sides at the end, and fronts at given speeds (left, right).

    ``before`` is the largest velocity at two thirds of the duration, ``ever`` the one at an earlier sample.
    """
    x = np.linspace(-40.0, 40.0, 801)
    release = np.full(x.shape, np.nan)
    release[np.abs(x) < 1e-9] = 0.0
    for speed, sign in zip(speeds, (-1.0, 1.0), strict=True):
        # One without a speed stops early, at one position.
        side = (sign * x > 0.0) & (np.abs(x) <= (speed * last_release or 2.0))
        release[side] = np.abs(x[side]) / speed if speed else 0.1 * last_release
    velocity = np.zeros((10, 3))
    velocity[2, 1], velocity[6, 2], velocity[-1] = ever, before, (left, centre, right)
    sampled = {"sample_velocity": (("sample_time", "sample_position"), velocity)}
    axes = {"sample_time": np.linspace(0.0, DURATION, 10), "sample_position": [-10.0, 0.0, 10.0]}
    attributes = {"duration": DURATION, "end_time": DURATION}
    return xr.Dataset({"release_time": ("x", release)} | sampled, {"x": x} | axes, attributes)


@pytest.mark.parametrize(
    ("run", "expected", "numbers"),
    [
        (dict(last_release=0.5 * DURATION), "arrested", {}),
        (dict(centre=0.5, left=1.0, speeds=(1.0, 1.0)), "crack-like, two-way", {}),
        (dict(centre=0.5), "crack-like, one-way", {}),
        (dict(left=1.0, speeds=(1.0, 1.0)), "pulses, two-way", {}),
        (dict(before=0.8), "pulse, one-way, growing", {}),
        (dict(), "pulse, one-way, steady", {}),
        (dict(before=1.2), "pulse, one-way, decaying", {}),
        # A nucleation point slower than `still` is a pulse.
        (dict(centre=0.04), "pulse, one-way, steady", {}),
        (dict(centre=0.06), "crack-like, one-way", {}),
        # It is compared with the largest velocity of the moment: slow in itself, but a large fraction of what is left.
        (dict(centre=0.06, right=0.5, before=0.5), "crack-like, one-way", {}),
        (dict(centre=0.06, right=2.0, before=2.0), "pulse, one-way, steady", {}),
        # No release in the last tenth is arrest, before the shape of slip counts; a front that stopped does not matter.
        (dict(last_release=0.88 * DURATION, speeds=(0.0, 1.2)), "arrested", {}),
        (dict(last_release=0.92 * DURATION, speeds=(0.0, 1.2)), "pulse, one-way, steady", {}),
        (dict(centre=1.0, left=1.0, last_release=0.5 * DURATION), "arrested", {}),
        # So is what is left of the largest velocity of the run.
        (dict(right=0.04, before=0.04), "arrested", {}),
        (dict(right=0.06, before=0.06), "pulse, one-way, steady", {}),
        # Where no front keeps up with the waves, the sides that slide run.
        (dict(left=0.06, centre=0.5, speeds=(0.5, 0.6)), "crack-like, two-way", {}),
        (dict(left=0.04, centre=0.5, speeds=(0.5, 0.6)), "crack-like, one-way", {}),
        (dict(left=0.06, speeds=(0.5, 0.6)), "pulses, two-way", {}),
        (dict(left=0.04, speeds=(0.5, 0.6)), "pulse, one-way, steady", {}),
        # Steady is a change within the tolerance.
        (dict(right=1.03), "pulse, one-way, growing", {"largest_velocity_change": 0.03}),
        (dict(right=1.01), "pulse, one-way, steady", {"largest_velocity_change": 0.01}),
        (dict(right=0.99), "pulse, one-way, steady", {"largest_velocity_change": -0.01}),
        (dict(right=0.97), "pulse, one-way, decaying", {"largest_velocity_change": -0.03}),
        # A front runs when it keeps up with the waves.
        (dict(left=1.0, speeds=(0.99, 1.0)), "pulses, two-way", {"late_front_speed_left": 0.99}),
        (
            dict(left=1.0, speeds=(0.95, 1.0)), "pulse, one-way, steady",
            {"late_front_speed_left": 0.95, "late_front_speed_right": 1.0},
        ),
        (
            dict(centre=0.02, right=0.5, before=0.4), "pulse, one-way, growing",
            {"centre_velocity_share": 0.04, "largest_velocity_change": 0.25},
        ),
        (dict(right=0.0, before=0.0, last_release=0.3 * DURATION), "arrested", {"centre_velocity_share": np.nan}),
    ],
)  # fmt: skip
def test_every_regime_is_reached_and_each_threshold_decides(run, expected, numbers):
    assert expected in REGIMES and len(set(REGIMES)) == 7
    out = classify(made_up(**run), STILL, TOLERANCE)
    assert out["regime"] == expected
    assert {name: out[name] for name in numbers} == pytest.approx(numbers, abs=1e-3, nan_ok=True)


def test_thresholds_are_arguments():
    run = made_up(centre=0.2, before=0.9)
    assert classify(run, 0.3, 0.05)["regime"] == "pulse, one-way, growing"
    assert classify(run, 0.3, 0.2)["regime"] == "pulse, one-way, steady"
    assert classify(run, 0.1, 0.05)["regime"] == "crack-like, one-way"


@pytest.mark.parametrize(
    ("boundary", "prestress", "duration", "gamma", "expected"),
    [
        ("displacement", Prestress(0.5, 0.5), 20.0, 0.2, "pulses, two-way"),
        # The same rupture, seen before half a period of the leaf springs is over.
        ("displacement", Prestress(0.5, 0.5), 20.0, 0.005, "crack-like, two-way"),
        ("displacement", Prestress(-0.1, -0.1), 20.0, 0.2, "arrested"),
        ("stress", Prestress(0.3, 0.3), 40.0, 0.0, "crack-like, two-way"),
        ("stress", Prestress(-0.3, 0.3), 40.0, 0.0, "crack-like, one-way"),
        ("stress", Prestress(0.3, -0.3), 40.0, 0.0, "crack-like, one-way"),
        ("stress", Prestress(-0.6, 0.0, steps=((15.0, 0.01),)), 80.0, 0.0, "pulse, one-way, growing"),
        ("stress", Prestress(-0.6, 0.0, steps=((15.0, 0.0),)), 80.0, 0.0, "pulse, one-way, steady"),
        ("stress", Prestress(-0.6, 0.0, steps=((15.0, -0.01),)), 80.0, 0.0, "pulse, one-way, decaying"),
    ],
)
def test_simulated_ruptures(boundary, prestress, duration, gamma, expected):
    # With fewer than ten blocks in the Gaussian, damping alone makes a steady pulse decay.
    scene = Scene(boundary, prestress, duration, dx=0.1, gamma=gamma, beta=0.01, max_step=0.5)
    reach = 1.5 * duration + 10.0
    run = simulate(scene, Samples(np.linspace(0.0, duration, 10), np.linspace(-reach, reach, 801)))
    assert run.attrs["run_flags"] == ""
    assert classify(run, STILL, TOLERANCE)["regime"] == expected
