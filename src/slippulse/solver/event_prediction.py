"""Prediction of the next event within a step: a release, a stick, or a kink in the law of friction.

Between events, the stress of a stuck block and the velocity of a sliding block are polynomials in
the time since the step began. A block is released when its stress reaches 1, and it sticks when its
velocity falls to 0. If the law of friction is piecewise linear, a third kind of event is that the
slip or slip rate of a block reaches the kink. Each time is therefore a root of a polynomial, and
`find_next_event` chooses the earliest. Most blocks are excluded by bounds that cost little; roots
are found by Newton's method.

All times are counted from the start of the step: ``now`` is the time from which on events are
searched for, and ``step_end`` is the end of the step. ``top`` is the order of the highest time
derivative of slip that the step has computed. The ``coefficients`` of a polynomial begin with that
of the lowest power, and end with that of the power ``degree``.

Arguments such as ``medium``, ``motion`` and ``prediction`` are groups of numbers and arrays, which
`arrays` defines. Row k of ``w``, which is ``motion.derivatives``, is time derivative k of slip; its
columns are blocks. Segment r of sliding blocks begins with the block ``edges[2 r]`` and ends before
the block ``edges[2 r + 1]``.
"""

import math

import numpy as np

from .arrays import ACCELERATION, EVENT_REACH, SLIP, VELOCITY, Event
from .jit import inlined_kernel, kernel_function

# Entry k is 1/k, a factor of Taylor polynomials that are written in derivatives; entry 0 is 0.
INVERSE_INTEGERS = np.append(0.0, 1.0 / np.arange(1.0, 2.0 * EVENT_REACH))
# A stress is evaluated this number of times in a step, and also where its slope changes sign.
STRESS_EVALUATIONS = 4
# At the instant of a stick, rounding of the root can make the velocity negative, but not by more
# than this number. In the same way, the stress of a block can be above the threshold by rounding.
ROUNDING_TOLERANCE = 1e-12
NEWTON_TOLERANCE = 1e-9  # relative to the upper limit
MAX_NEWTON_STEPS = 100


@kernel_function()
def evaluate_polynomial(coefficients, degree, x):
    """Return the value of a polynomial at x."""
    value = coefficients[degree]
    for k in range(degree - 1, -1, -1):
        value = coefficients[k] + x * value
    return value


@kernel_function()
def find_crossing(coefficients, degree, lower, upper):
    """Return a root of a polynomial between two times, by Newton's method with bisection.

    If rounding hides the change of sign at the upper time, the result is the upper time.
    """
    value_at_lower = evaluate_polynomial(coefficients, degree, lower)
    value_at_upper = evaluate_polynomial(coefficients, degree, upper)
    is_rising = value_at_lower < 0.0
    # Start from linear interpolation, or from the middle if the sign does not change.
    root = 0.5 * (lower + upper)
    if (value_at_upper > 0.0) == is_rising and value_at_upper != value_at_lower:
        root = lower + (upper - lower) * value_at_lower / (value_at_lower - value_at_upper)
    # Newton's method converges quadratically: after a step of 1e-9 the root is exact to rounding.
    tolerance = NEWTON_TOLERANCE * upper
    for _ in range(MAX_NEWTON_STEPS):
        # Horner's rule for the value and the slope of the polynomial.
        value = coefficients[degree]
        slope = 0.0
        for k in range(degree - 1, -1, -1):
            slope = value + root * slope
            value = coefficients[k] + root * value
        # Narrow the interval that contains the root.
        if (value > 0.0) == is_rising:
            upper = root
        else:
            lower = root
        candidate = root - value / slope if slope != 0.0 else upper
        if abs(candidate - root) <= tolerance or upper - lower <= tolerance:
            return min(max(candidate, lower), upper)
        # A step of Newton's method that leaves the interval is replaced by a bisection.
        root = candidate if lower < candidate < upper else 0.5 * (lower + upper)
    return root


