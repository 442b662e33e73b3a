"""Costs are estimated before they are met: random scenes over the whole documented range, edges included."""

from __future__ import annotations

import random
import time

import numpy as np
import pytest
from reference.wide_scenes import wide_scene

import slippulse as sp
from slippulse.configuration import cost
from slippulse.configuration.cost import (
    exceeded_limit,
    expected_cost,
    expected_seconds,
    most_expected,
    overrun_watch,
)
from slippulse.configuration.front_paths import approximate_speed, front_paths
from slippulse.model.scene import LATTICE_SCHEMES, ORDERS
from slippulse.theory import front_speed

# Of a machine: a run that takes less than this is not late.
HICCUP = 0.3


def ratios(scenes, seconds: float, blocks: float = 3e6) -> list[float]:
    """Time taken over estimate, of scenes estimated at so many seconds at most."""
    for boundary, gamma in (("stress", 0.0), ("displacement", 0.5)):
        for scheme in LATTICE_SCHEMES:
            for order in ORDERS:
                warm = {"scheme": scheme, "order": order, "gamma": gamma}
                sp.simulate(sp.Scene(boundary, sp.Prestress(0.5, 0.4), 0.3, 0.1, **warm))
    found = []
    for scene in scenes:
        expected, bytes_ = expected_seconds(scene), expected_cost([scene], [None]).bytes
        if expected > seconds or bytes_ > 500.0 * blocks:
            continue
        began = time.process_time()

        def late(share, began=began, expected=expected, scene=scene):
            taken = time.process_time() - began
            assert taken < max(HICCUP, 10.0 * expected), (scene, taken, expected)

        try:
            sp.simulate(scene, progress=late)
        except sp.UnstableRun:
            continue
        taken = time.process_time() - began
        late(1.0)
        found.append(taken / expected)
    return found


def test_a_sample_of_scenes_takes_what_is_expected():
    chance = random.Random(3)
    found = np.array(ratios((wide_scene(chance) for _ in range(60)), 0.3))
    assert found.size > 25
    assert np.mean((found > 0.2) & (found < 5.0)) > 0.9


@pytest.mark.slow
def test_a_thousand_scenes_finish_or_are_refused():
    chance = random.Random(4)
    scenes = [wide_scene(chance) for _ in range(1000)]
    assert sum(bool(exceeded_limit(expected_cost([scene], [None]))) for scene in scenes) < 300
    found = np.array(ratios(scenes, 5.0))
    assert found.size > 500
    assert np.mean((found > 1.0 / 3.0) & (found < 3.0)) > 0.98


@pytest.mark.parametrize(
    ("change", "at_least"),
    [
        ({"prestress": sp.Prestress(0.9999, 0.9999), "beta": 0.01}, 600.0),
        ({"prestress": sp.Prestress(0.5, 0.5, 1e9)}, 3600.0),
        ({"beta": 100.0, "max_step": 1e-5}, 3600.0),
    ],
    ids=["level near 1", "wide nucleation", "strong damping"],
)
def test_fronts_that_outrun_the_waves_are_expected_to_cost(change, at_least):
    usual = {"boundary": "stress", "prestress": sp.Prestress(0.5, 0.5), "duration": 20.0, "dx": 0.01}
    usual |= {"order": 8, "max_step": 0.3}
    assert expected_seconds(sp.Scene(**usual)) < 0.2
    assert expected_seconds(sp.Scene(**usual | change)) > at_least


def test_a_front_is_not_stopped_before_it_begins():
    """A dent at the middle of a very wide nucleation: the run begins beyond it."""
    dented = sp.Prestress(0.999, 0.3, 1e9, 1.0, (), ((-4.5, -1.0, 2.3),))
    scene = sp.Scene(
        "displacement", dented, 2.0, 1.0, gamma=10.0, beta=0.3, release="elastic", max_step=0.09, order=6
    )
    assert expected_seconds(scene) > 10.0


@pytest.mark.parametrize("level", [-10.0, -0.3, -0.03])
def test_momentum_is_used_up_when_a_rupture_without_springs_ends(level):
    scene = sp.Scene("stress", sp.Prestress(level, level), 300.0, 0.03, beta=0.003)
    paths = front_paths(scene)
    run = sp.simulate(scene)
    middle = np.argmin(np.abs(paths.x))
    assert paths.spent[middle] == pytest.approx(run.attrs["end_time"], rel=0.3)
    reached = np.max(paths.x[paths.release < scene.duration])
    assert reached == pytest.approx(float(run.x[np.isfinite(run.release_time)].max()), rel=0.4)


@pytest.mark.parametrize("level", [-0.01, 0.0, 0.01])
def test_fronts_that_leaf_springs_fade_stop_about_there(level):
    scene = sp.Scene("displacement", sp.Prestress(level, level), 200.0, 0.03, gamma=1.0, beta=0.009)
    paths, run = front_paths(scene), sp.simulate(scene)
    reached = np.max(paths.x[paths.release < scene.duration])
    assert reached == pytest.approx(float(run.x[np.isfinite(run.release_time)].max()), rel=0.4)


