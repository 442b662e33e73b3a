"""The free boundary: a front into negative pre-stress, which is slower than the waves.

A fast front is driven by the pre-stress ahead of it. A front into negative pre-stress is driven by
the waves that come from behind, and its path is unknown: it is a free boundary. Slip, slip velocity
and strain vanish on it, because no fracture energy is needed to release a block.

Consider the wave, or characteristic, that arrives at the slow front at (X, t). It entered the
rupture at a point e of the known part of the curve, which is called its entry:

      t |                      *      (X, t)
        |                    / *
        |                  /  *
        |                /    *       slow front, dT/dx > 1
        |              /     *
        |            /       *        characteristic T - x = const, from e to X
        |          /        *
        |        /          *
        | e -> *           *          fast fronts, known
        |         *     *
        |            *                nucleation
        +--------------------------- x

T - x has the same value at the entry and at the front. With xi = T(e) - e and eta = xi + 2 X, the
condition that du/dt = 0 on the front is Riemann's formula

    Int_e^X tau(x) E J0( sqrt(k (xi - T + x) (eta - T - x)) ) dx = 0,

where the decay factor E and the stiffness k are those of `riemann`. X is computed as a function of
the entry e instead of the time, because this function remains smooth where the front stops (there
dX/de = 0).

The front grows by one panel at a time (`SlowFront.next_panel`). Its entries form a chunk, which is
part of one panel of the known curve, from right to left. `FreeBoundary` is the equation above at
the nodes of the chunk. Newton's method solves it for the positions X. The chunk is halved if the
solution is not resolved. It is shortened where the front stops, or where it reaches the end of the
negative pre-stress, which is called the mark. The new panel belongs to the known curve from then
on.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ..model.prestress import Interval, Prestress
from .curve import (
    NODE_COUNT,
    NODES,
    NODES_TO_DERIVATIVES,
    NODES_TO_ENDS,
    NODES_TO_INTEGRALS,
    NODES_TO_SERIES,
    WEIGHTS,
    Curve,
    Panel,
)
from .prestress_pieces import continued_prestress
from .riemann import decay, kernel_function, partial_weights

# A solution is resolved if the last two coefficients of its Legendre series are below this
# fraction of the size of the rupture.
SERIES_TOLERANCE = 1e-11
# After a chunk that was shortened, the next one is at most this factor longer.
MAX_CHUNK_GROWTH = 4.0
# Shortest chunk, in the parameter of its panel.
MIN_CHUNK = 1e-11
# If a shorter remainder of a panel of entries is left, the next panel is used instead.
MIN_REMAINDER = 1e-8
# Entries are skipped if they move the front by less than a small fraction of the size of the
# rupture. The first fraction is that of rounding. The larger ones are used only if the front would
# otherwise run back, because panels do not resolve such small motions.
NEGLIGIBLE_MOTIONS = (1e-13, 1e-12, 1e-11, 1e-10)
# The entries to skip are determined at samples between the first entry and the left end of its
# panel, at these fractions of the way.
ENTRY_FRACTIONS = np.linspace(0.0, 1.0, 65)
# A front that speeds up to the wave speed at the mark cannot be resolved up to there. If the mark
# is nearer than this fraction of the size of the rupture, the front is continued at the wave speed.
MARK_DISTANCE = 1e-5
# Length of a panel in its parameter.
PANEL_LENGTH = 2.0
# The time by which a characteristic is later than another one, for a search of its entry, as a
# fraction of the size of the rupture.
SEARCH_DELAY = 1e-11
# An event this close to the first entry of a chunk, in the parameter of the chunk, is the one that
# ended the previous chunk.
EVENT_AT_START = 1e-6
# A chunk ends at an event if the distance between the event and its last entry is below this.
EVENT_AT_END = 1e-9
# After more corrections of the end than this number, a larger distance is sufficient.
MAX_EXACT_CORRECTIONS = 5
# The larger distance.
EVENT_NEAR_END = 1e-6
# In a chunk that was shortened to end at an event, events are searched up to this parameter, a
# little beyond its end at 1.
SEARCH_LIMIT = 1.2
# The most chunks that are tried for a panel.
MAX_CHUNKS = 60
# A front is not followed on a curve of more panels.
MAX_PANELS = 100_000
MAX_NEWTON_STEPS = 60


class Progress(NamedTuple):
    """State that a slow front keeps from one panel to the next.

    next_length is the longest chunk to try next. last_entry is the position where the wave that
    arrives at the front now entered the rupture; NaN before the first panel.
    """

    next_length: float = PANEL_LENGTH
    last_entry: float = np.nan


class Event(NamedTuple):
    """An event of a slow front: it reaches the mark ("mark"), or it stops for a while ("stop").

    s is the parameter of the event on the chunk. If there is no event, s is infinite, and the name
    is "none".
    """

    s: float
    name: str


class Entry(NamedTuple):
    """A point of the curve where a wave enters the rupture: its panel, and the parameter on it.

    The panel is negative if no further entry moves the front on. skipped_motion is the distance
    that the front moves by the negligible entries that were skipped before this one.
    """

    panel: int
    s: float
    skipped_motion: float = 0.0


NO_ENTRY = Entry(panel=-1, s=1.0)


class Skipped(NamedTuple):
    """The entries that are skipped on a panel, because they hardly move the front.

    last_sample is the number of the last skipped sample, and s is its parameter. motion is the
    distance that the front moves by all skipped entries. moves_on is False if the entries after
    them move the front back.
    """

    last_sample: int
    s: float
    motion: float
    moves_on: bool


class Advance(NamedTuple):
    """The next panel of a front, and the state for the panel after it.

    end_reason is the reason why the front ends (see `SlowFront.next_panel`), None if it goes on.
    """

    panel: Panel | None
    end_reason: str | None
    progress: Progress = Progress()


class Chunk(NamedTuple):
    """A range of entries on one panel of the curve, from right to left.

    start and stop are the parameters of the first and the last entry on the panel. The chunk has a
    parameter of its own, which is -1 at the first entry and 1 at the last one.
    """

    panel: int
    start: float
    stop: float

    def parameters(self, s: np.ndarray = NODES) -> np.ndarray:
        """Return the parameters on the panel that belong to parameters s of the chunk."""
        return self.start + 0.5 * (self.stop - self.start) * (1.0 + s)

    def half(self) -> "Chunk":
        """Return the first half of the chunk."""
        return self._replace(stop=0.5 * (self.start + self.stop))


def _first_event(x: np.ndarray, mark: float, corrections: int) -> Event:
    """Return the first event of a front on a chunk of entries: it stops, or it reaches the mark.

    x has the positions of the front at the nodes of the chunk. The front stops where the derivative
    of its position by the parameter is 0. corrections is the number of times that the end of the
    chunk was moved to an event. If it was moved, the event may lie a little beyond the end.
    """
    largest_s = SEARCH_LIMIT if corrections else 1.0
    stops = _roots_on_chunk(NODES_TO_DERIVATIVES @ x, largest_s)
    arrivals = _roots_on_chunk(x - mark, largest_s) if np.isfinite(mark) else []
    events = [Event(s, "stop") for s in stops] + [Event(s, "mark") for s in arrivals]
    return min(events, key=lambda event: event.s, default=Event(np.inf, "none"))


def _must_be_corrected(event: Event, corrections: int) -> bool:
    """Return True if there is an event on a chunk of entries, but the chunk does not end there yet.

    corrections is the number of times that the end of the chunk was moved to an event. It is moved
    at least once, even if the event is at the end already. After many corrections the event may be
    a little farther from the end.
    """
    if event.name == "none":
        return False
    has_many_corrections = corrections > MAX_EXACT_CORRECTIONS
    tolerance = EVENT_NEAR_END if has_many_corrections else EVENT_AT_END
    # The parameter s of the chunk is 1 at its end.
    distance_to_end = abs(event.s - 1.0)
    return corrections == 0 or distance_to_end >= tolerance


def _runs_back(x: np.ndarray) -> bool:
    """Return True if a front runs back at the start of a chunk of entries.

    x has the positions of the front at the nodes of the chunk.
    """
    slope = NODES_TO_DERIVATIVES @ x
    # The sign of the slope is examined halfway between the start, at s = -1, and the first stop of
    # the front.
    first_stop = min(_roots_on_chunk(slope, 1.0), default=1.0)
    halfway = 0.5 * (first_stop - 1.0)
    return bool(legendre.legval(halfway, NODES_TO_SERIES @ slope) < 0.0)


def _roots_on_chunk(values: np.ndarray, largest_s: float) -> list[float]:
    """Return the roots of a polynomial between the start of a chunk, s = -1, and the largest s.

    values are those of the polynomial at the nodes. A root at the very start is left out.
    """
    series = NODES_TO_SERIES @ values
    largest_coefficient = np.max(np.abs(series))
    if largest_coefficient == 0.0:
        return []
    # The highest terms are dropped if they are only rounding errors.
    roots = legendre.legroots(legendre.legtrim(series, 1e-13 * largest_coefficient))
    is_real = np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots.real))
    real_roots = roots.real[is_real]
    is_on_chunk = (real_roots > -1.0 + EVENT_AT_START) & (real_roots <= largest_s)
    return real_roots[is_on_chunk].tolist()


class FreeBoundary:
    """The equation of the free boundary on one chunk, for the positions X of the front.

    It is one integral for each node of the chunk, from an entry to the front. Arrays have one row
    for each of these integrals, and one column for each node of the curve. The first columns are
    those of the known curve, from the panel of the entries on, and the last ones those of the new
    panel.
    """

    def __init__(self, front: "SlowFront", chunk: Chunk) -> None:
        curve, panel = front.curve, chunk.panel
        s = chunk.parameters()
        self.front = front
        # T - x at the entries. It has the same value at the front.
        self.t_minus_x = curve.evaluate("t_minus_x", np.full(NODE_COUNT, panel), s)
        # T + x at the nodes of the known curve.
        self.t_plus_x = curve.t_plus_x[panel:].ravel()
        # Weights, times tau, of the integrals over the known curve. An integral begins at an entry,
        # within the panel of the entries, and covers all later panels.
        on_entry_panel = (WEIGHTS - partial_weights(s)) * curve.source[panel]
        on_later_panels = (curve.source[panel + 1 :] * WEIGHTS).ravel()
        self.weight = np.concatenate(
            [on_entry_panel, np.tile(on_later_panels, (NODE_COUNT, 1))], axis=1
        )
        self.d_xi = self.t_minus_x[:, None] - np.append(curve.t_minus_x[panel:], self.t_minus_x)
        # Without leaf springs and drag the kernel is 1.
        self.has_unit_kernel = front.stiffness == front.alpha == 0.0
        self.known_integral = self.weight.sum(axis=1) if self.has_unit_kernel else np.zeros(0)

    def newton_step(self, x: np.ndarray) -> np.ndarray | None:
        """Return the step of Newton's method, which is to be subtracted from the positions x.

        None if a front at such positions would be unstable: one of the integrals would grow if the
        front moved farther.
        """
        if self.has_unit_kernel:
            return self.newton_step_with_unit_kernel(x)
        kernel, kernel_slope = self.kernel_and_slope(x)
        # The integrals over the known curve, from the entries to x0.
        known_count = self.t_plus_x.size
        over_known = (self.weight * kernel[:, :known_count]).sum(axis=1)
        over_known_slope = (self.weight * kernel_slope[:, :known_count]).sum(axis=1)
        # The integrals over the new panel, from x0 to the positions, are split into two. With a
        # kernel of 1 they are exact. With the kernel minus 1 they are computed from the nodes.
        prestress_integral, tau = self.crossed_by_front(x)
        slope_of_integral = tau + over_known_slope
        if not np.all(slope_of_integral < 0.0):
            return None
        dx_ds = NODES_TO_DERIVATIVES @ x
        # This matrix integrates a function times the kernel minus 1, in each row up to its node.
        kernel_minus_1 = NODES_TO_INTEGRALS * (kernel[:, known_count:] - 1.0)
        residual = over_known + prestress_integral + kernel_minus_1 @ (tau * dx_ds)
        # The derivatives of the residual of each row by the positions at all nodes. A position
        # changes dX/ds and tau at its node. It also changes the kernel of its own row, and that of
        # the other rows at its node by the opposite amount.
        by_dx_ds = (kernel_minus_1 * tau) @ NODES_TO_DERIVATIVES
        by_tau = kernel_minus_1 * (NODES_TO_DERIVATIVES @ tau)
        by_kernel = NODES_TO_INTEGRALS * kernel_slope[:, known_count:] * (tau * dx_ds)
        derivatives = by_dx_ds + by_tau - by_kernel
        derivatives += np.diag(slope_of_integral + by_kernel.sum(axis=1))
        return np.linalg.solve(derivatives, residual)

    def kernel_and_slope(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the kernel E J0, [row, node], and its derivative by the position X of the row.

        E is the decay factor by drag. The positions of the front are x.
        """
        k, alpha = self.front.stiffness, self.front.alpha
        # T + x at the front, where T - x has its value at the entry.
        eta = self.t_minus_x + 2.0 * x
        d_eta = eta[:, None] - np.append(self.t_plus_x, eta)
        z = k * self.d_xi * d_eta
        bessel = kernel_function(k, z, z)
        exponential = decay(alpha, self.d_xi, d_eta) if alpha else 1.0
        kernel = exponential * bessel(0)
        # The derivative of eta by X is 2.
        slope = 2.0 * k * exponential * bessel(1) * self.d_xi - 0.5 * alpha * kernel
        return kernel, slope

    def newton_step_with_unit_kernel(self, x: np.ndarray) -> np.ndarray | None:
        """Return the step of Newton's method if the kernel is 1; None as in `newton_step`."""
        prestress_integral, tau = self.crossed_by_front(x)
        if not np.all(tau < 0.0):
            return None
        return (self.known_integral + prestress_integral) / tau

    def crossed_by_front(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the integral of tau from the start x0 of the new panel to x, and tau at x.

        x are the positions of the front.
        """
        half = 0.5 * (x - self.front.x0)
        # Quadrature nodes between the start and each position, and the position itself.
        nodes_and_end = np.append(1.0 + NODES, 2.0)
        tau = self.front.tau(self.front.x0 + half[:, None] * nodes_and_end)
        return half * (tau[:, :-1] @ WEIGHTS), tau[:, -1]


@dataclass
class SlowFront:
    """The right end of a curve, and its continuation into negative pre-stress.

    The front is at the position x0 at the time t0. background is the linear piece of the
    pre-stress around x0. size is the size of the rupture. An entry is the point of the curve where
    a wave entered the rupture that arrives at the front.
    """

    curve: Curve
    prestress: Prestress
    background: Interval
    gamma: float
    alpha: float = 0.0

    def __post_init__(self) -> None:
        self.stiffness = self.gamma - 0.25 * self.alpha**2
        edges = self.curve.edges
        self.x0, self.t0 = float(edges[-1]), float(self.curve.edge_times[-1])
        self.size = max(float(edges[-1] - edges[0]), abs(self.x0))

    def next_panel(self, mark: float, progress: Progress) -> Advance:
        """Continue the front by the next panel, whose entries lie on one panel of the curve.

        mark is the end of the negative pre-stress; it may be infinite. The panel ends at the latest
        where the front stops, for a while or for ever. The reason in the result is None if the
        front can go on, and otherwise one of

            "mark"        the new panel ends at the mark;
            "stops"       the front could only run back;
            "unknown"     the wave that arrives next comes from beyond the left end of the curve;
            "unresolved"  the front is not resolved on any chunk.
        """
        if len(self.curve.panels) > MAX_PANELS:
            return Advance(None, "unresolved")
        # If the front seems to stop, the next attempts skip more entries.
        for negligible in NEGLIGIBLE_MOTIONS:
            entry = self.next_entry(progress.last_entry, negligible)
            if entry is None:
                return Advance(None, "unknown")
            if entry.panel < 0:
                return Advance(None, "stops")
            resting = self.resting_panel(entry)
            if resting is not None:
                return Advance(resting, None, Progress(last_entry=self.position(entry)))
            advance = self.advance_from(entry, mark, progress.next_length)
            if advance.end_reason != "stops":
                break
        return advance

    def advance_from(self, entry: Entry, mark: float, next_length: float) -> Advance:
        """Continue the front by one panel, which begins with a given entry.

        The longest chunk of entries that next_length allows is tried first. It is halved until its
        solution can be used. If there is an event on it, it is changed to end at the event.
        """
        last_s = max(entry.s - next_length, -1.0)
        chunk, corrections = Chunk(entry.panel, entry.s, last_s), 0
        for _ in range(MAX_CHUNKS):
            if chunk.start - chunk.stop < MIN_CHUNK:
                return self.straight_to_mark(mark)
            x = self.solve(chunk)
            if x is not None and _runs_back(x):
                if mark - self.x0 >= MARK_DISTANCE * self.size:
                    return Advance(None, "stops")
                # This close to a mark the front may run back only because of rounding.
                x = None
            if x is None:
                chunk, corrections = chunk.half(), 0
                continue
            event = _first_event(x, mark, corrections)
            if _must_be_corrected(event, corrections):
                # Beyond an event the solution may be meaningless. So the chunk is solved again with
                # its end at the event.
                chunk = chunk._replace(stop=float(chunk.parameters(np.array(event.s))))
                corrections += 1
            elif np.any(np.diff(x, prepend=self.x0) <= 0.0):
                # Where the equation hardly depends on the position of the front, rounding may put
                # the front behind its start.
                chunk, corrections = chunk.half(), 0
            else:
                return self.advance_along(chunk, x, event, mark)
        return Advance(None, "unresolved")

    def advance_along(self, chunk: Chunk, x: np.ndarray, event: Event, mark: float) -> Advance:
        """Return the panel with positions x at the nodes of a solved chunk that ends at an event.

        If there was no event, the chunk that is tried next may be longer.
        """
        reaches_mark = event.name == "mark"
        x_end = mark if reaches_mark else float(NODES_TO_ENDS[1] @ x)
        next_length = PANEL_LENGTH
        if event.name == "none" and chunk.stop != -1.0:
            next_length = MAX_CHUNK_GROWTH * (chunk.start - chunk.stop)
        progress = Progress(next_length, self.position(Entry(chunk.panel, chunk.stop)))
        return Advance(
            self.panel_of_chunk(chunk, x, x_end), "mark" if reaches_mark else None, progress
        )

    def tau(self, x: np.ndarray) -> np.ndarray:
        """Return the pre-stress at positions ahead of the front."""
        return continued_prestress(self.prestress, self.background, x)

    def next_entry(self, last_entry: float, negligible: float) -> Entry | None:
        """Return where the wave entered the rupture that moves the front next; None if unknown.

        This entry follows the last one, whose position is given, along the curve from right to
        left. Entries are skipped as long as all of them together move the front by no more than the
        fraction ``negligible`` of the size of the rupture.
        """
        # The entry could also be found from its value of T - x. But where the pre-stress is nearly
        # 0, T - x is constant to rounding, and the search would fail.
        entry = self.entry_next_to(last_entry)
        skipped_motion, has_skipped = 0.0, False
        # The panels are examined one after another. The search ends at a panel of the slow front
        # itself, since an entry behind it is found in another way.
        while entry.panel >= 0 and not self.is_slow_to_right(entry.panel):
            skipped = self.skip_entries(entry, skipped_motion, negligible)
            skipped_motion = skipped.motion
            has_skipped = has_skipped or skipped.last_sample > 0
            if skipped.last_sample < ENTRY_FRACTIONS.size - 1:
                if not has_skipped:
                    return Entry(int(entry.panel), skipped.s)
                if not skipped.moves_on:
                    return NO_ENTRY
                motion = max(skipped_motion, self.min_motion)
                return Entry(int(entry.panel), skipped.s, motion)
            entry = Entry(entry.panel - 1, 1.0)
        if entry.panel >= 0:
            return self.entry_behind_slow_front()
        return NO_ENTRY if has_skipped else None

    def entry_next_to(self, last_entry: float) -> Entry:
        """Return the point of the curve that follows the position of the last entry on its left.

        It is the right end of the curve if there was no entry yet (NaN).
        """
        if not np.isfinite(last_entry):
            return Entry(len(self.curve.panels) - 1, 1.0)
        (panel,), (s,) = self.curve.locate(np.array([last_entry]))
        # A remainder of the panel that is as small as rounding errors cannot be resolved.
        return Entry(panel, s) if s + 1.0 >= MIN_REMAINDER else Entry(panel - 1, 1.0)

    def skip_entries(self, entry: Entry, skipped_motion: float, negligible: float) -> Skipped:
        """Return which entries are skipped on a panel, from a given one to the left.

        Entries are skipped if they move the front by no more than the fraction ``negligible`` of
        the size of the rupture. skipped_motion is the motion by entries on other panels that were
        skipped before.
        """
        # Samples from the entry to the left end of its panel.
        s = entry.s - (entry.s + 1.0) * ENTRY_FRACTIONS
        motions = skipped_motion + self.motion_by_entries(entry.panel, s)
        # Only entries with negative pre-stress can move the front back. Of their motions only
        # rounding errors are negligible.
        is_negative = bool(np.min(self.curve.source[entry.panel]) < 0.0)
        largest_motion = self.size * (NEGLIGIBLE_MOTIONS[0] if is_negative else negligible)
        # The last sample before the first one whose motion is too large, or the entry itself.
        is_negligible = np.append(np.abs(motions) <= largest_motion, False)
        last = max(0, int(np.argmin(is_negligible)) - 1)
        motion = float(motions[last])
        is_end_of_panel = last == ENTRY_FRACTIONS.size - 1
        moves_on = not is_negative or is_end_of_panel or motions[last + 1] >= motion
        return Skipped(last, s=float(s[last]), motion=motion, moves_on=bool(moves_on))

    def motion_by_entries(self, panel: int, parameters: np.ndarray) -> np.ndarray:
        """Return how far the front moves by the waves that entered on a part of a panel.

        The part goes from the first of the parameters to each of them. The motion times the
        resistance of the front is the integral of the pre-stress over this part.
        """
        weights = partial_weights(parameters)
        return (weights[0] - weights) @ self.curve.source[panel] / self.resistance

    @property
    def min_motion(self) -> float:
        """The smallest motion of the front that is taken into account, below rounding errors."""
        return 0.1 * NEGLIGIBLE_MOTIONS[0] * self.size

    @property
    def resistance(self) -> float:
        """Size of the negative pre-stress immediately ahead of the front."""
        x_ahead = self.x0 + NEGLIGIBLE_MOTIONS[0] * self.size
        return abs(float(self.tau(np.array(x_ahead))))

    def position(self, entry: Entry) -> float:
        """Return the position of an entry on the curve."""
        return self.value_at("x", entry)

    def value_at(self, name: str, entry: Entry, order: int = 0) -> float:
        """Return a field of the curve at an entry, or its derivative, as in `Curve.evaluate`."""
        panel, s = np.array([entry.panel]), np.array([entry.s])
        return float(self.curve.evaluate(name, panel, s, order)[0])

    def resting_panel(self, entry: Entry) -> Panel | None:
        """Return a panel on which the front hardly moves until the wave from an entry arrives.

        It is None if no entry was skipped, or if the wave has arrived already.
        """
        # T - x does not change along the wave.
        t_minus_x = self.value_at("t_minus_x", entry)
        x_end = self.x0 + entry.skipped_motion
        time_end = t_minus_x + x_end
        has_arrived = time_end - self.t0 < NEGLIGIBLE_MOTIONS[0] * self.size
        if entry.skipped_motion == 0.0 or has_arrived:
            return None
        return Panel(
            x=self.x0 + 0.5 * (x_end - self.x0) * (1.0 + NODES),
            time=self.t0 + 0.5 * (time_end - self.t0) * (1.0 + NODES),
            source=np.full(NODE_COUNT, -0.5 * self.resistance * entry.skipped_motion),
            x_ends=(self.x0, x_end),
            time_ends=(self.t0, time_end),
        )

    def is_slow_to_right(self, panel: int) -> bool:
        """Return True if a panel belongs to a front that runs right, slower than the waves."""
        start_time, end_time = self.curve.edge_times[panel : panel + 2]
        # The source, tau dx/ds, is negative where the pre-stress is.
        return bool(end_time > start_time and np.sum(self.curve.source[panel]) < 0.0)

    def entry_behind_slow_front(self) -> Entry | None:
        """Return the next entry if the last one is at a slow part of the front; None if unknown.

        The wave that arrives at the front now, and one that arrives slightly later, are traced back
        to the curve. The later one enters on the panel of the next entries. The other one may enter
        on the panel before it.
        """
        xi_now = self.t0 - self.x0
        delay = SEARCH_DELAY * max(self.size, abs(xi_now))
        xi = np.array([xi_now, xi_now + delay])
        entries, _ = self.curve.crossings(y=np.full(2, self.x0), xi=xi, eta=xi + 2.0 * self.x0)
        if not entries.meets_curve[1]:
            return None
        panel_now, panel = entries.panel.tolist()
        s_now, s_later = entries.s.tolist()
        # Because of the delay, the entries between an entry near the right end of the panel and
        # this end would be lost. So it is moved to the end.
        columns = self.curve.columns("t_minus_x", entries.panel)
        _, xi_at_right_end = self.curve.end_values[1, columns].tolist()
        if abs(xi_at_right_end - xi_now) < 10.0 * delay:
            return Entry(panel, 1.0)
        s = s_now if panel_now == panel else s_later
        # A remainder of the panel that is as small as rounding errors cannot be resolved.
        if s + 1.0 < MIN_REMAINDER and panel > 0:
            return Entry(panel - 1, 1.0)
        return Entry(panel, s)

    def solve(self, chunk: Chunk) -> np.ndarray | None:
        """Return the positions of the front at the nodes of a chunk of entries, by Newton's method.

        It is None if the chunk is too long, so that the method fails or its result is not resolved.
        """
        equation = FreeBoundary(self, chunk)
        x, change = self.first_guess(chunk), np.inf
        for _ in range(MAX_NEWTON_STEPS):
            step = equation.newton_step(x)
            if step is None:
                return None
            x = x - step
            # Both numbers are fractions of the size of the rupture.
            previous_change = change
            change = float(np.max(np.abs(step))) / self.size
            last_coefficients = np.max(np.abs(NODES_TO_SERIES[-2:] @ x)) / self.size
            # Written with `not`, so that NaN counts as divergence.
            diverges = not change <= 1e3
            # Further steps are too small to make the last coefficients smaller.
            is_unresolved = last_coefficients > 2.0 * SERIES_TOLERANCE
            stays_unresolved = is_unresolved and change < 0.1 * last_coefficients
            if diverges or stays_unresolved:
                return None
            # Steps as small as rounding errors no longer become smaller.
            if change < 1e-13 or (change < 1e-11 and change >= 0.5 * previous_change):
                return x if last_coefficients <= SERIES_TOLERANCE else None
        return None

    def first_guess(self, chunk: Chunk) -> np.ndarray:
        """Return the positions of the front at the nodes of a chunk as if gamma were 0.

        Without leaf springs the integral of tau from the entry to the front is 0. So the front
        moves right by -(tau at the entry)/(tau at the front) times the motion of the entry to the
        left.
        """
        start = Entry(chunk.panel, chunk.start)
        prestress_at_entry = self.value_at("source", start) / self.value_at("x", start, order=1)
        prestress_at_front = float(self.tau(np.array(self.x0)))
        ratio = 1.0
        if prestress_at_front < -1e-6 and prestress_at_entry > 0.0:
            ratio = prestress_at_entry / -prestress_at_front
        entries = self.curve.evaluate("x", np.full(NODE_COUNT, chunk.panel), chunk.parameters())
        return self.x0 + min(max(ratio, 1e-3), 10.0) * (self.position(start) - entries)

    def panel_of_chunk(self, chunk: Chunk, x: np.ndarray, x_end: float) -> Panel:
        """Return the new panel of the curve for a chunk, with positions x at its nodes.

        The panel ends at x_end.
        """
        nodes_and_end = np.append(chunk.parameters(), chunk.stop)
        # T - x is the same at the front as at the entry.
        t_minus_x = self.curve.evaluate(
            "t_minus_x", np.full(NODE_COUNT + 1, chunk.panel), nodes_and_end
        )
        source = self.tau(x) * (NODES_TO_DERIVATIVES @ x)
        # Rounding and skipped entries leave a gap between x0 and the start of the computed
        # positions. If it is larger than rounding errors, its pre-stress is added to the panel.
        # Otherwise all later panels would have a gap too, and a larger one where tau is nearer
        # to 0.
        gap = float(NODES_TO_ENDS[0] @ x) - self.x0
        if abs(gap) > NEGLIGIBLE_MOTIONS[0] * self.size:
            source += 0.5 * gap * self.tau(np.array(self.x0))
        return Panel(
            x=x,
            time=t_minus_x[:-1] + x,
            source=source,
            x_ends=(self.x0, x_end),
            time_ends=(self.t0, float(t_minus_x[-1]) + x_end),
        )

    def straight_to_mark(self, mark: float) -> Advance:
        """Continue the front up to a near mark at the wave speed.

        This is used if no chunk is resolved, as it happens where tau rises to 0 at the mark. If the
        mark is not near, the result is "unresolved".
        """
        if mark - self.x0 > MARK_DISTANCE * self.size:
            return Advance(None, "unresolved")
        half = 0.5 * (mark - self.x0)
        x = self.x0 + half * (1.0 + NODES)
        x_ends, time_ends = (self.x0, mark), (self.t0, self.t0 + 2.0 * half)
        panel = Panel(
            x=x,
            time=self.t0 + x - self.x0,
            source=self.tau(x) * half,
            x_ends=x_ends,
            time_ends=time_ends,
        )
        return Advance(panel, "mark")
