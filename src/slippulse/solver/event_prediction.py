"""Prediction of the next event within a step: a release, a stick, or a kink in the law of friction.

Between events, the stress of a stuck block and the velocity of a sliding block are polynomials in
the time since the step began. A block is released when its stress reaches 1, and it sticks when its
velocity falls to 0. A law of friction may be piecewise linear; the slip or slip rate of a block
reaching the kink of its law is an event, too. Each time is therefore a root of a polynomial, and
`find_next_event` chooses the earliest. Most blocks are excluded by bounds that cost little; roots
are found by Newton's method.
"""

import math

import numpy as np

from .arrays import ACCELERATION, EVENT_REACH, SLIP, VELOCITY, Event
from .jit import inlined_kernel, kernel_function

# The factors 1/j of Taylor polynomials that are written in derivatives; 0 for j = 0.
RECIPROCALS = np.append(0.0, 1.0 / np.arange(1.0, 2.0 * EVENT_REACH))
# A stress is evaluated this number of times in a step, and also where its slope changes sign.
STRESS_EVALUATIONS = 4
# A velocity below zero by no more than this at the instant of a stick is due to the rounding of the
# root and is not another stick. A stress above the threshold by no more than this may be falling.
ROUNDING_TOLERANCE = 1e-12
NEWTON_TOLERANCE = 1e-9  # relative to the upper limit
MAX_NEWTON_STEPS = 100


@kernel_function()
def evaluate_polynomial(coefficients, degree, h):
    """Return the value at h of a polynomial, whose coefficients begin with the lowest power."""
    value = coefficients[degree]
    for k in range(degree - 1, -1, -1):
        value = coefficients[k] + h * value
    return value


@kernel_function()
def find_crossing(coefficients, degree, lower, upper):
    """Return a root between two times by Newton's method, with bisection as a safeguard.

    If rounding hides the change of sign at the upper time, the result is the upper time.
    """
    at_lower = evaluate_polynomial(coefficients, degree, lower)
    at_upper = evaluate_polynomial(coefficients, degree, upper)
    is_rising = at_lower < 0.0
    # Start from linear interpolation, or from the middle if the sign does not change.
    root = 0.5 * (lower + upper)
    if (at_upper > 0.0) == is_rising and at_upper != at_lower:
        root = lower + (upper - lower) * at_lower / (at_lower - at_upper)
    # Newton's method converges quadratically: after a step of 1e-9 the root is exact to rounding.
    tolerance = NEWTON_TOLERANCE * upper
    for _ in range(MAX_NEWTON_STEPS):
        # Horner's rule for the value and the slope of the polynomial.
        value = coefficients[degree]
        slope = 0.0
        for k in range(degree - 1, -1, -1):
            slope = value + root * slope
            value = coefficients[k] + root * value
        if (value > 0.0) == is_rising:
            upper = root
        else:
            lower = root
        candidate = root - value / slope if slope != 0.0 else upper
        if abs(candidate - root) <= tolerance or upper - lower <= tolerance:
            return min(max(candidate, lower), upper)
        root = candidate if lower < candidate < upper else 0.5 * (lower + upper)
    return root


@kernel_function()
def find_turning_point(coefficients, slopes, degree, lower, upper):
    """Return the time at which the slope of a polynomial changes sign, ``upper`` if it does not.

    The coefficients of the slope are left in ``slopes``.
    """
    for k in range(degree):
        slopes[k] = (k + 1) * coefficients[k + 1]
    at_lower = evaluate_polynomial(slopes, degree - 1, lower)
    at_upper = evaluate_polynomial(slopes, degree - 1, upper)
    if at_lower * at_upper < 0.0:
        return find_crossing(slopes, degree - 1, lower, upper)
    return upper


@kernel_function()
def find_threshold_crossing(coefficients, slopes, degree, lower, upper):
    """Return the first time between two at which a polynomial rises to 0, inf if it does not.

    The polynomial is the stress of a block minus the threshold of 1.
    """
    # Between blocks that slow down, a stress can pass the threshold and fall again within one step.
    for k in range(1, STRESS_EVALUATIONS + 1):
        time = lower + (upper - lower) * k / STRESS_EVALUATIONS
        if evaluate_polynomial(coefficients, degree, time) > ROUNDING_TOLERANCE:
            return find_crossing(coefficients, degree, lower, time)
    turn = find_turning_point(coefficients, slopes, degree, lower, upper)
    if turn < upper and evaluate_polynomial(coefficients, degree, turn) >= 0.0:
        return find_crossing(coefficients, degree, lower, turn)
    return math.inf


