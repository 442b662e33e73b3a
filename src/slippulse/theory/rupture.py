"""A whole rupture in the continuum limit dx -> 0 at fixed beta/dx: fronts, trailing edges, slip, without a lattice.

While tau(x) > 0 a front outruns the waves, so T(x) is the integral of 1/v(tau(x), beta/dx), and the damping,
beta = (beta/dx) dx -> 0, acts at the front alone. Where tau < 0 the front is a free boundary (`slow_front`). Behind
the fronts the undamped equation has Riemann's solution (`riemann`), up to the trailing edge (`part`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number, short_repr
from ..model.prestress import Prestress
from ..model.roots import root_between
from .curve import SAME
from .domains import broadcast_numbers
from .fronts import NARROWEST, FrontLaw
from .part import Part
from .spreading import Stretch, spread

# The construction goes on this much beyond the duration, relative, so that the end is a time like any other.
BEYOND = 1e-6
# Of exponents, alpha times the duration, with room to the end of floating point.
MOST_DECAY = 600.0
FIELDS = ("slip_velocity", "slip", "strain")
# Of a map, which takes 100 bytes each.
MOST_POINTS = 10**7


@dataclass(frozen=True)
class Limit:
    """A point in whose future the construction says nothing."""

    x: float
    time: float
    reason: str


class FrontEnd(Limit):
    """Where a front is when it stops, or at the end of the time asked for."""


class Rupture:
    """The exact rupture of a pre-stress in the continuum limit.

    Parameters
    ----------
    prestress : Prestress, reaching 1 somewhere; each position where it does at t = 0 is a nucleation point
    gamma : elasticity ratio, > 0; or 0 for the stress boundary
    damping_ratio, release : beta/dx, from 0 to 1e6, at which dx -> 0; "total" or "elastic"
    duration : time up to which the rupture is wanted, >= 1e-9
    refinement : panels are cut into this number of parts, to see what the result owes to them; 1 to 10
    rate_strengthening : alpha, of a term -alpha du/dt; above where slip runs away, and at most 600/duration in size

    Raises ValueError: if a value is outside its domain, the pre-stress nowhere reaches 1, or a front needs more than
    20000 panels; of every method, if a position or a time is not finite.
    Source: derived for this project; verified against the lattice, which tends to it at first order in dx.
    """

    def __init__(
        self, prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total",
        duration: float = 10.0, refinement: int = 1, rate_strengthening: float = 0.0,
    ) -> None:  # fmt: skip
        check_number("duration", duration, at_least=NARROWEST)
        self.law = FrontLaw(
            prestress, gamma, damping_ratio, release, refinement, rate_strengthening
        )
        check_number("rate_strengthening", rate_strengthening, at_most=MOST_DECAY / duration)
        self.prestress, self.gamma, self.rate_strengthening = (
            prestress,
            self.law.gamma,
            self.law.alpha,
        )
        self.duration = float(duration)
        until = self.duration * (1.0 + BEYOND)
        self.stretches, self._unknown = spread(self.law, until)
        kinks = [0.0, *(piece.right for piece in self.law.pieces if np.isfinite(piece.right))]
        same = self.law.refinement, prestress.symmetric, self.law.alpha
        self._parts = [
            Part(stretch.curve(), self.gamma, until, [*kinks, *stretch.joins], *same)
            for stretch in self.stretches
        ]

    @property
    def front_ends(self) -> list[tuple[FrontEnd, FrontEnd]]:
        """Left and right end of each connected part: "stops" for good, or "duration" where it goes on."""
        pairs = zip(self._parts, self.stretches, strict=True)
        return [(self._front_end(*pair, -1.0), self._front_end(*pair, 1.0)) for pair in pairs]

    def _front_end(self, part: Part, stretch: Stretch, side: float) -> FrontEnd:
        (x, time), reason = stretch.ends[side], str(stretch.stopped[side])
        if reason != "duration" and time <= self.duration * (1.0 + SAME):
            reason = "stops" if reason == "dead" else reason
            return FrontEnd(float(x), float(min(time, self.duration)), reason)
        edges = part.curve.edges[part.curve.edge_times <= self.duration]
        x = part.curve.front_at(self.duration, edges[-1 if side > 0.0 else 0], side)
        return FrontEnd(x, self.duration, "duration")

    def release_time(self, x) -> np.ndarray:
        """T(x): when the first front reaches x; NaN where none does until ``duration``."""
        x = as_numbers("x", x)
        times = [part.curve.arrival(x) for part in self._parts]
        return self._until_end(x, np.fmin.reduce(times))

    def fronts_at(self, time: float, x: float = 0.0) -> tuple[float, float]:
        """Positions of the two fronts of the connected part around x at a time.

        Raises ValueError: if the time is outside (0, duration], or x has not slipped by then.
        """
        time = self._time(time)
        check_number("x", x)
        for part in self._parts:
            if part.curve.arrival(x) <= time * (1.0 + SAME):
                return part.curve.front_at(time, x, -1.0), part.curve.front_at(time, x, 1.0)
        raise ValueError(f"x: {x!r}; allowed: positions released before {time:g}")

    def stick_time(self, x) -> np.ndarray:
        """When x sticks; NaN where it does not until ``duration``, or where the construction ends before."""
        x = as_numbers("x", x)
        return self._until_end(x, self._stick(x))

    def _stick(self, x: np.ndarray) -> np.ndarray:
        """Stick times, NaN where not until a little beyond the end, whatever the horizon."""
        positions, back = np.unique(
            np.abs(x) if self.prestress.symmetric else x, return_inverse=True
        )
        out = np.full(positions.shape, np.nan)
        for part in self._parts:
            on = part.curve.covers(positions)
            out[on] = part.stick_time(positions[on])
        return out[back].reshape(x.shape)

    def final_slip(self, x) -> np.ndarray:
        """Slip at x after sticking; 0 where nothing has slipped, NaN where it has not stuck until ``duration``."""
        x = as_numbers("x", x)
        stick = self.stick_time(x)
        slides = np.isfinite(self.release_time(x)) & ~np.isfinite(stick)
        return np.where(
            slides, np.nan, self.slip(x, np.where(np.isfinite(stick), stick, self.duration))
        )

    @cached_property
    def first_stick(self) -> tuple[float, float] | None:
        """Time and position of the first sticking; None where nothing sticks until ``duration``."""
        found = [first for part in self._parts if (first := part.first_stick())]
        known = [(float(self._until_end(np.array(x), np.array(time))), x) for time, x in found]
        return min((first for first in known if np.isfinite(first[0])), default=None)

    @property
    def transition_time(self) -> float:
        """T_trans, the time of the first sticking; NaN where nothing sticks until ``duration``."""
        return self.first_stick[0] if self.first_stick else np.nan

    @cached_property
    def transition_length(self) -> float:
        """L_trans, the distance between the two fronts around the first sticking then."""
        if not self.first_stick:
            return np.nan
        left, right = self.fronts_at(*self.first_stick)
        return right - left

    def pulse_width(self, time: float, side: str = "right") -> float:
        """Distance between the front and the trailing edge behind it at a time; NaN before anything sticks.

        The time is > 0 and at most ``duration``, the side "right" or "left".
        """
        check_choice("side", side, ("right", "left"))
        time = self._time(time)
        if not self.first_stick or time <= self.first_stick[0] * (1.0 + SAME):
            return np.nan
        x = self.first_stick[1]
        front = self.fronts_at(time, x)[side == "right"]

        def late(position: float) -> float:
            return (
                float(np.nan_to_num(self._stick(np.array(position)), nan=2.0 * self.duration))
                - time
            )

        trailing = front if late(front) <= 0.0 else root_between(late, x, front, xtol=1e-11)
        beyond = self._beyond_horizon(np.array([trailing, front]), time).any()
        return np.nan if beyond else abs(front - trailing)

    @cached_property
    def largest_velocity(self) -> float:
        """Largest slip velocity until ``duration``, where the construction holds."""
        return max(part.largest_velocity(self.duration, self.horizon) for part in self._parts)

    def slip_velocity(self, x, time) -> np.ndarray:
        """du/dt at points, broadcast."""
        return self._points(("slip_velocity",), x, time)["slip_velocity"]

    def slip(self, x, time) -> np.ndarray:
        """u at points, broadcast."""
        return self._points(("slip",), x, time)["slip"]

    def strain(self, x, time) -> np.ndarray:
        """du/dx at points, broadcast."""
        return self._points(("strain",), x, time)["strain"]

    def map(self, times, positions, fields: tuple[str, ...] = FIELDS) -> dict[str, np.ndarray]:
        """Fields on a grid of times and positions, at most 1e7 points: arrays [time, position]."""
        if not isinstance(fields, Sequence) or isinstance(fields, str):
            raise ValueError(
                f"fields: {short_repr(fields)}; allowed: a list of {', '.join(FIELDS)}"
            )
        for name in fields:
            check_choice("fields", name, FIELDS)
        x, time = as_numbers("positions", positions), as_numbers("times", times)
        if x.ndim != 1 or time.ndim != 1:
            raise ValueError(
                "times, positions: not one-dimensional; allowed: one-dimensional arrays"
            )
        check_number("times and positions", x.size * time.size, at_most=MOST_POINTS)
        return self._points(tuple(fields), x[None, :], time[:, None])

    def _points(self, fields: tuple[str, ...], x, time) -> dict[str, np.ndarray]:
        x, time = broadcast_numbers(x=x, time=time)
        if np.any(time > self.duration * (1.0 + SAME)):
            raise ValueError(
                f"time: {float(np.max(time))!r}; allowed: <= duration = {self.duration:g}"
            )
        time = np.minimum(time, self.duration)
        positions, column = np.unique(
            np.abs(x) if self.prestress.symmetric else x, return_inverse=True
        )
        column = column.reshape(x.shape)
        out = {name: np.zeros(x.shape) for name in fields}
        for part in self._parts:
            number = np.flatnonzero(part.curve.covers(positions))
            if not number.size:
                continue
            release, stick = np.full((2, positions.size), np.inf)
            release[number] = part.curve.arrival(positions[number])
            stick[number] = np.nan_to_num(part.stick_time(positions[number]), nan=np.inf)
            sliding = (time > release[column]) & (time < stick[column])
            stuck = (time >= stick[column]) & np.isfinite(release[column])
            y, t = positions[column[sliding]], time[sliding]
            # What has stuck is computed once for each position.
            ended = np.unique(column[stuck])
            for name in fields:
                out[name][sliding] = part.field(name, y, t)
                if name != "slip_velocity" and ended.size:
                    last = np.zeros(positions.size)
                    last[ended] = part.field(name, positions[ended], stick[ended])
                    out[name][stuck] = last[column[stuck]]
        if "strain" in out and self.prestress.symmetric:
            out["strain"] *= np.where(x < 0.0, -1.0, 1.0)
        late = self._beyond_horizon(x, time)
        return {name: np.where(late, np.nan, values) for name, values in out.items()}

    def _time(self, time: float) -> float:
        """A time until the duration, which is the duration if only rounding tells them apart."""
        check_number("time", time, above=0.0)
        time = min(float(time), self.duration) if time <= self.duration * (1.0 + SAME) else time
        check_number("time", time, at_most=self.duration)
        return time

    def _until_end(self, x: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Times of events; NaN where they are not known to come until the duration."""
        known = (time <= self.duration * (1.0 + SAME)) & ~self._beyond_horizon(x, time)
        return np.where(known, np.minimum(time, self.duration), np.nan)

    def _beyond_horizon(self, x: np.ndarray, time: np.ndarray | float) -> np.ndarray:
        return time * (1.0 + SAME) >= self.horizon(x)

    @cached_property
    def _ends(self) -> list[Limit]:
        reason = "the trailing edge is slower than the waves"
        found = [Limit(x, t, reason) for part in self._parts for x, t in part.violations()]
        if self.prestress.symmetric:
            found += [Limit(-end.x, end.time, end.reason) for end in found]
        found += [Limit(*point) for point in self._unknown]
        return [end for end in found if end.time <= self.duration * (1.0 + SAME)]

    @property
    def limit(self) -> Limit | None:
        """The earliest point in whose future the construction says nothing; None where it holds until ``duration``."""
        return min(self._ends, key=lambda end: end.time, default=None)

    def horizon(self, x) -> np.ndarray:
        """From when on the construction says nothing at x: everything then is NaN."""
        x = as_numbers("x", x)
        return np.min([end.time + np.abs(x - end.x) for end in self._ends], axis=0, initial=np.inf)
