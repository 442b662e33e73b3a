"""Whether du/dt stays above 0 between two positions that slide, by a bound that holds in between.

In xi = t - y and eta = t + y, w = exp(alpha t/2) du/dt obeys w_xi_eta = -k w/4. So w = F - W: F is
half the integral of tau exp(alpha T/2) along the curve in the past of a point, and W is k/4 times
that of w over the region of its past; it grows with xi and eta as long as w > 0 there, if k > 0.
Let a and b be positions at a time, h apart, and c the point from which their characteristics went
apart. Then w in the whole triangle is at least

    w(a) + w(b) - w(c) - J - k h^2/16 (w(c) + J),

where J is what positive pre-stress added to F between c and a, and c and b. For k <= 0 it is at
least w(c) less what negative pre-stress took. Behind a front that outruns the waves, where c has
not slipped, w > 0 as long as the pre-stress is positive and J0 is: up to its first zero. Intervals
are cut until the bound is above 0, or to a length that is felt in no answer.
"""

import numpy as np

from .curve import WEIGHTS
from .part import Part
from .riemann import LARGEST_EXPONENT, partial_weights

# The square of the first zero of J0.
FIRST_ZERO = 5.783185962946784
# An interval without a bound is cut into CUTS parts, down to the shortest ones, in units of
# `Part.scale`: with slip velocity at both ends, and next to a position that does not move yet.
CUTS, SHORTEST, SHORTEST_AT_REST = 4, 1e-6, 1e-3
# So near the first stick, in these units, the trailing edge shows that it is the first.
NEAR_FIRST = 0.2
# Slip velocities of this size are 0.
ROUNDING = 1e-12
# Strong rate strengthening leaves a creep that may be far smaller than what pre-stress adds to it,
# and the bound with it. Where du/dt is below FAINT at both ends of an interval that is not cut yet,
# it is cut to SHORTEST_FAINT at most.
FAINT, SHORTEST_FAINT = 1e-5, 1e-2


def stuck_between(part: Part, x: np.ndarray, time: float, first: float = np.inf) -> np.ndarray:
    """Positions found to have stuck until a time between pairs [left and right, pair] that slide.

    There are none if the bound holds. The position that sticks at that time may be known.
    """

    def velocity_at(x: np.ndarray) -> np.ndarray:
        return part.velocity(x.ravel(), np.full(x.size, time)).reshape(x.shape)

    velocity = velocity_at(x)
    faint = velocity.max(axis=0) < FAINT
    while x.size:
        least = np.where(velocity.min(axis=0) > ROUNDING, SHORTEST, SHORTEST_AT_REST)
        least[faint] = SHORTEST_FAINT
        wide = (x[1] - x[0] > least * part.scale) & ~stays_positive(part, x, velocity, time)
        wide &= np.abs(x - first).max(axis=0) > NEAR_FIRST * part.scale
        edges = np.linspace(x[0, wide], x[1, wide], CUTS + 1)
        inner = velocity_at(edges[1:-1])
        if np.any(inner < -ROUNDING):
            return edges[1:-1][inner < -ROUNDING]
        values = np.concatenate([velocity[:1, wide], inner, velocity[1:, wide]])
        faint = np.tile(faint[wide], CUTS)
        x, velocity = (np.array([rows[:-1], rows[1:]]).reshape(2, -1) for rows in (edges, values))
    return np.empty(0)


def stays_positive(part: Part, x: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    """Mask of pairs of positions, with du/dt, [left and right, pair]: no stick between until time.

    Both slide until then, or a front has just come there, and so does all in their past.
    """
    (left, right), curve, alpha = x, part.curve, part.alpha
    span, middle, early = right - left, 0.5 * (left + right), time - 0.5 * (right - left)
    begin, end = curve.crossings(middle, time - left, time + right)
    past = part.past(middle, early)
    k, slipped = past.stiffness, curve.arrival(middle) < early
    points = [np.concatenate(at) for at in zip(begin, past.left, past.right, end, strict=True)]

    # In units of exp(alpha t/2).
    exponent = np.clip(0.5 * alpha * (curve.time - time), -LARGEST_EXPONENT, LARGEST_EXPONENT)

    def gains(sign: float) -> np.ndarray:
        """Integrals of pre-stress of one sign, from c to a or b, and over both pasts."""
        source = 0.5 * np.exp(exponent) * np.maximum(sign * curve.source, 0.0)
        whole = source @ WEIGHTS
        panel, s, _ = points
        cut = np.sum(partial_weights(s) * source[panel], axis=-1)
        at = ((np.cumsum(whole) - whole)[panel] + cut).reshape(4, -1)
        return np.array([at[1] - at[0] + at[3] - at[2], at[3] - at[0]])

    before = np.exp(-0.25 * alpha * span) * past.slip_velocity()
    taken, negative = gains(-1.0)
    if k > 0.0:
        added = gains(1.0)[0]
        lowest = sum(velocity) - before - added - k * span**2 / 16.0 * (before + added)
    else:
        lowest = before - taken
    to_end = time - left - curve.evaluate("early", end.panel, end.s)
    to_begin = time + right - curve.evaluate("late", begin.panel, begin.s)
    young = (negative <= 0.0) & (k * to_end * to_begin < FIRST_ZERO)
    return (slipped & (lowest > 0.0)) | young
