"""A left front that the lattice holds up is told apart from one that slows by its pre-stress."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import slippulse as sp
from slippulse.measure.fronts import longest_wait
from slippulse.measure.transition import STALL, transition_stress
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
