"""Whether a pulse is called steady, unsteady or thick at its front."""

from __future__ import annotations

import pytest

import slippulse as sp
from slippulse.measure.pulses import leading_pulse
from slippulse.predict.measured import pulse_state


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
