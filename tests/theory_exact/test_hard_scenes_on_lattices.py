"""Lattices at three spacings tend to the exact solution of random hard scenes before its limits."""

import numpy as np
import pytest
from hard_scenes import Keys, scene

import slippulse as sp

pytestmark = pytest.mark.slow

NUMBERS = range(60)
SPACINGS = (0.04, 0.02, 0.01)
POSITIONS = 12
# Extrapolation errs by this fraction of what the spacing changed; a block is late by its jerk.
CHANGE, BLOCKS = 1.0, 3.0


def lattice_answers(keys: Keys, samples: sp.Samples, dx: float) -> tuple[np.ndarray, np.ndarray]:
    """Release times at positions, infinite where there is none, and slip there [time, position]."""
    boundary = "displacement" if keys.gamma else "stress"
    rules = {"gamma": keys.gamma, "beta": keys.damping_ratio * dx, "release": keys.release}
    lattice = sp.Scene(boundary, keys.prestress, keys.duration, dx, max_step=0.5, order=8, **rules)
    run = sp.simulate(lattice, samples=samples)
    release = run["release_time"].sel(x=samples.positions, method="nearest").values
    return np.nan_to_num(release, nan=np.inf), run["sample_slip"].values


def disagreements(number: int) -> list[str]:
    """Release times and slip for which lattices tend to something else than the exact solution."""
    keys = scene(number)
    rupture = keys.rupture()
    ends = [end.x for pair in rupture.front_ends for end in pair]
    x = np.round(np.linspace(min(ends), max(ends), POSITIONS + 2)[1:-1] / SPACINGS[0]) * SPACINGS[0]
    times = keys.duration * np.array([0.35, 0.65, 0.95])
    end = np.minimum(rupture.horizon(x), keys.duration) - BLOCKS * SPACINGS[0]
    release = np.minimum(np.nan_to_num(rupture.release_time(x), nan=np.inf), end)
    slip = rupture.map(times, x, ("slip",))["slip"]
    runs = [lattice_answers(keys, sp.Samples(times, x), dx) for dx in SPACINGS]
    releases = np.array([np.minimum(run, end) for run, _ in runs])
    slips = np.where(times[:, None] < end, [run for _, run in runs], np.nan)
    return _differences("release", release, releases) + _differences("slip", slip, slips)


def _differences(name: str, exact: np.ndarray, runs: np.ndarray) -> list[str]:
    coarse, middle, fine = runs
    # A step of the pre-stress between two blocks moves with dx, and an error that changes its sign
    # cannot be extrapolated.
    steady = (fine - middle) * (middle - coarse) >= 0.0
    extrapolated = np.where(steady, (8.0 * fine - 6.0 * middle + coarse) / 3.0, fine)
    allowed = CHANGE * np.maximum(np.abs(fine - middle), np.abs(middle - coarse))
    wrong = np.argwhere(np.abs(extrapolated - exact) > allowed + BLOCKS * SPACINGS[-1])
    return [f"{name} {at}: {exact[tuple(at)]:.6g}, {runs[:, *at]}" for at in wrong]


@pytest.mark.parametrize("number", NUMBERS)
def test_lattices_tend_to_the_exact_solution(number):
    assert disagreements(number) == []
