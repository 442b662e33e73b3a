r"""A lower bound of du/dt between two positions that slide, to prove that nothing sticks there.

Samples of du/dt alone cannot exclude a stick between them; the bound can. It is formulated for
w = exp(alpha t/2) du/dt, where alpha is the rate strengthening. In the coordinates xi = t - y and
eta = t + y, it obeys w_xi_eta = -k w/4 with k = gamma - alpha^2/4. Hence w is the difference of two
terms, w = F - W. F is half the integral of tau exp(alpha T/2) along the front, t = T(x), as far as
it lies in the past of a point. W is k/4 times the integral of w over xi and eta in the past of the
point. If k > 0, W grows with xi and with eta as long as w > 0 there.

Let a and b be two positions at the same time, and h the distance between them. c is the point from
which their characteristics went apart, in the middle between them and h/2 earlier:

     a ------ b     time t
      \      /
       \    /
        \  /
         c          time t - h/2

For k > 0, w in the whole triangle is at least

    w(a) + w(b) - w(c) - J - k h^2/16 (w(c) + J),

where J is the sum of the gains of F by positive pre-stress, from c to a and from c to b. For
k <= 0, w is at least w(c) minus the loss of F by negative pre-stress. If c has not slipped, another
condition is used. By Riemann's formula (`riemann`), w is an integral of tau and the Bessel function
J0. So w > 0 if all pre-stress in the past is positive, and J0 does not reach its first zero.

An interval is divided until the bound is positive, or until it is too short to change any result.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .curve import WEIGHTS, Crossing
from .part import Part
from .riemann import MAX_EXPONENT, partial_weights

# The square of the first zero of the Bessel function J0.
SQUARED_FIRST_ZERO = 5.783185962946784
# An interval whose bound is not positive is cut into this number of parts.
PARTS_PER_CUT = 4
# Shortest interval that is cut, in units of `Part.scale`, if both ends move.
MIN_INTERVAL = 1e-6
# Shortest interval that is cut, in the same units, if one end does not move yet.
MIN_INTERVAL_AT_REST = 1e-3
# Within this distance of the first stick, in units of `Part.scale`, no interval is cut. There the
# trailing edge, which is known at knots, shows that no other position sticks before.
FIRST_STICK_DISTANCE = 0.2
# Slip velocities below this are 0.
ROUNDING_ERROR = 1e-12
# Slip velocity below which motion is faint. Strong rate strengthening leaves such a slow creep, for
# which the bound is not positive.
FAINT_VELOCITY = 1e-5
# Shortest interval that is cut if the motion was faint at both ends of the first interval.
MIN_FAINT_INTERVAL = 1e-2


class PastOnCurve(NamedTuple):
    """Points of the curve where the past of the positions a and b, and of c, begins and ends.

    The four points are in this order along the curve. Each has one element for each pair.
    """

    a_begins: Crossing
    c_begins: Crossing
    c_ends: Crossing
    b_ends: Crossing


def stuck_between(part: Part, x: np.ndarray, time: float, first_x: float = np.inf) -> np.ndarray:
    """Return positions that have stuck before a time, between positions that still slide then.

    Row 0 of x has the left positions of pairs, and row 1 the right ones. The interval of each pair
    is cut into smaller and smaller parts, until a lower bound of du/dt in between is positive. The
    search ends as soon as it finds positions; the result is empty if nothing has stuck. first_x is
    the position that sticks first, at this time, if it is known.
    """

    def velocity_at(x: np.ndarray) -> np.ndarray:
        """Return du/dt at positions of any shape."""
        return part.velocity(x.ravel(), np.full(x.size, time)).reshape(x.shape)

    velocity = velocity_at(x)
    # Pairs that move so slowly that their bound is never positive.
    is_faint = velocity.max(axis=0) < FAINT_VELOCITY
    while x.size:
        # At a position that is just being released du/dt is 0. The bound next to it need not become
        # positive, however short the interval. So this interval is not cut into the smallest parts.
        both_move = velocity.min(axis=0) > ROUNDING_ERROR
        min_length = np.where(both_move, MIN_INTERVAL, MIN_INTERVAL_AT_REST)
        min_length[is_faint] = MIN_FAINT_INTERVAL
        # Only pairs between which something may still have stuck are cut into parts.
        is_cut = x[1] - x[0] > min_length * part.scale
        is_cut &= ~stays_positive(part, x=x, velocity=velocity, time=time)
        # Next to the first stick, the knots of the trailing edge show that nothing else has stuck.
        is_cut &= np.abs(x - first_x).max(axis=0) > FIRST_STICK_DISTANCE * part.scale
        # The ends of the parts and du/dt there, [end, pair]. The first and the last end are the two
        # positions of the pair.
        ends = np.linspace(x[0, is_cut], x[1, is_cut], PARTS_PER_CUT + 1)
        inner_velocity = velocity_at(ends[1:-1])
        # Where a block has stuck before, the formula for sliding gives a negative velocity.
        has_stuck = inner_velocity < -ROUNDING_ERROR
        if np.any(has_stuck):
            return ends[1:-1][has_stuck]
        end_velocity = np.concatenate([velocity[:1, is_cut], inner_velocity, velocity[1:, is_cut]])
        # The parts are the pairs of the next round.
        is_faint = np.tile(is_faint[is_cut], PARTS_PER_CUT)
        x = np.array([ends[:-1], ends[1:]]).reshape(2, -1)
        velocity = np.array([end_velocity[:-1], end_velocity[1:]]).reshape(2, -1)
    return np.empty(0)


def stays_positive(part: Part, x: np.ndarray, velocity: np.ndarray, time: float) -> np.ndarray:
    """Return a mask of the pairs of positions a and b between which nothing sticks until a time.

    x and velocity (du/dt) have the left positions a in row 0 and the right ones b in row 1. Both
    positions and everything in their past must slide until the time, or a front has just arrived
    there. Each of two conditions is sufficient: a positive lower bound of du/dt, and a positive
    integrand in Riemann's formula for du/dt.
    """
    a, b = x
    # The points of the curve where the past of a begins, and where the past of b ends.
    ends = part.curve.crossings(y=0.5 * (a + b), xi=time - a, eta=time + b)
    bound = _lower_bound(part, x=x, velocity=velocity, time=time, ends=ends)
    return (bound > 0.0) | _velocity_is_surely_positive(part, x=x, time=time, ends=ends)


def _lower_bound(
    part: Part,
    x: np.ndarray,
    velocity: np.ndarray,
    time: float,
    ends: tuple[Crossing, Crossing],
) -> np.ndarray:
    """Return a lower bound of du/dt between each pair of positions a and b; -inf if unknown.

    The arguments are those of `stays_positive`, and ends are the points of the curve where the past
    of a begins, and where the past of b ends. The bound follows from w = exp(alpha t/2) du/dt at a,
    at b, and at the point c from which waves arrive at both (see the module docstring). It is
    unknown if c has not slipped.
    """
    a, b = x
    curve, alpha = part.curve, part.alpha
    distance, middle = b - a, 0.5 * (a + b)
    # The point c is in the middle between a and b.
    time_at_c = time - 0.5 * distance
    past_of_c = part.domains(middle, time_at_c)
    c_slides = curve.arrival(middle) < time_at_c
    k = past_of_c.stiffness
    a_begins, b_ends = ends
    past = PastOnCurve(a_begins, past_of_c.left, past_of_c.right, b_ends)
    # Everything is divided by exp(alpha t/2) at the time of a and b, so that w is du/dt there. At
    # c, which is half of the distance earlier, w keeps an exponential factor.
    w_at_a, w_at_b = velocity
    w_at_c = np.exp(-0.25 * alpha * distance) * past_of_c.slip_velocity()
    exponent = np.clip(0.5 * alpha * (curve.time - time), -MAX_EXPONENT, MAX_EXPONENT)
    # The integral of this density along the curve is F of the module docstring. Densities are per
    # unit of the parameter of the curve.
    density = 0.5 * np.exp(exponent) * curve.source
    if k > 0.0:
        gain = _integral_outside_past_of_c(np.maximum(density, 0.0), past)
        by_springs = k * distance**2 / 16.0 * (w_at_c + gain)
        bound = w_at_a + w_at_b - w_at_c - gain - by_springs
    else:
        bound = w_at_c - _integral_outside_past_of_c(np.maximum(-density, 0.0), past)
    return np.where(c_slides, bound, -np.inf)


def _velocity_is_surely_positive(
    part: Part, x: np.ndarray, time: float, ends: tuple[Crossing, Crossing]
) -> np.ndarray:
    """Return a mask of the pairs of positions a and b between which du/dt is surely positive.

    Between a and b, du/dt is an integral of tau times the Bessel function J0 over the past. This
    integral is positive if all pre-stress in the past of a and b is positive, and if the largest
    argument of J0, sqrt(k d_xi d_eta), is below its first zero. The arguments are those of
    `_lower_bound`.
    """
    a, b = x
    a_begins, b_ends = ends
    curve, k = part.curve, part.gamma - 0.25 * part.alpha**2
    # The past has no negative pre-stress if its integral does not grow from a_begins to b_ends.
    negative_part = np.maximum(-curve.source, 0.0)
    integral_to_begin, integral_to_end = _integrals_from_left_end(negative_part, ends)
    is_past_positive = integral_to_end - integral_to_begin <= 0.0
    # The largest differences of xi = t - x and eta = t + x from a point between a and b to a point
    # of the curve: xi falls, and eta rises, from left to right.
    d_xi = time - a - curve.evaluate("t_minus_x", b_ends.panel, b_ends.s)
    d_eta = time + b - curve.evaluate("t_plus_x", a_begins.panel, a_begins.s)
    return is_past_positive & (k * d_xi * d_eta < SQUARED_FIRST_ZERO)


def _integral_outside_past_of_c(density: np.ndarray, past: PastOnCurve) -> np.ndarray:
    """Return the integral of a density along the curve, for each pair of positions a and b.

    The integral covers the past of a and of b, except the past of the point c, from which waves
    arrive at both. The density is a function per unit of the parameter of each panel, given at the
    nodes.
    """
    to_a_begins, to_c_begins, to_c_ends, to_b_ends = _integrals_from_left_end(density, past)
    return to_c_begins - to_a_begins + to_b_ends - to_c_ends


def _integrals_from_left_end(density: np.ndarray, ends: Sequence[Crossing]) -> np.ndarray:
    """Return the integrals of a density from the left end of the curve to several points on it.

    All elements of ends have the same number of points. The result has a row for each element, and
    a column for each point. The density is a function per unit of the parameter of each panel,
    given at the nodes.
    """
    panel = np.concatenate([end.panel for end in ends])
    s = np.concatenate([end.s for end in ends])
    over_panel = density @ WEIGHTS
    # The integral over all panels before each panel.
    before_panel = np.cumsum(over_panel) - over_panel
    # The integral from the left end of its panel to each point.
    in_panel = np.sum(partial_weights(s) * density[panel], axis=-1)
    return (before_panel[panel] + in_panel).reshape(len(ends), -1)
