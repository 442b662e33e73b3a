"""Lattices tend to the exact rupture at first order in dx."""

from __future__ import annotations

import numpy as np
import pytest

import slippulse as sp
from slippulse.theory import Rupture

SPACINGS = (0.02, 0.01, 0.005)
LEVEL = 0.5
# Profile, gamma, damping ratio, duration, positions.
SCENES = {
    "undamped": (sp.Prestress(0.5, 0.5), 2.0 / 3.0, 0.0, 7.0, [0.0, 1.0, 2.4, 4.0]),
    "damped": (sp.Prestress(0.25, 0.25), 0.55, 0.1, 7.0, [0.0, 1.0, 2.0, 3.2]),
    "more damped": (sp.Prestress(0.4, 0.4), 0.65, 0.3, 7.0, [0.0, 1.0, 2.4, 4.0]),
    "asymmetric": (sp.Prestress(0.2, 0.6), 0.65, 0.1, 6.0, [-2.0, -1.0, 0.0, 1.0, 2.4, 4.0]),
    "across a step": (sp.Prestress(0.3, 0.3, steps=((4.0, 0.6),)), 0.65, 0.1, 7.0, [0.0, 2.4, 3.6, 4.4, 5.0]),
}
ORDER = (0.9, 1.1)
RICHARDSON = 1e-4


@pytest.mark.parametrize("name", SCENES)
def test_lattices_tend_to_the_exact_rupture_at_first_order(name):
    profile, gamma, ratio, duration, positions = SCENES[name]
    x = np.array(positions)
    exact = Rupture(profile, gamma, ratio, "total", duration)
    truth = exact.release_time(x), exact.stick_time(x), exact.final_slip(x)
    assert np.all(np.isfinite(truth))
    errors = []
    for dx in SPACINGS:
        scene = sp.Scene(
            "displacement", profile, duration, dx, gamma=gamma, beta=ratio * dx, max_step=0.5, order=8
        )  # fmt: skip
        run = sp.simulate(scene)
        here = np.argmin(np.abs(run["x"].values - x[:, None]), axis=1)
        found = [run[quantity].values[here] for quantity in ("release_time", "stick_time", "slip")]
        errors.append(np.array(found) - truth)
    coarse, middle, fine = errors
    for quantity in range(3):
        worst = np.argmax(np.abs(fine[quantity]))
        for a, b in ((coarse, middle), (middle, fine)):
            assert ORDER[0] < np.log2(a[quantity, worst] / b[quantity, worst]) < ORDER[1]
    # Errors of first and second order taken out.
    assert np.max(np.abs(8.0 * fine - 6.0 * middle + coarse)) / 3.0 < RICHARDSON


@pytest.mark.parametrize("gamma", [0.65, 0.0])
def test_slow_fronts_and_fields_of_lattices_tend_to_the_exact_ones(gamma):
    profile, ratio, duration = sp.Prestress(-0.5, 0.5), 0.1, 5.0
    exact = Rupture(profile, gamma, ratio, "total", duration)
    times, x = np.array([1.5, 2.5, 3.3]), np.array([-2.0, -1.0, 0.0, 1.5])
    fields = exact.map(times, x, ("slip_velocity", "slip"))
    errors, arrival = [], []
    for dx in (0.02, 0.01):
        scene = sp.Scene(
            "displacement" if gamma else "stress", profile, duration, dx, gamma=gamma, beta=ratio * dx, max_step=0.5,
            order=8,
        )  # fmt: skip
        run = sp.simulate(scene, samples=sp.Samples(times, x))
        errors.append([np.max(np.abs(run[f"sample_{q}"].values - fields[f"slip_{q}" if q == "velocity" else q]))
                       for q in ("velocity", "slip")])  # fmt: skip
        slow = np.array([-3.0, -2.4, -1.8])
        here = np.argmin(np.abs(run["x"].values - slow[:, None]), axis=1)
        arrival.append(np.max(np.abs(run["release_time"].values[here] - exact.release_time(slow))))
    for coarse, fine in zip(*errors, strict=True):
        assert fine < 0.62 * coarse
        assert fine < 0.015
    # A slow front goes from block to block by jerks, of the order of dx themselves.
    assert arrival[1] < 0.65 * arrival[0] < 0.05


def test_a_barrier_on_the_lattice_is_passed_when_it_is_shorter():
    depth = sp.theory.barrier_depth(LEVEL, -LEVEL, 0.65, 0.1)
    for length, passed in ((0.9 * depth, True), (1.1 * depth, False)):
        profile = sp.Prestress(LEVEL, LEVEL, steps=((9.0, -LEVEL), (9.0 + length, LEVEL)))
        run = sp.simulate(
            sp.Scene("displacement", profile, 13.0, 0.02, gamma=0.65, beta=0.002, max_step=0.5, order=8)
        )
        released = run["x"].values[np.isfinite(run["release_time"].values)]
        assert (released.max() > 9.0 + length + 0.5) == passed