@kernel_function()
def find_turning_point(coefficients, slopes, degree, lower, upper):
    """Return the time at which the slope of a polynomial changes sign, ``upper`` if it does not.

    slopes : receives the coefficients of the slope, which is the derivative of the polynomial
    """
    for k in range(degree):
        slopes[k] = (k + 1) * coefficients[k + 1]
    slope_at_lower = evaluate_polynomial(slopes, degree - 1, lower)
    slope_at_upper = evaluate_polynomial(slopes, degree - 1, upper)
    if slope_at_lower * slope_at_upper < 0.0:
        return find_crossing(slopes, degree - 1, lower, upper)
    return upper


@kernel_function()
def find_threshold_crossing(coefficients, slopes, degree, lower, upper):
    """Return the first time from ``lower`` to ``upper`` at which a polynomial rises to 0.

    The polynomial is, for example, the stress of a block minus the threshold of 1. The result is
    inf if the polynomial does not reach 0. ``slopes`` is scratch for the coefficients of its slope.
    """
    # The stress of a block next to one that slows down can pass the threshold and fall again within
    # one step. It is therefore evaluated at several times.
    for k in range(1, STRESS_EVALUATIONS + 1):
        time = lower + (upper - lower) * k / STRESS_EVALUATIONS
        if evaluate_polynomial(coefficients, degree, time) > ROUNDING_TOLERANCE:
            return find_crossing(coefficients, degree, lower, time)
    # Between these times the polynomial may still reach 0 for a moment, at its highest point.
    turn = find_turning_point(coefficients, slopes, degree, lower, upper)
    if turn < upper and evaluate_polynomial(coefficients, degree, turn) >= 0.0:
        return find_crossing(coefficients, degree, lower, turn)
    return math.inf


@kernel_function(inline=True)
def elastic_force(medium, motion, block):
    """Return the elastic force on a block by its neighbours, with the slip by events of the step.

    The stored strain is that of the start of the step, and does not contain this slip yet.
    """
    strain, event_slip = motion.strain, motion.event_slip
    at_step_start = (strain[block] - strain[block - 1]) / medium.dx
    added_on_left = event_slip[block] - event_slip[block - 1]
    added_on_right = event_slip[block + 1] - event_slip[block]
    return at_step_start + medium.inverse_dx2 * (added_on_right - added_on_left)


@kernel_function(inline=True)
def predict_release(medium, motion, prediction, block, now, step_end, top):
    """Return the time at which a stuck block is released, and its stress at the time ``now``.

    The time is inf if the block is not released until ``step_end``, the end of the step.
    """
    w, coefficients = motion.derivatives, prediction.coefficients
    # The stress minus 1 is a polynomial of the time since the step began. Its constant term is the
    # stress at the start of the step, with the slip that earlier events of the step have added.
    slip = w[SLIP, block] + motion.event_slip[block]
    elastic = elastic_force(medium, motion, block)
    coefficients[0] = elastic - medium.leaf_stiffness * slip + motion.tau[block] - 1.0
    # The block is at rest, so that only the motion of its two neighbours changes its stress, by
    # their slip and, through damping, by their velocities. The coefficient of power k is derivative
    # k of the stress, divided by k!. In the loop, ``inverse_factorial`` is 1/(k - 1)!, then 1/k!.
    inverse_factorial, damping = 1.0, 0.0
    # With beta < 0, the sign that the paper prints, the stress that decides on a release does not
    # contain damping.
    if medium.damping_counts_for_release and medium.beta > 0.0:
        damping = medium.damping
    for k in range(1, top + 1):
        neighbours = w[k, block - 1] + w[k, block + 1]
        # Derivative k - 1 of the velocity is derivative k of slip.
        coefficients[k - 1] += inverse_factorial * damping * neighbours
        inverse_factorial *= INVERSE_INTEGERS[k]
        coefficients[k] = inverse_factorial * medium.inverse_dx2 * neighbours
    excess_stress = evaluate_polynomial(coefficients, top, now)
    if excess_stress >= 0.0:
        return now, excess_stress + 1.0
    # The positive terms alone, at ``step_end``, bound the rise of the stress. In most calls they
    # rule out a release, and no root is searched for.
    largest_rise = 0.0
    for k in range(top, 0, -1):
        largest_rise = step_end * (max(coefficients[k], 0.0) + largest_rise)
    if coefficients[0] + largest_rise < 0.0:
        return math.inf, excess_stress + 1.0
    time = find_threshold_crossing(coefficients, prediction.slopes, top, now, step_end)
    return time, excess_stress + 1.0


