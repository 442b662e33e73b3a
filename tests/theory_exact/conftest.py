"""With SLIPPULSE_NUDGED set, all inputs of the exact theory are moved by some units in the last place."""

import os

import numpy as np
import pytest
from nudges import nudged

from slippulse.theory import domains, fast_front, rupture


@pytest.fixture(autouse=True)
def inputs_nudged_in_their_last_bits(monkeypatch):
    """Keys of a rupture, positions, times and pre-stresses: by a seed, so that a failure can be repeated."""
    if not os.environ.get("SLIPPULSE_NUDGED"):
        return
    rng = np.random.default_rng(int(os.environ["SLIPPULSE_NUDGED"]))

    class Law(fast_front.FastFront):
        def __init__(self, prestress, gamma, damping_ratio, release, refinement=1, alpha=0.0):
            # Half a lattice is no other scene than the whole: equal keys give equal moves.
            rng = np.random.default_rng(abs(hash((prestress, gamma, damping_ratio))) % 2**32)
            *moved, alpha = [
                nudged(value, rng) for value in (prestress, gamma, damping_ratio, alpha)
            ]
            super().__init__(*moved, release, refinement, alpha)

    as_numbers = rupture.as_numbers
    monkeypatch.setattr(rupture, "FastFront", Law)
    for module in (rupture, domains):
        monkeypatch.setattr(
            module, "as_numbers", lambda *a, **k: np.array(nudged(as_numbers(*a, **k), rng))
        )
