"""Inner loops of the Taylor step: each a plain pass over the blocks first..last-1 of whole rows.

Row k of ``w`` is the k-th time derivative of slip. The loops count in unsigned integers, since an
index that could be negative would be tested for wrapping, which costs a factor 4 to 10. They take
``w`` as one array, since every view of a row that is handed to a function costs 30 ns, more than
the pass over a narrow pulse.
"""

import numpy as np

from .jit import inner

ONE = np.uint64(1)


@inner(inline=True)
def blocks(first, last):
    """The blocks first..last-1, as unsigned integers."""
    return range(np.uint64(first), np.uint64(max(first, last)))


@inner(inline=True)
def second_difference(w, k, i):
    """Second difference of row k around block i, as the difference of two differences."""
    return (w[k, i + ONE] - w[k, i]) - (w[k, i] - w[k, i - ONE])


@inner(inline=True)
def first_acceleration(w, strain, tau, first, last, per_dx, leaf, damping):
    """Acceleration of each block: strain difference, leaf spring, pre-stress, damping."""
    for i in blocks(first, last):
        # Second differences of slip would cancel where slip is large (gamma -> 0).
        force = per_dx * (strain[i] - strain[i - ONE]) - leaf * w[0, i] + tau[i]
        w[2, i] = force + damping * second_difference(w, 1, i) if damping != 0.0 else force


@inner(inline=True)
def derivative(w, k, i, per_dx2, leaf, damping):
    """Time derivative k of the slip of block i from the two before it."""
    elastic = per_dx2 * second_difference(w, k - 2, i) - leaf * w[k - 2, i]
    return elastic + damping * second_difference(w, k - 1, i) if damping != 0.0 else elastic


@inner(inline=True)
def nest(inner, w, k, weight, lower_weight, first, last):
    """Two levels of a Taylor polynomial, in place: w[k-1] + lower_weight (w[k] + weight inner)."""
    for i in blocks(first, last):
        inner[i] = w[k - 1, i] + lower_weight * (w[k, i] + weight * inner[i])


@inner(inline=True)
def velocity_after(out, w, first, last, step, order):
    """Velocity of blocks first..last-1 after a time ``step``. Returns how many may stop by then."""
    k = order
    if order % 2 == 1:
        for i in blocks(first, last):
            out[i] = w[order + 1, i]
    else:
        weight = step / order
        for i in blocks(first, last):
            out[i] = w[order, i] + weight * w[order + 1, i]
        k = order - 1
    while k > 3:
        nest(out, w, k, step / k, step / (k - 1), first, last)
        k -= 2
    count = np.int64(0)
    half, third = step / 2.0, step / 3.0
    for i in blocks(first, last):
        after = w[1, i] + step * (w[2, i] + half * (w[3, i] + third * out[i]))
        out[i] = after
        # A block may stop if its velocity is below 0 or NaN after the step. If it dips below 0 and
        # returns, its tangent at the start shows it.
        count += (not (after >= 0.0)) | (w[1, i] + step * w[2, i] < 0.0)
    return count


@inner(inline=True)
def advance_slip(w, velocity, first, last, step, order):
    """Advance slip by its Taylor polynomial, and velocity; the slip increment is left in w[2]."""
    inner = w[order + 1]
    k = order
    while k > 4:
        nest(inner, w, k, step / (k + 1), step / k, first, last)
        k -= 2
    half, third = step / 2.0, step / 3.0
    fourth, fifth = step / 4.0, step / 5.0
    for i in blocks(first, last):
        rest = w[3, i] + fourth * (w[4, i] + fifth * inner[i] if k == 4 else inner[i])
        increment = step * (w[1, i] + half * (w[2, i] + third * rest))
        w[2, i] = increment
        w[0, i] += increment
        w[1, i] = velocity[i]


@inner(reorder=True)
def stretching(w, first, last):
    """Sums of (dv)^2 and dv da between neighbours: viscous dissipation and half its slope."""
    square, product = 0.0, 0.0
    for i in blocks(first, last):
        dv = w[1, i + ONE] - w[1, i]
        square += dv * dv
        product += dv * (w[2, i + ONE] - w[2, i])
    return square, product