@kernel_function(inline=True)
def predict_releases(medium, motion, segments, prediction, first, last, now, step_end):
    """Predict the releases of the blocks first..last-1 from the time ``now`` until ``step_end``.

    Only the neighbours of sliding segments can be released. Returns their lowest stress at ``now``.
    """
    top = motion.derivatives.shape[0] - 1
    lowest_stress = math.inf
    for r in range(segments.count.n):
        for side in range(2):
            # The block before the segment, then the block behind it.
            block = segments.edges[2 * r] - 1 if side == 0 else segments.edges[2 * r + 1]
            is_mirror_image = medium.is_mirrored and block == 0
            if not first <= block < last or is_mirror_image:
                continue
            release, stress = predict_release(medium, motion, prediction, block, now, step_end, top)
            prediction.release_time[block] = release
            lowest_stress = min(lowest_stress, stress)
    return lowest_stress


@inlined_kernel
def find_next_event(segments, prediction):
    """Return the earliest predicted event, or one at the time inf if no event is predicted."""
    block, earliest = -1, math.inf
    is_stick = is_law_kink = False
    # Releases, which are predicted for the two neighbours of each segment.
    for r in range(segments.count.n):
        for neighbour in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            if prediction.release_time[neighbour] < earliest:
                block, earliest = neighbour, prediction.release_time[neighbour]
    # Sticks and kinks of the law.
    for q in range(prediction.event_count.n):
        if prediction.event_time[q] < earliest:
            block, is_law_kink = prediction.event_block[q], prediction.is_law_kink[q]
            is_stick = not is_law_kink
            earliest = prediction.event_time[q]
    return Event(block, earliest, is_stick, is_law_kink)


@kernel_function(inline=True)
def interacts_with_mirror_image(medium, block):
    """Return True if an event of a block interacts with that of the block's mirror image."""
    # Block 1 on the axis is its own mirror image, so that there is no second event. If the law has
    # a kink, however, an event of block 1 counts as well, because it would also change mirror
    # images, whose slopes of friction are not stored.
    nearest = 2 if medium.law_kink is None else 1
    return medium.is_mirrored and nearest <= block <= 1 + EVENT_REACH


@inlined_kernel
def has_simultaneous_event(segments, prediction, medium, block, latest):
    """Return True if another event until the time ``latest`` interacts with the event of a block.

    Such events must happen together. The event of the block's mirror image counts as well.
    """
    # Two events interact if the blocks that they change overlap or are neighbours.
    near = 2 * EVENT_REACH + 1
    is_found = interacts_with_mirror_image(medium, block)
    # Releases of the two neighbours of each segment.
    for r in range(segments.count.n):
        for neighbour in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            is_near = 0 < abs(neighbour - block) <= near
            is_found |= is_near and prediction.release_time[neighbour] <= latest
    # Sticks and kinks of the law.
    for q in range(prediction.event_count.n):
        is_near = 0 < abs(prediction.event_block[q] - block) <= near
        is_found |= is_near and prediction.event_time[q] <= latest
    return is_found


@kernel_function()
def list_due_releases(segments, prediction, latest, due):
    """Write the blocks that are released until ``latest`` into ``due``, and return their number.

    If there are more of them than ``due`` can hold, the others are released in the next step.
    """
    count = 0
    for r in range(segments.count.n):
        for neighbour in (segments.edges[2 * r] - 1, segments.edges[2 * r + 1]):
            is_due = prediction.release_time[neighbour] <= latest
            # A block between two segments is a neighbour of both.
            is_listed = count > 0 and due[count - 1] == neighbour
            if is_due and not is_listed and count < due.shape[0]:
                due[count] = neighbour
                count += 1
    return count


