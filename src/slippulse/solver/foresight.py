"""Time of the next release or stick: the first root of a stress or a velocity within the step."""

import math

import numpy as np

from .arrays import REACH, Event
from .jit import inner, once

# The factors 1/j of Taylor polynomials in derivatives.
RECIPROCAL = np.append(0.0, 1.0 / np.arange(1.0, 2.0 * REACH))
# A stress is evaluated this number of times in a step, and where its slope changes sign.
LOOKS = 4
# A velocity this little below zero at the instant of a stick is the rounding of the root, not
# another stick. A stress this little above the threshold may be on its way down.
ROUNDING = 1e-12


@inner()
def polynomial(coefficients, degree, h):
    """Value at h of a polynomial, lowest power first."""
    value = coefficients[degree]
    for k in range(degree - 1, -1, -1):
        value = coefficients[k] + h * value
    return value


@inner()
def crossing(coefficients, degree, lower, upper):
    """Root between two times, ``upper`` where its sign is lost there; by Newton, or bisection."""
    start = polynomial(coefficients, degree, lower)
    end = polynomial(coefficients, degree, upper)
    rising = start < 0.0
    root = 0.5 * (lower + upper)
    if (end > 0.0) == rising and end != start:
        root = lower + (upper - lower) * start / (start - end)
    # Newton's steps converge quadratically: after a step of 1e-9 the root is exact to rounding.
    close = 1e-9 * upper
    for _ in range(100):
        value = coefficients[degree]
        change = 0.0
        for k in range(degree - 1, -1, -1):
            change = value + root * change
            value = coefficients[k] + root * value
        if (value > 0.0) == rising:
            upper = root
        else:
            lower = root
        candidate = root - value / change if change != 0.0 else upper
        if abs(candidate - root) <= close or upper - lower <= close:
            return min(max(candidate, lower), upper)
        root = candidate if lower < candidate < upper else 0.5 * (lower + upper)
    return root


@inner()
def turning_point(coefficients, slopes, degree, lower, upper):
    """Time at which a polynomial turns once between two, else ``upper``; leaves ``slopes``."""
    for k in range(degree):
        slopes[k] = (k + 1) * coefficients[k + 1]
    if polynomial(slopes, degree - 1, lower) * polynomial(slopes, degree - 1, upper) < 0.0:
        return crossing(slopes, degree - 1, lower, upper)
    return upper


@inner()
def first_reach_of_threshold(coefficients, slopes, degree, lower, upper):
    """First time from ``lower`` to ``upper`` at which a stress, minus 1, reaches 0; inf if none."""
    # Between blocks that slow down, a stress can pass the threshold and fall again within a step.
    for k in range(1, LOOKS + 1):
        part = lower + (upper - lower) * k / LOOKS
        if polynomial(coefficients, degree, part) > ROUNDING:
            return crossing(coefficients, degree, lower, part)
    turn = turning_point(coefficients, slopes, degree, lower, upper)
    if turn < upper and polynomial(coefficients, degree, turn) >= 0.0:
        return crossing(coefficients, degree, lower, turn)
    return math.inf


@inner(inline=True)
def foresee_release(medium, motion, forecast, block, now, h, top):
    """Time at which a stuck block is released until h, or inf, and its stress at ``now``."""
    w, offset = motion.w, motion.offset
    strain = motion.strain
    ahead = (offset[block + 1] - offset[block]) - (offset[block] - offset[block - 1])
    slip = w[0, block] + offset[block]
    elastic = (strain[block] - strain[block - 1]) / medium.dx + medium.per_dx2 * ahead
    # The stress minus 1 is a polynomial of the time since the step began.
    coefficients = forecast.coefficients
    coefficients[0] = elastic - medium.leaf * slip + motion.tau[block] - 1.0
    scale, damping = 1.0, medium.damping if medium.total and medium.beta > 0.0 else 0.0
    for k in range(1, top + 1):
        neighbours = w[k, block - 1] + w[k, block + 1]
        coefficients[k - 1] += scale * damping * neighbours
        scale *= RECIPROCAL[k]
        coefficients[k] = scale * medium.per_dx2 * neighbours
    below = polynomial(coefficients, top, now)
    if below >= 0.0:
        return now, below + 1.0
    rise = 0.0
    for k in range(top, 0, -1):
        rise = h * (max(coefficients[k], 0.0) + rise)
    if coefficients[0] + rise < 0.0:
        return math.inf, below + 1.0
    return first_reach_of_threshold(coefficients, forecast.slopes, top, now, h), below + 1.0


@inner(inline=True)
def foresee_releases(medium, motion, segments, forecast, first, last, now, h):
    """Foresee releases until h of blocks first..last-1. Returns their lowest stress at ``now``."""
    top = motion.w.shape[0] - 1
    lowest = math.inf
    for r in range(segments.count.n):
        for side in range(2):
            block = segments.edges[2 * r + 1] if side else segments.edges[2 * r] - 1
            if not first <= block < last or (medium.mirror and block == 0):
                continue
            release, stress = foresee_release(medium, motion, forecast, block, now, h, top)
            forecast.release[block] = release
            lowest = min(lowest, stress)
    return lowest


@once
def next_event(segments, forecast):
    """The first event foreseen; its time is inf where there is none."""
    block, stick, bends = -1, False, False
    earliest = math.inf
    for r in range(segments.count.n):
        for edge in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            if forecast.release[edge] < earliest:
                block, earliest = edge, forecast.release[edge]
    for q in range(forecast.sticks.n):
        if forecast.stick_time[q] < earliest:
            block, bends = forecast.stick_block[q], forecast.bends[q]
            stick = not bends
            earliest = forecast.stick_time[q]
    return Event(block, earliest, stick, bends)


