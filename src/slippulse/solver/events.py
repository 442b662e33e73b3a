"""The change that an event makes: a difference that spreads one block a derivative.

The sliding lattice is linear, so an event adds a polynomial to the present ones. The lowest
derivative of this difference that is not zero is the second, or the third where friction bends, at
the block of the event. Each further derivative reaches one block more, since damping couples
neighbours through their velocities (without damping, one block more takes two derivatives). The
difference is cut off at the order of the step, so the few blocks within reach change as in a new
expansion of the whole lattice.
"""

import numpy as np

from .arrays import CENTRE, COLUMNS
from .foresight import RECIPROCAL, find_bends, find_sticks, foresee_releases, forget_sticks
from .friction_terms import begin_to_fall, fall, resistance_at_rest, strengthen, turn
from .jit import inner, once
from .segments import sliding_beside
from .stencils import blocks, derivative


@inner()
def taylor_shift(derivatives, lowest, last, top, s):
    """Shift derivatives lowest..last of a polynomial of degree ``top`` by a time s."""
    for m in range(lowest, last + 1):
        value = derivatives[top]
        for j in range(top - 1, m - 1, -1):
            value = derivatives[j] + s * RECIPROCAL[j - m + 1] * value
        derivatives[m] = value


@inner(inline=True)
def later_velocity(w, i, top, s):
    """Velocity of a block a time s after the step began."""
    value = w[top, i]
    for k in range(top - 1, 0, -1):
        value = w[k, i] + s * RECIPROCAL[k] * value
    return value


@inner(inline=True)
def start(centre, medium, motion, block, now, top):
    """Derivatives of the slip of a block released at ``now``. Returns its friction."""
    w, offset = motion.w, motion.offset
    strain = motion.strain
    per_dx2, damping = medium.per_dx2, medium.damping
    ahead = (offset[block + 1] - offset[block]) - (offset[block] - offset[block - 1])
    force = (strain[block] - strain[block - 1]) / medium.dx + per_dx2 * ahead + motion.tau[block]
    force -= medium.leaf * (w[0, block] + offset[block])
    centre[2] = force + damping * (w[1, block - 1] + w[1, block + 1])
    friction = begin_to_fall(motion, medium.bend, block)
    centre[2] -= friction
    # Between the start of the step and ``now``, two derivatives more than are kept contribute.
    for k in range(1, top + 1):
        centre[k + 2] = per_dx2 * (w[k, block - 1] + w[k, block + 1])
        if k < top:
            centre[k + 2] += damping * (w[k + 1, block - 1] + w[k + 1, block + 1])
    taylor_shift(centre, np.int64(2), top, top + 2, now)
    return friction


@inner(inline=True)
def stop(centre, w, offset, block, now, top):
    """Hold a block at ``now``; ``centre`` gets minus its derivatives. Returns its velocity."""
    centre[0] = 0.0
    for k in range(1, top + 1):
        centre[k] = w[k, block]
        w[k, block] = 0.0
    taylor_shift(centre, np.int64(0), top, top, now)
    offset[block] += centre[0]
    for k in range(2, top + 1):
        centre[k] = -centre[k]
    return centre[1]


@inner(inline=True)
def bend_course(centre, motion, bend, block, now, top):
    """Derivatives of the change that a bend of friction makes. Returns that of friction times v."""
    if bend is not None:
        for k in range(1, top + 1):
            centre[k] = motion.w[k, block]
        taylor_shift(centre, np.int64(1), top, top, now)
        velocity, before = centre[1], motion.falls[block]
        turn(motion, bend, block)
        change = motion.falls[block] - before
        for k in range(top, 2, -1):
            centre[k] = change * centre[k - 2 + bend.rate]
        centre[2] = 0.0
        return -centre[3] * velocity
    return 0.0


