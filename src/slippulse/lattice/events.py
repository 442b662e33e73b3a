"""When the next block is released or sticks, and what that changes: a difference that spreads one block a derivative.

The sliding lattice is linear, so what an event changes is a polynomial to be added to those that are there. Its first
derivative that is not zero is the second, at the block of the event; each further derivative reaches one block more,
since damping couples neighbours through their velocities (without damping it takes two derivatives). Nothing is left of
it beyond the order of the step, so that the few blocks within reach change just as the whole lattice expanded anew
would.
"""

from __future__ import annotations

import math

import numpy as np

from .jit import compiled
from .stencils import blocks, crossing, derivative, polynomial, slope

# 1/j, for Taylor polynomials in derivatives.
SHARE = np.append(0.0, 1.0 / np.arange(1.0, 16.0))
# How far an event reaches on either side at order 8, the highest there is.
REACH = 7
# Columns of a difference: its reach on either side of its centre, and a block at rest at each end.
CENTRE = REACH + 1
COLUMNS = 2 * CENTRE + 1
# How many times within a step a stress is looked at, besides where it turns.
LOOKS = 4
# A velocity this little below zero at the instant of a stick is the rounding of the root, not another stick; a stress
# this little above the threshold may be on its way down.
ROUNDING = 1e-12


@compiled()
def stress_polynomial(out, w, offset, strain, tau, block, dx, leaf, beta, total, top):
    """Coefficients of the stress of a stuck block minus 1, in powers of the time since the step began."""
    per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
    ahead = (offset[block + 1] - offset[block]) - (offset[block] - offset[block - 1])
    slip = w[0, block] + offset[block]
    out[0] = (strain[block] - strain[block - 1]) / dx + per_dx2 * ahead - leaf * slip + tau[block] - 1.0
    scale, damping = 1.0, damping if total and beta > 0.0 else 0.0
    for k in range(1, top + 1):
        beside = w[k, block - 1] + w[k, block + 1]
        out[k - 1] += scale * damping * beside
        scale *= SHARE[k]
        out[k] = scale * per_dx2 * beside


@compiled()
def turning_point(coefficients, slopes, degree, lower, upper):
    """Where a polynomial turns, at the one change of sign of its slope between two times; else ``upper``."""
    for k in range(degree):
        slopes[k] = (k + 1) * coefficients[k + 1]
    if polynomial(slopes, degree - 1, lower) * polynomial(slopes, degree - 1, upper) < 0.0:
        return crossing(slopes, degree - 1, lower, upper)
    return upper


@compiled()
def highest_possible(coefficients, degree, h):
    """A value that a polynomial does not pass until h."""
    value = 0.0
    for k in range(degree, 0, -1):
        value = h * (max(coefficients[k], 0.0) + value)
    return coefficients[0] + value


@compiled(inline=True)
def first_reach_of_threshold(coefficients, slopes, degree, lower, upper):
    """When a stress, less 1, reaches 0 after ``lower``; inf where it does not until ``upper``."""
    # It can pass the threshold and fall back within a step, between blocks that slow down.
    for k in range(1, LOOKS + 1):
        part = lower + (upper - lower) * k / LOOKS
        if polynomial(coefficients, degree, part) > ROUNDING:
            return crossing(coefficients, degree, lower, part)
    turn = turning_point(coefficients, slopes, degree, lower, upper)
    if turn < upper and polynomial(coefficients, degree, turn) >= 0.0:
        return crossing(coefficients, degree, lower, turn)
    return math.inf


@compiled(inline=True)
def foresee_release(coefficients, slopes, w, offset, strain, tau, block, now, h, dx, leaf, beta, total, top):
    """When a stuck block is released between ``now`` and h (inf: it is not), and its stress now."""
    stress_polynomial(coefficients, w, offset, strain, tau, block, dx, leaf, beta, total, top)
    below = polynomial(coefficients, top, now)
    if below >= 0.0:
        return now, below + 1.0
    if highest_possible(coefficients, top, h) < 0.0:
        return math.inf, below + 1.0
    return first_reach_of_threshold(coefficients, slopes, top, now, h), below + 1.0


@compiled()
def foresee_releases(
    release_at, coefficients, slopes, w, offset, strain, tau, starts, ends, n, now, h, mirror, dx, leaf, beta, total,
    top, first, last,
):  # fmt: skip
    """Note when each stuck neighbour of a run is released within h, among the blocks first..last-1.

    Returns the lowest of their stresses now.
    """
    lowest = math.inf
    for r in range(n):
        for side in range(2):
            block = ends[r] if side else starts[r] - 1
            if not first <= block < last or (mirror and block == 0):
                continue
            release_at[block], stress = foresee_release(
                coefficients, slopes, w, offset, strain, tau, block, now, h, dx, leaf, beta, total, top
            )
            lowest = min(lowest, stress)
    return lowest


