"""Arrest of pulses on rough pre-stress, compared with a solver that shares no code with ours."""

from typing import NamedTuple

import numpy as np
import pytest
import tolerances as tol
from reference.block_row import Row, simulate_row

import slippulse as sp


class Setting(NamedTuple):
    """Numbers that all scenes under one boundary condition have in common."""

    start: float
    stop: float
    dx: float
    duration: float
    gamma: float = 0.0
    peak: float = 1.0
    bumps: tuple[tuple[float, float, float], ...] = ()


class Case(NamedTuple):
    """One rough pre-stress, and the damping of its scene. No study uses these seeds."""

    boundary: str
    level: float
    deviation: float
    correlation_length: float
    hurst: float
    damping_ratio: float
    seed: int


# Under a stress boundary, a negative bump stops the left front.
SETTINGS = {
    "displacement": Setting(-20.0, 20.0, dx=0.05, duration=16.0, gamma=0.65),
    "stress": Setting(-20.0, 60.0, dx=0.1, duration=60.0, peak=1.05, bumps=((-10.0, -4.0, 3.0),)),
}
# At least one pulse of each case dies. The deviation is up to twice the level.
CASES = [
    Case("displacement", 0.4, 0.8, 20.0, 0.5, 1.0, 6002),
    Case("displacement", 0.6, 0.6, 20.0, 0.0, 0.0, 6003),
    Case("displacement", 0.2, 0.4, 0.25, 0.5, 1.0, 6007),
    Case("displacement", 0.4, 0.8, 10.0, 0.0, 1.0, 6009),
    Case("displacement", 0.6, 0.6, 4.0, 0.5, 0.3, 6010),
    Case("displacement", 0.8, 0.8, 4.0, 0.5, 0.3, 6011),
    Case("displacement", 0.4, 0.3, 20.0, 0.0, 1.0, 6015),
    Case("displacement", 0.2, 0.2, 10.0, 0.5, 0.3, 6020),
    Case("displacement", 0.2, 0.4, 1.0, 0.9, 1.0, 6028),
    Case("displacement", 0.25, 0.3, 10.0, 0.5, 0.3, 6033),
    Case("displacement", 0.2, 0.2, 20.0, 0.9, 0.1, 6034),
    Case("displacement", 0.2, 0.4, 10.0, 0.5, 0.0, 6035),
    Case("stress", 0.0, 0.1, 4.0, 0.5, 0.1, 6041),
    Case("stress", 0.01, 0.2, 20.0, 0.0, 0.3, 6043),
    Case("stress", 0.01, 0.2, 10.0, 0.0, 0.1, 6048),
    Case("stress", 0.0, 0.5, 4.0, 0.9, 0.0, 6049),
    Case("stress", 0.0, 0.3, 20.0, 0.5, 1.0, 6052),
    Case("stress", 0.01, 0.2, 20.0, 0.5, 0.1, 6053),
    Case("stress", 0.0, 0.3, 1.0, 0.9, 1.0, 6057),
    Case("stress", 0.01, 0.2, 10.0, 0.5, 0.3, 6058),
]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.boundary}-{case.seed}")
def test_pulses_stop_where_an_independent_solver_stops_them(case):
    setting = SETTINGS[case.boundary]
    dx, stop, beta = setting.dx, setting.stop, case.damping_ratio * setting.dx
    points = sp.rough(
        case.level,
        case.deviation,
        case.correlation_length,
        case.hurst,
        setting.start,
        stop,
        spacing=0.1 if case.correlation_length < 0.5 else 0.25,
        seed=case.seed,
    )
    profile = sp.Prestress.through(*points, 1.0, setting.peak, setting.bumps)
    gamma = {"gamma": setting.gamma} if setting.gamma else {}
    ours = sp.simulate(sp.Scene(case.boundary, profile, setting.duration, dx, beta=beta, **gamma))
    # The row is longer than the track on which pulses are followed.
    x = dx * np.arange(round((setting.start - 15.0) / dx), round((stop + 15.0) / dx) + 1)
    tau = np.interp(x, *points)
    tau += (setting.peak - tau) * np.exp(-0.5 * x**2)
    for centre, amplitude, width in setting.bumps:
        tau += amplitude * np.exp(-0.5 * ((x - centre) / width) ** 2)
    other = simulate_row(Row(tau, dx, beta, setting.gamma), setting.duration, 0.15 * dx)
    died = []
    for side in (1, -1):
        distance, is_dead = arrest(ours["x"], ours["release_time"], ours["stick_time"], side)
        expected, expected_dead = arrest(x, other.release_time, other.stick_time, side)
        # Beyond the rough part, the row of the other solver ends.
        distance, expected = min(distance, stop), min(expected, stop)
        assert distance == pytest.approx(expected, abs=tol.ARREST_SPACINGS * dx)
        if distance < stop:
            assert is_dead == expected_dead
            died.append(is_dead)
    assert any(died)


