"""Random valid scenes, small enough to run by the hundred, extremes included."""

from __future__ import annotations

import math

from hypothesis import strategies as st

import slippulse as sp
from slippulse.model.scene import LATTICE_SCHEMES, ORDERS, RELEASES
from slippulse.model.stability import largest_step

# Levels far below and just below the threshold, at and beside 0.
LEVELS = st.one_of(
    st.sampled_from([-3.0, -1.0, -1e-9, 0.0, 1e-9, 0.5, 0.95]), st.floats(-3.0, 0.95, allow_subnormal=False)
)
RATIOS = st.one_of(
    st.sampled_from([0.0, 1e-6, 0.1, 1.0, 1.5, 2.0, 3.0]), st.floats(0.0, 1.0, allow_subnormal=False)
)
STEP = st.tuples(
    st.one_of(st.floats(-15.0, -0.5), st.floats(0.5, 15.0)), st.floats(-3.0, 0.95, allow_subnormal=False)
)
BUMP = st.tuples(st.floats(-15.0, 15.0), st.floats(-2.0, 1.5), st.floats(0.5, 3.0))


@st.composite
def random_scenes(draw, schemes: tuple[str, ...] = LATTICE_SCHEMES) -> sp.Scene:
    """A valid scene of a few thousand block updates to some millions."""
    dx = draw(st.sampled_from([0.1, 0.2, 0.37, 1.0]))
    boundary = draw(st.sampled_from(["displacement", "stress"]))
    gamma = (
        10.0 ** draw(st.one_of(st.floats(-1.0, 1.0), st.floats(-6.0, 1.0)))
        if boundary == "displacement"
        else 0.0
    )
    left = draw(LEVELS)
    profile = sp.Prestress(
        left=left,
        right=draw(st.one_of(st.just(left), LEVELS)),
        width=max(dx, draw(st.floats(0.1, 5.0))),
        peak=draw(st.sampled_from([1.0, 1.5, 1.0, 0.99])),
        steps=tuple(draw(st.lists(STEP, max_size=2, unique_by=lambda step: step[0]))),
        bumps=tuple(draw(st.lists(BUMP, max_size=2))),
    )
    ratio, order = draw(RATIOS), draw(st.sampled_from(ORDERS))
    scheme = draw(st.sampled_from(schemes))
    bound = largest_step(scheme, order, ratio, gamma * dx**2)
    return sp.Scene(
        boundary=boundary,
        prestress=profile,
        duration=draw(st.one_of(st.floats(0.5, 3.0), st.floats(5.0, 10.0))),
        dx=dx,
        gamma=gamma,
        beta=ratio * dx,
        release=draw(st.sampled_from(RELEASES)),
        scheme=scheme,
        max_step=min(0.5, 0.9 * bound) * draw(st.sampled_from([0.25, 0.5, 1.0])),
        order=order,
    )


def mirrored(scene: sp.Scene) -> sp.Scene:
    """The same scene with left and right exchanged."""
    import dataclasses

    profile = scene.prestress
    return dataclasses.replace(
        scene,
        prestress=sp.Prestress(
            profile.right,
            profile.left,
            profile.width,
            profile.peak,
            tuple((-position, level) for position, level in profile.steps),
            tuple((-centre, amplitude, width) for centre, amplitude, width in profile.bumps),
        ),
    )


def sampled(scene: sp.Scene) -> sp.Samples:
    """Samples over the whole run, some way to each side."""
    import numpy as np

    reach = math.ceil(scene.duration) + 2.0
    return sp.Samples(np.linspace(0.0, scene.duration, 25), np.linspace(-reach, reach, 41))