@compiled(inline=True)
def next_event(release_at, starts, ends, n, mirror, stopping_block, stopping_time, n_stopping):
    """The block that is released or sticks first, when (inf: none), and whether it sticks."""
    block, earliest, stuck = -1, math.inf, False
    for r in range(n):
        if not (mirror and starts[r] == 1) and release_at[starts[r] - 1] < earliest:
            block, earliest = starts[r] - 1, release_at[starts[r] - 1]
        if release_at[ends[r]] < earliest:
            block, earliest = ends[r], release_at[ends[r]]
    for q in range(n_stopping):
        if stopping_time[q] < earliest:
            block, earliest, stuck = stopping_block[q], stopping_time[q], True
    return block, earliest, stuck


@compiled(inline=True)
def crowded(release_at, starts, ends, n, mirror, stopping_block, stopping_time, n_stopping, block, latest):
    """Whether the reach of an event meets that of another until ``latest``, its own mirror image included.

    Taken one after the other they would not come out as they do in the mirror.
    """
    near = 2 * REACH + 1
    others = 1 if mirror and 1 < block <= 1 + REACH else 0
    for r in range(n):
        for edge in (starts[r] - 1, ends[r]):
            others += 0 < abs(edge - block) <= near and release_at[edge] <= latest
    for q in range(n_stopping):
        others += 0 < abs(stopping_block[q] - block) <= near and stopping_time[q] <= latest
    return others > 0


@compiled()
def due_releases(release_at, starts, ends, n, mirror, latest, due):
    """Fill ``due`` with the stuck neighbours of the runs that are released until ``latest``. Returns how many."""
    count = 0
    for r in range(n):
        for edge in (starts[r] - 1, ends[r]):
            joined = count > 0 and due[count - 1] == edge
            if (
                release_at[edge] <= latest
                and not joined
                and not (mirror and edge == 0)
                and count < due.shape[0]
            ):
                due[count] = edge
                count += 1
    return count


@compiled()
def foresee_stick(coefficients, slopes, degree, after, now, h):
    """When a velocity passes below 0 between ``now`` and h, where it is ``after``; inf where it does not."""
    before = polynomial(coefficients, degree, now)
    if after >= 0.0:
        if after <= ROUNDING:
            # Released just before the end of the step, its acceleration is 0 but for rounding.
            return math.inf if abs(before) <= ROUNDING else crossing(coefficients, degree, now, h)
        turn = turning_point(coefficients, slopes, degree, now, h)
        if polynomial(coefficients, degree, turn) >= -ROUNDING:
            return math.inf
        return crossing(coefficients, degree, now, turn)
    if before <= ROUNDING and slope(coefficients, degree, now) > 0.0:
        # Released at this very instant: the zero at the start is not the one that is sought.
        turn = turning_point(coefficients, slopes, degree, now, h)
        return crossing(coefficients, degree, turn, h)
    return crossing(coefficients, degree, now, h) if before > 0.0 else now


@compiled()
def find_sticks(
    w, velocity, first, last, suspects, stopping_block, stopping_time, n_stopping, coefficients, slopes, now, top, h
):  # fmt: skip
    """Add when each of the blocks first..last-1 whose velocity passes below 0 between ``now`` and h does so.

    ``velocity`` is that at h; no more than so many ``suspects`` may do so. Returns how many there are then, or -1 where
    a velocity is not finite.
    """
    for i in range(first, last):
        if velocity[i] >= 0.0 and w[1, i] + h * w[2, i] >= 0.0:
            continue
        if not math.isfinite(velocity[i]):
            return -1
        suspects -= 1
        factorial = 1.0
        for k in range(top):
            factorial *= max(k, 1)
            coefficients[k] = w[k + 1, i] / factorial
        root = foresee_stick(coefficients, slopes, top - 1, velocity[i], now, h)
        if root < math.inf:
            stopping_block[n_stopping] = i
            stopping_time[n_stopping] = root
            n_stopping += 1
        if suspects == 0:
            break
    return n_stopping


@compiled()
def forget_sticks(stopping_block, stopping_time, n_stopping, first, last):
    """Drop the foreseen sticks of the blocks first..last-1. Returns how many remain."""
    kept = 0
    for q in range(n_stopping):
        if not first <= stopping_block[q] < last:
            stopping_block[kept], stopping_time[kept] = stopping_block[q], stopping_time[q]
            kept += 1
    return kept


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
