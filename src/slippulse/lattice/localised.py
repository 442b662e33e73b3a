"""The localised scheme: Taylor steps of any order that end at each release and at each stick.

Between events the sliding lattice is linear with constant coefficients, so its Taylor polynomial is cheap, and it
is its own dense output: the stress of a stuck neighbour and the velocity of a sliding block are polynomials in the
step, and the step ends at the first root of either. Only the runs of sliding blocks and their neighbours are
touched; everything else is at rest and its derivatives are zero.
"""

from __future__ import annotations

import math

import numpy as np

from .jit import compiled
from .runs import release_block, stick_block
from .stencils import (
    advance_slip,
    advance_strain,
    count_stopping,
    crossing,
    first_acceleration,
    next_derivative,
    polynomial,
    stretching,
    velocity_after,
)

# Why `advance` came back.
DONE, CONTINUE, GROW, UNSTABLE, ALL_STUCK = 0, 1, 2, 3, 4
# Places in `counts`.
RUNS, STEPS, BLOCK_UPDATES, RELEASES, STICKS, RE_RELEASES, NEXT_SAMPLE, FIRST_STUCK = range(8)
# Places in `totals`.
TIME, VISCOUS_LOSS, PENDING_STEP, MIN_VELOCITY, MIN_STUCK_STRESS, FIRST_STICK, STICK_LOSS = range(7)

# Events closer than this share of the largest step are one event: the two fronts of a mirror-symmetric scene.
SIMULTANEOUS = 1e-11
# How many times within a step a stress, or a velocity that may dip below 0, is looked at.
LOOKS = 4
# A velocity this little below zero at the instant of a stick is the rounding of the root, not another stick.
ROUNDING = 1e-12
# Velocities beyond this many times the largest that any pre-stress could have driven by now mean a blow-up.
BLOW_UP = 100.0


@compiled()
def derivatives(w, strain, tau, starts, ends, n_runs, mirror, top, dx, leaf, beta):
    """Fill w[2..top] with the time derivatives of slip on all runs."""
    per_dx, per_dx2, damping = 1.0 / dx, 1.0 / (dx * dx), beta / (dx * dx)
    for r in range(n_runs):
        a, b = starts[r], ends[r]
        if mirror and a == 1:
            w[1, 0] = w[1, 2]
        first_acceleration(
            w[2, a:b],
            strain[a - 1 : b],
            w[1, a - 1 : b + 1],
            w[0, a - 1 : b + 1],
            tau[a - 1 : b + 1],
            per_dx,
            leaf,
            damping,
        )
        for k in range(3, top + 1):
            if mirror and a == 1:
                w[k - 1, 0] = w[k - 1, 2]
            next_derivative(
                w[k, a:b], w[k - 2, a - 1 : b + 1], w[k - 1, a - 1 : b + 1], per_dx2, leaf, damping
            )
    if mirror:
        for k in range(1, top + 1):
            w[k, 0] = w[k, 2]


@compiled()
def add_viscous_loss(w, starts, ends, n_runs, mirror, dx, beta, step, totals):
    """Close the last step's viscous loss with the dissipation now, and open this step's.

    Third order in the step from the rate D and its derivative at the start and D at the end, which is the next
    start since velocities are continuous: h (2 D_0 + D_1)/3 + h^2 D_0'/6.
    """
    square, product = 0.0, 0.0
    for r in range(n_runs):
        a, b = starts[r], ends[r]
        left = 1 if mirror and a == 1 else a - 1
        s, p = stretching(w[1, left : b + 1], w[2, left : b + 1])
        square += s
        product += p
    scale = (2.0 if mirror else 1.0) * beta / dx
    rate, change = scale * square, 2.0 * scale * product
    totals[VISCOUS_LOSS] += totals[PENDING_STEP] * rate / 3.0
    totals[VISCOUS_LOSS] += step * (2.0 * rate / 3.0) + step * step * change / 6.0
    totals[PENDING_STEP] = step


