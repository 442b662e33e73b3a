"""The sliding blocks as a sorted list of segments, contiguous stretches [start, end)."""

from .jit import inner


@inner()
def release_block(segments, block):
    """Add a block to the segments, unless it is in one: extend, join or begin one."""
    starts, ends = segments.starts, segments.ends
    n = segments.count.n
    r = 0
    while r < n and ends[r] < block:
        r += 1
    if r == n or block + 1 < starts[r]:
        insert(segments, r, block, block + 1)
    elif block + 1 == starts[r]:
        starts[r] = block
    elif block == ends[r]:
        ends[r] = block + 1
        if r + 1 < n and starts[r + 1] == block + 1:
            ends[r] = ends[r + 1]
            remove(segments, r + 1)


@inner()
def stick_block(segments, block):
    """Take a sliding block out of the segments: shorten, split or end one."""
    starts, ends = segments.starts, segments.ends
    r = 0
    while ends[r] <= block:
        r += 1
    at_start = starts[r] == block
    at_end = ends[r] == block + 1
    if at_start and at_end:
        remove(segments, r)
    elif at_start:
        starts[r] = block + 1
    elif at_end:
        ends[r] = block
    else:
        insert(segments, r + 1, block + 1, ends[r])
        ends[r] = block


@inner()
def insert(segments, r, start, end):
    """Make [start, end) segment number r."""
    starts, ends = segments.starts, segments.ends
    for q in range(segments.count.n, r, -1):
        starts[q], ends[q] = starts[q - 1], ends[q - 1]
    starts[r], ends[r] = start, end
    segments.count.n += 1


@inner()
def remove(segments, r):
    """Take segment number r out of the list."""
    starts, ends = segments.starts, segments.ends
    for q in range(r, segments.count.n - 1):
        starts[q], ends[q] = starts[q + 1], ends[q + 1]
    segments.count.n -= 1


@inner(inline=True)
def sliding_beside(segments, block):
    """Number of blocks that slide without a gap to the left of a block, and to its right."""
    left, right = 0, 0
    for r in range(segments.count.n):
        if segments.starts[r] < block <= segments.ends[r]:
            left = block - segments.starts[r]
        if segments.starts[r] <= block + 1 < segments.ends[r]:
            right = segments.ends[r] - block - 1
    return left, right
