"""Knots of the trailing edge: where and when it sticks, and how these predict it in between."""

from typing import NamedTuple

import numpy as np

from .curve import SAME

# Kinds of a knot: it slides at the end; it has stuck, where the edge outruns the waves or not; or
# it slid too briefly to tell, next to the point where a slow front has stopped.
SLIDES, FAST, SLOW, BRIEF = range(4)
# Stick times halfway between knots are predicted to this fraction of the interval, their slopes to
# this.
PREDICTED, PREDICTED_SLOPE = 1e-5, 0.05
# Where in its interval an edge that is nearly slow is looked at, apart from halfway.
SHIFTED = 0.382


class Knots(NamedTuple):
    """Positions, stick times (the end for none), kinds, and du/dt and its slopes by xi and eta.

    Interval k lies between the knots k and k + 1.
    """

    x: np.ndarray
    stick: np.ndarray
    kind: np.ndarray
    velocity: np.ndarray
    by_xi: np.ndarray
    by_eta: np.ndarray

    @property
    def pace(self) -> np.ndarray:
        """Derivative of the stick time by position."""
        fall = self.by_xi + self.by_eta
        return (self.by_xi - self.by_eta) / np.where(fall == 0.0, np.nan, fall)

    def joined(self, other: "Knots") -> "Knots":
        """These knots and others, in order."""
        _, first = np.unique(np.append(self.x, other.x), return_index=True)
        return Knots._make(np.append(a, b)[first] for a, b in zip(self, other, strict=True))

    def interval(self, x: np.ndarray) -> np.ndarray:
        """The interval of each position, the nearest one beyond the knots."""
        k = np.searchsorted(self.x, x, side="right") - 1
        return np.clip(k, 0, self.x.size - 2)

    @property
    def sliding(self) -> np.ndarray:
        """Ends [left and right, interval] of the intervals that slide at the end."""
        k = np.arange(self.x.size - 1)
        k = k[self.of_kinds(k, SLIDES, SLIDES)]
        return self.x[np.array([k, k + 1])]

    @property
    def nearly_slow(self) -> np.ndarray:
        """Positions in the intervals whose edge, if it turns on as it does, may become slow."""
        k = np.arange(self.x.size - 1)
        pace = np.abs([self.pace[:-1], self.pace[1:]])
        k = k[self.outruns(k) & (pace.max(axis=0) + np.abs(np.diff(self.pace)) > 1.0)]
        return self.x[k] + SHIFTED * (self.x[k + 1] - self.x[k])

    def of_kinds(self, k: np.ndarray, one: int, other: int) -> np.ndarray:
        """Mask of the intervals whose two ends have these kinds in any order."""
        left, right = self.kind[k], self.kind[k + 1]
        return ((left == one) & (right == other)) | ((left == other) & (right == one))

    def outruns(self, k: np.ndarray) -> np.ndarray:
        """Mask of the intervals in which the edge outruns the waves."""
        return self.of_kinds(k, FAST, FAST) & ~self.jumps(k)

    def brief(self, k: np.ndarray) -> np.ndarray:
        """Mask of the intervals with an end that slid too briefly."""
        return (self.kind[k] == BRIEF) | (self.kind[k + 1] == BRIEF)

    def jumps(self, k: np.ndarray) -> np.ndarray:
        """Mask of the intervals in which the edge jumps, or changes from fast to slow."""
        change = np.abs(self.stick[k + 1] - self.stick[k])
        steep = change >= (self.x[k + 1] - self.x[k]) * (1.0 + SAME)
        told = ~self.brief(k) & ~self.of_kinds(k, SLOW, SLOW)
        return (steep & told) | self.of_kinds(k, FAST, SLOW)

    def fast_ends(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Knots at which the edge last outruns the waves before it jumps, and lengths of jumps."""
        k = k[self.jumps(k)]
        left, right = self.kind[k], self.kind[k + 1]
        # The edge ends at the earlier of two knots, unless only the other one outruns the waves.
        right_first = self.stick[k] >= self.stick[k + 1]
        at_right = np.where(left == right, right_first, right == FAST)
        return np.where(at_right, k + 1, k), self.x[k + 1] - self.x[k]

    def stick_between(self, k: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Stick times by cubics in intervals."""
        span = self.x[k + 1] - self.x[k]
        s = (x - self.x[k]) / span
        bow = span * ((1.0 - s) * self.pace[k] - s * self.pace[k + 1])
        rise = self.stick[k + 1] - self.stick[k]
        return self.stick[k] + s**2 * (3.0 - 2.0 * s) * rise + s * (1.0 - s) * bow

    def predict(self, k: np.ndarray, middle: "Knots") -> np.ndarray:
        """Mask of the intervals whose ends predict the knot in the middle."""
        one_kind = (self.kind[k] == middle.kind) & (self.kind[k + 1] == middle.kind)
        half = middle.x - self.x[k]
        slope = 0.75 * (self.stick[k + 1] - self.stick[k]) / half
        slope -= 0.25 * (self.pace[k] + self.pace[k + 1])
        near = np.abs(middle.stick - self.stick_between(k, middle.x)) <= 2.0 * PREDICTED * half
        # The closer the edge is to the speed of the waves, the less it may turn unseen.
        steepest = np.abs([self.pace[k], middle.pace, self.pace[k + 1]]).max(axis=0)
        near &= np.abs(middle.pace - slope) <= np.minimum(PREDICTED_SLOPE, 1.0 - steepest)
        return one_kind & (near | (middle.kind != FAST))