# Scenes under a stress boundary, in which waves of the undamped lattice move the left front. The
# independent solver stops it six blocks farther in the first one, and with another fate in the
# second one.
RESTARTED = [(0.05, 0.02, 2.0, 1.0, 14169), (-0.02, 0.2, 2.0, 0.9, 14257)]


@pytest.mark.parametrize("damping_ratio", [0.0, 0.1])
@pytest.mark.parametrize("field", RESTARTED)
def test_a_front_that_lattice_waves_move_is_flagged_and_sensitive(field, damping_ratio):
    *shape, seed = field
    x, tau = sp.rough(*shape, start=-30.0, stop=80.0, spacing=0.25, seed=seed)
    dx, fates = 0.1, []
    for moved in (0.0, -dx, dx):
        # The table moves instead of the nucleation, which stays at x = 0.
        bump = ((moved - 10.0, -4.0, 3.0),)
        profile = sp.Prestress.through(np.round(x + moved, 9), tau, 1.0, 1.05, bump)
        run = sp.simulate(sp.Scene("stress", profile, 80.0, dx, beta=damping_ratio * dx))
        is_flagged = "front_restarted" in run.attrs["run_flags"]
        assert is_flagged or damping_ratio > 0.0 or moved != 0.0
        assert not is_flagged or damping_ratio == 0.0
        distance, is_dead = arrest(run["x"] - moved, run["release_time"], run["stick_time"], -1)
        fates.append((distance, is_dead))
    changes = [abs(distance - fates[0][0]) / dx for distance, _ in fates[1:]]
    has_another_fate = any(is_dead != fates[0][1] for _, is_dead in fates[1:])
    is_sensitive = max(changes) > 2.5 or has_another_fate
    assert is_sensitive == (damping_ratio == 0.0)


def arrest(x, release_time, stick_time, side):
    """Return how far the front on one side has gone, and whether everything behind it is stuck."""
    x, release_time, stick_time = map(np.asarray, (x, release_time, stick_time))
    released = (side * x > 0.0) & np.isfinite(release_time)
    return float(np.max(side * x[released])), bool(np.isfinite(stick_time[released]).all())


def test_a_seed_gives_the_same_run_on_every_machine():
    """The pinned values are those of this solver; tests above compare it with another one."""
    points = sp.rough(0.25, 0.3, 4.0, 0.5, -40.0, 40.0, 0.25, seed=2002)
    profile = sp.Prestress.through(*points, width=1.0)
    run = sp.simulate(sp.Scene("displacement", profile, 9.0, 0.1, 0.65, 0.01, order=8))
    blocks = run.sel(x=[-6.0, -2.0, 0.0, 2.0, 6.0], method="nearest")
    for name, values in PINNED.items():
        assert blocks[name].values == pytest.approx(values, abs=1e-9), name


PINNED = {
    "release_time": [4.81472671541, 1.114349609057, 0.0, 1.149032766975, 5.394435298122],
    "stick_time": [7.054739317807, 3.932792382365, 3.556627724281, 4.003332129497, 6.476234897995],
    "slip": [1.061923549053, 1.091100662287, 1.741445518761, 1.20150358254, 0.171898571245],
}
