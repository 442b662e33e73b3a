"""Inner loops of the Taylor step: each is a plain pass over the blocks first..last-1.

Row k of ``w`` is the k-th time derivative of slip, and its columns are the blocks.

The loops count in unsigned integers. Numba would test an index that can be negative for wrapping,
which makes a loop 4 to 10 times slower. The functions take ``w`` as one array, because each row
that is passed separately costs 30 ns, more than the pass over a narrow pulse.
"""

import numpy as np

from .arrays import ACCELERATION, SLIP, SLIP_INCREMENT, VELOCITY
from .jit import kernel_function

UNSIGNED_ONE = np.uint64(1)


@kernel_function(inline=True)
def block_range(first, last):
    """Return the range of the blocks first..last-1, in unsigned integers."""
    return range(np.uint64(first), np.uint64(max(first, last)))


@kernel_function(inline=True)
def second_difference(w, k, i):
    """Return the second difference of row k at block i, w[k, i+1] - 2 w[k, i] + w[k, i-1]."""
    return (w[k, i + UNSIGNED_ONE] - w[k, i]) - (w[k, i] - w[k, i - UNSIGNED_ONE])


@kernel_function(inline=True)
def compute_accelerations(w, strain, tau, first, last, inverse_dx, leaf, damping):
    """Compute the accelerations of blocks first..last-1 from the equation of motion.

    The forces come from differences of strain, leaf springs, pre-stress and damping. Those of
    friction are subtracted elsewhere. Row k of ``w`` is time derivative k of slip.

    leaf : stiffness of the leaf springs
    damping : beta/dx^2
    """
    for i in block_range(first, last):
        # Where slip is large (gamma -> 0), second differences of slip would lose digits. The stored
        # strain does not.
        elastic = inverse_dx * (strain[i] - strain[i - UNSIGNED_ONE])
        force = elastic - leaf * w[SLIP, i] + tau[i]
        w[ACCELERATION, i] = (
            force + damping * second_difference(w, VELOCITY, i) if damping != 0.0 else force
        )


@kernel_function(inline=True)
def next_derivative(w, k, i, inverse_dx2, leaf, damping):
    """Return time derivative k of the slip of block i, from the derivatives k - 2 and k - 1.

    The equation of motion, differentiated k - 2 times, gives this derivative. ``leaf`` is the
    stiffness of the leaf springs, and ``damping`` is beta/dx^2.
    """
    elastic = inverse_dx2 * second_difference(w, k - 2, i) - leaf * w[k - 2, i]
    return elastic + damping * second_difference(w, k - 1, i) if damping != 0.0 else elastic


@kernel_function(inline=True)
def add_two_taylor_terms(nested, w, k, weight, lower_weight, first, last):
    """Add two terms to the Taylor polynomials of blocks, which are summed in nested form, in place.

    The new value of ``nested`` is w[k-1] + lower_weight (w[k] + weight nested).
    """
    for i in block_range(first, last):
        nested[i] = w[k - 1, i] + lower_weight * (w[k, i] + weight * nested[i])


@kernel_function(inline=True)
def compute_velocities(out, w, first, last, step, order):
    """Compute the velocities of blocks first..last-1 after a time ``step``, in ``out``.

    Horner's rule sums the Taylor polynomial of degree ``order``, whose coefficients are the time
    derivatives w[1], w[2], ... of slip, from its innermost parenthesis outwards:
    w[1] + step (w[2] + step/2 (w[3] + step/3 (w[4] + ... step/order w[order + 1]))).

    Returns the number of blocks that may stop within this time.
    """
    # ``out`` holds the parenthesis that begins with w[k + 1]: at first the innermost one, or the
    # next one if the order is even, so that k is odd. Each further pass over the blocks adds two
    # terms and lowers k by 2, down to 3. The last pass adds the other terms.
    k = order
    if order % 2 == 1:
        for i in block_range(first, last):
            out[i] = w[order + 1, i]
    else:
        weight = step / order
        for i in block_range(first, last):
            out[i] = w[order, i] + weight * w[order + 1, i]
        k = order - 1
    while k > 3:
        add_two_taylor_terms(out, w, k, step / k, step / (k - 1), first, last)
        k -= 2
    may_stop_count = np.int64(0)
    half, third = step / 2.0, step / 3.0
    for i in block_range(first, last):
        after = w[1, i] + step * (w[2, i] + half * (w[3, i] + third * out[i]))
        out[i] = after
        # Count the block if its velocity is negative or NaN after the step. If it is negative only
        # for a part of the step, its tangent at the start of the step is negative at the end.
        tangent_at_end = w[1, i] + step * w[2, i]
        may_stop_count += (not (after >= 0.0)) | (tangent_at_end < 0.0)
    return may_stop_count


@kernel_function(inline=True)
def advance_slip(w, velocity, first, last, step, order):
    """Advance the slip of blocks first..last-1 by a step, with a Taylor polynomial.

    Horner's rule sums the polynomial of degree order + 1 from its innermost parenthesis outwards:
    w[0] + step (w[1] + step/2 (w[2] + ... step/(order + 1) w[order + 1])).
    The change of slip is left in row SLIP_INCREMENT of ``w``, the table of time derivatives. The
    row of velocities is replaced by ``velocity``, the velocities at the end of the step.
    """
    # ``nested`` holds the parenthesis that begins with w[k + 1]. Its memory is the highest row of
    # w, which is needed only once. Each pass over the blocks adds two terms, until k is 4 (if the
    # order is even) or 3.
    nested = w[order + 1]
    k = order
    while k > 4:
        add_two_taylor_terms(nested, w, k, step / (k + 1), step / k, first, last)
        k -= 2
    half, third = step / 2.0, step / 3.0
    fourth, fifth = step / 4.0, step / 5.0
    for i in block_range(first, last):
        # The parentheses that begin with w[4] (if k is 3, it is ``nested``) and with w[3].
        from_fourth = w[4, i] + fifth * nested[i] if k == 4 else nested[i]
        from_third = w[3, i] + fourth * from_fourth
        increment = step * (w[1, i] + half * (w[2, i] + third * from_third))
        w[SLIP_INCREMENT, i] = increment
        w[SLIP, i] += increment
        w[VELOCITY, i] = velocity[i]


@kernel_function(reorder=True)
def sum_strain_rate_products(w, first, last):
    """Return the sums of (dv)^2 and of dv da over the pairs of neighbours (i, i + 1).

    The block i runs from ``first`` to ``last`` - 1. Here dv and da are the differences of the two
    velocities and of the two accelerations. The sums give the viscous dissipation and half of its
    time derivative.
    """
    square, product = 0.0, 0.0
    for i in block_range(first, last):
        dv = w[VELOCITY, i + UNSIGNED_ONE] - w[VELOCITY, i]
        square += dv * dv
        product += dv * (w[ACCELERATION, i + UNSIGNED_ONE] - w[ACCELERATION, i])
    return square, product
