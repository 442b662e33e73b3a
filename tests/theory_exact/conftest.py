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

    def nudged_law(*keys):
        # Half a lattice is no other scene than the whole: equal keys give equal moves.
        rng = np.random.default_rng(abs(hash(keys[:3])) % 2**32)
        return fast_front.FastFront(*[nudged(value, rng) for value in keys])

    as_numbers = rupture.as_numbers
    monkeypatch.setattr(rupture, "FastFront", nudged_law)

    def nudged_numbers(key, value, **bounds):
        return np.array(nudged(as_numbers(key, value, **bounds), rng))

    for module in (rupture, domains):
        monkeypatch.setattr(module, "as_numbers", nudged_numbers)
