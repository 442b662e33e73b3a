"""When the next block is released or sticks: the first root of a stress or of a velocity within the step."""

from __future__ import annotations

import math

from .jit import compiled
from .stencils import REACH, SHARE, crossing, polynomial, slope

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
