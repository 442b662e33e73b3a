"""Blocks and springs, dx = 1, against an independent integration of the same equation of motion."""

from itertools import product

import numpy as np
import pytest
import tolerances as tol
from reference.burridge_knopoff import Chain
from reference.lattice_state import sliding

import slippulse as sp

DURATION = 16.0
REACH = 40
UNEVEN = sp.Prestress(0.2, 0.6, peak=1.01, bumps=((5.0, -0.7, 1.0),))
TWO_POINTS = sp.Prestress(-0.2, 0.1, bumps=((9.0, 1.0, 1.0), (-7.0, 0.3, 2.0)))
PROFILES = {
    "displacement, even": ("displacement", 0.3, sp.Prestress(0.3, 0.3)),
    "displacement, uneven": ("displacement", 0.5, UNEVEN),
    "stress, one-way": ("stress", 0.0, sp.Prestress(-0.5, 0.0)),
    "stress, two points": ("stress", 0.0, TWO_POINTS),
}
RULES = ((0.0, "total"), (0.3, "total"), (0.3, "elastic"))
CASES = [(name, *rule) for name, rule in product(PROFILES, RULES)]


def run_of(name: str, beta: float, release: str, **accuracy):
    boundary, gamma, profile = PROFILES[name]
    values = {"gamma": gamma, "beta": beta, "release": release, "resolved_blocks": 1, **accuracy}
    return sp.simulate(sp.Scene(boundary, profile, DURATION, 1.0, **values))


def check(run, chain: Chain, error: float) -> None:
    blocks = np.round(run["x"].values).astype(int)
    kept = np.abs(blocks) <= REACH
    for name in ("release_time", "stick_time", "slip", "slip_velocity"):
        ours, theirs = run[name].values[kept], getattr(chain, name)[blocks[kept] + REACH]
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=error, err_msg=name)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_event_and_every_slip_agrees(case):
    run = run_of(*case, max_step=0.05, order=8, half_lattice=False)
    _, gamma, profile = PROFILES[case[0]]
    chain = Chain(profile(np.arange(-REACH, REACH + 1.0)), gamma, *case[1:]).run(DURATION)
    releases, sticks, again = (run.attrs[name] for name in ("releases", "sticks", "re_releases"))
    assert (releases, sticks) == (chain.releases, chain.sticks)
    # Blocks released again are counted, and slide on.
    assert again == releases - np.isfinite(run["release_time"].values).sum()
    assert releases - sticks == sliding(run).sum()
    assert again > 0 or case != ("stress, one-way", 0.0, "total")
    check(run, chain, tol.CHAIN)
    # The fourth-order step of the figure agrees to its truncation error.
    check(run_of(*case, max_step=0.1, order=4), chain, tol.CHAIN_ORDER_4)


def test_no_event_is_stepped_over():
    random, names = np.random.default_rng(1), ("releases", "sticks", "re_releases")
    for number in range(200):
        gamma, beta = random.uniform(0.05, 1.5), random.choice([0.0, 0.05, 0.2])
        bumps = tuple(tuple(random.uniform((-20, -0.5, 1), (20, 0.5, 4))) for _ in range(3))
        boundary = str(random.choice(["displacement", "stress"]))
        profile = sp.Prestress(*random.uniform((-0.5, -0.3), 0.5), bumps=bumps)
        gamma *= boundary == "displacement"
        scene = {"boundary": boundary, "gamma": gamma, "beta": beta, "prestress": profile}
        scene |= {"duration": 25.0, "dx": 1.0, "order": 8, "resolved_blocks": 1}
        long, short, shortest = (
            sp.simulate(sp.Scene(**scene, max_step=step)).attrs for step in (0.5, 0.2, 0.02)
        )
        for name in names:
            assert long[name] == short[name] == shortest[name], (number, scene)