def test_strong_damping_delays_no_front_before_it_begins():
    """At a bump, away from the Gaussian."""
    bump = sp.Prestress(-0.1, 0.0, 2.6, 0.8, (), ((5.0, 1.2, 1.8),))
    scene = sp.Scene("stress", bump, 6.0, 1e-3, beta=80.0, release="elastic", max_step=8e-6, order=4)
    assert expected_seconds(scene) > 60.0


def test_the_quick_bound_is_a_bound():
    chance = random.Random(5)
    for scene in (wide_scene(chance) for _ in range(300)):
        expected, most = expected_cost([scene], [None]), most_expected([scene], [None])
        assert most.seconds >= expected.seconds and most.bytes >= expected.bytes, scene


@pytest.mark.parametrize("release", ["total", "elastic"])
def test_the_speeds_behind_it_are_about_right(release):
    for ratio in (0.0, 0.1, 1.0, 10.0):
        for level in (0.1, 0.3, 0.6, 0.9, 0.99):
            exact = front_speed(level, ratio, release) - 1.0
            assert approximate_speed(np.array(level), ratio, release) - 1.0 == pytest.approx(exact, rel=0.35)


def test_the_continuum_takes_no_steps():
    usual = {"boundary": "stress", "prestress": sp.Prestress(0.5, 0.5), "duration": 1e3, "dx": 0.01}
    exact = sp.Scene(**usual, scheme="continuum", max_step=1e9)
    assert expected_seconds(exact) == expected_seconds(sp.Scene(**usual, scheme="continuum"))


@pytest.mark.parametrize(
    ("prestress", "change", "at_least"),
    [
        (sp.Prestress(0.5, 0.5), {"gamma": 1e12, "duration": 1e-3, "dx": 0.05}, 60.0),
        (sp.Prestress(0.5, 0.5, 1e5), {"gamma": 0.65, "duration": 3.0, "dx": 0.1}, 5.0),
        (sp.Prestress(0.5, 0.5), {"gamma": 0.65, "duration": 1e4, "dx": 0.01}, 10.0),
    ],
    ids=["stiff springs", "wide nucleation", "long"],
)
def test_what_the_exact_solution_resolves_is_expected_to_cost(prestress, change, at_least):
    usual = {"boundary": "displacement", "gamma": 0.65, "duration": 3.0, "dx": 0.1, "scheme": "continuum"}
    assert expected_seconds(sp.Scene(prestress=sp.Prestress(0.5, 0.5), **usual)) < 0.5
    assert expected_seconds(sp.Scene(prestress=prestress, **usual | change)) > at_least


def test_exact_solutions_take_what_is_expected():
    chance = random.Random(6)
    sp.simulate(sp.Scene("stress", sp.Prestress(0.5, 0.4), 1.0, 0.1, scheme="continuum"))
    found = []
    for _ in range(12):
        left, right = chance.uniform(-1.0, 0.9), chance.uniform(-1.0, 0.9)
        boundary, gamma = chance.choice(
            [("stress", 0.0), ("displacement", 10.0 ** chance.uniform(-2.0, 2.0))]
        )
        duration = chance.uniform(1.0, 30.0)
        scene = sp.Scene(
            boundary, sp.Prestress(left, right), duration, 0.1, gamma=gamma, beta=0.01, scheme="continuum"
        )
        began = time.process_time()
        sp.simulate(scene)
        found.append((time.process_time() - began) / expected_seconds(scene))
    assert np.mean((np.array(found) > 0.2) & (np.array(found) < 5.0)) > 0.9


def test_a_run_far_beyond_its_estimate_says_so_once(monkeypatch):
    scene = sp.Scene("stress", sp.Prestress(0.5, 0.5), 5.0, 0.1)
    said = []
    watch = overrun_watch(scene, said.append)
    watch(0.5)
    assert said == []
    monkeypatch.setattr(cost, "WORTH_A_WORD", 0.0)
    monkeypatch.setattr(cost, "FAR_BEYOND", 1e-6)
    watch = overrun_watch(scene, said.append)
    sum(range(100_000))
    watch(0.25)
    watch(0.5)
    assert len(said) == 1 and "25% done" in said[0] and "goes on" in said[0]


def test_a_sweep_warns_of_it_and_goes_on(monkeypatch):
    monkeypatch.setattr(cost, "WORTH_A_WORD", 0.0)
    monkeypatch.setattr(cost, "FAR_BEYOND", 1e-9)
    scenes = [sp.Scene("stress", sp.Prestress(0.5, 0.5), 100.0, 0.02)] * 2
    with pytest.warns(UserWarning, match="times its estimate"):
        assert sp.run_sweep(scenes).sizes["point"] == 2
