"""The front law against the steady state found block by block and against lattice runs; admissibility."""

from __future__ import annotations

import numpy as np
import pytest

import slippulse as sp
from slippulse.theory import lattice_front_speed, prestress_for_speed, steady_front

# Two evaluations that share nothing but the equation of motion: rounding of a linear system of 200.
BLOCK_BY_BLOCK = 1e-11
# Localised events of order 8, a steady pulse long settled: what is left is the sticking behind the front.
LATTICE = 3e-4


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize(
    ("v", "b", "g"), [(1.2, 0.1, 0.01), (1.05, 0.3, 0.3), (2.0, 1.0, 0.65), (1.5, 0.3, 3.0), (1.2, 0.1, 0.0)]
)
def test_block_by_block(v, b, g, release):
    front = steady_front(v, b, g, release, blocks=100 if g == 0.0 else 60)
    if g == 0.0:
        assert front.prestress == pytest.approx(prestress_for_speed(v, b, release), rel=BLOCK_BY_BLOCK)
    else:
        found = lattice_front_speed(front.prestress, g, 1.0, b, release)
        assert found == pytest.approx(v, rel=BLOCK_BY_BLOCK)
    assert front.admissible and front.ahead[-1] == pytest.approx(1.0)
    assert np.all(np.diff(front.ahead) > 0.0)


@pytest.mark.parametrize(
    ("tau", "gamma", "dx", "b", "release"),
    [
        (0.6, 0.05, 1.0, 0.1, "total"),
        (0.6, 0.05, 1.0, 0.1, "elastic"),
        (0.6, 0.3, 1.0, 0.1, "elastic"),
        (0.8, 0.5, 1.0, 0.2, "total"),
        (0.9, 1.0, 1.0, 0.3, "elastic"),
        (0.5, 0.5, 1.0, 3.0, "total"),
        (0.5, 0.65, 0.2, 0.3, "total"),
        (0.4, 1.0, 0.1, 1.0, "elastic"),
    ],
)
def test_lattice(tau, gamma, dx, b, release):
    speed = lattice_front_speed(tau, gamma, dx, b, release)
    run = sp.simulate(
        sp.Scene(
            boundary="displacement", gamma=gamma, beta=b * dx, dx=dx, release=release, order=8, max_step=0.15,
            prestress=sp.Prestress(tau, tau, max(1.0, dx)), duration=600.0 * dx / speed, resolved_blocks=1,
        )
    )  # fmt: skip
    x, t = run.x.to_numpy(), run.release_time.to_numpy()
    late = (x > 400.0 * dx) & np.isfinite(t)
    assert np.polyfit(t[late], x[late], 1)[0] == pytest.approx(speed, rel=LATTICE)


def test_refused():
    with pytest.raises(ValueError, match=r"speed: 0.9; allowed: .*> 1"):
        steady_front(0.9, 0.1)
    with pytest.raises(ValueError, match=r"damping_ratio: 1000.0; allowed"):
        steady_front(1.5, 1000.0)
