"""Chains of blocks and springs, compared with an independent integration event by event."""

import math
from itertools import product

import numpy as np
import pytest
import tolerances as tol
from reference.burridge_knopoff import Chain
from reference.lattice_state import elastic_stress, sliding

import slippulse as sp
from slippulse.solver.fixed_step import LATTICES

DURATION = 16.0
COMPARED_BLOCKS = 40  # on each side of x = 0
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
    """Compare the fields of a run with the fields of the independent integration."""
    blocks = np.round(run["x"].values).astype(int)
    kept = np.abs(blocks) <= COMPARED_BLOCKS
    for name in ("release_time", "stick_time", "slip", "slip_velocity"):
        ours, theirs = run[name].values[kept], getattr(chain, name)[blocks[kept] + COMPARED_BLOCKS]
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=error, err_msg=name)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_event_and_every_slip_agrees(case):
    run = run_of(*case, max_step=0.05, order=8, half_lattice=False)
    _, gamma, profile = PROFILES[case[0]]
    chain = Chain(
        profile(np.arange(-COMPARED_BLOCKS, COMPARED_BLOCKS + 1.0)), gamma, *case[1:]
    ).run(DURATION)
    releases, sticks, again = (run.attrs[name] for name in ("releases", "sticks", "re_releases"))
    assert (releases, sticks) == (chain.releases, chain.sticks)
    # Blocks that were released again are counted as well, and are still sliding.
    assert again == releases - np.isfinite(run["release_time"].values).sum()
    assert releases - sticks == sliding(run).sum()
    assert again > 0 or case != ("stress, one-way", 0.0, "total")
    check(run, chain, tol.CHAIN)
    # The fourth-order step, as in the figure, agrees within its truncation error.
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


@pytest.mark.parametrize("scheme", LATTICES)
def test_every_block_at_or_above_the_threshold_is_released_at_once_and_none_below(scheme):
    profile = sp.Prestress(0.9, 0.9, peak=math.nextafter(1.0, 0.0))
    scene = sp.Scene("stress", profile, 5.0, 0.1, scheme=scheme, resolved_blocks=1)
    run = sp.simulate(scene, sp.Samples([0.0, 1.0, 5.0], [0.0, 0.5]))
    assert (run.attrs["releases"], run.attrs["stopped_because"]) == (0, "everything is stuck")
    assert not np.isfinite(run["release_time"].values).any()
    for name in ("slip", "slip_velocity", "slip_acceleration", "sample_slip", "sample_velocity"):
        assert not run[name].values.any(), name
    for peak, blocks in ((1.0, 1), (1.3, 17)):
        profile = sp.Prestress(0.2, 0.5, peak=peak)
        run = sp.simulate(sp.Scene("stress", profile, 0.001, 0.1, scheme=scheme))
        above = run["prestress"].values >= 1.0
        assert above.sum() == blocks
        assert np.array_equal(run["release_time"].values == 0.0, above)
        assert np.array_equal(run["slip_velocity"].values > 0.0, above)


@pytest.mark.parametrize("half", [True, False])
def test_a_second_nucleation_point_beyond_the_first_lattice_is_released_at_once(half):
    centre, profile = 80.0, sp.Prestress(0.1, 0.1, bumps=((80.0, 0.95, 1.0), (-80.0, 0.95, 1.0)))
    run = sp.simulate(sp.Scene("stress", profile, 0.01, 0.1, half_lattice=half))
    released = np.abs(run["x"].values[run["release_time"].values == 0.0])
    expected = 2 * np.count_nonzero(profile(np.arange(0.0, 2.0 * centre, 0.1)[1:]) >= 1.0)
    assert np.count_nonzero(np.abs(released - centre) < 1.0) == expected


@pytest.mark.parametrize(("level", "ratio"), [(0.0, 0.0), (-0.6, 5.0)], ids=["three", "one"])
def test_the_lowest_stress_of_a_stuck_block_is_not_above_what_is_left_at_the_end(level, ratio):
    values = {"gamma": 0.65, "max_step": 0.05, "order": 8, "resolved_blocks": 1}
    profile = sp.Prestress(level, level)
    scene = sp.Scene("displacement", profile, 40.0, 1.0, friction_ratio=ratio, **values)
    run = sp.simulate(scene)
    lowest = elastic_stress(run)[~sliding(run)].min()
    assert run.attrs["min_stuck_stress"] <= lowest + tol.STRESS_AT_END
    if lowest <= scene.reverse_threshold:
        assert "reverse_sliding" in run.attrs["run_flags"]