@kernel_function()
def predict_stick(coefficients, slopes, degree, end_velocity, now, step_end):
    """Return the time from ``now`` to ``step_end`` at which a block sticks, inf if it does not.

    A block sticks when its velocity, a polynomial of the time since the step began, falls below 0.

    coefficients : those of the velocity
    slopes : scratch for the coefficients of its slope
    end_velocity : velocity at the time ``step_end``
    """
    velocity_now = evaluate_polynomial(coefficients, degree, now)
    if end_velocity > ROUNDING_TOLERANCE:
        # The block sticks only if the velocity has a negative minimum within the step.
        turn = find_turning_point(coefficients, slopes, degree, now, step_end)
        if evaluate_polynomial(coefficients, degree, turn) >= -ROUNDING_TOLERANCE:
            return math.inf
        return find_crossing(coefficients, degree, now, turn)
    if end_velocity >= 0.0 and abs(velocity_now) <= ROUNDING_TOLERANCE:
        # The velocity is 0 now and at the end, apart from rounding. The block was released just
        # before the end of the step, and does not stick.
        return math.inf
    if end_velocity >= 0.0 or velocity_now > ROUNDING_TOLERANCE:
        # The velocity falls from a positive value to 0, apart from rounding, or below.
        return find_crossing(coefficients, degree, now, step_end)
    # The velocity is 0 now, apart from rounding, and negative at the end. If it rises now, the
    # block has just been released, and sticks after its velocity has passed the maximum.
    # `find_turning_point` also fills ``slopes``.
    turn = find_turning_point(coefficients, slopes, degree, now, step_end)
    is_rising = evaluate_polynomial(slopes, degree - 1, now) > 0.0
    if is_rising:
        return find_crossing(coefficients, degree, turn, step_end)
    # Otherwise the block sticks at once, or as soon as the small positive velocity is gone.
    return find_crossing(coefficients, degree, now, step_end) if velocity_now > 0.0 else now


@kernel_function(inline=True)
def add_predicted_event(prediction, block, time, is_law_kink):
    """Append an event of a sliding block to the list: a kink of its law, or else a stick."""
    n = prediction.event_count.n
    prediction.event_block[n], prediction.event_time[n] = block, time
    prediction.is_law_kink[n] = is_law_kink
    prediction.event_count.n = n + 1


@kernel_function(inline=True)
def predict_sticks(motion, prediction, first, last, may_stick_count, now, step_end, top):
    """Predict the sticks of the blocks first..last-1 from the time ``now`` until ``step_end``.

    Returns False if a velocity is not finite at the end of the step.

    may_stick_count : number of blocks that may stick; the search ends after them
    top : order of the highest time derivative of slip
    """
    w, end_velocity = motion.derivatives, motion.end_velocity
    coefficients = prediction.coefficients
    for i in range(first, last):
        # A block may stick if its velocity is negative at the end of the step. If it is negative
        # only in between, it curves upwards and lies above its tangent at the start of the step, so
        # that this tangent is negative at the end.
        tangent_at_end = w[VELOCITY, i] + step_end * w[ACCELERATION, i]
        if end_velocity[i] >= 0.0 and tangent_at_end >= 0.0:
            continue
        if not math.isfinite(end_velocity[i]):
            return False
        may_stick_count -= 1
        # The velocity as a polynomial of the time since the step began.
        factorial = 1.0
        for k in range(top):
            factorial *= max(k, 1)
            coefficients[k] = w[k + 1, i] / factorial
        stick_time = predict_stick(
            coefficients, prediction.slopes, top - 1, end_velocity[i], now, step_end
        )
        if stick_time < math.inf:
            add_predicted_event(prediction, i, stick_time, is_law_kink=False)
        if may_stick_count == 0:
            break
    return True


