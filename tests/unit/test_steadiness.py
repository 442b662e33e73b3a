"""Whether a pulse is called steady, unsteady or thick at its front."""

from __future__ import annotations

import pytest

import slippulse as sp
from slippulse.measure.pulses import leading_pulse
from slippulse.predict.measured import pulse_state


def state(level: float, duration: float, **values) -> str:
    """State of the right pulse after a time; dx = 0.05 and gamma = 0.65 unless said."""
    values = {"boundary": "displacement", "gamma": 0.65, "dx": 0.05, "beta": 0.005, "max_step": 0.5} | values
    run = sp.simulate(sp.Scene(prestress=sp.Prestress(level, level), duration=duration, **values))
    return pulse_state(run, leading_pulse(run, 0.3))


@pytest.mark.parametrize("level", [0.3, 0.6, 0.9])
def test_a_pulse_that_has_run_long_enough_is_steady(level):
    assert state(level, 60.0) == "steady"


def test_a_young_pulse_is_unsteady():
    """Just split from its twin: half as wide again as the pulse that it becomes."""
    assert state(0.5, 5.0) == "unsteady"
    assert state(0.5, 40.0) == "steady"


def test_a_pulse_slower_than_the_waves_is_unsteady():
    """The elastic rule under strong damping: 0.83, where the formula without leaf springs says 1.19."""
    assert state(0.3, 40.0, beta=0.5, release="elastic", max_step=0.05) == "unsteady"
    assert sp.theory.front_speed(0.3, 10.0, "elastic") > 1.1


def test_a_damped_layer_as_wide_as_the_pulse_is_told():
    assert state(0.05, 60.0, dx=0.02, beta=0.006) == "thick_front"


def test_without_a_pulse_there_is_no_state():
    assert state(0.5, 1.0) == "none"
    assert state(0.5, 5.0, boundary="stress", gamma=0.0) == "none"
