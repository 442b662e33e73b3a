"""The sliding blocks as a sorted list of segments, contiguous stretches [start, end)."""

from .jit import inner


@inner(inline=True)
def flip(segments, block):
    """Let a block at rest slide, or a sliding one rest.

    A side of the block that was an edge of a segment ceases to be one; a side that was none is one.
    """
    edges, n = segments.edges, 2 * segments.count.n
    q = 0
    while q < n and edges[q] < block:
        q += 1
    left = q < n and edges[q] == block
    other = q + 1 if left else q
    right = other < n and edges[other] == block + 1
    if left and right:
        for k in range(q, n - 2):
            edges[k] = edges[k + 2]
        segments.count.n -= 1
    elif left or right:
        edges[q] = block + 1 if left else block
    else:
        for k in range(n - 1, q - 1, -1):
            edges[k + 2] = edges[k]
        edges[q], edges[q + 1] = block, block + 1
        segments.count.n += 1


@inner(inline=True)
def contain(segments, block):
    """True if a block is in one of the segments."""
    for r in range(segments.count.n):
        if segments.edges[2 * r] <= block < segments.edges[2 * r + 1]:
            return True
    return False


@inner(inline=True)
def sliding_beside(segments, block):
    """Number of blocks that slide without a gap to the left of a block, and to its right."""
    left, right = 0, 0
    for r in range(segments.count.n):
        if segments.edges[2 * r] < block <= segments.edges[2 * r + 1]:
            left = block - segments.edges[2 * r]
        if segments.edges[2 * r] <= block + 1 < segments.edges[2 * r + 1]:
            right = segments.edges[2 * r + 1] - block - 1
    return left, right
