"""Lattices at three spacings tend to the exact solution of random hard scenes before its limits."""

from dataclasses import replace

import numpy as np
import pytest
from hard_scenes import Keys, scene

import slippulse as sp

pytestmark = pytest.mark.slow

# Odd factors: what lies in the middle between two blocks of one lattice does so in all.
SPACINGS = (0.045, 0.015, 0.005)
POSITIONS = 12
# Extrapolation errs by this fraction of what the finest spacing changed; blocks come by jerks.
CHANGE, BLOCKS = 1.0, 3.0
TO_ZERO = np.array([1.0, -12.0, 27.0]) / 16.0


# The jerks of a slow front without damping shake a block at du/dt = 0.02: in lattices it sticks at
# 10.536, 10.545, 10.785, 10.686 and 10.678 as dx falls to 5.6e-4, exactly at 10.665. With damping
# the same scene agrees.
SHAKEN, DAMPED = 52, 0.1


def on_blocks(keys: Keys) -> Keys:
    """The scene with steps in the middle between blocks, where no lattice moves them."""
    tau, dx = keys.prestress, SPACINGS[0]
    steps = tuple((dx * (np.floor(x / dx) + 0.5), level) for x, level in tau.steps)
    return replace(keys, prestress=replace(tau, steps=steps))


def lattice_answers(keys: Keys, samples: sp.Samples, dx: float) -> list[np.ndarray]:
    """Release and stick times at positions, infinite where there is none; slip [time, position]."""
    boundary = "displacement" if keys.gamma else "stress"
    rules = {"gamma": keys.gamma, "beta": keys.damping_ratio * dx, "release": keys.release}
    lattice = sp.Scene(boundary, keys.prestress, keys.duration, dx, max_step=0.5, order=8, **rules)
    run = sp.simulate(lattice, samples=samples)
    blocks = run.sel(x=samples.positions, method="nearest")
    times = (blocks[name].values for name in ("release_time", "stick_time"))
    return [*(np.nan_to_num(time, nan=np.inf) for time in times), run["sample_slip"].values]


def disagreements(keys: Keys) -> list[str]:
    """Times and slip for which lattices tend to something else than the exact solution."""
    rupture = keys.rupture()
    ends = [end.x for pair in rupture.front_ends for end in pair]
    x = np.round(np.linspace(min(ends), max(ends), POSITIONS + 2)[1:-1] / SPACINGS[0]) * SPACINGS[0]
    times = keys.duration * np.array([0.35, 0.65, 0.95])
    first_limit = rupture.limit.time if rupture.limit else keys.duration
    # A lattice keeps the last stick of a block, and beyond a limit what has stuck is pushed again.
    ends = {"release": np.minimum(rupture.horizon(x), keys.duration), "stick": first_limit}
    runs = [lattice_answers(keys, sp.Samples(times, x), dx) for dx in SPACINGS]
    before = replace(keys, duration=first_limit)
    stick = [lattice_answers(before, sp.Samples([0.0], x), dx)[1] for dx in SPACINGS]
    out = []
    for name, values in (("release", [release for release, *_ in runs]), ("stick", stick)):
        end = ends[name] - BLOCKS * SPACINGS[0]
        exact = np.nan_to_num(getattr(rupture, f"{name}_time")(x), nan=np.inf)
        out += _differences(name, np.minimum(exact, end), np.minimum(values, end))
    end = ends["release"] - BLOCKS * SPACINGS[0]
    slips = np.where(times[:, None] < end, [slip for *_, slip in runs], np.nan)
    return out + _differences("slip", rupture.map(times, x, ("slip",))["slip"], slips)


def _differences(name: str, exact: np.ndarray, runs: np.ndarray) -> list[str]:
    extrapolated = np.tensordot(TO_ZERO, runs, 1)
    allowed = CHANGE * np.abs(runs[2] - runs[1]) + BLOCKS * SPACINGS[-1]
    wrong = np.argwhere(np.abs(extrapolated - exact) > allowed)
    return [f"{name} {at}: {exact[tuple(at)]:.6g}, {runs[:, *at]}" for at in wrong]


@pytest.mark.parametrize("number", range(60))
def test_lattices_tend_to_the_exact_solution(number):
    keys = on_blocks(scene(number))
    if number == SHAKEN:
        found = disagreements(keys)
        assert len(found) == 1 and found[0].startswith("stick [0]")
        keys = replace(keys, damping_ratio=DAMPED)
    assert disagreements(keys) == []
