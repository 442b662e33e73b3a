"""Whether a pulse is called steady, unsteady or thick at its front, and a left front held up by the lattice stalled."""

import numpy as np
import pytest
import xarray as xr

import slippulse as sp
from slippulse.measure.fronts import longest_wait
from slippulse.measure.pulses import leading_pulse
from slippulse.measure.transition import STALL, transition_stress
from slippulse.predict.measured import pulse_state
from slippulse.theory import ArrestingCrack


def test_the_longest_wait_on_the_way():
    """Blocks at -1, -2, ... released at 1, 2, 5, 6 and 20: the last is beyond the distance asked for."""
    x = np.arange(-5.0, 1.0)
    run = xr.Dataset({"release_time": ("x", [20.0, 6.0, 5.0, 2.0, 1.0, 0.0])}, coords={"x": x})
    assert longest_wait(run, 4.0, "left") == 3.0
    assert longest_wait(run, 5.0, "left") == 14.0
    assert np.isnan(longest_wait(run, 6.0, "left"))


@pytest.mark.parametrize(
    ("level", "dx", "ratio", "state"),
    [
        (-1.0, 0.01, 0.1, "resolved"),
        (-1.0, 0.01, 0.0, "stalled"),
        (-1.0, 0.04, 0.1, "stalled"),
        (-10.0, 0.02, 0.1, "stalled"),
        (-0.25, 0.02, 0.1, "resolved"),
        (-0.25, 0.02, 0.0, "not reached"),
    ],
)
def test_a_stalled_front_is_late_and_a_resolved_one_is_not(level, dx, ratio, state, paper_accuracy):
    profile = sp.Prestress(level, 0.0)
    exact = ArrestingCrack(profile, ratio).share_time(0.95)
    run = sp.simulate(sp.Scene("stress", profile, 1.6 * exact, dx, beta=ratio * dx, **paper_accuracy))
    found = transition_stress(run, 0.95)
    assert found["transition_state"] == state
    if state == "resolved":
        assert abs(found["transition_time"] / exact - 1.0) < 1.5 * STALL
    if state == "stalled":
        assert found["transition_time"] / exact - 1.0 > STALL


@pytest.mark.parametrize(
    ("level", "duration", "values", "expected"),
    [
        (0.3, 60.0, {}, "steady"),
        (0.6, 60.0, {}, "steady"),
        (0.9, 60.0, {}, "steady"),
        (0.5, 40.0, {}, "steady"),
        # Just split from its twin: half as wide again as the pulse that it becomes.
        (0.5, 5.0, {}, "unsteady"),
        # The elastic rule under strong damping: slower than the waves; the formula without leaf springs says 1.19.
        (0.3, 40.0, {"beta": 0.5, "release": "elastic", "max_step": 0.05}, "unsteady"),
        # The damped layer is as wide as the pulse.
        (0.05, 60.0, {"dx": 0.02, "beta": 0.006}, "thick_front"),
        (0.5, 1.0, {}, "none"),
        (0.5, 5.0, {"boundary": "stress", "gamma": 0.0}, "none"),
    ],
)
def test_what_a_pulse_is_called(level, duration, values, expected):
    values = {"boundary": "displacement", "gamma": 0.65, "dx": 0.05, "beta": 0.005, "max_step": 0.5} | values
    run = sp.simulate(sp.Scene(prestress=sp.Prestress(level, level), duration=duration, **values))
    assert pulse_state(run, leading_pulse(run, 0.3)) == expected
    # The formula without leaf springs has a faster front under the elastic rule.
    assert sp.theory.front_speed(0.3, 10.0, "elastic") > 1.1
