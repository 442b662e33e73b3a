"""The list of sliding runs against a mask of blocks."""

from __future__ import annotations

import numpy as np
import pytest
from reference.from_python import from_python

from slippulse.solver.segments import release_block, stick_block

BLOCKS = 24


def runs_of(mask: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return list(zip(edges[0::2].tolist(), edges[1::2].tolist(), strict=True))


class RunList:
    """The list as the lattice keeps it: two arrays and a number."""

    def __init__(self, runs: list[tuple[int, int]]) -> None:
        self.starts, self.ends = np.zeros(BLOCKS, dtype=np.int64), np.zeros(BLOCKS, dtype=np.int64)
        self.n = len(runs)
        for r, (start, end) in enumerate(runs):
            self.starts[r], self.ends[r] = start, end

    def release(self, block: int) -> list[tuple[int, int]]:
        self.n = from_python(release_block)(self.starts, self.ends, self.n, block)
        return self.runs()

    def stick(self, block: int) -> list[tuple[int, int]]:
        self.n = from_python(stick_block)(self.starts, self.ends, self.n, block)
        return self.runs()

    def runs(self) -> list[tuple[int, int]]:
        return list(zip(self.starts[: self.n].tolist(), self.ends[: self.n].tolist(), strict=True))


@pytest.mark.parametrize(
    ("before", "block", "after"),
    [
        ([], 5, [(5, 6)]),
        ([(5, 8)], 8, [(5, 9)]),
        ([(5, 8)], 4, [(4, 8)]),
        ([(2, 4), (5, 8)], 4, [(2, 8)]),
        ([(2, 4), (5, 8), (10, 12)], 4, [(2, 8), (10, 12)]),
        ([(5, 8)], 2, [(2, 3), (5, 8)]),
        ([(5, 8)], 12, [(5, 8), (12, 13)]),
        ([(2, 3), (8, 9)], 5, [(2, 3), (5, 6), (8, 9)]),
    ],
    ids=["first", "extend right", "extend left", "join", "join of three", "before", "after", "between"],
)
def test_release(before, block, after):
    assert RunList(before).release(block) == after


@pytest.mark.parametrize(
    ("before", "block", "after"),
    [
        ([(5, 6)], 5, []),
        ([(2, 4), (5, 6), (8, 9)], 5, [(2, 4), (8, 9)]),
        ([(5, 8)], 5, [(6, 8)]),
        ([(5, 8)], 7, [(5, 7)]),
        ([(5, 8)], 6, [(5, 6), (7, 8)]),
        ([(1, 3), (5, 9), (12, 14)], 6, [(1, 3), (5, 6), (7, 9), (12, 14)]),
    ],
    ids=["last", "end one of three", "shorten left", "shorten right", "split", "split one of three"],
)
def test_stick(before, block, after):
    assert RunList(before).stick(block) == after


@pytest.mark.parametrize("seed", range(20))
def test_random_sequences_agree_with_a_mask(seed):
    random = np.random.default_rng(seed)
    mask = random.random(BLOCKS) < random.random()
    runs = RunList(runs_of(mask))
    for _ in range(300):
        block = int(random.integers(BLOCKS))
        changed = runs.stick(block) if mask[block] else runs.release(block)
        mask[block] = not mask[block]
        assert changed == runs_of(mask)