@compiled()
def stress_polynomial(out, w, strain, tau, block, dx, leaf, beta, total, top):
    """Coefficients of the stress of a stuck block minus 1, in powers of the step. Returns the degree."""
    per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
    out[0] = (strain[block] - strain[block - 1]) / dx - leaf * w[0, block] + tau[block] - 1.0
    factorial = 1.0
    for k in range(1, top + 1):
        factorial *= k
        out[k] = per_dx2 * (w[k, block - 1] + w[k, block + 1]) / factorial
    if total and beta > 0.0:
        factorial = 1.0
        for k in range(top):
            factorial *= max(k, 1)
            out[k] += damping * (w[k + 1, block - 1] + w[k + 1, block + 1]) / factorial
    return top


@compiled()
def sample(w, blocks, step, order, slip, velocity):
    """Slip and slip velocity at the requested blocks (-1: outside the lattice, at rest) ``step`` into this step."""
    for p in range(blocks.shape[0]):
        i = blocks[p]
        if i < 0:
            continue
        u, v = 0.0, 0.0
        for k in range(order + 1, 0, -1):
            u = step / k * (w[k, i] + u)
        for k in range(order, 0, -1):
            v = step / k * (w[k + 1, i] + v)
        slip[p] = w[0, i] + u
        velocity[p] = w[1, i] + v


@compiled()
def find_releases(
    w, strain, tau, starts, ends, n, edge_block, edge_time, totals, mirror, dx, leaf, beta, total, top, h, same
):  # fmt: skip
    """When each stuck neighbour of a run reaches stress 1 within h. Returns how many there are and the first."""
    coefficients = np.empty(top + 1)
    n_edges = 0
    for r in range(n):
        if not (mirror and starts[r] == 1) and (r == 0 or ends[r - 1] < starts[r] - 1):
            edge_block[n_edges] = starts[r] - 1
            n_edges += 1
        edge_block[n_edges] = ends[r]
        n_edges += 1
    for q in range(n_edges):
        degree = stress_polynomial(coefficients, w, strain, tau, edge_block[q], dx, leaf, beta, total, top)
        totals[MIN_STUCK_STRESS] = min(totals[MIN_STUCK_STRESS], coefficients[0] + 1.0)
        edge_time[q] = math.inf
        if coefficients[0] >= 0.0:
            edge_time[q] = 0.0
        else:
            # A stress can pass the threshold and fall back within a step, between blocks that slow down.
            for k in range(1, LOOKS + 1):
                part = (h + same) * k / LOOKS
                if polynomial(coefficients, degree, part) >= 0.0:
                    edge_time[q] = crossing(coefficients, degree, part)
                    break
        h = min(h, edge_time[q])
    return n_edges, h


@compiled()
def find_sticks(w, velocity, starts, ends, n, stopping_block, stopping_time, top, h):
    """When each block whose velocity passes below 0 within h does so.

    Returns how many there are and the first time, or -1 for the number where a velocity is not finite.
    """
    coefficients = np.empty(top)
    n_stopping = 0
    earliest = h
    for r in range(n):
        for i in range(starts[r], ends[r]):
            if velocity[i] >= 0.0 and w[1, i] + h * w[2, i] >= 0.0:
                continue
            if not math.isfinite(velocity[i]):
                return -1, h
            factorial = 1.0
            for k in range(top):
                factorial *= max(k, 1)
                coefficients[k] = w[k + 1, i] / factorial
            below = h
            if velocity[i] > ROUNDING:
                below = math.inf
                for k in range(1, LOOKS):
                    if polynomial(coefficients, top - 1, h * k / LOOKS) < 0.0:
                        below = h * k / LOOKS
                        break
                if below == math.inf:
                    continue
            root = 0.0
            if coefficients[0] > 0.0:
                root = crossing(coefficients, top - 1, below)
            elif coefficients[0] == 0.0 and coefficients[1] > 0.0:
                # Released at this very instant: the zero at the start is not the one that is sought.
                root = crossing(coefficients[1:], top - 2, below)
            stopping_block[n_stopping] = i
            stopping_time[n_stopping] = root
            n_stopping += 1
            earliest = min(earliest, root)
    return n_stopping, earliest


