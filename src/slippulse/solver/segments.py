"""The sliding blocks as a sorted list of segments: contiguous stretches [start, end).

The list is edited in place when a block begins or ceases to slide.
"""

from .jit import kernel_function


@kernel_function(inline=True)
def toggle_block(segments, block):
    """Add a block at rest to the segments, or remove a sliding block from them.

    Either way, each side of the block that was an edge of a segment no longer is one, and each
    other side becomes an edge.
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


@kernel_function(inline=True)
def contains_block(segments, block):
    """Return True if a block is in one of the segments."""
    for r in range(segments.count.n):
        if segments.edges[2 * r] <= block < segments.edges[2 * r + 1]:
            return True
    return False


@kernel_function(inline=True)
def count_sliding_neighbours(segments, block):
    """Return the numbers of adjacent sliding blocks to the left and to the right of a block."""
    left, right = 0, 0
    for r in range(segments.count.n):
        if segments.edges[2 * r] < block <= segments.edges[2 * r + 1]:
            left = block - segments.edges[2 * r]
        if segments.edges[2 * r] <= block + 1 < segments.edges[2 * r + 1]:
            right = segments.edges[2 * r + 1] - block - 1
    return left, right