@kernel_function(inline=True)
def predict_release(medium, motion, prediction, block, now, h, top):
    """Return the time at which a stuck block is released, and its stress at the time ``now``.

    The time is inf if the block is not released until h.
    """
    w, offset = motion.w, motion.offset
    strain = motion.strain
    curvature = (offset[block + 1] - offset[block]) - (offset[block] - offset[block - 1])
    slip = w[SLIP, block] + offset[block]
    elastic = (strain[block] - strain[block - 1]) / medium.dx + medium.inverse_dx2 * curvature
    # The stress minus 1 is a polynomial of the time since the step began. The block is at rest, so
    # that its terms come from the time derivatives of the slip of its two neighbours.
    coefficients = prediction.coefficients
    coefficients[0] = elastic - medium.leaf_stiffness * slip + motion.tau[block] - 1.0
    inverse_factorial, damping = 1.0, 0.0
    if medium.damping_counts_for_release and medium.beta > 0.0:
        damping = medium.damping
    for k in range(1, top + 1):
        neighbours = w[k, block - 1] + w[k, block + 1]
        # The damping force contains the velocity, whose derivative k - 1 is derivative k of slip.
        coefficients[k - 1] += inverse_factorial * damping * neighbours
        inverse_factorial *= RECIPROCALS[k]
        coefficients[k] = inverse_factorial * medium.inverse_dx2 * neighbours
    above_threshold = evaluate_polynomial(coefficients, top, now)
    if above_threshold >= 0.0:
        return now, above_threshold + 1.0
    # The positive terms alone bound the rise of the stress. Most searches for a root end here.
    rise = 0.0
    for k in range(top, 0, -1):
        rise = h * (max(coefficients[k], 0.0) + rise)
    if coefficients[0] + rise < 0.0:
        return math.inf, above_threshold + 1.0
    time = find_threshold_crossing(coefficients, prediction.slopes, top, now, h)
    return time, above_threshold + 1.0


@kernel_function(inline=True)
def predict_releases(medium, motion, segments, prediction, first, last, now, h):
    """Predict the releases of the blocks first..last-1 until time h.

    Only the neighbours of sliding segments can be released. Returns their lowest stress at ``now``.
    """
    top = motion.w.shape[0] - 1
    lowest = math.inf
    for r in range(segments.count.n):
        for side in range(2):
            block = segments.edges[2 * r + 1] if side else segments.edges[2 * r] - 1
            if not first <= block < last or (medium.is_mirrored and block == 0):
                continue
            release, stress = predict_release(medium, motion, prediction, block, now, h, top)
            prediction.release_time[block] = release
            lowest = min(lowest, stress)
    return lowest


@inlined_kernel
def find_next_event(segments, prediction):
    """Return the earliest predicted event. Its time is inf if there is none."""
    block, earliest = -1, math.inf
    is_stick = is_law_kink = False
    for r in range(segments.count.n):
        for edge in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            if prediction.release_time[edge] < earliest:
                block, earliest = edge, prediction.release_time[edge]
    for q in range(prediction.event_count.n):
        if prediction.event_time[q] < earliest:
            block, is_law_kink = prediction.event_block[q], prediction.is_law_kink[q]
            is_stick = not is_law_kink
            earliest = prediction.event_time[q]
    return Event(block, earliest, is_stick, is_law_kink)


@inlined_kernel
def has_simultaneous_event(segments, prediction, medium, block, latest):
    """Return True if an event until ``latest`` would interact with an event of this block.

    Its own mirror image counts as well. Such events must happen together.
    """
    # Two events interact if the blocks that they change overlap or are neighbours.
    near = 2 * EVENT_REACH + 1
    # Block 1 on the axis is its own mirror image, and does not interact with itself. The slopes of
    # friction of the mirror images, however, are not stored, so with a kink of the law it counts.
    nearest = 2 if medium.law_kink is None else 1
    others = 1 if medium.is_mirrored and nearest <= block <= 1 + EVENT_REACH else 0
    for r in range(segments.count.n):
        for edge in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            others += 0 < abs(edge - block) <= near and prediction.release_time[edge] <= latest
    for q in range(prediction.event_count.n):
        distance = abs(prediction.event_block[q] - block)
        others += 0 < distance <= near and prediction.event_time[q] <= latest
    return others > 0


@kernel_function()
def list_due_releases(segments, prediction, latest, due):
    """Write the blocks that are released until ``latest`` into ``due``, and return their number."""
    count = 0
    for r in range(segments.count.n):
        for edge in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            is_due = prediction.release_time[edge] <= latest
            is_listed = count > 0 and due[count - 1] == edge
            if is_due and not is_listed and count < due.shape[0]:
                due[count] = edge
                count += 1
    return count


