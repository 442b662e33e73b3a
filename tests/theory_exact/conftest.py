"""All inputs of the exact theory are moved by some last digits where SLIPPULSE_NUDGED is set."""

import os

import numpy as np
import pytest
from nudges import nudged

from slippulse.theory import domains, fast_front, rupture


@pytest.fixture(autouse=True)
def inputs_nudged_in_their_last_bits(monkeypatch):
    """Move keys of a rupture, positions and times, by a seed that repeats a failure."""
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

    def nudged_numbers(key, value, **bounds):
        return np.array(nudged(as_numbers(key, value, **bounds), rng))

    for module in (rupture, domains):
        monkeypatch.setattr(module, "as_numbers", nudged_numbers)
