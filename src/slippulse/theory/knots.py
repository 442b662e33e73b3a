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
        fall = self.velocity_by_xi + self.velocity_by_eta
        return (self.velocity_by_xi - self.velocity_by_eta) / np.where(fall == 0.0, np.nan, fall)

    def joined(self, other: "Knots") -> "Knots":
        """Return these knots combined with others, in order of position."""
        _, first = np.unique(np.append(self.x, other.x), return_index=True)
        return Knots._make(np.append(a, b)[first] for a, b in zip(self, other, strict=True))

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
        steepness = np.abs([self.slope[:-1], self.slope[1:]])
        k = k[self.outruns_waves(k) & (steepness.max(axis=0) + np.abs(np.diff(self.slope)) > 1.0)]
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
        change = np.abs(self.stick[k + 1] - self.stick[k])
        steep = change >= (self.x[k + 1] - self.x[k]) * (1.0 + EQUALITY_TOLERANCE)
        is_resolved = ~self.touches_brief_slip(k) & ~self.has_end_kinds(
            k, SLOWER_THAN_WAVES, SLOWER_THAN_WAVES
        )
        return (steep & is_resolved) | self.has_end_kinds(k, FASTER_THAN_WAVES, SLOWER_THAN_WAVES)

    def ends_before_jumps(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return, for each interval with a jump, the knot before the jump and the interval length.

        It is the last knot at which the edge is faster than the waves.
        """
        k = k[self.has_jump(k)]
        left, right = self.kind[k], self.kind[k + 1]
        # The edge is fast up to the earlier of the two knots, unless only the other one is of the
        # kind FASTER_THAN_WAVES.
        right_first = self.stick[k] >= self.stick[k + 1]
        at_right = np.where(left == right, right_first, right == FASTER_THAN_WAVES)
        return np.where(at_right, k + 1, k), self.x[k + 1] - self.x[k]

    def interpolate(self, k: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return stick times at positions x in the intervals k, by cubic interpolation."""
        span = self.x[k + 1] - self.x[k]
        s = (x - self.x[k]) / span
        bow = span * ((1.0 - s) * self.slope[k] - s * self.slope[k + 1])
        rise = self.stick[k + 1] - self.stick[k]
        return self.stick[k] + s**2 * (3.0 - 2.0 * s) * rise + s * (1.0 - s) * bow

    def predicts_middle(self, k: np.ndarray, middle: "Knots") -> np.ndarray:
        """Return a mask of the intervals k whose cubic predicts the knot in its middle."""
        one_kind = (self.kind[k] == middle.kind) & (self.kind[k + 1] == middle.kind)
        half = middle.x - self.x[k]
        cubic_slope = 0.75 * (self.stick[k + 1] - self.stick[k]) / half
        cubic_slope -= 0.25 * (self.slope[k] + self.slope[k + 1])
        near = (
            np.abs(middle.stick - self.interpolate(k, middle.x))
            <= 2.0 * STICK_TIME_TOLERANCE * half
        )
        # The closer the edge comes to the wave speed, the smaller a change of its slope must be to
        # be accepted.
        steepest = np.abs([self.slope[k], middle.slope, self.slope[k + 1]]).max(axis=0)
        near &= np.abs(middle.slope - cubic_slope) <= np.minimum(SLOPE_TOLERANCE, 1.0 - steepest)
        return one_kind & (near | (middle.kind != FASTER_THAN_WAVES))
