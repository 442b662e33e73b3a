"""Lattices tend to the exact rupture at first order in dx."""

import numpy as np
import pytest

import slippulse as sp
from slippulse.theory import Rupture

LEVEL = 0.5
STEP = sp.Prestress(0.3, 0.3, steps=((4.0, 0.6),))
# Profile, gamma, damping ratio, duration, rate strengthening, positions.
SCENES = {
    "undamped": (sp.Prestress(0.5, 0.5), 2.0 / 3.0, 0.0, 7.0, 0.0, [0.0, 1.0, 2.4, 4.0]),
    "damped": (sp.Prestress(0.25, 0.25), 0.55, 0.1, 7.0, 0.0, [0.0, 1.0, 2.0, 3.2]),
    "more damped": (sp.Prestress(0.4, 0.4), 0.65, 0.3, 7.0, 0.0, [0.0, 1.0, 2.4, 4.0]),
    "asymmetric": (sp.Prestress(0.2, 0.6), 0.65, 0.1, 6.0, 0.0, [-2.0, -1.0, 0.0, 1.0, 2.4, 4.0]),
    "strengthening": (sp.Prestress(0.5, 0.5), 0.65, 0.1, 8.0, 0.4, [0.0, 1.0, 2.4, 4.0]),
    "weakening": (sp.Prestress(0.5, 0.5), 0.65, 0.1, 8.0, -0.3, [0.0, 1.0, 2.4, 4.0]),
    "across a step": (STEP, 0.65, 0.1, 7.0, 0.0, [0.0, 2.4, 3.6, 4.4, 5.0]),
}
ORDER = (0.9, 1.1)
RICHARDSON = 1e-4


def lattice_run(profile, gamma, ratio, duration, dx, samples=None, alpha=0.0):
    boundary = "displacement" if gamma else "stress"
    friction = sp.friction("linear_rate", alpha=alpha)
    values = {"gamma": gamma, "beta": ratio * dx, "friction": friction}
    scene = sp.Scene(boundary, profile, duration, dx, max_step=0.5, order=8, **values)
    return sp.simulate(scene, samples=samples)


def nearest(run, x, *quantities):
    """Quantities of the blocks nearest to positions, shape (quantities, positions)."""
    blocks = run.sel(x=x, method="nearest")
    return np.array([blocks[quantity].values for quantity in quantities])


@pytest.mark.parametrize("name", SCENES)
def test_lattices_tend_to_the_exact_rupture_at_first_order(name):
    *scene, duration, alpha, x = SCENES[name]
    exact = Rupture(*scene, "total", duration, rate_strengthening=alpha)
    truth = np.array([exact.release_time(x), exact.stick_time(x), exact.final_slip(x)])
    assert np.all(np.isfinite(truth))
    runs = (lattice_run(*scene, duration, dx, alpha=alpha) for dx in (0.02, 0.01, 0.005))
    errors = [nearest(run, x, "release_time", "stick_time", "slip") - truth for run in runs]
    coarse, middle, fine = errors
    for quantity in range(3):
        worst = np.argmax(np.abs(fine[quantity]))
        for a, b in ((coarse, middle), (middle, fine)):
            assert ORDER[0] < np.log2(a[quantity, worst] / b[quantity, worst]) < ORDER[1]
    # Errors of first and second order taken out.
    assert np.max(np.abs(8.0 * fine - 6.0 * middle + coarse)) / 3.0 < RICHARDSON


@pytest.mark.parametrize(
    ("gamma", "alpha", "first", "farthest"),
    [
        (0.65, 0.0, 1.5, 3.0),
        (0.0, 0.0, 1.5, 3.0),
        (0.65, 0.5, 1.5, 2.4),
        (0.65, -0.3, 1.5, 3.0),
        (0.0, 0.5, 1.5, 3.0),
        (0.65, 1.7, 2.0, 2.0),
    ],
)
def test_slow_fronts_and_fields_of_lattices_tend_to_the_exact_ones(gamma, alpha, first, farthest):
    scene = sp.Prestress(-LEVEL, LEVEL), gamma, 0.1
    exact = Rupture(*scene, "total", 5.0, rate_strengthening=alpha)
    times, x = np.array([first, 2.5, 3.3]), np.array([-2.0, -1.0, 0.0, 1.5])
    slow = -farthest * np.array([1.0, 0.8, 0.6])
    fields = exact.map(times, x, ("slip_velocity", "slip"))
    errors, arrival = [], []
    for dx in (0.02, 0.01):
        run = lattice_run(*scene, 5.0, dx, sp.Samples(times, x), alpha)
        pairs = (("sample_velocity", "slip_velocity"), ("sample_slip", "slip"))
        differences = [run[sampled].values - fields[name] for sampled, name in pairs]
        errors.append([np.max(np.abs(difference)) for difference in differences])
        late = nearest(run, slow, "release_time") - exact.release_time(slow)
        arrival.append(np.max(np.abs(late)))
    for coarse, fine in zip(*errors, strict=True):
        assert fine < 0.62 * coarse and fine < 0.015
    # A slow front goes from block to block by jerks, of the order of dx themselves.
    assert arrival[1] < 0.65 * arrival[0] < 0.05
