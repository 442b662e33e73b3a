"""The sliding part of the lattice as a sorted list of contiguous runs, [start, end) each."""

from __future__ import annotations

from .jit import compiled


@compiled(inline=True)
def release_block(starts, ends, n, block):
    """Add a stuck block to the runs: extend, join or begin one. Returns the new number of runs."""
    r = 0
    while r < n and ends[r] < block:
        r += 1
    joins_left = r < n and ends[r] == block
    if joins_left:
        ends[r] = block + 1
        if r + 1 < n and starts[r + 1] == block + 1:
            ends[r] = ends[r + 1]
            for q in range(r + 1, n - 1):
                starts[q] = starts[q + 1]
                ends[q] = ends[q + 1]
            return n - 1
        return n
    if r < n and starts[r] == block + 1:
        starts[r] = block
        return n
    for q in range(n, r, -1):
        starts[q] = starts[q - 1]
        ends[q] = ends[q - 1]
    starts[r] = block
    ends[r] = block + 1
    return n + 1


@compiled(inline=True)
def stick_block(starts, ends, n, block):
    """Take a sliding block out of the runs: shorten, split or end one. Returns the new number of runs."""
    r = 0
    while ends[r] <= block:
        r += 1
    at_start = starts[r] == block
    at_end = ends[r] == block + 1
    if at_start and at_end:
        for q in range(r, n - 1):
            starts[q] = starts[q + 1]
            ends[q] = ends[q + 1]
        return n - 1
    if at_start:
        starts[r] = block + 1
        return n
    if at_end:
        ends[r] = block
        return n
    for q in range(n, r + 1, -1):
        starts[q] = starts[q - 1]
        ends[q] = ends[q - 1]
    starts[r + 1] = block + 1
    ends[r + 1] = ends[r]
    ends[r] = block
    return n + 1


@compiled(inline=True)
def holds(starts, ends, n, block):
    """Whether a block is in one of the runs."""
    r = 0
    while r < n and ends[r] <= block:
        r += 1
    return r < n and starts[r] <= block
