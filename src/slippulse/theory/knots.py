"""Knots of the trailing edge: stick times at some positions, and their interpolation in between.

Between two knots the stick time is a cubic polynomial of position (Hermite interpolation), which
has the given stick time and slope at both knots. The two knots are close enough to each other if
this cubic predicts a third knot in the middle between them (`Knots.predicts_middle`). Otherwise
`trailing_edge` halves the interval.
"""

from typing import NamedTuple

import numpy as np

from .curve import EQUALITY_TOLERANCE

# Kinds of a knot. At a SLIDING knot the block has not stuck until the end. At the other knots it
# has, while the trailing edge ran faster or slower than the waves. BRIEF_SLIP means that the slip
# was too brief to decide between these two, as it is next to where a slow front has stopped.
SLIDING, FASTER_THAN_WAVES, SLOWER_THAN_WAVES, BRIEF_SLIP = range(4)
# An interval is resolved if its cubic predicts the stick time in its middle with an error below
# this fraction of its length ...
STICK_TIME_TOLERANCE = 1e-5
# ... and the slope of the stick time there with an error below this.
SLOPE_TOLERANCE = 0.05
# An edge that is nearly as slow as the waves is checked again at this fraction of each interval. It
# differs from the middle, which has been checked before.
OFF_CENTRE_FRACTION = 0.382


