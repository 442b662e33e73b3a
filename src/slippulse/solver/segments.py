"""The sliding blocks as a sorted list of segments: contiguous stretches [start, end).

The edges of a segment are its first block and the block after its last one. The list of all edges
is changed in place when a block begins or ceases to slide.
"""

from .jit import kernel_function


@kernel_function(inline=True)
def find_edge(edges, edge_count, block):
    """Return the position in the list of the first edge that is not smaller than ``block``.

    edges, edge_count : array with the list of edges, and its number of used elements
    """
    position = 0
    while position < edge_count and edges[position] < block:
        position += 1
    return position


@kernel_function(inline=True)
def toggle_block(segments, block):
    """Add a block at rest to the segments, or remove a sliding block from them.

    In the list of edges, the left side of the block has the number ``block``, and its right side
    the number ``block + 1``. In either case, each side that is an edge is removed from the list,
    and each side that is not is added.
    """
    edges, edge_count = segments.edges, 2 * segments.count.n
    position = find_edge(edges, edge_count, block)
    is_left_edge = position < edge_count and edges[position] == block
    right_position = position + 1 if is_left_edge else position
    is_right_edge = right_position < edge_count and edges[right_position] == block + 1
    if is_left_edge and is_right_edge:
        # Remove both sides.
        for k in range(position, edge_count - 2):
            edges[k] = edges[k + 2]
        segments.count.n -= 1
    elif is_left_edge:
        # Replace the left side by the right one.
        edges[position] = block + 1
    elif is_right_edge:
        # Replace the right side by the left one.
        edges[position] = block
    else:
        # Insert both sides.
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
    """Return the numbers of adjacent sliding blocks to the left and to the right of a block.

    The blocks are counted up to the next block at rest. The block itself may slide or be at rest.
    """
    left, right = 0, 0
    for r in range(segments.count.n):
        start, end = segments.edges[2 * r], segments.edges[2 * r + 1]
        if start < block <= end:
            left = block - start
        if start <= block + 1 < end:
            right = end - block - 1
    return left, right