@compiled()
def advance(
    w, strain, velocity, tau, starts, ends, edge_block, edge_time, stopping_block, stopping_time,
    release_time, stick_time, counts, totals,
    sample_times, sample_blocks, sample_slip, sample_velocity,
    mirror, total, dx, leaf, beta, order, largest_step, end_time, largest_force, call_steps,
):  # fmt: skip
    """Advance the lattice by at most ``call_steps`` steps, to ``end_time`` at most. Returns why it stopped."""
    top = order + 1
    size = tau.shape[0]
    same = SIMULTANEOUS * largest_step
    for _ in range(call_steps):
        n = counts[RUNS]
        t = totals[TIME]
        if n == 0:
            return ALL_STUCK
        if t >= end_time:
            return DONE
        if ends[n - 1] >= size - 2 or (starts[0] <= 1 and not mirror):
            return GROW
        derivatives(w, strain, tau, starts, ends, n, mirror, top, dx, leaf, beta)

        whole = min(largest_step, end_time - t)
        n_edges, h = find_releases(
            w, strain, tau, starts, ends, n, edge_block, edge_time, totals, mirror, dx, leaf, beta, total, top,
            whole, same,
        )  # fmt: skip
        n_stopping = 0
        floor = 0.0
        while True:
            stopping = 0
            for r in range(n):
                velocity_after(velocity, w, starts[r], ends[r], h, order)
                a, b = starts[r], ends[r]
                stopping += count_stopping(velocity[a:b], w[1, a:b], w[2, a:b], h, floor)
            if stopping == 0:
                break
            n_stopping, earliest = find_sticks(
                w, velocity, starts, ends, n, stopping_block, stopping_time, top, h
            )
            if n_stopping < 0:
                return UNSTABLE
            if not earliest < h - same:
                break
            # The shorter step may end inside a dip that the longer one stepped over, so look again.
            h = earliest
            floor = -ROUNDING

        end = end_time if h == end_time - t else t + h
        while counts[NEXT_SAMPLE] < sample_times.shape[0] and sample_times[counts[NEXT_SAMPLE]] <= end:
            s = counts[NEXT_SAMPLE]
            into = min(max(sample_times[s] - t, 0.0), h)
            sample(w, sample_blocks, into, order, sample_slip[s], sample_velocity[s])
            counts[NEXT_SAMPLE] += 1

        if beta > 0.0:
            add_viscous_loss(w, starts, ends, n, mirror, dx, beta, h, totals)
        fastest = 0.0
        for r in range(n):
            a, b = starts[r], ends[r]
            advance_slip(w, velocity, a, b, h, order)
            counts[BLOCK_UPDATES] += b - a
            fastest = max(fastest, w[1, a], w[1, (a + b) // 2], w[1, b - 1])
        for r in range(n):
            a, b = starts[r], ends[r]
            first = 1 if mirror and a == 1 else a - 1
            advance_strain(strain[first:b], w[2, first : b + 1], 1.0 / dx)
        if mirror:
            strain[0] = -strain[1]
        counts[STEPS] += 1
        totals[TIME] = end
        if not fastest <= BLOW_UP * (1.0 + largest_force * end):
            return UNSTABLE

        for q in range(n_stopping):
            if stopping_time[q] > h + same:
                continue
            i = stopping_block[q]
            totals[MIN_VELOCITY] = min(totals[MIN_VELOCITY], w[1, i])
            for k in range(1, top + 1):
                w[k, i] = 0.0
            stick_time[i] = end
            if counts[STICKS] == 0:
                totals[FIRST_STICK] = end
                counts[FIRST_STUCK] = i
            counts[STICKS] += 1
            counts[RUNS] = stick_block(starts, ends, counts[RUNS], i)
        for q in range(n_edges):
            if edge_time[q] > h + same:
                continue
            i = edge_block[q]
            if math.isnan(release_time[i]):
                release_time[i] = end
            else:
                counts[RE_RELEASES] += 1
                stick_time[i] = math.nan
            counts[RELEASES] += 1
            counts[RUNS] = release_block(starts, ends, counts[RUNS], i)
    return CONTINUE


@compiled()
def finish(w, strain, tau, starts, ends, counts, totals, mirror, dx, leaf, beta):
    """Leave the acceleration of the end in w[2] and close the viscous loss."""
    n = counts[RUNS]
    derivatives(w, strain, tau, starts, ends, n, mirror, 2, dx, leaf, beta)
    if beta > 0.0:
        add_viscous_loss(w, starts, ends, n, mirror, dx, beta, 0.0, totals)
