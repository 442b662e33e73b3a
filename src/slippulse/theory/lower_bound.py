r"""A lower bound of du/dt between two positions that slide, to prove that nothing sticks there.

Samples of du/dt alone cannot exclude a stick between them; the bound can. In the coordinates xi = t
- y and eta = t + y, w = exp(alpha t/2) du/dt obeys w_xi_eta = -k w/4. Hence w = F - W. F is half
the integral of tau exp(alpha T/2) along the part of the curve in the past of a point. W is k/4
times the integral of w over the region of its past. If k > 0, W grows with xi and with eta as long
as w > 0 in this region.

Let a and b be two positions at the same time, a distance h apart, and c the point from which their
characteristics went apart, at (a + b)/2 and h/2 earlier:

     a ------ b     time t
      \      /
       \    /
        \  /
         c          time t - h/2

For k > 0, w in the whole triangle is at least

    w(a) + w(b) - w(c) - J - k h^2/16 (w(c) + J),

where J is the gain of F by positive pre-stress between c and a and between c and b. For k <= 0, w
is at least w(c) less the loss of F by negative pre-stress. If c has not slipped, behind a front
that outruns the waves, w > 0 as long as the pre-stress is positive and J0 is before its first zero.

An interval is divided until the bound is positive, or until it is too short to change any result.
"""

import numpy as np

from .curve import WEIGHTS
from .part import Part
from .riemann import MAX_EXPONENT, partial_weights

# Points on the curve, from left to right: where the past of a begins, where that of c begins and
# ends, and where that of b ends.
A_BEGINS, C_BEGINS, C_ENDS, B_ENDS = range(4)
# The square of the first zero of the Bessel function J0.
SQUARED_FIRST_ZERO = 5.783185962946784
# An interval whose bound is not positive is cut into this number of parts.
PARTS_PER_CUT = 4
# Shortest interval that is cut, in units of `Part.scale`, if both ends have slip velocity.
MIN_INTERVAL = 1e-6
# Shortest interval that is cut if one end does not move yet.
MIN_INTERVAL_AT_REST = 1e-3
# Within this distance of the first stick, in units of `Part.scale`, the trailing edge itself shows
# that this one is the first.
FIRST_STICK_DISTANCE = 0.2
# Slip velocities below this are 0.
ROUNDING_ERROR = 1e-12
# Slip velocity below which motion is faint. Strong rate strengthening leaves a creep that is much
# slower than what pre-stress adds to it, and than the error of the bound.
FAINT_VELOCITY = 1e-5
# Shortest interval that is cut if the motion was faint at both ends of the first interval.
MIN_FAINT_INTERVAL = 1e-2


def stuck_between(part: Part, x: np.ndarray, time: float, first: float = np.inf) -> np.ndarray:
    """Return positions that have stuck until a time, between pairs of positions that slide then.

    The result is empty if nothing has stuck. x has the pairs, [left and right, pair]. first is the
    position that sticks at this time, if it is known.
    """

    def velocity_at(x: np.ndarray) -> np.ndarray:
        """Return du/dt at positions of any shape."""
        return part.velocity(x.ravel(), np.full(x.size, time)).reshape(x.shape)

    velocity = velocity_at(x)
    is_faint = velocity.max(axis=0) < FAINT_VELOCITY
    while x.size:
        both_move = velocity.min(axis=0) > ROUNDING_ERROR
        min_length = np.where(both_move, MIN_INTERVAL, MIN_INTERVAL_AT_REST)
        min_length[is_faint] = MIN_FAINT_INTERVAL
        # Only pairs between which something may still have stuck are cut into parts.
        is_open = x[1] - x[0] > min_length * part.scale
        is_open &= ~stays_positive(part, x=x, velocity=velocity, time=time)
        is_open &= np.abs(x - first).max(axis=0) > FIRST_STICK_DISTANCE * part.scale
        # The ends of the parts and du/dt there, [end, pair].
        ends = np.linspace(x[0, is_open], x[1, is_open], PARTS_PER_CUT + 1)
        inner_velocity = velocity_at(ends[1:-1])
        has_stuck = inner_velocity < -ROUNDING_ERROR
        if np.any(has_stuck):
            return ends[1:-1][has_stuck]
        end_velocity = np.concatenate(
            [velocity[:1, is_open], inner_velocity, velocity[1:, is_open]]
        )
        is_faint = np.tile(is_faint[is_open], PARTS_PER_CUT)
        x = np.array([ends[:-1], ends[1:]]).reshape(2, -1)
        velocity = np.array([end_velocity[:-1], end_velocity[1:]]).reshape(2, -1)
    return np.empty(0)


def stays_positive(part: Part, x: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    """Return a mask of the pairs between which nothing sticks until a time.

    x and velocity (du/dt) are [left and right, pair]. Both positions and everything in their past
    must slide until the time, or a front has just arrived there.
    """
    left, right = x
    curve, alpha = part.curve, part.alpha
    span, middle = right - left, 0.5 * (left + right)
    # The point c is at the middle at this time.
    apex_time = time - 0.5 * (right - left)
    # Where the past of a begins on the curve, and where that of b ends.
    begin, end = curve.crossings(middle, time - left, time + right)
    domains = part.domains(middle, apex_time)
    k = domains.stiffness
    apex_slides = curve.arrival(middle) < apex_time
    # In the order of A_BEGINS, C_BEGINS, C_ENDS and B_ENDS.
    crossings = (begin, domains.left, domains.right, end)
    panel = np.concatenate([crossing.panel for crossing in crossings])
    s = np.concatenate([crossing.s for crossing in crossings])
    # w and F are divided by exp(alpha t/2) at the time t of the two positions.
    exponent = np.clip(0.5 * alpha * (curve.time - time), -MAX_EXPONENT, MAX_EXPONENT)

    def gains(sign: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the size of the part of F that pre-stress of one sign contributes.

        The first array has the sum of the gains from c to a and from c to b, and the second one all
        that the past of the two positions contributes.
        """
        source = 0.5 * np.exp(exponent) * np.maximum(sign * curve.source, 0.0)
        by_panel = source @ WEIGHTS
        before_panel = np.cumsum(by_panel) - by_panel
        in_panel = np.sum(partial_weights(s) * source[panel], axis=-1)
        integral = (before_panel[panel] + in_panel).reshape(4, -1)
        outside_c = integral[C_BEGINS] - integral[A_BEGINS] + integral[B_ENDS] - integral[C_ENDS]
        return outside_c, integral[B_ENDS] - integral[A_BEGINS]

    # At c, which is earlier by half of the span, w contains a smaller exponential.
    velocity_at_apex = np.exp(-0.25 * alpha * span) * domains.slip_velocity()
    lost, negative_part = gains(-1.0)
    # The two lower bounds of the module docstring, for k > 0 and for k <= 0.
    if k > 0.0:
        gained, _ = gains(1.0)
        by_springs = k * span**2 / 16.0 * (velocity_at_apex + gained)
        lowest = sum(velocity) - velocity_at_apex - gained - by_springs
    else:
        lowest = velocity_at_apex - lost
    # The largest argument of J0 in the triangle, squared.
    d_xi = time - left - curve.evaluate("t_minus_x", end.panel, end.s)
    d_eta = time + right - curve.evaluate("t_plus_x", begin.panel, begin.s)
    is_before_first_zero = (negative_part <= 0.0) & (k * d_xi * d_eta < SQUARED_FIRST_ZERO)
    # The second condition is sufficient whether or not c has slipped.
    return (apex_slides & (lowest > 0.0)) | is_before_first_zero
