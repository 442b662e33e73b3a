"""A whole rupture in the continuum limit dx -> 0 at fixed beta/dx: fronts, trailing edges, slip, without a lattice.

While tau(x) > 0 a front outruns the waves, so T(x) is the integral of 1/v(tau(x), beta/dx), and the damping,
beta = (beta/dx) dx -> 0, acts at the front alone. Where tau < 0 the front is a free boundary (`slow_front`). Behind
the fronts the undamped equation has Riemann's solution (`riemann`), up to the trailing edge (`trailing`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number, of_one_shape, short_repr
from ..model.prestress import Prestress
from ..model.roots import root_between
from .fronts import NARROWEST, FrontLaw
from .part import Part
from .spreading import spread

FIELDS = ("slip_velocity", "slip", "strain")
# Of a map, which takes 100 bytes each.
MOST_POINTS = 10**7


@dataclass(frozen=True)
class Limit:
    """A point in whose future the construction says nothing."""

    x: float
    time: float
    reason: str


@dataclass(frozen=True)
class FrontEnd:
    """Where a front is when it stops, or at the end of the time asked for."""

    x: float
    time: float
    reason: str


class Rupture:
    """The exact rupture of a pre-stress in the continuum limit.

    Parameters
    ----------
    prestress : Prestress
        Reaching 1 somewhere; each place where it does at t = 0 is a nucleation point.
    gamma : float
        Elasticity ratio, > 0; or 0 for the stress boundary.
    damping_ratio : float
        beta/dx, from 0 to 1e6, at which dx -> 0.
    release : "total" or "elastic"
    duration : float
        Time up to which the rupture is wanted, >= 1e-9.
    refinement : int
        Panels are cut into so many more, to see what the result owes to them; 1 to 10.

    Raises
    ------
    ValueError
        If a value is outside its domain, the pre-stress nowhere reaches 1, or a front needs more than 20000 panels.
        Of every method: if a position or a time is not a finite number (where arrays are taken, an array of them).

    Source: derived for this project; verified against the lattice, which tends to it at first order in dx.
    """

    def __init__(
        self, prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total",
        duration: float = 10.0, refinement: int = 1,
    ) -> None:  # fmt: skip
        check_number("duration", duration, at_least=NARROWEST)
        self.law = FrontLaw(prestress, gamma, damping_ratio, release, refinement)
        self.prestress, self.gamma = prestress, self.law.gamma
        self.damping_ratio, self.release, self.duration = self.law.damping_ratio, release, float(duration)
        self.refinement = self.law.refinement
        self.stretches, stopped = spread(self.law, self.duration)
        self._stopped = [Limit(*point) for point in stopped]
        self._parts = [Part(self.law, stretch, self.duration) for stretch in self.stretches if stretch.panels]

    # Fronts

    @property
    def front_ends(self) -> list[tuple[FrontEnd, FrontEnd]]:
        """Left and right end of each connected part: "stops" for good, or "duration" where it goes on."""
        names = {"dead": "stops"}
        return [
            tuple(
                FrontEnd(
                    *map(float, stretch.ends[side]), names.get(stretch.stopped[side], stretch.stopped[side])
                )
                for side in (-1.0, 1.0)
            )
            for stretch in self.stretches
        ]

    def release_time(self, x) -> np.ndarray:
        """T(x): when the first front reaches x; NaN where none does until ``duration``."""
        x = as_numbers("x", x)
        out = np.full(x.shape, np.nan)
        for part in self._parts:
            time = part.curve.arrival(x)
            out = np.where(np.isfinite(time), time, out)
        return np.where((out <= self.duration) & (out < self.horizon(x)), out, np.nan)

    def fronts_at(self, time: float, x: float = 0.0) -> tuple[float, float]:
        """Positions of the two fronts of the connected part around x at a time.

        Raises
        ------
        ValueError
            If the time is outside (0, duration], or x has not slipped by then.
        """
        check_number("time", time, above=0.0, at_most=self.duration)
        check_number("x", x)
        part = self._part_at(x)
        if part is None or not float(part.curve.arrival(np.array(x))) <= time:
            raise ValueError(f"x: {x!r}; allowed: positions released before {time:g}")
        return part.front_at(time, x, -1.0), part.front_at(time, x, 1.0)

    # Sticking

    def stick_time(self, x) -> np.ndarray:
        """When x sticks; NaN where it does not until ``duration``, or where the construction ends before."""
        x = as_numbers("x", x)
        places, back = np.unique(self._side(x), return_inverse=True)
        out = np.full(places.shape, np.nan)
        for part in self._parts:
            inside = part.inside(places)
            out[inside] = part.edge.stick_time(places[inside])
        out[~(out < self.horizon(places))] = np.nan
        return out[back].reshape(x.shape)

    def final_slip(self, x) -> np.ndarray:
        """Slip at x after sticking; 0 where nothing has slipped, NaN where it has not stuck until ``duration``.

        Final as long as `limit` is None: in the future of that point blocks may slip again.
        """
        x = as_numbers("x", x)
        stick = self.stick_time(x)
        slid = np.isfinite(self.release_time(x))
        known = np.where(np.isfinite(stick), stick, self.duration)
        return np.where(slid & ~np.isfinite(stick), np.nan, self.slip(x, known))

    @cached_property
    def first_stick(self) -> tuple[float, float] | None:
        """Time and position of the first sticking; None where nothing sticks until ``duration``."""
        found = [first for part in self._parts if (first := part.first_stick())]
        found = [(time, x) for time, x in found if time < float(self.horizon(np.array(x)))]
        return min(found) if found else None

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

        Parameters
        ----------
        time : > 0, at most ``duration``
        side : "right" or "left"
        """
        check_choice("side", side, ("right", "left"))
        check_number("time", time, above=0.0, at_most=self.duration)
        if not self.first_stick or time <= self.first_stick[0]:
            return np.nan
        x = self.first_stick[1]
        front = self.fronts_at(time, x)[side == "right"]

        def late(place: float) -> float:
            stick = float(self.stick_time(np.array(place)))
            # At the end itself the front's own point is said to stick as it is released.
            return (stick if stick < self.duration else 2.0 * self.duration) - time

        if late(front) <= 0.0 or time >= float(self.horizon(np.array(front))):
            return 0.0 if late(front) <= 0.0 else np.nan
        return abs(front - root_between(late, x, front, xtol=1e-11))

    @cached_property
    def largest_velocity(self) -> float:
        """Largest slip velocity until ``duration``, where the construction holds."""
        return max(part.largest_velocity(self.horizon) for part in self._parts)

    # Fields

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
        x, time = of_one_shape(x=as_numbers("x", x), time=as_numbers("time", time))
        if np.any(time > self.duration):
            raise ValueError(f"time: {float(np.max(time))!r}; allowed: <= duration = {self.duration:g}")
        side = self._side(x)
        places, column = np.unique(side, return_inverse=True)
        column = column.reshape(x.shape)
        out = {name: np.zeros(x.shape) for name in fields}
        for part in self._parts:
            number = np.flatnonzero(part.inside(places))
            if not number.size:
                continue
            release, stick = np.full((2, places.size), np.inf)
            release[number] = part.curve.arrival(places[number])
            found = part.edge.stick_time(places[number])
            stick[number] = np.where(np.isfinite(found), found, np.inf)
            sliding = (time > release[column]) & (time < stick[column])
            stuck = (time >= stick[column]) & np.isfinite(release[column])
            y, t = places[column[sliding]], time[sliding]
            # What has stuck is computed once for each position.
            ended = np.unique(column[stuck])
            for name in fields:
                out[name][sliding] = part.field(name, y, t)
                if name != "slip_velocity" and ended.size:
                    last = np.zeros(places.size)
                    last[ended] = part.field(name, places[ended], stick[ended])
                    out[name][stuck] = last[column[stuck]]
        if "strain" in out and self.prestress.symmetric:
            out["strain"] = np.where(x < 0.0, -out["strain"], out["strain"])
        late = time >= self.horizon(x)
        return {name: np.where(late, np.nan, values) for name, values in out.items()}

    def _side(self, x: np.ndarray) -> np.ndarray:
        return np.abs(x) if self.prestress.symmetric else x

    def _part_at(self, x: float) -> Part | None:
        return next((part for part in self._parts if part.inside(np.array(x))), None)

    # Where it ends

    @cached_property
    def _ends(self) -> list[Limit]:
        reason = "the trailing edge is slower than the waves"
        found = [Limit(x, t, reason) for part in self._parts for x, t in part.edge.violations()]
        if self.prestress.symmetric:
            found += [Limit(-end.x, end.time, end.reason) for end in found]
        return self._stopped + found

    @property
    def limit(self) -> Limit | None:
        """The earliest point in whose future the construction says nothing; None where it holds until ``duration``."""
        return min(self._ends, key=lambda end: end.time, default=None)

    def horizon(self, x) -> np.ndarray:
        """From when on the construction says nothing at x: everything then is NaN."""
        x = as_numbers("x", x)
        out = np.full(x.shape, np.inf)
        if self._ends:
            ends = np.array([(end.x, end.time) for end in self._ends])
            out = np.min(ends[:, 1] + np.abs(x[..., None] - ends[:, 0]), axis=-1)
        return out
