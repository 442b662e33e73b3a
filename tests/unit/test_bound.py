"""What a run takes is bounded before it runs: random scenes over the whole documented range, edges included."""

from __future__ import annotations

import random

import pytest
from reference.wide_scenes import wide_scene

import slippulse as sp
from slippulse.configuration.resolve import bound_of

# Undamped blocks that slip again and again cut steps short.
SMALL_FACTOR = 3.0


@pytest.mark.parametrize("seed", range(3))
def test_the_bound_is_not_exceeded_by_more_than_a_small_factor(seed):
    chance, tried = random.Random(seed), 0
    for scene in (wide_scene(chance) for _ in range(60)):
        bound = bound_of(scene).block_updates
        if bound > 2e7:
            continue
        try:
            run = sp.simulate(scene)
        except sp.UnstableRun:
            continue
        tried += 1
        assert run.attrs["block_updates"] < SMALL_FACTOR * bound, scene
        assert run.nbytes < bound_of(scene).bytes, scene
    assert tried > 5


def test_slipping_again_and_again_is_bounded():
    """Undamped, at pre-stress 0, of a nucleation about as wide as a block: 40,000 blocks are released again."""
    scene = sp.Scene(
        "displacement", sp.Prestress(0.0, 0.0, 0.76), 400.0, 0.76, gamma=8e-8, order=8, max_step=1.0
    )
    run = sp.simulate(scene)
    assert run.attrs["re_releases"] > 10_000
    assert run.attrs["block_updates"] < SMALL_FACTOR * bound_of(scene).block_updates