@kernel_function()
def predict_stick(coefficients, slopes, degree, velocity_after, now, h):
    """Return the time until h at which a velocity falls below 0, inf if it does not.

    The coefficients are those of the velocity. ``velocity_after`` is the velocity at h.
    """
    velocity_now = evaluate_polynomial(coefficients, degree, now)
    if velocity_after >= 0.0:
        if velocity_after <= ROUNDING_TOLERANCE:
            # If a block was released just before the end of the step, its acceleration is 0 apart
            # from rounding.
            if abs(velocity_now) <= ROUNDING_TOLERANCE:
                return math.inf
            return find_crossing(coefficients, degree, now, h)
        # The velocity may be negative for a part of the step, around its minimum.
        turn = find_turning_point(coefficients, slopes, degree, now, h)
        if evaluate_polynomial(coefficients, degree, turn) >= -ROUNDING_TOLERANCE:
            return math.inf
        return find_crossing(coefficients, degree, now, turn)
    if velocity_now <= ROUNDING_TOLERANCE:
        turn = find_turning_point(coefficients, slopes, degree, now, h)
        if evaluate_polynomial(slopes, degree - 1, now) > 0.0:
            # The block is released at this instant: the zero at the start is its release, and the
            # velocity falls to 0 again after its maximum.
            return find_crossing(coefficients, degree, turn, h)
    return find_crossing(coefficients, degree, now, h) if velocity_now > 0.0 else now


@kernel_function(inline=True)
def predict_sticks(motion, prediction, first, last, suspects, now, h, top):
    """Predict the sticks of the blocks first..last-1 until time h.

    The search ends when all ``suspects``, the number of blocks that may stick, have been found.
    Returns False if a velocity is not finite at h.
    """
    w, velocity = motion.w, motion.velocity
    coefficients = prediction.coefficients
    for i in range(first, last):
        # A velocity that is negative only for a part of the step shows it in its tangent.
        if velocity[i] >= 0.0 and w[VELOCITY, i] + h * w[ACCELERATION, i] >= 0.0:
            continue
        if not math.isfinite(velocity[i]):
            return False
        suspects -= 1
        factorial = 1.0
        for k in range(top):
            factorial *= max(k, 1)
            coefficients[k] = w[k + 1, i] / factorial
        root = predict_stick(coefficients, prediction.slopes, top - 1, velocity[i], now, h)
        if root < math.inf:
            n = prediction.event_count.n
            prediction.event_block[n], prediction.event_time[n] = i, root
            prediction.is_law_kink[n] = False
            prediction.event_count.n = n + 1
        if suspects == 0:
            break
    return True


@kernel_function()
def predict_law_kink(coefficients, slopes, degree, now, h):
    """Return the time until h at which a polynomial reaches 0, inf if it does not.

    The polynomial is the slip or slip rate of a block minus its value at the kink of the law.
    """
    if evaluate_polynomial(coefficients, degree, now) >= -ROUNDING_TOLERANCE:
        later = find_turning_point(coefficients, slopes, degree, now, h)
        if evaluate_polynomial(slopes, degree - 1, now) > 0.0:
            return now
        # The block leaves the kink at this instant.
        now = later
    return find_threshold_crossing(coefficients, slopes, degree, now, h)


@kernel_function(inline=True)
def predict_law_kinks(motion, law_kink, prediction, first, last, now, h, top):
    """Predict until time h when the blocks first..last-1 reach the kink of their law.

    The polynomial is the slip or slip rate minus its value at the kink. It is multiplied by -1 for
    a block that is beyond the kink, so that it rises to 0 in either direction.
    """
    if law_kink is not None:
        w, coefficients = motion.w, prediction.coefficients
        degree = top - law_kink.rate
        for i in range(first, last):
            sign = 1.0 if motion.weakening_slope[i] > 0.0 else -1.0
            # A block is left out if ``after``, the polynomial at the end of the step or only its
            # sign, is negative. Slip only grows: every block before a kink in slip is examined, and
            # none beyond it. A slip rate that passes the kink for a part of the step shows it in
            # its tangent, as in `predict_sticks`.
            after = sign
            if law_kink.rate == 1:
                tangent_after = w[VELOCITY, i] + h * w[ACCELERATION, i]
                farthest = max(sign * motion.velocity[i], sign * tangent_after)
                after = farthest - sign * law_kink.end
            if after < 0.0:
                continue
            factor = sign
            for k in range(degree + 1):
                coefficients[k] = factor * w[k + law_kink.rate, i]
                factor *= RECIPROCALS[k + 1]
            # In a law of slip rate, slip_at_release is 0. Only the row of slip has an offset.
            at_kink = motion.slip_at_release[i] + law_kink.end
            coefficients[0] -= sign * (at_kink if law_kink.rate else at_kink - motion.offset[i])
            root = predict_law_kink(coefficients, prediction.slopes, degree, now, h)
            if root < math.inf:
                n = prediction.event_count.n
                prediction.event_block[n], prediction.event_time[n] = i, root
                prediction.is_law_kink[n] = True
                prediction.event_count.n = n + 1


@kernel_function(inline=True)
def drop_predicted_events(prediction, first, last):
    """Drop the predicted sticks and kinks of the blocks first..last-1."""
    block, time = prediction.event_block, prediction.event_time
    is_law_kink = prediction.is_law_kink
    kept = 0
    for q in range(prediction.event_count.n):
        if not first <= block[q] < last:
            block[kept], time[kept] = block[q], time[q]
            is_law_kink[kept] = is_law_kink[q]
            kept += 1
    prediction.event_count.n = kept
