"""How long the rows of the lattice are, at first and when it grows."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.solver.lattice import Lattice

EVEN, UNEVEN = Prestress(0.5, 0.5), Prestress(0.5, 0.4)


@pytest.mark.parametrize("profile", [EVEN, UNEVEN], ids=["half lattice", "whole lattice"])
def test_rows_begin_at_different_places_of_their_pages(profile):
    """In a page of 4096 bytes the beginnings of any two are three lines of the cache apart, or more."""
    lattice = Lattice(Scene("displacement", profile, 1.0, 0.1, gamma=0.5, order=8), None, 0.0)
    for _ in range(6):
        size = lattice.size
        rows = [*lattice.motion.w, *lattice.motion[1:]]
        places = np.sort([row.ctypes.data % 4096 for row in rows])
        assert np.diff(places, append=places[0] + 4096).min() >= 3 * 64
        assert np.abs(lattice.motion.tau[-lattice.first_block] - 1.0) < 1e-12
        lattice._grow()
        assert 2 * size <= lattice.size < 3 * size + 512
