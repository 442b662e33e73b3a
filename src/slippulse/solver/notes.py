"""What a run keeps on its way: releases, sticks, samples, viscous loss."""

import math

from .jit import inner
from .stencils import motion_of, stretching


@inner()
def note_release(history, block, time):
    """Keep the time of a first release; a later one takes back the stick."""
    if math.isnan(history.release_time[block]):
        history.release_time[block] = time
    else:
        history.tally.re_releases += 1
        history.stick_time[block] = math.nan
    history.tally.releases += 1


@inner()
def note_stick(history, block, time):
    """Keep the time of a stick; of the first one, its block too."""
    history.stick_time[block] = time
    if history.tally.sticks == 0:
        history.tally.first_stick_time = time
        history.tally.first_stuck_block = block
    history.tally.sticks += 1


@inner()
def take_samples(recorder, motion, tally, start, end, order):
    """Take the samples that are due by ``end``, from polynomials about ``start``."""
    times, blocks, w = recorder.times, recorder.blocks, motion.w
    while tally.samples_taken < times.shape[0] and times[tally.samples_taken] <= end:
        n = tally.samples_taken
        s = min(max(times[n], start), end) - start
        for p in range(blocks.shape[0]):
            i = blocks[p]
            if i < 0:
                continue
            u, v = 0.0, 0.0
            for k in range(order + 1, 0, -1):
                u = s / k * (w[k, i] + u)
            for k in range(order, 0, -1):
                v = s / k * (w[k + 1, i] + v)
            recorder.slip[n, p] = w[0, i] + motion.offset[i] + u
            recorder.velocity[n, p] = w[1, i] + v
        tally.samples_taken += 1


@inner()
def dissipation_by_rate(medium, w, segments):
    """D = alpha dx sum of v_i^2 over all segments, and dD/dt."""
    square, product = 0.0, 0.0
    for r in range(segments.count.n):
        s, p = motion_of(w, segments.starts[r], segments.ends[r])
        # The block at x = 0 has no mirror image.
        once = 0.5 if medium.mirror and segments.starts[r] == 1 else 0.0
        square += s - once * w[1, 1] * w[1, 1]
        product += p - once * w[1, 1] * w[2, 1]
    scale = (2.0 if medium.mirror else 1.0) * medium.alpha * medium.dx
    return scale * square, 2.0 * scale * product


@inner(inline=True)
def dissipation(medium, motion, segments):
    """D = beta dx sum ((v_{i+1} - v_i)/dx)^2 over all segments and what rate strengthening adds, and dD/dt."""
    square, product, rate, change = 0.0, 0.0, 0.0, 0.0
    for r in range(segments.count.n):
        start = segments.starts[r]
        left = 1 if medium.mirror and start == 1 else start - 1
        s, p = stretching(motion.w, left, segments.ends[r])
        square += s
        product += p
    if medium.alpha != 0.0:
        rate, change = dissipation_by_rate(medium, motion.w, segments)
    scale = (2.0 if medium.mirror else 1.0) * medium.beta / medium.dx
    return scale * square + rate, 2.0 * scale * product + change


@inner()
def viscous_loss(h, rate, change, kinks):
    """Viscous loss of a step h, rate strengthening's included, without h D_1/3, which is added when D_1 is known.

    Third order in h from the dissipation D_0 and its derivative D_0' at the start and D_1 at the end, which is the next
    start since velocities are continuous: h (2 D_0 + D_1)/3 + h^2 D_0'/6. An event at s that changes D' by k adds
    k (h - s)^2/2, and takes back h k (h - s)/3, its part of h D_1/3.
    """
    without_events = h * 2.0 * rate / 3.0 + h * h * change / 6.0
    first = kinks.k * h - kinks.ks
    second = kinks.k * h * h - 2.0 * kinks.ks * h + kinks.kss
    return without_events + second / 2.0 - h * first / 3.0
