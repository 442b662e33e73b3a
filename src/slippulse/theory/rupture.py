"""A whole rupture in the continuum limit dx -> 0 at fixed beta/dx: fronts, trailing edges, slip, without a lattice.

While tau(x) > 0 a front outruns the waves, so T(x) is the integral of 1/v(tau(x), beta/dx), and the damping,
beta = (beta/dx) dx -> 0, acts at the front alone. Where tau < 0 the front is a free boundary (`slow_front`). Behind
the fronts the undamped equation has Riemann's solution (`riemann`), up to the trailing edge (`part`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number, short_repr
from ..model.prestress import Prestress
from ..model.roots import root_between
from .curve import SAME, Curve, Panel, seen
from .domains import of_one_shape
from .fronts import NARROWEST, FrontLaw, nucleations
from .part import Part
from .slow_front import advance

# The construction goes on this much beyond the duration, relative, so that the end is a time like any other.
BEYOND = 1e-6
# Of exponents, alpha times the duration, with room to the end of floating point.
MOST_DECAY = 600.0
FIELDS = ("slip_velocity", "slip", "strain")
# Of a map, which takes 100 bytes each.
MOST_POINTS = 10**7
# Why a slow front cannot be followed further.
UNKNOWN = {
    "unknown": "what decides on a slow front comes from another part of the rupture",
    "unresolved": "the motion of a slow front is not resolved",
}
SIDES = (-1.0, 1.0)


@dataclass(frozen=True)
class Limit:
    """A point in whose future the construction says nothing."""

    x: float
    time: float
    reason: str


class FrontEnd(Limit):
    """Where a front is when it stops, or at the end of the time asked for."""


@dataclass
class Stretch:
    """A connected part of the rupture and its two fronts, side -1 (left) and +1 (right)."""

    # Position and time of the outermost known point, by side.
    ends: dict[float, tuple[float, float]]
    # How far, seen going right, a front may go before it meets another nucleation point.
    limits: dict[float, float]
    panels: list[Panel] = field(default_factory=list)
    # Why a front goes no further: "dead" (it stops for good), "duration", "met", a key of UNKNOWN, or None.
    stopped: dict[float, str | None] = field(default_factory=lambda: dict.fromkeys(SIDES))
    # Where a front that was slow outran the waves again, and where fronts from different nucleation points met.
    restarts: dict[float, list[float]] = field(default_factory=lambda: {-1.0: [], 1.0: []})
    joins: list[float] = field(default_factory=list)

    def curve(self) -> Curve:
        """Its panels, as one curve."""
        return Curve(self.panels, self.restarts[-1.0], self.restarts[1.0])

    def add(self, side: float, panels: list[Panel], x: float, time: float) -> None:
        """Append panels made by a front seen going right, which ends at x and time so seen."""
        self.panels = seen(seen(self.panels, side) + panels, side)
        self.ends[side] = (side * x, time)

    def cut(self, side: float, x: float) -> None:
        """Take away what lies beyond x."""
        kept = []
        for panel in seen(self.panels, side):
            left, right = panel.x_ends
            if right <= side * x:
                kept.append(panel)
            elif left < side * x:
                s = float(Curve([panel]).locate(np.array([side * x]))[1][0])
                if s > -1.0:
                    kept.append(panel.until(s, side * x))
        time = kept[-1].time_ends[1] if kept else 0.0
        self.panels = seen(kept, side)
        self.ends[side] = (x, time)
        self.restarts[side] = [r for r in self.restarts[side] if side * r < side * x]


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
        self.law = FrontLaw(prestress, gamma, damping_ratio, release, refinement, rate_strengthening)
        check_number("rate_strengthening", rate_strengthening, at_most=MOST_DECAY / duration)
        self.prestress, self.gamma, self.rate_strengthening = prestress, self.law.gamma, self.law.alpha
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
        positions, back = np.unique(np.abs(x) if self.prestress.symmetric else x, return_inverse=True)
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
        return np.where(slides, np.nan, self.slip(x, np.where(np.isfinite(stick), stick, self.duration)))

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
            return float(np.nan_to_num(self._stick(np.array(position)), nan=2.0 * self.duration)) - time

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
            raise ValueError(f"fields: {short_repr(fields)}; allowed: a list of {', '.join(FIELDS)}")
        for name in fields:
            check_choice("fields", name, FIELDS)
        x, time = as_numbers("positions", positions), as_numbers("times", times)
        if x.ndim != 1 or time.ndim != 1:
            raise ValueError("times, positions: not one-dimensional; allowed: one-dimensional arrays")
        check_number("times and positions", x.size * time.size, at_most=MOST_POINTS)
        return self._points(tuple(fields), x[None, :], time[:, None])

    def _points(self, fields: tuple[str, ...], x, time) -> dict[str, np.ndarray]:
        x, time = of_one_shape(x=x, time=time)
        if np.any(time > self.duration * (1.0 + SAME)):
            raise ValueError(f"time: {float(np.max(time))!r}; allowed: <= duration = {self.duration:g}")
        time = np.minimum(time, self.duration)
        positions, column = np.unique(np.abs(x) if self.prestress.symmetric else x, return_inverse=True)
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


def spread(law: FrontLaw, until: float) -> tuple[list[Stretch], list[tuple[float, float, str]]]:
    """All connected parts of the rupture until a time, from left to right, and points where more is not known."""
    starts = nucleations(law.prestress)
    if not starts:
        raise ValueError("prestress: below 1 everywhere; allowed: a profile that reaches 1 somewhere")
    laws = {1.0: law, -1.0: law.mirrored()}
    befores, afters = [-np.inf, *(right for _, right in starts)], [*(left for left, _ in starts[1:]), np.inf]
    stretches = []
    for (left, right), before, after in zip(starts, befores, afters, strict=False):
        stretch = Stretch({-1.0: (left, 0.0), 1.0: (right, 0.0)}, {-1.0: -before, 1.0: after})
        if left < right:
            stretch.add(1.0, law.rightwards(left, 0.0, right, np.inf)[0], right, 0.0)
        for side in SIDES:
            _run(laws[side], stretch, side, until)
        stretches.append(stretch)
    stretches = _joined(stretches)
    # The slow fronts, the earliest first: each follows from what the others did before.
    while going := [
        (s.ends[side][1], n, side)
        for n, s in enumerate(stretches)
        for side in SIDES
        if s.stopped[side] is None
    ]:
        _, n, side = min(going)
        _step(laws[side], stretches[n], side, until)
        stretches = _joined(stretches)
    stops = [(s.ends[side], str(s.stopped[side])) for s in stretches for side in SIDES]
    unknown = [(*end, UNKNOWN[reason]) for end, reason in stops if reason in UNKNOWN]
    return stretches, unknown + _overrun(stretches)


def _overrun(stretches: list[Stretch]) -> list[tuple[float, float, str]]:
    """Cut fronts that come to where another has stopped for good: what they do there is not known."""
    out = []
    for left, right in pairwise(stretches):
        for near, far, side in ((left, right, -1.0), (right, left, 1.0)):
            # The front of `far` on this side has passed the end of `near`.
            x = near.ends[-side][0]
            if far.panels and side * far.ends[side][0] > side * x:
                far.cut(side, x)
                far.stopped[side] = "met"
                out.append((*far.ends[side], "a front comes to where another one has stopped"))
    return out


def _run(law: FrontLaw, stretch: Stretch, side: float, until: float) -> None:
    """Let a front go on while it outruns the waves, as far as the next nucleation point."""
    x, time = stretch.ends[side]
    limit = stretch.limits[side]
    panels, x, time = law.rightwards(side * x, time, limit, until)
    if panels:
        stretch.add(side, panels, x, time)
    if time >= until:
        stretch.stopped[side] = "duration"
    elif x >= limit:
        stretch.stopped[side] = "met"


def _step(law: FrontLaw, stretch: Stretch, side: float, until: float) -> None:
    """One panel of a slow front, and where its negative piece ends the fast front that follows."""
    x, _ = stretch.ends[side]
    piece = law.piece_right_of(side * x)
    mark = min(piece.right, stretch.limits[side])
    curve = stretch.curve() if side > 0.0 else stretch.curve().mirrored()
    panel, stop = advance(curve, law.prestress, piece.level, law.gamma, mark, law.alpha)
    if panel is not None:
        stretch.add(side, [panel], panel.x_ends[1], panel.time_ends[1])
    if stop in ("dead", *UNKNOWN):
        stretch.stopped[side] = stop
    elif stretch.ends[side][1] >= until:
        stretch.stopped[side] = "duration"
    elif stop == "mark":
        if mark >= stretch.limits[side]:
            stretch.stopped[side] = "met"
        elif law.piece_right_of(mark).supersonic:
            stretch.restarts[side].append(side * mark)
            _run(law, stretch, side, until)


def _joined(stretches: list[Stretch]) -> list[Stretch]:
    """Neighbours whose fronts have met, made one: where both have been, the earlier counts."""
    out = [stretches[0]]
    for right in stretches[1:]:
        left = out[-1]
        overlap = right.ends[-1.0][0], left.ends[1.0][0]
        if not (overlap[0] <= overlap[1] and left.panels and right.panels):
            out.append(right)
            continue
        first, second = left.curve(), right.curve()

        def lead(x: float, first=first, second=second) -> float:
            return float(first.arrival(np.array(x)) - second.arrival(np.array(x)))

        low = max(overlap[0], float(first.edges[0]))
        high = min(overlap[1], float(second.edges[-1]))
        if not (lead(low) <= 0.0 <= lead(high)):
            out.append(right)
            continue
        x = root_between(lead, low, high, xtol=1e-14)
        rises = np.diff([first.arrival(np.array([x - 1e-6, x])), second.arrival(np.array([x, x + 1e-6]))])
        slow = bool(np.any(np.abs(rises) > 1e-6))
        left.cut(1.0, x)
        right.cut(-1.0, x)
        restart = [x] if slow else []
        out[-1] = Stretch(
            ends={-1.0: left.ends[-1.0], 1.0: right.ends[1.0]},
            limits={-1.0: left.limits[-1.0], 1.0: right.limits[1.0]},
            panels=left.panels + right.panels,
            stopped={-1.0: left.stopped[-1.0], 1.0: right.stopped[1.0]},
            restarts={side: left.restarts[side] + right.restarts[side] + restart for side in SIDES},
            joins=[*left.joins, x, *right.joins],
        )
    return out
