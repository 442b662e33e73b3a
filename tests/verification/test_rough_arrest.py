"""Arrest of pulses on rough pre-stress, compared with a solver that shares no code with ours."""

import numpy as np
import pytest
import tolerances as tol
from reference.block_row import Row, simulate_row

import slippulse as sp

DAMPING_RATIO = 0.1
SHAPE = {"correlation_length": 4.0, "hurst": 0.5, "spacing": 0.25}
# Rougher than the ensembles of the study, so that most pulses die. No study uses these seeds.
HELD = {"level": 0.25, "deviation": 0.3, "start": -40.0, "stop": 40.0} | SHAPE
FREE = {"level": 0.0, "deviation": 0.3, "start": -30.0, "stop": 120.0} | SHAPE
# The dent stops the left front.
DENT = (-10.0, -4.0, 3.0)
SCENES = {
    "displacement": {"duration": 40.0, "dx": 0.05, "gamma": 0.65},
    "stress": {"duration": 110.0, "dx": 0.1},
}
CASES = [("displacement", 2001), ("displacement", 2002)]
CASES += [("stress", 2001), ("stress", 2002), ("stress", 2008)]


@pytest.mark.slow
@pytest.mark.parametrize(("boundary", "seed"), CASES)
def test_pulses_stop_where_an_independent_solver_stops_them(boundary, seed):
    scene_numbers = SCENES[boundary]
    dx, duration = scene_numbers["dx"], scene_numbers["duration"]
    keys, peak, bumps = (HELD, 1.0, ()) if boundary == "displacement" else (FREE, 1.05, (DENT,))
    points = sp.rough(**keys, seed=seed)
    profile = sp.Prestress.through(*points, width=1.0, peak=peak, bumps=bumps)
    scene = sp.Scene(
        boundary, profile, beta=DAMPING_RATIO * dx, order=8, max_step=1.0, **scene_numbers
    )
    ours = sp.simulate(scene)
    # The row is longer than the track on which pulses are followed.
    x = dx * np.arange(round((keys["start"] - 20.0) / dx), round((keys["stop"] + 20.0) / dx) + 1)
    level, gaussian = np.interp(x, *points), np.exp(-0.5 * x**2)
    tau = level + (peak - level) * gaussian
    for centre, amplitude, width in bumps:
        tau += amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    row = Row(tau, dx, DAMPING_RATIO * dx, scene_numbers.get("gamma", 0.0))
    other = simulate_row(row, duration, longest_step=0.2 * dx)
    died = []
    for side in (1, -1):
        distance, is_dead = arrest(ours["x"], ours["release_time"], ours["stick_time"], side)
        expected, expected_dead = arrest(x, other.release_time, other.stick_time, side)
        # Beyond the rough part, the row of the other solver ends.
        distance, expected = min(distance, keys["stop"]), min(expected, keys["stop"])
        assert distance == pytest.approx(expected, abs=tol.ARREST_SPACINGS * dx)
        if distance < keys["stop"]:
            assert is_dead == expected_dead
            died.append(is_dead)
    assert any(died)


def arrest(x, release_time, stick_time, side):
    """Return how far the front on one side has gone, and whether everything behind it is stuck."""
    x, release_time, stick_time = map(np.asarray, (x, release_time, stick_time))
    released = (side * x > 0.0) & np.isfinite(release_time)
    return float(np.max(side * x[released])), bool(np.isfinite(stick_time[released]).all())


def test_a_seed_gives_the_same_run_on_every_machine():
    """The pinned values are those of this solver; tests above compare it with another one."""
    profile = sp.Prestress.through(*sp.rough(**HELD, seed=2002), width=1.0)
    run = sp.simulate(sp.Scene("displacement", profile, 9.0, 0.1, 0.65, 0.01, order=8))
    blocks = run.sel(x=[-6.0, -2.0, 0.0, 2.0, 6.0], method="nearest")
    for name, values in PINNED.items():
        assert blocks[name].values == pytest.approx(values, abs=1e-9), name


PINNED = {
    "release_time": [4.81472671541, 1.114349609057, 0.0, 1.149032766975, 5.394435298122],
    "stick_time": [7.054739317807, 3.932792382365, 3.556627724281, 4.003332129497, 6.476234897995],
    "slip": [1.061923549053, 1.091100662287, 1.741445518761, 1.20150358254, 0.171898571245],
}
