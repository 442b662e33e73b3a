"""The exact slip velocity before the transition, laid beside the simulated one over space and time."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.theory import Fronts, slip_velocity

SCENES = {
    "displacement": (sp.Prestress(0.4, 0.4), 0.65, np.array([0.5, 1.5, 2.5]), np.array([0.0, 0.7, 1.6])),
    "stress": (sp.Prestress(-0.5, 0.3, 1.5), 0.0, np.array([0.5, 1.0, 1.6]), np.array([-0.4, 0.0, 0.6, 1.2])),
}


@pytest.mark.parametrize("boundary", SCENES)
def test_map_converges_to_the_exact_one(boundary):
    profile, gamma, times, positions = SCENES[boundary]
    ratio = 0.1
    fronts = Fronts(profile, ratio, "total", 12.0)
    exact = np.array([[slip_velocity(fronts, gamma, y, time) for y in positions] for time in times])
    assert np.count_nonzero(exact) > exact.size / 2
    errors = []
    for dx in (0.04, 0.02, 0.01):
        scene = sp.Scene(
            boundary=boundary, gamma=gamma, dx=dx, beta=ratio * dx, duration=float(times[-1]), max_step=0.2,
            prestress=profile,
        )  # fmt: skip
        run = sp.simulate(scene, samples=sp.Samples(times, positions))
        errors.append(np.max(np.abs(run["sample_velocity"].values - exact)))
    assert errors[2] < tol.VELOCITY_MAP * exact.max()
    assert errors[0] > 1.5 * errors[1] > 2.25 * errors[2]
