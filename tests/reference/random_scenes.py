"""Random valid scenes, small enough to run by the hundred, extremes included."""

from __future__ import annotations

from hypothesis import strategies as st

import slippulse as sp
from slippulse.model.scene import LATTICE_SCHEMES, ORDERS, RELEASES
from slippulse.model.stability import largest_step


def real(low: float, high: float, *extremes: float) -> st.SearchStrategy[float]:
    """A number of an interval, or one of the extremes."""
    anywhere = st.floats(low, high, allow_subnormal=False)
    return st.one_of(st.sampled_from(extremes), anywhere) if extremes else anywhere


# Levels far below and just below the threshold, at and beside 0.
LEVELS = real(-3.0, 0.95, -3.0, -1.0, -1e-9, 0.0, 1e-9, 0.5, 0.95)
RATIOS = real(0.0, 1.0, 0.0, 1e-6, 0.1, 1.0, 1.5, 2.0, 3.0)
STEP = st.tuples(st.one_of(real(-15.0, -0.5), real(0.5, 15.0)), real(-3.0, 0.95))
BUMP = st.tuples(real(-15.0, 15.0), real(-2.0, 1.5), real(0.5, 3.0))


@st.composite
def random_scenes(draw) -> sp.Scene:
    """A valid scene of a few thousand block updates to some millions."""
    dx = draw(st.sampled_from([0.1, 0.2, 0.37, 1.0]))
    boundary = draw(st.sampled_from(["displacement", "stress"]))
    exponent = draw(st.one_of(real(-1.0, 1.0), real(-6.0, 1.0)))
    gamma = 10.0**exponent if boundary == "displacement" else 0.0
    left = draw(LEVELS)
    profile = sp.Prestress(
        left=left,
        right=draw(st.one_of(st.just(left), LEVELS)),
        width=max(dx, draw(real(0.1, 5.0))),
        peak=draw(st.sampled_from([1.0, 1.5, 1.0, 0.99])),
        steps=tuple(draw(st.lists(STEP, max_size=2, unique_by=lambda step: step[0]))),
        bumps=tuple(draw(st.lists(BUMP, max_size=2))),
    )
    ratio, order, scheme = draw(RATIOS), draw(st.sampled_from(ORDERS)), draw(st.sampled_from(LATTICE_SCHEMES))
    bound = largest_step(scheme, order, ratio, gamma * dx**2)
    return sp.Scene(
        boundary=boundary,
        prestress=profile,
        duration=draw(st.one_of(real(0.5, 3.0), real(5.0, 10.0))),
        dx=dx,
        gamma=gamma,
        beta=ratio * dx,
        release=draw(st.sampled_from(RELEASES)),
        scheme=scheme,
        max_step=min(0.5, 0.9 * bound) * draw(st.sampled_from([0.25, 0.5, 1.0])),
        order=order,
    )
