"""The sliding blocks as a sorted list of segments: contiguous stretches [start, end).

The list is edited in place when a block begins or ceases to slide.
"""

from .jit import kernel_function


@kernel_function(inline=True)
def find_edge(edges, edge_count, block):
    """Return the position of the first edge that is at least ``block``."""
    position = 0
    while position < edge_count and edges[position] < block:
        position += 1
    return position


@kernel_function(inline=True)
def toggle_block(segments, block):
    """Add a block at rest to the segments, or remove a sliding block from them.

    A block has two sides, numbered ``block`` and ``block + 1``. Either way, each side that was an
    edge of a segment no longer is one, and each other side becomes an edge.
    """
    edges, edge_count = segments.edges, 2 * segments.count.n
    position = find_edge(edges, edge_count, block)
    is_left_edge = position < edge_count and edges[position] == block
    following = position + 1 if is_left_edge else position
    is_right_edge = following < edge_count and edges[following] == block + 1
    if is_left_edge and is_right_edge:
        # Remove both edges.
        for k in range(position, edge_count - 2):
            edges[k] = edges[k + 2]
        segments.count.n -= 1
    elif is_left_edge:
        edges[position] = block + 1
    elif is_right_edge:
        edges[position] = block
    else:
        # Insert both edges.
        for k in range(edge_count - 1, position - 1, -1):
            edges[k + 2] = edges[k]
        edges[position], edges[position + 1] = block, block + 1
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
