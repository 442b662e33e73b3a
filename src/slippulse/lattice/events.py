"""When the next block is released or sticks, and what that changes: the polynomials of its neighbourhood alone.

A change at one block reaches a neighbour further off only through a higher derivative: ``order - 1`` blocks off it is
below what the Taylor polynomial holds. Within that reach the blocks are expanded anew at the instant of the event, in a
small array of constant width (its loops then need no bookkeeping), and their polynomials are then written about the
start of the step again, like all others.
"""

from __future__ import annotations

import math

import numpy as np

from .jit import compiled
from .stencils import ONE, crossing, derivative, elastic, polynomial, second_difference, velocity_after

# How far an event expands anew on either side, enough for order 8; one more block on each side is read.
REACH = 7
COLUMNS = 2 * REACH + 3
# How many times within a step a stress is looked at, besides where it turns.
LOOKS = 4
# A velocity this little below zero at the instant of a stick is the rounding of the root, not another stick.
ROUNDING = 1e-12


@compiled()
def translate(target, to, source, shift, share, gained, top):
    """Derivatives 1..top of slip, and the slip gained, a time s later, where share[j] is s/j: column by column."""
    into, out_of = np.uint64(to), np.uint64(shift)
    for k in range(1, top + 1):
        for p in range(np.uint64(COLUMNS)):
            target[k, p + into] = source[top, p + out_of]
        for j in range(top - 1, k - 1, -1):
            for p in range(np.uint64(COLUMNS)):
                target[k, p + into] = source[j, p + out_of] + share[j - k + 1] * target[k, p + into]
    for p in range(np.uint64(COLUMNS)):
        gained[p] = share[top] * source[top, p + out_of]
    for j in range(top - 1, 0, -1):
        for p in range(np.uint64(COLUMNS)):
            gained[p] = share[j] * (source[j, p + out_of] + gained[p])


@compiled()
def stress_polynomial(out, w, strain, tau, block, dx, leaf, beta, total, top):
    """Coefficients of the stress of a stuck block minus 1, in powers of the time that ``w`` is expanded in."""
    per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
    out[0] = (strain[block] - strain[block - 1]) / dx - leaf * w[0, block] + tau[block] - 1.0
    scale = per_dx2
    for k in range(1, top + 1):
        scale /= k
        out[k] = scale * (w[k, block - 1] + w[k, block + 1])
    if total and beta > 0.0:
        scale = damping
        for k in range(top):
            scale /= max(k, 1)
            out[k] += scale * (w[k + 1, block - 1] + w[k + 1, block + 1])


@compiled()
def turning_point(coefficients, slopes, degree, h):
    """Where a polynomial turns within h, at the one change of sign of its slope; h where it does not."""
    for k in range(degree):
        slopes[k] = (k + 1) * coefficients[k + 1]
    if slopes[0] * polynomial(slopes, degree - 1, h) < 0.0:
        return crossing(slopes, degree - 1, h)
    return h


@compiled()
def foresee_release(coefficients, slopes, w, strain, tau, block, h, dx, leaf, beta, total, top):
    """When the stress of a stuck block reaches 1 within h; inf where it does not. ``coefficients`` is left filled."""
    stress_polynomial(coefficients, w, strain, tau, block, dx, leaf, beta, total, top)
    if coefficients[0] >= 0.0:
        return 0.0
    # A stress can pass the threshold and fall back within a step, between blocks that slow down.
    for k in range(1, LOOKS + 1):
        part = h * k / LOOKS
        if polynomial(coefficients, top, part) >= 0.0:
            return crossing(coefficients, top, part)
    turn = turning_point(coefficients, slopes, top, h)
    if turn < h and polynomial(coefficients, top, turn) >= 0.0:
        return crossing(coefficients, top, turn)
    return math.inf


