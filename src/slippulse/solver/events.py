"""What a release or a stick changes: a difference that spreads one block a derivative.

The sliding lattice is linear, so what an event changes is a polynomial to be added to those that are there. Its first
derivative that is not zero is the second, at the block of the event; each further derivative reaches one block more,
since damping couples neighbours through their velocities (without damping it takes two derivatives). Nothing is left of
it beyond the order of the step, so that the few blocks within reach change just as the whole lattice expanded anew
would.
"""

from __future__ import annotations

import numpy as np

from .foresight import find_sticks, foresee_releases, forget_sticks
from .jit import compiled
from .stencils import REACH, SHARE, blocks, derivative

# Columns of a difference: its reach on either side of its centre, and a block at rest at each end.
CENTRE = REACH + 1
COLUMNS = 2 * CENTRE + 1


@compiled(inline=True)
def sliding_beside(starts, ends, n, block):
    """How many blocks slide without a gap to the left of a block, and to its right."""
    left, right = 0, 0
    for r in range(n):
        if starts[r] < block <= ends[r]:
            left = block - starts[r]
        if starts[r] <= block + 1 < ends[r]:
            right = ends[r] - block - 1
    return left, right


@compiled()
def later(derivatives, lowest, last, top, s):
    """Derivatives lowest..last of a polynomial, in place, a time s later; ``top`` is its highest."""
    for m in range(lowest, last + 1):
        value = derivatives[top]
        for j in range(top - 1, m - 1, -1):
            value = derivatives[j] + s * SHARE[j - m + 1] * value
        derivatives[m] = value


@compiled(inline=True)
def velocity_at(w, i, top, s):
    """Velocity of a block a time s after the step began."""
    value = w[top, i]
    for k in range(top - 1, 0, -1):
        value = w[k, i] + s * SHARE[k] * value
    return value


@compiled(inline=True)
def start(own, w, offset, strain, tau, block, now, dx, leaf, beta, top):
    """Derivatives of slip that its neighbours give a block released at ``now``, in ``own``."""
    per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
    ahead = (offset[block + 1] - offset[block]) - (offset[block] - offset[block - 1])
    force = (strain[block] - strain[block - 1]) / dx + per_dx2 * ahead + tau[block]
    force -= leaf * (w[0, block] + offset[block])
    own[2] = force + damping * (w[1, block - 1] + w[1, block + 1])
    # Two derivatives more than are kept count on the way from the start of the step to now.
    for k in range(1, top + 1):
        own[k + 2] = per_dx2 * (w[k, block - 1] + w[k, block + 1])
        if k < top:
            own[k + 2] += damping * (w[k + 1, block - 1] + w[k + 1, block + 1])
    later(own, np.int64(2), top, top + 2, now)


@compiled(inline=True)
def stop(own, w, offset, block, now, top):
    """Hold a block where it is at ``now``; less its derivatives of then are left in ``own``. Returns its velocity."""
    own[0] = 0.0
    for k in range(1, top + 1):
        own[k] = w[k, block]
        w[k, block] = 0.0
    later(own, np.int64(0), top, top, now)
    offset[block] += own[0]
    for k in range(2, top + 1):
        own[k] = -own[k]
    return own[1]


@compiled(inline=True)
def spread(difference, own, left, right, stuck, per_dx2, leaf, damping, top):
    """Derivatives of what an event changes, from ``own`` at its block, over so many sliding blocks on either side."""
    for k in range(2, top + 1):
        for p in range(np.uint64(COLUMNS)):
            difference[k, p] = 0.0
        far = k - 2 if damping != 0.0 else (k - 2) // 2
        for p in blocks(CENTRE - min(left, far), CENTRE + min(right, far) + 1):
            difference[k, p] = derivative(difference, k, p, per_dx2, leaf, damping)
        difference[k, CENTRE] = own[k] + (0.0 if stuck else difference[k, CENTRE])


@compiled(inline=True)
def evaluate(out, difference, lowest, top, s):
    """Derivative ``lowest`` of what an event changes a time s after it, in all columns but the last."""
    columns = np.uint64(COLUMNS - 1)
    j = top - 1
    if (top - lowest) % 2 == 1:
        share = s * SHARE[top - lowest]
        for p in range(columns):
            out[p] = difference[j, p] + share * difference[top, p]
        j -= 1
    else:
        for p in range(columns):
            out[p] = difference[top, p]
    # Two levels at once: half as often to memory and back.
    while j > lowest:
        share, lower_share = s * SHARE[j + 1 - lowest], s * SHARE[j - lowest]
        for p in range(columns):
            out[p] = difference[j - 1, p] + lower_share * (difference[j, p] + share * out[p])
        j -= 2


@compiled(inline=True)
def change_course(
    w, offset, strain, tau, velocity, starts, ends, n, block, stuck, now, h, release_at, stopping_block, stopping_time,
    n_stopping, difference, own, values, coefficients, slopes, mirror, total, dx, leaf, beta, top,
):  # fmt: skip
    """Change the polynomials within reach of an event at ``block`` and ``now``, and foresee their events up to h.

    ``starts`` and ``ends`` are the runs after the event; ``stuck`` says that the block has just stuck. ``offset`` is
    what slip is ahead of its polynomial by the events of this step.

    Returns
    -------
    number of foreseen sticks (-1: a velocity is not finite), first block that changed and the one after the last,
    velocity of the block before the event, lowest stress of a stuck block, sum over neighbours of dv times the change
    of da
    """
    per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
    speed, kink = 0.0, 0.0
    left, right = sliding_beside(starts, ends, n, block)
    middle = mirror and block == 1
    if middle:
        left = right
    if stuck:
        speed = stop(own, w, offset, block, now, top)
        velocity[block] = 0.0
    else:
        start(own, w, offset, strain, tau, block, now, dx, leaf, beta, top)
    if beta > 0.0:
        # Only the block of the event changes its acceleration, and it is at rest.
        beside = velocity_at(w, block + 1, top, now)
        if not middle:
            beside += velocity_at(w, block - 1, top, now)
        kink = -own[2] * beside
    spread(difference, own, left, right, stuck, per_dx2, leaf, damping, top)
    if stuck:
        # It has stopped already.
        for k in range(2, top + 1):
            difference[k, CENTRE] = 0.0

    reach = top - 2 if damping != 0.0 else (top - 2) // 2
    first, last = max(block - min(left, reach), 1), block + min(right, reach) + 1
    column = np.uint64(CENTRE) - np.uint64(block)
    evaluate(values, difference, np.int64(1), top, h - now)
    for i in blocks(first, last):
        velocity[i] += values[i + column]
    evaluate(values, difference, np.int64(0), top, -now)
    for i in blocks(first, last):
        offset[i] += values[i + column]
    for m in range(1, top + 1):
        evaluate(values, difference, m, top, -now)
        for i in blocks(first, last):
            w[m, i] += values[i + column]
    with_ghost = mirror and first <= 2
    if with_ghost:
        offset[0] = offset[2]
        for m in range(1, top + 1):
            w[m, 0] = w[m, 2]

    lowest = foresee_releases(
        release_at, coefficients, slopes, w, offset, strain, tau, starts, ends, n, now, h, mirror, dx, leaf, beta,
        total, top, first - 1, last + 1,
    )  # fmt: skip
    n_stopping = forget_sticks(stopping_block, stopping_time, n_stopping, first, last)
    n_stopping = find_sticks(
        w, velocity, first, last, last - first, stopping_block, stopping_time, n_stopping, coefficients, slopes, now,
        top, h,
    )  # fmt: skip
    return n_stopping, 0 if with_ghost else first, last, speed, lowest, kink