@inner(inline=True)
def spread(difference, medium, motion, event, left, right, top):
    """Derivatives of the difference from those of its centre, over the sliding blocks beside it."""
    rows, centre = difference.rows, difference.centre
    column = np.uint64(event.block) - np.uint64(CENTRE)
    for k in range(2, top + 1):
        for p in range(np.uint64(COLUMNS)):
            rows[k, p] = 0.0
        reach = k - 2 if medium.damping != 0.0 else (k - 2) // 2
        first, last = CENTRE - min(left, reach), CENTRE + min(right, reach) + 1
        for p in blocks(first, last):
            rows[k, p] = derivative(rows, k, p, medium.per_dx2, medium.leaf, medium.damping)
        if medium.alpha != 0.0:
            strengthen(rows, k, first, last, medium.alpha)
        fall(rows, k, first, last, column, motion, medium.bend)
        rows[k, CENTRE] = centre[k] + (0.0 if event.stick else rows[k, CENTRE])


@inner(inline=True)
def evaluate(out, rows, lowest, top, s):
    """Derivative ``lowest`` of the difference at time s, in all columns but the last."""
    columns = np.uint64(COLUMNS - 1)
    for p in range(columns):
        out[p] = rows[top, p]
    for k in range(top - 1, lowest - 1, -1):
        weight = s * RECIPROCAL[k + 1 - lowest]
        for p in range(columns):
            out[p] = rows[k, p] + weight * out[p]


@inner(inline=True)
def add_difference(motion, difference, first, last, block, now, h, top):
    """Add the difference to the polynomials of blocks first..last-1 and their velocities at h."""
    w, offset, velocity = motion.w, motion.offset, motion.velocity
    rows, values = difference.rows, difference.values
    column = np.uint64(CENTRE) - np.uint64(block)
    evaluate(values, rows, 1, top, h - now)
    for i in blocks(first, last):
        velocity[i] += values[i + column]
    evaluate(values, rows, 0, top, -now)
    for i in blocks(first, last):
        offset[i] += values[i + column]
    for m in range(1, top + 1):
        evaluate(values, rows, m, top, -now)
        for i in blocks(first, last):
            w[m, i] += values[i + column]


@once
def change_course(medium, motion, segments, forecast, difference, event, h, top):
    """Change the polynomials within reach of an event, and foresee further events there until h.

    Returns: velocities are finite; first block that changed and the one after the last; velocity
    of the block before; lowest stress of a stuck block; sum of dv times the change of da; change
    of the time derivative of friction times velocity.
    """
    w, offset, velocity = motion.w, motion.offset, motion.velocity
    block, now, stick, bends = event
    speed = kink = bent = friction = 0.0
    left, right = sliding_beside(segments, block)
    middle = medium.mirror and block == 1
    if middle:
        left = right
    if stick:
        speed = stop(difference.centre, w, offset, block, now, top)
        velocity[block] = 0.0
        friction = resistance_at_rest(motion, medium.bend, block)
    elif bends:
        bent = bend_course(difference.centre, motion, medium.bend, block, now, top)
    else:
        friction = start(difference.centre, medium, motion, block, now, top)
    if medium.beta > 0.0:
        # Only the block of the event changes its acceleration, and it is at rest.
        neighbours = later_velocity(w, block + 1, top, now)
        if not middle:
            neighbours += later_velocity(w, block - 1, top, now)
        kink = -difference.centre[2] * neighbours
    bent += friction * difference.centre[2]
    spread(difference, medium, motion, event, left, right, top)
    if stick:
        # `stop` has changed the block of the event already.
        for k in range(2, top + 1):
            difference.rows[k, CENTRE] = 0.0

    reach = top - 2 if medium.damping != 0.0 else (top - 2) // 2
    first, last = max(block - min(left, reach), 1), block + min(right, reach) + 1
    add_difference(motion, difference, first, last, block, now, h, top)
    with_ghost = medium.mirror and first <= 2
    if with_ghost:
        offset[0] = offset[2]
        for m in range(1, top + 1):
            w[m, 0] = w[m, 2]

    lowest = foresee_releases(medium, motion, segments, forecast, first - 1, last + 1, now, h)
    forget_sticks(forecast, first, last)
    finite = find_sticks(motion, forecast, first, last, last - first, now, h, top)
    find_bends(motion, medium.bend, forecast, first, last, now, h, top)
    return finite, 0 if with_ghost else first, last, speed, lowest, kink, bent
