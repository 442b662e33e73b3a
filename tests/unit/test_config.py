"""The shipped configuration: what its sweeps are, and that a run takes no more than its bound says."""

import random

import pytest
from reference.wide_scenes import wide_scene

import slippulse as sp
from slippulse.configuration.expand import expand
from slippulse.configuration.resolve import bound_of, resolve

# Undamped blocks that slip again and again cut steps short.
SMALL_FACTOR = 3.0


@pytest.fixture
def scenes_of(shipped):
    """A function that returns a shipped sweep and its scenes at preset paper, on its lattice or a coarser one."""

    def scenes(name: str, coarser: float = 1.0):
        sweep = resolve(shipped["simulations"][name], shipped["model"], shipped["presets"]["paper"], coarser)
        return sweep, expand(sweep)[0]

    return scenes


def test_a_sweep_is_the_product_of_its_lists(scenes_of):
    sweep, scenes = scenes_of("scaling_stress")
    assert len(scenes) == len(sweep["left"]) * len(sweep["width"]) >= 60
    assert {scene.prestress.left for scene in scenes} == set(sweep["left"])
    assert all(scene.damping_ratio == pytest.approx(0.1) for scene in scenes)


def test_a_coarser_lattice_keeps_the_damping_ratio(scenes_of):
    (_, fine), (_, coarse) = (scenes_of("steady_displacement", coarser) for coarser in (1.0, 2.0))
    for a, b in zip(fine, coarse, strict=True):
        assert (b.dx, b.damping_ratio) == pytest.approx((2.0 * a.dx, a.damping_ratio))
        assert b.duration == a.duration


def test_the_paper_preset_is_the_published_lattice(scenes_of):
    _, (scene,) = scenes_of("space_time_displacement")
    assert (scene.dx, scene.beta) == (0.01, pytest.approx(1e-3))
    assert (scene.prestress.left, scene.gamma, scene.release) == (0.25, 0.55, "total")


def test_the_sweeps_cover_what_the_paper_states(shipped):
    sweep, held = (shipped["simulations"][f"scaling_{boundary}"] for boundary in ("displacement", "stress"))
    assert min(sweep["left"]) <= 0.1 and max(sweep["left"]) >= 0.9
    assert min(sweep["gamma"]) <= 1e-3 and max(sweep["gamma"]) >= 1.0
    assert len(sweep["left"]) * len(sweep["gamma"]) >= 60
    assert min(held["left"]) <= -2.0 and max(held["left"]) >= -0.1
    assert min(held["width"]) <= 0.5 and max(held["width"]) >= 16.0
    for name in ("damping_displacement", "damping_stress"):
        ratios = sorted(shipped["simulations"][name]["damping_ratio"])
        assert ratios[0] == 0.0 < ratios[1] and len(ratios) >= 5 and ratios[-1] / ratios[1] >= 100.0


@pytest.mark.parametrize("seed", range(3))
def test_the_bound_is_not_exceeded_by_more_than_a_small_factor(seed):
    """Random scenes over the whole documented range, edges included."""
    chance, tried = random.Random(seed), 0
    for scene in (wide_scene(chance) for _ in range(60)):
        bound = bound_of(scene)
        if bound.block_updates > 2e7:
            continue
        try:
            run = sp.simulate(scene)
        except sp.UnstableRun:
            continue
        tried += 1
        assert run.attrs["block_updates"] < SMALL_FACTOR * bound.block_updates, scene
        assert run.nbytes < bound.bytes, scene
    assert tried > 5


def test_slipping_again_and_again_is_bounded():
    """Undamped, at pre-stress 0, of a nucleation about as wide as a block: 40,000 blocks are released again."""
    profile = sp.Prestress(0.0, 0.0, 0.76)
    scene = sp.Scene("displacement", profile, 400.0, 0.76, gamma=8e-8, order=8, max_step=1.0)
    run = sp.simulate(scene)
    assert run.attrs["re_releases"] > 10_000
    assert run.attrs["block_updates"] < SMALL_FACTOR * bound_of(scene).block_updates
