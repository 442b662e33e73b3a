"""Knots of the trailing edge: stick times at some positions, and their interpolation in between.

Between two knots the stick time is a cubic polynomial, the Hermite interpolant of the stick times
and of their slopes at both knots. An interval is fine enough when this cubic predicts a third
knot in its middle (`Knots.predicts_middle`); otherwise `trailing_edge` halves it.
"""

from typing import NamedTuple

import numpy as np

from .curve import EQUALITY_TOLERANCE

# Kinds of a knot. At a SLIDING knot the block has not stuck until the end. At the others it has:
# where the edge is faster than the waves, where it is slower, and, next to the point where a slow
# front has stopped, after a slip too brief to tell which of the two it is.
SLIDING, FASTER_THAN_WAVES, SLOWER_THAN_WAVES, BRIEF_SLIP = range(4)
# An interval is resolved if its cubic predicts the stick time in its middle to this fraction of its
# length ...
STICK_TIME_TOLERANCE = 1e-5
# ... and the slope of the stick time there to this error.
SLOPE_TOLERANCE = 0.05
# An edge that is nearly as slow as the waves is checked again at this fraction of each interval,
# which differs from the middle that has been checked before.
OFF_CENTRE_FRACTION = 0.382


class Knots(NamedTuple):
    """Knots of the trailing edge from left to right; interval k lies between the knots k and k + 1.

    stick is the stick time (the final time if the block still slides), kind is one of the four
    kinds above, velocity is du/dt at that time, and the last two are its derivatives by xi = t - x
    and eta = t + x.
    """

    x: np.ndarray
    stick: np.ndarray
    kind: np.ndarray
    velocity: np.ndarray
    velocity_by_xi: np.ndarray
    velocity_by_eta: np.ndarray

    @property
    def slope(self) -> np.ndarray:
        """Derivative of the stick time by position; NaN where du/dt does not change."""
        # du/dt is 0 all along the edge: velocity_by_xi (dt - dx) + velocity_by_eta (dt + dx) = 0.
        # The sum of the two derivatives is the acceleration.
        acceleration = self.velocity_by_xi + self.velocity_by_eta
        divisor = np.where(acceleration == 0.0, np.nan, acceleration)
        return (self.velocity_by_xi - self.velocity_by_eta) / divisor

    def at(self, chosen: slice | np.ndarray) -> "Knots":
        """Return some of the knots, chosen by a slice or by their numbers."""
        return Knots._make(values[chosen] for values in self)

    def joined(self, other: "Knots") -> "Knots":
        """Return these knots combined with others, in order of position.

        Where both have a knot at one position, that of these knots is kept.
        """
        pairs = zip(self, other, strict=True)
        together = Knots._make(np.append(values, others) for values, others in pairs)
        _, first_of_equal = np.unique(together.x, return_index=True)
        return together.at(first_of_equal)

    def interval_of(self, x: np.ndarray) -> np.ndarray:
        """Return the interval of each position; the first or last one outside of the knots."""
        k = np.searchsorted(self.x, x, side="right") - 1
        return np.clip(k, 0, self.x.size - 2)

    @property
    def sliding_intervals(self) -> np.ndarray:
        """Ends [left and right, interval] of the intervals whose two knots slide at the end."""
        k = np.arange(self.x.size - 1)
        k = k[self.has_end_kinds(k, SLIDING, SLIDING)]
        return self.x[np.array([k, k + 1])]

    @property
    def positions_to_recheck(self) -> np.ndarray:
        """One position in each interval whose edge may become slower than the waves.

        This is so if the slope of its edge, continued to change as it does now, would exceed 1.
        """
        k = np.arange(self.x.size - 1)
        steepest_end = np.abs([self.slope[:-1], self.slope[1:]]).max(axis=0)
        may_exceed_1 = steepest_end + np.abs(np.diff(self.slope)) > 1.0
        k = k[self.outruns_waves(k) & may_exceed_1]
        return self.x[k] + OFF_CENTRE_FRACTION * (self.x[k + 1] - self.x[k])

    def has_end_kinds(self, k: np.ndarray, one: int, other: int) -> np.ndarray:
        """Return a mask of the intervals whose two knots have these kinds, in either order."""
        left, right = self.kind[k], self.kind[k + 1]
        return ((left == one) & (right == other)) | ((left == other) & (right == one))

    def outruns_waves(self, k: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals in which the edge is faster than the waves."""
        return self.has_end_kinds(k, FASTER_THAN_WAVES, FASTER_THAN_WAVES) & ~self.has_jump(k)

    def touches_brief_slip(self, k: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals with at least one knot of the kind BRIEF_SLIP."""
        return (self.kind[k] == BRIEF_SLIP) | (self.kind[k + 1] == BRIEF_SLIP)

    def has_jump(self, k: np.ndarray) -> np.ndarray:
        """Return a mask of the intervals in which the edge jumps or turns from fast to slow."""
        duration = np.abs(self.stick[k + 1] - self.stick[k])
        length = self.x[k + 1] - self.x[k]
        is_slower_than_waves = duration >= length * (1.0 + EQUALITY_TOLERANCE)
        # Between two slow knots, and next to a brief slip, the edge may be slow without a jump.
        may_be_slow = self.touches_brief_slip(k) | self.has_end_kinds(
            k, SLOWER_THAN_WAVES, SLOWER_THAN_WAVES
        )
        turns_slow = self.has_end_kinds(k, FASTER_THAN_WAVES, SLOWER_THAN_WAVES)
        return (is_slower_than_waves & ~may_be_slow) | turns_slow

    def ends_before_jumps(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return, for each interval with a jump, the knot before the jump and the interval length.

        The knot before the jump is the one that the edge reaches faster than the waves.
        """
        k = k[self.has_jump(k)]
        left_kind, right_kind = self.kind[k], self.kind[k + 1]
        # If only one of the two knots is of the kind FASTER_THAN_WAVES, the edge is fast up to that
        # knot. If both are of one kind, the edge is fast up to the knot that sticks first.
        right_sticks_first = self.stick[k] >= self.stick[k + 1]
        is_right = np.where(
            left_kind == right_kind, right_sticks_first, right_kind == FASTER_THAN_WAVES
        )
        return np.where(is_right, k + 1, k), self.x[k + 1] - self.x[k]

    def interpolate(self, k: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return stick times at positions x in the intervals k, by Hermite's cubic polynomial."""
        span = self.x[k + 1] - self.x[k]
        s = (x - self.x[k]) / span
        # The term with the rise joins the two stick times, with slope 0 at both knots. The term
        # with the bow is 0 at both knots and gives the curve its slopes there.
        rise = self.stick[k + 1] - self.stick[k]
        bow = span * ((1.0 - s) * self.slope[k] - s * self.slope[k + 1])
        return self.stick[k] + s**2 * (3.0 - 2.0 * s) * rise + s * (1.0 - s) * bow

    def predicts_middle(self, k: np.ndarray, middle: "Knots") -> np.ndarray:
        """Return a mask of the intervals k in which interpolation predicts the knot in the middle.

        All three knots must be of one kind. Where they are FASTER_THAN_WAVES, the cubic must also
        agree with the stick time and the slope in the middle; elsewhere it is not used.
        """
        is_one_kind = (self.kind[k] == middle.kind) & (self.kind[k + 1] == middle.kind)
        half = middle.x - self.x[k]
        # The slope of the cubic in the middle of the interval.
        cubic_slope = 0.75 * (self.stick[k + 1] - self.stick[k]) / half
        cubic_slope -= 0.25 * (self.slope[k] + self.slope[k + 1])
        time_error = np.abs(middle.stick - self.interpolate(k, middle.x))
        slope_error = np.abs(middle.slope - cubic_slope)
        # The closer the edge comes to the wave speed (slope 1), the smaller an error of the slope
        # must be.
        steepest = np.abs([self.slope[k], middle.slope, self.slope[k + 1]]).max(axis=0)
        largest_slope_error = np.minimum(SLOPE_TOLERANCE, 1.0 - steepest)
        # The length of the interval is twice its half.
        cubic_agrees = time_error <= 2.0 * STICK_TIME_TOLERANCE * half
        cubic_agrees &= slope_error <= largest_slope_error
        return is_one_kind & (cubic_agrees | (middle.kind != FASTER_THAN_WAVES))