@compiled()
def foresee_releases(
    release_at, coefficients, slopes, w, strain, tau, starts, ends, n, h, mirror, dx, leaf, beta, total, top
):  # fmt: skip
    """Note when each stuck neighbour of a run is released within h. Returns the lowest of their stresses now."""
    lowest = math.inf
    for r in range(n):
        for block in (starts[r] - 1, ends[r]):
            if mirror and block == 0:
                continue
            release_at[block] = foresee_release(
                coefficients, slopes, w, strain, tau, block, h, dx, leaf, beta, total, top
            )
            lowest = min(lowest, coefficients[0] + 1.0)
    return lowest


@compiled()
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


@compiled()
def crowded(release_at, starts, ends, n, mirror, stopping_block, stopping_time, n_stopping, block, latest):
    """Whether the reach of an event meets that of another until ``latest``, its own mirror image included.

    Expanded one after the other they would not come out as they do in the mirror.
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
def find_sticks(
    w, velocity, first, last, stopping_block, stopping_time, n_stopping, coefficients, slopes, shift, now, top, h
):  # fmt: skip
    """Add when each of the blocks first..last-1 whose velocity passes below 0 within h does so.

    ``w`` is expanded about ``now``, ``velocity`` is that after h, and ``shift`` is added to the number of a block.
    Returns how many there are then, or -1 where a velocity is not finite.
    """
    for i in range(first, last):
        if velocity[i] >= 0.0 and w[1, i] + h * w[2, i] >= 0.0:
            continue
        if not math.isfinite(velocity[i]):
            return -1
        if w[1, i] == 0.0 and 0.0 <= velocity[i] <= ROUNDING:
            # Released just before the end of the step: its acceleration is 0 but for rounding.
            continue
        factorial = 1.0
        for k in range(top):
            factorial *= max(k, 1)
            coefficients[k] = w[k + 1, i] / factorial
        below = h
        if velocity[i] > ROUNDING:
            below = turning_point(coefficients, slopes, top - 1, h)
            if polynomial(coefficients, top - 1, below) >= -ROUNDING:
                continue
        root = 0.0
        if coefficients[0] > 0.0:
            root = crossing(coefficients, top - 1, below)
        elif coefficients[0] == 0.0 and coefficients[1] > 0.0:
            # Released at this very instant: the zero at the start is not the one that is sought.
            root = crossing(coefficients[1:], top - 2, below)
        stopping_block[n_stopping] = i + shift
        stopping_time[n_stopping] = now + root
        n_stopping += 1
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


@compiled()
def mark(sliding, kept, starts, ends, n, shift, last, middle):
    """1 or 0 for each column: whether its block slides, and whether it lies beyond ``last`` and keeps its polynomial.

    Beyond it lies what is there only to fill the array, next to the middle of a mirrored lattice.
    """
    sliding[:] = 0.0
    for p in range(COLUMNS):
        kept[p] = 1.0 if p > last else 0.0
    for r in range(n):
        for p in range(max(starts[r] - shift, 0), min(ends[r] - shift, COLUMNS)):
            sliding[p] = 1.0
    if middle:
        sliding[0] = sliding[2]


@compiled()
def change_of_dissipation(patch, before, first):
    """Sum over neighbours of dv times the change of da, from the accelerations ``before`` to those now."""
    change = 0.0
    for p in range(first, COLUMNS - 1):
        after = (patch[2, p + 1] - before[p + 1]) - (patch[2, p] - before[p])
        change += (patch[1, p + 1] - patch[1, p]) * after
    return change


@compiled()
def expand_anew(
    w, offset, strain, tau, velocity, starts, ends, n, block, stuck, now, h, release_at, stopping_block, stopping_time,
    n_stopping, patch, rows, coefficients, slopes, mirror, total, dx, leaf, beta, top,
):  # fmt: skip
    """Expand the reach of an event at ``block`` anew at ``now``, and foresee its events up to h.

    ``starts`` and ``ends`` are the runs after the event; ``stuck`` says that the block has just stuck. ``offset`` is
    what slip is ahead of its polynomial by the events of this step.

    Returns
    -------
    number of foreseen sticks (-1: a velocity is not finite), first block of the reach, velocity of the block before the
    event, lowest stress of a stuck block, sum over neighbours of dv times the change of da
    """
    gained, patch_strain, patch_tau, patch_velocity, sliding, kept, before, share = (
        rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7],
    )  # fmt: skip
    per_dx, per_dx2, damping = 1.0 / dx, 1.0 / (dx * dx), beta / (dx * dx)
    # Not literals, for which everything that is called would be compiled once more.
    none, one = np.int64(0), np.int64(1)
    shift = max(block - REACH, 1) - 1
    start = np.uint64(shift)
    middle = mirror and shift == 0
    for j in range(1, top + 1):
        share[j] = now / j
    translate(patch, none, w, shift, share, gained, top)
    for p in range(np.uint64(COLUMNS)):
        gained[p] += offset[p + start]
        patch[0, p] = w[0, p + start] + gained[p]
        patch_tau[p] = tau[p + start]
        before[p] = patch[2, p]
    if middle:
        gained[0] = gained[2]
        for k in range(top + 1):
            patch[k, 0] = patch[k, 2]
    for p in range(np.uint64(COLUMNS - 1)):
        patch_strain[p] = strain[p + start] + per_dx * (gained[p + ONE] - gained[p])
    speed = patch[1, block - shift]
    if stuck:
        for k in range(1, top + 1):
            patch[k, block - shift] = 0.0
        velocity[block] = 0.0
    mark(sliding, kept, starts, ends, n, shift, block + REACH - shift, middle)

    for p in range(ONE, np.uint64(COLUMNS - 1)):
        force = elastic(patch, patch_strain, patch_tau, p, per_dx, leaf)
        force = sliding[p] * (force + damping * second_difference(patch, 1, p))
        patch[2, p] = force + kept[p] * (patch[2, p] - force)
        if -ROUNDING < patch[1, p] < 0.0 <= patch[2, p]:
            # Released a moment ago, and its polynomial is about the start of the step.
            patch[1, p] = 0.0
    for k in range(3, top + 1):
        if middle:
            patch[k - 1, 0] = patch[k - 1, 2]
        for p in range(ONE, np.uint64(COLUMNS - 1)):
            new = sliding[p] * derivative(patch, k, p, per_dx2, leaf, damping)
            patch[k, p] = new + kept[p] * (patch[k, p] - new)
    if middle:
        patch[top, 0] = patch[top, 2]
    change = change_of_dissipation(patch, before, 1 if middle else 0) if beta > 0.0 else 0.0

    lowest = math.inf
    for p in range(1, COLUMNS - 1):
        if sliding[p] == 0.0 and sliding[p - 1] + sliding[p + 1] > 0.0:
            foreseen = foresee_release(
                coefficients, slopes, patch, patch_strain, patch_tau, p, h - now, dx, leaf, beta, total, top
            )
            release_at[p + shift] = now + foreseen
            lowest = min(lowest, coefficients[0] + 1.0)

    velocity_after(patch_velocity, patch, one, COLUMNS - one, h - now, top - 1)
    for p in range(1, COLUMNS - 1):
        if sliding[p] > 0.0:
            velocity[p + shift] = patch_velocity[p]
    n_stopping = forget_sticks(stopping_block, stopping_time, n_stopping, shift + 1, shift + COLUMNS - 1)
    n_stopping = find_sticks(
        patch, patch_velocity, one, COLUMNS - one, stopping_block, stopping_time, n_stopping, coefficients, slopes,
        shift, now, top, h - now,
    )  # fmt: skip

    # Written about the start of the step again, like all other polynomials.
    for p in range(np.uint64(COLUMNS)):
        offset[p + start] = gained[p]
    for j in range(1, top + 1):
        share[j] = -now / j
    translate(w, shift, patch, none, share, gained, top)
    for p in range(np.uint64(COLUMNS)):
        offset[p + start] += gained[p]
    if mirror and shift == 1:
        # The ghost beyond the middle mirrors the first block of the reach.
        offset[0] = offset[2]
        for k in range(1, top + 1):
            w[k, 0] = w[k, 2]
    return n_stopping, shift, speed, lowest, change