class Knots(NamedTuple):
    """Knots of the trailing edge from left to right.

    Interval k lies between the knots k and k + 1. Arguments k of the methods are arrays of such
    numbers.

    stick is the stick time, or the final time if the block still slides then. kind is SLIDING,
    FASTER_THAN_WAVES, SLOWER_THAN_WAVES or BRIEF_SLIP. velocity is du/dt at the time stick. The
    last two are its derivatives by xi = t - x and by eta = t + x.
    """

    x: np.ndarray
    stick: np.ndarray
    kind: np.ndarray
    velocity: np.ndarray
    velocity_by_xi: np.ndarray
    velocity_by_eta: np.ndarray

    @property
    def slope(self) -> np.ndarray:
        """Derivative dt/dx of the stick time by position; NaN where the acceleration is 0."""
        # du/dt is 0 all along the edge: velocity_by_xi (dt - dx) + velocity_by_eta (dt + dx) = 0.
        # The sum of the two derivatives is the acceleration.
        acceleration = self.velocity_by_xi + self.velocity_by_eta
        divisor = np.where(acceleration == 0.0, np.nan, acceleration)
        return (self.velocity_by_xi - self.velocity_by_eta) / divisor

    def select(self, chosen: slice | np.ndarray) -> "Knots":
        """Return some of the knots, chosen by a slice or by their numbers."""
        return Knots._make(values[chosen] for values in self)

    def joined(self, other: "Knots") -> "Knots":
        """Return these knots combined with others, in order of position.

        Where both have a knot at one position, that of these knots is kept.
        """
        fields = zip(self, other, strict=True)
        all_knots = Knots._make(np.append(first, second) for first, second in fields)
        # `np.unique` sorts the positions, and returns the first of equal ones.
        _, first_of_equal = np.unique(all_knots.x, return_index=True)
        return all_knots.select(first_of_equal)

    def interval_of(self, x: np.ndarray) -> np.ndarray:
        """Return the interval that contains each position; outside of the knots the nearest one."""
        k = np.searchsorted(self.x, x, side="right") - 1
        return np.clip(k, 0, self.x.size - 2)

    @property
    def sliding_intervals(self) -> np.ndarray:
        """Left ends (row 0) and right ends (row 1) of the intervals between two SLIDING knots."""
        k = np.arange(self.x.size - 1)
        k = k[self.has_end_kinds(k, SLIDING, SLIDING)]
        return self.x[np.array([k, k + 1])]

    @property
    def positions_to_recheck(self) -> np.ndarray:
        """One position in each interval in which the edge may become slower than the waves.

        The edge is slower than the waves where the size of its slope exceeds 1. This is possible if
        the steepest slope at the two ends exceeds 1 when the change of the slope between the ends
        is added. The position is not in the middle, which has been checked before.
        """
        k = np.arange(self.x.size - 1)
        steepest_end = np.abs([self.slope[:-1], self.slope[1:]]).max(axis=0)
        may_exceed_1 = steepest_end + np.abs(np.diff(self.slope)) > 1.0
        k = k[self.outruns_waves(k) & may_exceed_1]
        return self.x[k] + OFF_CENTRE_FRACTION * (self.x[k + 1] - self.x[k])

    def has_end_kinds(self, k: np.ndarray, kind_1: int, kind_2: int) -> np.ndarray:
        """Return a mask of the intervals whose two knots have these kinds, in either order."""
        left, right = self.kind[k], self.kind[k + 1]
        is_in_order = (left == kind_1) & (right == kind_2)
        return is_in_order | ((left == kind_2) & (right == kind_1))

    def outruns_waves(self, k: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals in which the edge is faster than the waves."""
        return self.has_end_kinds(k, FASTER_THAN_WAVES, FASTER_THAN_WAVES) & ~self.has_jump(k)

    def touches_brief_slip(self, k: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals with at least one knot of the kind BRIEF_SLIP.

        The slip of such a knot is too brief to show whether the edge is faster than the waves.
        """
        return (self.kind[k] == BRIEF_SLIP) | (self.kind[k + 1] == BRIEF_SLIP)

    def has_jump(self, k: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals in which the edge jumps.

        The edge jumps if it takes longer than a wave, whose speed is 1, from one knot to the other,
        although it is not known to be slow there. Its speed must be known at both knots, which it
        is not at a BRIEF_SLIP (a knot that sticks too soon after its release). A change from faster
        to slower than the waves counts as a jump.
        """
        duration = np.abs(self.stick[k + 1] - self.stick[k])
        length = self.x[k + 1] - self.x[k]
        takes_longer = duration >= length * (1.0 + EQUALITY_TOLERANCE)
        is_slow = self.has_end_kinds(k, SLOWER_THAN_WAVES, SLOWER_THAN_WAVES)
        jumps = takes_longer & ~(is_slow | self.touches_brief_slip(k))
        turns_slow = self.has_end_kinds(k, FASTER_THAN_WAVES, SLOWER_THAN_WAVES)
        return jumps | turns_slow

    def ends_before_jumps(self, k: np.ndarray) -> np.ndarray:
        """Return the knot from which the edge jumps, for each interval k with a jump (`has_jump`).

        "Before" refers to time: the edge runs to this knot faster than the waves, and arrives at
        the other knot of the interval later. The knot is given by its number, k or k + 1.
        """
        left_kind, right_kind = self.kind[k], self.kind[k + 1]
        # If both knots are of one kind, the edge jumps from the one that sticks first. Otherwise it
        # jumps from the knot of the kind FASTER_THAN_WAVES: at the other knot the edge has become
        # slower than the waves, or the block still slides.
        right_sticks_first = self.stick[k] >= self.stick[k + 1]
        is_right_knot = np.where(
            left_kind == right_kind, right_sticks_first, right_kind == FASTER_THAN_WAVES
        )
        return np.where(is_right_knot, k + 1, k)

    def interpolate(self, k: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return stick times at positions x in the intervals k, by Hermite's cubic polynomial."""
        length = self.x[k + 1] - self.x[k]
        # The variable s runs from 0 to 1 between the two knots.
        s = (x - self.x[k]) / length
        # The first term goes from 0 to the difference of the stick times, with slope 0 at both
        # knots. The second term is 0 at both knots, and has the slopes of the edge there.
        difference = self.stick[k + 1] - self.stick[k]
        weighted_slopes = length * ((1.0 - s) * self.slope[k] - s * self.slope[k + 1])
        return self.stick[k] + s**2 * (3.0 - 2.0 * s) * difference + s * (1.0 - s) * weighted_slopes

    def predicts_middle(self, k: np.ndarray, middle: "Knots") -> np.ndarray:
        """Return a mask of the intervals k in which interpolation predicts a knot in the middle.

        ``middle`` has one knot for each interval, in its middle. This knot must be of the same kind
        as both ends of the interval. If this kind is FASTER_THAN_WAVES, the interpolating cubic
        must also predict the stick time and the slope of the middle. For other kinds the cubic is
        not used.
        """
        is_one_kind = (self.kind[k] == middle.kind) & (self.kind[k + 1] == middle.kind)
        length = 2.0 * (middle.x - self.x[k])
        time_error = np.abs(middle.stick - self.interpolate(k, middle.x))
        # The slope of Hermite's cubic in the middle: 3/2 of the mean slope of the interval, minus a
        # quarter of the sum of the slopes at its ends.
        cubic_slope = 1.5 * (self.stick[k + 1] - self.stick[k]) / length
        cubic_slope -= 0.25 * (self.slope[k] + self.slope[k + 1])
        slope_error = np.abs(middle.slope - cubic_slope)
        # The closer the edge comes to the wave speed (slope 1), the smaller an error of the slope
        # must be, so that the cubic remains faster than the waves.
        steepest = np.abs([self.slope[k], middle.slope, self.slope[k + 1]]).max(axis=0)
        largest_slope_error = np.minimum(SLOPE_TOLERANCE, 1.0 - steepest)
        is_cubic_right = time_error <= STICK_TIME_TOLERANCE * length
        is_cubic_right &= slope_error <= largest_slope_error
        return is_one_kind & (is_cubic_right | (middle.kind != FASTER_THAN_WAVES))
