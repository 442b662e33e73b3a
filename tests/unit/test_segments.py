"""The list of segments against a mask of sliding blocks."""

from __future__ import annotations

import numpy as np
import pytest
from reference.from_python import from_python

from slippulse.solver.arrays import make_segments
from slippulse.solver.segments import holds, release_block, sliding_beside, stick_block

BLOCKS = 24


def segments_of(mask: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return list(zip(edges[0::2].tolist(), edges[1::2].tolist(), strict=True))


class SegmentList:
    """The list as the lattice keeps it."""

    def __init__(self, segments: list[tuple[int, int]]) -> None:
        self.kept = make_segments(BLOCKS)
        self.kept.count.n = len(segments)
        for r, (start, end) in enumerate(segments):
            self.kept.starts[r], self.kept.ends[r] = start, end

    def release(self, block: int) -> list[tuple[int, int]]:
        from_python(release_block)(self.kept, block)
        return self.segments()

    def stick(self, block: int) -> list[tuple[int, int]]:
        from_python(stick_block)(self.kept, block)
        return self.segments()

    def segments(self) -> list[tuple[int, int]]:
        n = self.kept.count.n
        return list(zip(self.kept.starts[:n].tolist(), self.kept.ends[:n].tolist(), strict=True))


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
    assert SegmentList(before).release(block) == after


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
    assert SegmentList(before).stick(block) == after


@pytest.mark.parametrize("seed", range(20))
def test_random_sequences_agree_with_a_mask(seed):
    random = np.random.default_rng(seed)
    mask = random.random(BLOCKS) < random.random()
    segments = SegmentList(segments_of(mask))
    for _ in range(300):
        block = int(random.integers(BLOCKS))
        changed = segments.stick(block) if mask[block] else segments.release(block)
        mask[block] = not mask[block]
        assert changed == segments_of(mask)
        inside = int(random.integers(1, BLOCKS - 1))
        assert from_python(holds)(segments.kept, inside) == mask[inside]
        left, right = from_python(sliding_beside)(segments.kept, inside)
        assert mask[inside - left : inside].all() and (left == inside or not mask[inside - left - 1])
        assert (
            mask[inside + 1 : inside + 1 + right].all()
            and not mask[inside + 1 + right : inside + 2 + right].any()
        )