@once
def simultaneous(segments, forecast, medium, block, latest):
    """True if a later event would meet this one or its mirror image: both must happen at once."""
    near = 2 * REACH + 1
    # The change at the axis is symmetric, but the slopes of friction beyond it are not at hand.
    nearest = 2 if medium.bend is None else 1
    others = 1 if medium.mirror and nearest <= block <= 1 + REACH else 0
    for r in range(segments.count.n):
        for edge in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            others += 0 < abs(edge - block) <= near and forecast.release[edge] <= latest
    for q in range(forecast.sticks.n):
        distance = abs(forecast.stick_block[q] - block)
        others += 0 < distance <= near and forecast.stick_time[q] <= latest
    return others > 0


@inner()
def due_releases(segments, forecast, latest, due):
    """Fill ``due`` with the blocks that are released until ``latest``. Returns their number."""
    count = 0
    for r in range(segments.count.n):
        for edge in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            joined = count > 0 and due[count - 1] == edge
            if forecast.release[edge] <= latest and not joined and count < due.shape[0]:
                due[count] = edge
                count += 1
    return count


@inner()
def foresee_stick(coefficients, slopes, degree, after, now, h):
    """Time until h at which a velocity, ``after`` at h, falls below 0; inf if it does not."""
    before = polynomial(coefficients, degree, now)
    if after >= 0.0:
        if after <= ROUNDING:
            # Released just before the end of the step, its acceleration is 0 but for rounding.
            return math.inf if abs(before) <= ROUNDING else crossing(coefficients, degree, now, h)
        turn = turning_point(coefficients, slopes, degree, now, h)
        if polynomial(coefficients, degree, turn) >= -ROUNDING:
            return math.inf
        return crossing(coefficients, degree, now, turn)
    if before <= ROUNDING:
        turn = turning_point(coefficients, slopes, degree, now, h)
        if polynomial(slopes, degree - 1, now) > 0.0:
            # Released at this very instant: the zero at the start is its release, not a stick.
            return crossing(coefficients, degree, turn, h)
    return crossing(coefficients, degree, now, h) if before > 0.0 else now


@inner(inline=True)
def find_sticks(motion, forecast, first, last, suspects, now, h, top):
    """Add sticks until h among blocks of few suspects. Returns False if one is not finite at h."""
    w, velocity = motion.w, motion.velocity
    coefficients = forecast.coefficients
    for i in range(first, last):
        if velocity[i] >= 0.0 and w[1, i] + h * w[2, i] >= 0.0:
            continue
        if not math.isfinite(velocity[i]):
            return False
        suspects -= 1
        factorial = 1.0
        for k in range(top):
            factorial *= max(k, 1)
            coefficients[k] = w[k + 1, i] / factorial
        root = foresee_stick(coefficients, forecast.slopes, top - 1, velocity[i], now, h)
        if root < math.inf:
            n = forecast.sticks.n
            forecast.stick_block[n], forecast.stick_time[n] = i, root
            forecast.bends[n] = False
            forecast.sticks.n = n + 1
        if suspects == 0:
            break
    return True


@inner()
def foresee_bend(coefficients, slopes, degree, now, h):
    """Time until h at which a slip or slip rate, less that of the bend, reaches 0; inf if not."""
    if polynomial(coefficients, degree, now) >= -ROUNDING:
        later = turning_point(coefficients, slopes, degree, now, h)
        if polynomial(slopes, degree - 1, now) > 0.0:
            return now
        # It leaves the bend at this very instant.
        now = later
    return first_reach_of_threshold(coefficients, slopes, degree, now, h)


@inner(inline=True)
def find_bends(motion, bend, forecast, first, last, now, h, top):
    """Add the bends of friction until h of the blocks first..last-1."""
    if bend is not None:
        w, coefficients = motion.w, forecast.coefficients
        degree = top - bend.rate
        for i in range(first, last):
            sign = 1.0 if motion.falls[i] > 0.0 else -1.0
            # Slip does not come back. A slip rate that does shows it as in `find_sticks`.
            after = sign
            if bend.rate == 1:
                farthest = max(sign * motion.velocity[i], sign * (w[1, i] + h * w[2, i]))
                after = farthest - sign * bend.end
            if after < 0.0:
                continue
            factor = sign
            for k in range(degree + 1):
                coefficients[k] = factor * w[k + bend.rate, i]
                factor *= RECIPROCAL[k + 1]
            reached = motion.released[i] + bend.end
            coefficients[0] -= sign * (reached if bend.rate else reached - motion.offset[i])
            root = foresee_bend(coefficients, forecast.slopes, degree, now, h)
            if root < math.inf:
                n = forecast.sticks.n
                forecast.stick_block[n], forecast.stick_time[n] = i, root
                forecast.bends[n] = True
                forecast.sticks.n = n + 1


@inner(inline=True)
def forget_sticks(forecast, first, last):
    """Drop the foreseen sticks of the blocks first..last-1."""
    block, time, bends = forecast.stick_block, forecast.stick_time, forecast.bends
    kept = 0
    for q in range(forecast.sticks.n):
        if not first <= block[q] < last:
            block[kept], time[kept], bends[kept] = block[q], time[q], bends[q]
            kept += 1
    forecast.sticks.n = kept
