"""The textbook scheme, for comparison: symplectic Euler over the whole lattice, events checked once a step.

First order in the step, and its measured front speed locks on dx / (n dt) for whole n.
"""

from __future__ import annotations

import math

from .jit import compiled
from .taylor import (
    ALL_STUCK,
    BLOCK_UPDATES,
    BLOW_UP,
    CONTINUE,
    DONE,
    FIRST_STICK,
    FIRST_STUCK,
    GROW,
    MIN_STUCK_STRESS,
    MIN_VELOCITY,
    NEXT_SAMPLE,
    RE_RELEASES,
    RELEASES,
    STEPS,
    STICK_LOSS,
    STICKS,
    TIME,
    UNSTABLE,
    VISCOUS_LOSS,
)


@compiled(entry=True)
def advance_fixed(
    slip, velocity, force, sliding, tau,
    release_time, stick_time, counts, totals,
    sample_times, sample_blocks, sample_slip, sample_velocity,
    mirror, total, dx, leaf, beta, step, end_time, largest_force, call_steps,
):  # fmt: skip
    """Advance by at most ``call_steps`` steps of ``step``, to ``end_time`` at most. Returns why it stopped."""
    size = tau.shape[0]
    per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
    for _ in range(call_steps):
        t = totals[TIME]
        if t >= end_time:
            return DONE
        if sliding[size - 3] or (sliding[2] and not mirror):
            return GROW
        dt = min(step, end_time - t)
        end = end_time if dt == end_time - t else t + dt
        if mirror:
            slip[0], velocity[0] = slip[2], velocity[2]
        moving = 0
        for i in range(1, size - 1):
            stress = per_dx2 * (slip[i + 1] - 2.0 * slip[i] + slip[i - 1]) - leaf * slip[i] + tau[i]
            drag = damping * (velocity[i + 1] - 2.0 * velocity[i] + velocity[i - 1])
            force[i] = stress + drag
            if not sliding[i]:
                if not total:
                    drag = 0.0
                totals[MIN_STUCK_STRESS] = min(totals[MIN_STUCK_STRESS], stress + drag)
                if stress + drag >= 1.0:
                    sliding[i] = True
                    counts[RELEASES] += 1
                    if math.isnan(release_time[i]):
                        release_time[i] = t
                    else:
                        counts[RE_RELEASES] += 1
                        stick_time[i] = math.nan
            moving += sliding[i]
        if moving == 0:
            return ALL_STUCK
        fastest = 0.0
        for i in range(1, size - 1):
            if not sliding[i]:
                continue
            before = velocity[i]
            after = before + dt * force[i]
            if after <= 0.0:
                weight = 2.0 if mirror and i > 1 else 1.0
                totals[STICK_LOSS] += weight * 0.5 * before * before * dx
                totals[MIN_VELOCITY] = min(totals[MIN_VELOCITY], after)
                after = 0.0
                sliding[i] = False
                stick_time[i] = end
                if counts[STICKS] == 0:
                    totals[FIRST_STICK] = end
                    counts[FIRST_STUCK] = i
                counts[STICKS] += 1
            velocity[i] = after
            slip[i] += dt * after
            if not after < math.inf:
                return UNSTABLE
            fastest = max(fastest, after)
        if mirror:
            velocity[0] = velocity[2]
        if beta > 0.0:
            first = 1 if mirror else 0
            lost = 0.0
            for i in range(first, size - 1):
                now = velocity[i + 1] - velocity[i]
                lost += now * now
            totals[VISCOUS_LOSS] += (2.0 if mirror else 1.0) * dt * beta / dx * lost
        counts[STEPS] += 1
        counts[BLOCK_UPDATES] += moving
        totals[TIME] = end
        if not fastest <= BLOW_UP * (1.0 + largest_force * end):
            return UNSTABLE
        while counts[NEXT_SAMPLE] < sample_times.shape[0] and sample_times[counts[NEXT_SAMPLE]] <= end:
            s = counts[NEXT_SAMPLE]
            back = end - sample_times[s]
            for p in range(sample_blocks.shape[0]):
                i = sample_blocks[p]
                if i >= 0:
                    sample_slip[s, p] = slip[i] - back * velocity[i]
                    sample_velocity[s, p] = velocity[i]
            counts[NEXT_SAMPLE] += 1
    return CONTINUE