@kernel_function()
def predict_law_kink(coefficients, slopes, degree, now, step_end):
    """Return the time from ``now`` to ``step_end`` at which a block reaches the kink of its law.

    The result is inf if it does not reach the kink.

    coefficients : those of a polynomial of time that rises to 0 at the kink: the slip or slip rate
        minus its value at the kink, or the opposite for a block beyond the kink
    slopes : scratch for the coefficients of its slope
    """
    if evaluate_polynomial(coefficients, degree, now) < -ROUNDING_TOLERANCE:
        return find_threshold_crossing(coefficients, slopes, degree, now, step_end)
    # The block is at the kink now. If the polynomial rises, the block passes it at this instant.
    # `find_turning_point` also fills ``slopes``.
    turn = find_turning_point(coefficients, slopes, degree, now, step_end)
    if evaluate_polynomial(slopes, degree - 1, now) > 0.0:
        return now
    # If it falls, the block can return to the kink only after the turning point.
    return find_threshold_crossing(coefficients, slopes, degree, turn, step_end)


@kernel_function(inline=True)
def predict_law_kinks(motion, law_kink, prediction, first, last, now, step_end, top):
    """Predict when the blocks first..last-1 reach the kink of their law, from ``now`` on.

    Friction decreases with its argument, the slip or the slip rate, until it reaches the kink, and
    is constant beyond. Row ``argument_row`` of the derivatives is this argument. Without such a law
    (``law_kink`` is None) nothing is predicted.

    now, step_end : start and end of the search, counted from the start of the step
    top : order of the highest time derivative of slip
    """
    if law_kink is not None:
        w, coefficients = motion.derivatives, prediction.coefficients
        degree = top - law_kink.argument_row
        for i in range(first, last):
            # Before the kink, the argument reaches it by rising. Beyond the kink, where the slope
            # is 0, it would have to fall, which the sign -1 turns into a rise.
            is_before_kink = motion.weakening_slope[i] > 0.0
            sign = 1.0 if is_before_kink else -1.0
            if law_kink.argument_row == SLIP:
                # Slip only grows, so that it does not come back to the kink.
                is_out_of_reach = not is_before_kink
            else:
                # A slip rate that reaches the kink has either passed it at the end of the step, or
                # has turned back before. A curve that turns back bends away from its tangent at the
                # start of the step, so that this tangent is beyond the kink at the end.
                tangent_at_end = w[VELOCITY, i] + step_end * w[ACCELERATION, i]
                largest = max(sign * motion.end_velocity[i], sign * tangent_at_end)
                is_out_of_reach = largest < sign * law_kink.argument_at_kink
            if is_out_of_reach:
                continue
            # Write the Taylor polynomial of the argument minus its value at the kink, times the
            # sign. This polynomial rises to 0 at the kink. The coefficient of power k is derivative
            # k, divided by k!.
            signed_inverse_factorial = sign
            for k in range(degree + 1):
                coefficients[k] = signed_inverse_factorial * w[k + law_kink.argument_row, i]
                signed_inverse_factorial *= INVERSE_INTEGERS[k + 1]
            # Slip is counted from the release. In a law of slip rate, slip_at_release is 0.
            argument_at_kink = motion.slip_at_release[i] + law_kink.argument_at_kink
            if law_kink.argument_row == SLIP:
                # Slip in ``w`` does not contain the slip by events of the step yet.
                argument_at_kink -= motion.event_slip[i]
            coefficients[0] -= sign * argument_at_kink
            time_of_kink = predict_law_kink(coefficients, prediction.slopes, degree, now, step_end)
            if time_of_kink < math.inf:
                add_predicted_event(prediction, i, time_of_kink, is_law_kink=True)


@kernel_function(inline=True)
def drop_predicted_events(prediction, first, last):
    """Remove the predicted sticks and kinks of the blocks first..last-1 from the list."""
    block, time = prediction.event_block, prediction.event_time
    is_law_kink = prediction.is_law_kink
    # The events that are kept move to the beginning of the arrays.
    kept_count = 0
    for q in range(prediction.event_count.n):
        if not first <= block[q] < last:
            block[kept_count], time[kept_count] = block[q], time[q]
            is_law_kink[kept_count] = is_law_kink[q]
            kept_count += 1
    prediction.event_count.n = kept_count
