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

The front grows by one panel at a time (`SlowFront.next_panel`). The entries of this panel form a
chunk, which is part of one panel of the known curve, from right to left. `FreeBoundary` is the
equation above at the nodes of the chunk. Newton's method solves it for the positions X. The chunk
is halved if the solution is not resolved. It is shortened where the front stops, or where it
reaches the end of the negative pre-stress, which is called the mark. The new panel belongs to the
known curve from then on.
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
    NODES_TO_END,
    NODES_TO_INTEGRALS,
    NODES_TO_SERIES,
    NODES_TO_START,
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
# A motion of the front is a rounding error if it is smaller than this fraction of the size of the
# rupture.
ROUNDING_MOTION = 1e-13
# Entries are skipped if they move the front by no more than a small fraction of the size of the
# rupture. The larger fractions are used only if the front would otherwise run back, because panels
# do not resolve such small motions.
NEGLIGIBLE_MOTIONS = (ROUNDING_MOTION, 1e-12, 1e-11, 1e-10)
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
# If the end of a chunk was moved more often than this, a larger distance is sufficient.
MAX_EXACT_MOVES = 5
# The larger distance.
EVENT_NEAR_END = 1e-6
# In a chunk whose end was moved to an event, events are searched up to this parameter, a little
# beyond its end at 1.
SEARCH_LIMIT = 1.2
# The most chunks that are tried for a panel.
MAX_CHUNKS = 60
# A front is not followed on a curve of more panels.
MAX_PANELS = 100_000
MAX_NEWTON_STEPS = 60


class Progress(NamedTuple):
    """State that a slow front keeps from one panel to the next.

    next_length is the longest chunk to try next. last_entry_x is the position where the wave that
    arrives at the front now entered the rupture; NaN before the first panel.
    """

    next_length: float = PANEL_LENGTH
    last_entry_x: float = np.nan


class Event(NamedTuple):
    """An event of a slow front: it reaches the mark ("mark"), or it stops for a while ("stop").

    s is the parameter of the event on the chunk. If there is no event, s is infinite, and the name
    is "none".
    """

    s: float
    name: str


class Entry(NamedTuple):
    """A point of the curve where a wave enters the rupture: its panel, and the parameter on it.

    skipped_motion is the distance that the front moves by the negligible entries that were skipped
    before this one, or 0 if none was skipped.
    """

    panel: int
    s: float
    skipped_motion: float = 0.0


# The result of a search for an entry if no further entry moves the front on.
NO_ENTRY = Entry(panel=-1, s=1.0)


class SkippedEntries(NamedTuple):
    """The entries that are skipped on a panel, because they hardly move the front.

    skips_any is False if there are none, and skips_all is True if they go on to the left end of the
    panel. last_s is the parameter of the last one. total_motion is the distance that the front
    moves by all entries that were skipped up to this one, on this and on other panels.
    next_moves_back is True if the entries after them move the front back, to the left.
    """

    skips_any: bool
    skips_all: bool
    last_s: float
    total_motion: float
    next_moves_back: bool


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

    @property
    def length(self) -> float:
        """Length of the chunk in the parameter of the panel, which falls from start to stop."""
        return self.start - self.stop

    def parameters(self, s: np.ndarray = NODES) -> np.ndarray:
        """Return the parameters on the panel that belong to parameters s of the chunk."""
        return self.start + 0.5 * (self.stop - self.start) * (1.0 + s)

    def half(self) -> "Chunk":
        """Return the first half of the chunk."""
        return self._replace(stop=0.5 * (self.start + self.stop))


def _first_event(x: np.ndarray, mark: float, end_was_moved: bool) -> Event:
    """Return the first event of a front on a chunk of entries: it stops, or it reaches the mark.

    x has the positions of the front at the nodes of the chunk, whose parameter s runs from -1 to 1.
    The front stops where dx/ds is 0. The mark is the position where the negative pre-stress ends;
    it may be infinite. If the end of the chunk was moved to an event before, this event may now lie
    a little beyond the end, at s > 1.
    """
    largest_s = SEARCH_LIMIT if end_was_moved else 1.0
    stops = _roots_on_chunk(NODES_TO_DERIVATIVES @ x, largest_s)
    arrivals = _roots_on_chunk(x - mark, largest_s) if np.isfinite(mark) else []
    events = [Event(s, "stop") for s in stops] + [Event(s, "mark") for s in arrivals]
    return min(events, key=lambda event: event.s, default=Event(np.inf, "none"))


def _ends_at_event(event: Event, move_count: int) -> bool:
    """Return True if a chunk of entries ends close enough to the event that was found on it.

    move_count is the number of times that the end of the chunk was moved to an event. If it is 0,
    the result is False, because the chunk can end at the event only by chance. If the end was moved
    often without success, a larger distance is accepted.
    """
    tolerance = EVENT_NEAR_END if move_count > MAX_EXACT_MOVES else EVENT_AT_END
    # The parameter s of the chunk is 1 at its end.
    distance_to_end = abs(event.s - 1.0)
    return move_count > 0 and distance_to_end < tolerance


def _runs_back(x: np.ndarray) -> bool:
    """Return True if a front runs back, to the left, at the start of a chunk of entries.

    x has the positions of the front at the nodes of the chunk, whose parameter s runs from -1 to 1.
    """
    dx_ds = NODES_TO_DERIVATIVES @ x
    # From the start, s = -1, to the first root of dx/ds (or the end, s = 1) dx/ds has one sign.
    # This sign is examined in the middle between them.
    first_root = min(_roots_on_chunk(dx_ds, 1.0), default=1.0)
    middle = 0.5 * (-1.0 + first_root)
    return bool(legendre.legval(middle, NODES_TO_SERIES @ dx_ds) < 0.0)


def _roots_on_chunk(values: np.ndarray, largest_s: float) -> list[float]:
    """Return the roots of a polynomial between the start of a chunk, s = -1, and the largest s.

    values are those of the polynomial at the nodes. A root at the very start is left out, because
    it is the event at which the chunk before ended.
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

    The equation consists of one integral for each node of the chunk, from an entry to the front.
    Arrays have one row for each of these integrals, and one column for each node of the curve. The
    first columns are those of the known curve, from the panel of the entries on, and the last ones
    those of the new panel.
    """

    def __init__(self, front: "SlowFront", chunk: Chunk) -> None:
        """Compute the quantities that do not depend on the unknown positions of the front.

        Each node of the chunk is an entry, and belongs to one integral over the curve, from this
        entry to the front. The weights and d_xi have one row for each integral, and one column for
        each node of the curve, from the panel of the entries on. d_xi is T - x at the entry minus
        T - x at the node.
        """
        curve, panel = front.curve, chunk.panel
        s = chunk.parameters()
        self.front = front
        # T - x at the entries. It has the same value at the front.
        self.t_minus_x = curve.evaluate("t_minus_x", np.full(NODE_COUNT, panel), s)
        # T + x at the nodes of the known curve.
        self.known_t_plus_x = curve.t_plus_x[panel:].ravel()
        # Weights of the integrals over the known curve, times tau. Each integral covers its panel
        # of entries only from the entry on, and all later panels completely.
        on_entry_panel = (WEIGHTS - partial_weights(s)) * curve.source[panel]
        on_later_panels = (curve.source[panel + 1 :] * WEIGHTS).ravel()
        self.known_weights = np.hstack([on_entry_panel, np.tile(on_later_panels, (NODE_COUNT, 1))])
        self.known_prestress_integral = self.known_weights.sum(axis=1)
        # The last columns belong to the nodes of the new panel.
        t_minus_x_of_nodes = np.append(curve.t_minus_x[panel:], self.t_minus_x)
        self.d_xi = self.t_minus_x[:, None] - t_minus_x_of_nodes

    def newton_step(self, x: np.ndarray) -> np.ndarray | None:
        """Return the step of Newton's method, which is to be subtracted from the positions x.

        x has the position of the front for each node of the chunk, which is an entry. The integrals
        of tau times the kernel, from each entry to the front, must become 0. The result is None if
        a front at x would be unstable: one of the integrals would grow if the front moved farther.
        """
        # The integrals of tau from the end of the known curve, x0, to the positions.
        prestress_integral, tau = self.crossed_by_front(x)
        # Without leaf springs and drag the kernel is 1, and each integral depends on its own
        # position only.
        if self.front.stiffness == self.front.alpha == 0.0:
            if not np.all(tau < 0.0):
                return None
            return (self.known_prestress_integral + prestress_integral) / tau
        # One row for each integral, and one column for each node: first those of the known curve,
        # then those of the new panel. The slope is the derivative by the position of the front.
        kernel, kernel_slope = self.kernel_and_slope(x)
        # The integrals over the known curve, from the entries to x0, and their derivatives.
        known_count = self.known_t_plus_x.size
        over_known = (self.known_weights * kernel[:, :known_count]).sum(axis=1)
        over_known_slope = (self.known_weights * kernel_slope[:, :known_count]).sum(axis=1)
        slope_of_integral = tau + over_known_slope
        if not np.all(slope_of_integral < 0.0):
            return None
        # The integrals over the new panel, from x0 to the positions, are those of tau and of tau
        # times (kernel - 1). The second ones are computed from the nodes of the new panel: this
        # matrix integrates a function times (kernel - 1), in each row up to the node of the row.
        integrate_kernel_minus_1 = NODES_TO_INTEGRALS * (kernel[:, known_count:] - 1.0)
        dx_ds = NODES_TO_DERIVATIVES @ x
        integrals = over_known + prestress_integral + integrate_kernel_minus_1 @ (tau * dx_ds)
        # The derivatives of all integrals (rows) by all positions (columns). A position changes
        # dx/ds and tau at its node. The kernel depends on T + x at the end of an integral minus
        # T + x at a node. So a position changes it at all nodes of its own integral, and with the
        # opposite sign at its own node of each integral.
        by_dx_ds = (integrate_kernel_minus_1 * tau) @ NODES_TO_DERIVATIVES
        by_tau = integrate_kernel_minus_1 * (NODES_TO_DERIVATIVES @ tau)
        by_kernel = NODES_TO_INTEGRALS * kernel_slope[:, known_count:] * (tau * dx_ds)
        derivatives = by_dx_ds + by_tau - by_kernel
        derivatives += np.diag(slope_of_integral + by_kernel.sum(axis=1))
        return np.linalg.solve(derivatives, integrals)

    def kernel_and_slope(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the kernel E J0(sqrt z) of the integrals, and its derivative by the position x.

        x has the positions of the front, at which the integrals end. Both results have one row for
        each integral, and one column for each node of the known curve and of the new panel. E is
        the decay factor exp(-alpha (d_xi + d_eta)/4) by drag, and z = k d_xi d_eta. d_xi and d_eta
        are T - x and T + x at the front, minus those at the node.
        """
        k, alpha = self.front.stiffness, self.front.alpha
        # T + x at the front, where T - x has its value at the entry.
        eta = self.t_minus_x + 2.0 * x
        d_eta = eta[:, None] - np.append(self.known_t_plus_x, eta)
        z = k * self.d_xi * d_eta
        # This function computes J0(sqrt z) (order 0), or its derivative by z (order 1).
        bessel = kernel_function(k, z, z_at_ends=z)
        exponential = decay(alpha, self.d_xi, d_eta) if alpha else 1.0
        kernel = exponential * bessel(0)
        # If x changes, d_eta changes by 2 dx. So z changes by 2 k d_xi dx, and E by -alpha/2 E dx.
        slope = 2.0 * k * exponential * bessel(1) * self.d_xi - 0.5 * alpha * kernel
        return kernel, slope

    def crossed_by_front(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the integrals of tau from the start x0 of the new panel to each x, and tau at x.

        x has the positions of the front.
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
        """Set the stiffness k of the kernel, the end of the curve, and the size of the rupture.

        Tolerances are fractions of this size. It is at least |x0|, because rounding errors of
        positions are proportional to |x0|.
        """
        self.stiffness = self.gamma - 0.25 * self.alpha**2
        edges = self.curve.edges
        self.x0, self.t0 = float(edges[-1]), float(self.curve.edge_times[-1])
        self.size = max(float(edges[-1] - edges[0]), abs(self.x0))

    def next_panel(self, mark: float, progress: Progress) -> Advance:
        """Continue the front by the next panel, whose entries lie on one panel of the curve.

        mark is the end of the negative pre-stress; it may be infinite. progress is the state that
        the panel before has left. The new panel ends at the latest where the front stops, for a
        while or for ever. The reason in the result is None if the front can go on, otherwise one of

            "mark"        the new panel ends at the mark;
            "stops"       the front could only run back;
            "unknown"     the wave that arrives next comes from beyond the left end of the curve;
            "unresolved"  the front is not resolved on any chunk of entries.
        """
        if len(self.curve.panels) > MAX_PANELS:
            return Advance(None, "unresolved")
        # Entries (points where waves entered the rupture that arrive at the front) are skipped if
        # they move the front only by a negligible distance. If the front seems to stop, the next
        # attempt skips more of them.
        for negligible in NEGLIGIBLE_MOTIONS:
            entry = self.next_entry(progress.last_entry_x, negligible)
            if entry is None:
                return Advance(None, "unknown")
            if entry is NO_ENTRY:
                return Advance(None, "stops")
            resting_panel = self.panel_until_arrival(entry)
            if resting_panel is not None:
                return Advance(resting_panel, None, Progress(last_entry_x=self.position(entry)))
            advance = self.advance_from(entry, mark, progress.next_length)
            if advance.end_reason != "stops":
                break
        return advance

    def advance_from(self, entry: Entry, mark: float, next_length: float) -> Advance:
        """Continue the front by one panel, by the waves from a chunk of entries.

        A chunk is a range of entries on one panel of the curve. The first entry is given. A chunk
        of the length next_length is tried first. It is halved until its solution can be used. If
        the front stops or reaches the mark on it, the end of the chunk is moved to this event.
        """
        last_s = max(entry.s - next_length, -1.0)
        # The chunk, and how often its end has been moved to an event.
        chunk, move_count = Chunk(entry.panel, entry.s, last_s), 0
        is_far_from_mark = mark - self.x0 >= MARK_DISTANCE * self.size
        for _ in range(MAX_CHUNKS):
            if chunk.length < MIN_CHUNK:
                # The front can go on only if it is very close to the mark.
                return self.straight_to_mark(mark)
            x = self.solve(chunk)
            runs_back = x is not None and _runs_back(x)
            if runs_back and is_far_from_mark:
                return Advance(None, "stops")
            # Close to a mark the front may run back only because of rounding.
            if x is None or runs_back:
                chunk, move_count = chunk.half(), 0
                continue
            event = _first_event(x, mark, end_was_moved=move_count > 0)
            if event.name != "none" and not _ends_at_event(event, move_count):
                # The event is inside of the chunk. Beyond an event the solution may be meaningless.
                # So the chunk is solved again with its end at the event.
                chunk = chunk._replace(stop=float(chunk.parameters(np.array(event.s))))
                move_count += 1
            elif np.any(np.diff(x, prepend=self.x0) <= 0.0):
                # Where the equation hardly depends on the position of the front, rounding may put
                # the front behind its start.
                chunk, move_count = chunk.half(), 0
            else:
                return self.advance_along(chunk, x, event, mark)
        return Advance(None, "unresolved")

    def advance_along(self, chunk: Chunk, x: np.ndarray, event: Event, mark: float) -> Advance:
        """Return the new panel for a solved chunk of entries, and the state for the next panel.

        x has the positions of the front at the nodes of the chunk. The chunk ends at the event: the
        front stops, or it reaches the mark. The name of the event is "none" if there is none.
        """
        reaches_mark = event.name == "mark"
        # The position of the front that belongs to the last entry of the chunk.
        x_end = mark if reaches_mark else float(NODES_TO_END @ x)
        # A front that stops at the end of the chunk may go on later, so this is no end reason.
        end_reason = "mark" if reaches_mark else None
        panel = self.panel_of_chunk(chunk, x, x_end)
        # A chunk goes from right to left. Without an event it goes up to the left end of its panel
        # of entries, s = -1, unless it was shortened because a longer one cannot be resolved. Then
        # the next chunk must not be much longer.
        was_shortened = event.name == "none" and chunk.stop != -1.0
        next_length = MAX_CHUNK_GROWTH * chunk.length if was_shortened else PANEL_LENGTH
        last_entry_x = self.position(Entry(chunk.panel, chunk.stop))
        return Advance(panel, end_reason, Progress(next_length, last_entry_x))

    def tau(self, x: np.ndarray) -> np.ndarray:
        """Return the pre-stress at positions ahead of the front."""
        return continued_prestress(self.prestress, self.background, x)

    def next_entry(self, last_entry_x: float, negligible: float) -> Entry | None:
        """Return the entry on the curve from which the front is continued.

        The search begins at the last entry, at the position last_entry_x, and goes along the curve
        from right to left. Entries are skipped as long as all of them together move the front by no
        more than the fraction ``negligible`` of the size of the rupture. The front is continued
        from the last skipped entry, or from the first entry if none is skipped, so that no entry is
        left out.

        NO_ENTRY is returned if the entries after the skipped ones move the front back, or if all
        further entries are skipped. None is returned if the next wave comes from beyond the left
        end of the curve, where nothing is known.
        """
        # The entry could also be found from its value of T - x. But where the pre-stress is nearly
        # 0, T - x is constant to rounding, and the search would fail.
        first = self.entry_left_of(last_entry_x)
        if first.panel < 0:
            # The last entry was the left end of the curve.
            return None
        skipped_motion, s = 0.0, first.s
        for panel in range(first.panel, -1, -1):
            # No wave enters the rupture on a panel of a slow front, because waves overtake it. The
            # next wave comes from farther left, and is traced back to the curve.
            if self.is_slow_to_right(panel):
                return self.entry_behind_slow_front()
            skipped = self.entries_to_skip(Entry(panel, s), skipped_motion, negligible)
            skipped_motion = skipped.total_motion
            if skipped.skips_all:
                # The next panel is examined from its right end.
                s = 1.0
                continue
            # If the search has gone on to a panel farther left, the first entry has been skipped.
            is_first_skipped = skipped.skips_any or panel < first.panel
            if not is_first_skipped:
                return first
            if skipped.next_moves_back:
                return NO_ENTRY
            # The motion must be positive, since a motion of 0 means that nothing was skipped.
            min_motion = 0.1 * ROUNDING_MOTION * self.size
            positive_motion = max(skipped_motion, min_motion)
            return Entry(panel, skipped.last_s, skipped_motion=positive_motion)
        return NO_ENTRY

    def entry_left_of(self, last_entry_x: float) -> Entry:
        """Return the point of the curve that follows the last entry on its left.

        last_entry_x is the position of the last entry. If it is NaN, there was no entry yet, and
        the result is the right end of the curve.
        """
        if not np.isfinite(last_entry_x):
            return Entry(len(self.curve.panels) - 1, s=1.0)
        (panel,), (s,) = self.curve.locate(np.array([last_entry_x]))
        # If nearly nothing of the panel is left, from s down to its left end at -1, the next panel
        # is used. Such a small remainder cannot be resolved.
        if s + 1.0 < MIN_REMAINDER:
            return Entry(int(panel) - 1, s=1.0)
        return Entry(int(panel), float(s))

    def entries_to_skip(
        self, entry: Entry, skipped_motion: float, negligible: float
    ) -> SkippedEntries:
        """Return which entries are skipped on a panel, from a given one to the left.

        The wave of each entry moves the front when it arrives there. Entries are skipped as long as
        all of them together move the front by no more than the fraction ``negligible`` of the size
        of the rupture, because panels do not resolve such small motions. skipped_motion is the
        motion by entries that were skipped on other panels.
        """
        # The entries are sampled from the given one (sample 0) to the left end of its panel, at
        # s = -1. motions has the distance that the front moves by all entries up to each sample.
        # Where motions falls, entries move the front back.
        s = entry.s - (entry.s + 1.0) * ENTRY_FRACTIONS
        motions = skipped_motion + self.motion_by_entries(entry.panel, s)
        # Only entries in negative pre-stress can move the front back. On a panel with such entries
        # a motion is negligible only if it is a rounding error.
        is_negative = bool(np.min(self.curve.source[entry.panel]) < 0.0)
        largest_motion = self.size * (ROUNDING_MOTION if is_negative else negligible)
        is_negligible = np.abs(motions) <= largest_motion
        skips_all = bool(is_negligible.all())
        # The number of the last sample that is skipped.
        last = s.size - 1
        if not skips_all:
            # The sample before the first one whose motion is too large, but at least sample 0.
            last = max(0, int(np.argmin(is_negligible)) - 1)
        next_moves_back = is_negative and not skips_all and motions[last + 1] < motions[last]
        return SkippedEntries(
            skips_any=last > 0,
            skips_all=skips_all,
            last_s=float(s[last]),
            total_motion=float(motions[last]),
            next_moves_back=bool(next_moves_back),
        )

    def motion_by_entries(self, panel: int, parameters: np.ndarray) -> np.ndarray:
        """Return how far the front moves by the waves that entered on a part of a panel.

        The part goes from the first of the parameters to each of them. The integral of the
        pre-stress over this part is the motion times the size of tau ahead of the front.
        """
        weights = partial_weights(parameters)
        return (weights[0] - weights) @ self.curve.source[panel] / self.abs_tau_ahead

    @property
    def abs_tau_ahead(self) -> float:
        """Absolute value of the (negative) pre-stress immediately ahead of the front."""
        x_ahead = self.x0 + ROUNDING_MOTION * self.size
        return abs(float(self.tau(np.array(x_ahead))))

    def position(self, entry: Entry) -> float:
        """Return the position of an entry on the curve."""
        return self.value_at("x", entry)

    def value_at(self, name: str, entry: Entry, order: int = 0) -> float:
        """Return a field of the curve at an entry, or its derivative, as in `Curve.evaluate`."""
        panel, s = np.array([entry.panel]), np.array([entry.s])
        return float(self.curve.evaluate(name, panel, s, order)[0])

    def panel_until_arrival(self, entry: Entry) -> Panel | None:
        """Return a panel that leads the front from now to the arrival of the wave from an entry.

        On it the front is moved only by waves from entries that were skipped before this one. All
        of them together move it by the negligible distance ``entry.skipped_motion``. The result is
        None if no entry was skipped, or if the wave has arrived already.
        """
        # The front is now at (x0, t0). T - x does not change along the wave.
        t_minus_x = self.value_at("t_minus_x", entry)
        x_end = self.x0 + entry.skipped_motion
        time_end = t_minus_x + x_end
        has_arrived = time_end - self.t0 < ROUNDING_MOTION * self.size
        if entry.skipped_motion == 0.0 or has_arrived:
            return None
        # x and T grow linearly with the parameter of the panel, which runs from -1 to 1. The source
        # is tau dx/ds, where tau is negative and dx/ds is half of the motion.
        return Panel(
            x=self.x0 + 0.5 * (x_end - self.x0) * (1.0 + NODES),
            time=self.t0 + 0.5 * (time_end - self.t0) * (1.0 + NODES),
            source=np.full(NODE_COUNT, -0.5 * self.abs_tau_ahead * entry.skipped_motion),
            x_ends=(self.x0, x_end),
            time_ends=(self.t0, time_end),
        )

    def is_slow_to_right(self, panel: int) -> bool:
        """Return True if a panel belongs to a front that runs right, slower than the waves.

        Such a front arrives later at the right end than at the left one, and the pre-stress is
        negative.
        """
        left_time, right_time = self.curve.edge_times[panel : panel + 2]
        # The source, tau dx/ds, is negative where the pre-stress is.
        return bool(right_time > left_time and np.sum(self.curve.source[panel]) < 0.0)

    def entry_behind_slow_front(self) -> Entry | None:
        """Return the point where the next wave that arrives at the front has entered the rupture.

        This function is used if the panel to the left of the last entry belongs to a slow front, on
        which no wave enters. Two waves are traced back from the front to the curve: the one that
        arrives now, and one that arrives slightly later. The next entries are on the panel where
        the later wave has entered. The result is None if this wave comes from beyond the end of the
        curve.
        """
        t_minus_x = self.t0 - self.x0
        delay = SEARCH_DELAY * max(self.size, abs(t_minus_x))
        xi = np.array([t_minus_x, t_minus_x + delay])
        entries, _ = self.curve.crossings(y=np.full(2, self.x0), xi=xi, eta=xi + 2.0 * self.x0)
        if not entries.meets_curve[1]:
            return None
        panel_now, panel = entries.panel.tolist()
        s_now, s_later = entries.s.tolist()
        # If the wave that arrives now entered close to the right end of this panel, the next entry
        # is this end, because the entry of the later wave would leave out those in between.
        right_end = self.curve.panels[panel].end
        if abs(right_end.time - right_end.x - t_minus_x) < 10.0 * delay:
            return Entry(panel, s=1.0)
        # The wave that arrives now is preferred if it has entered on this panel.
        s = s_now if panel_now == panel else s_later
        # If nearly nothing of the panel is left, from s down to its left end at -1, the next panel
        # is used. Such a small remainder cannot be resolved.
        if s + 1.0 < MIN_REMAINDER and panel > 0:
            return Entry(panel - 1, s=1.0)
        return Entry(panel, s)

    def solve(self, chunk: Chunk) -> np.ndarray | None:
        """Return the positions of the front at the nodes of a chunk of entries, by Newton's method.

        The result is None if the chunk is too long, so that the method fails, or so that the
        Legendre series of the positions does not fall below SERIES_TOLERANCE.
        """
        equation = FreeBoundary(self, chunk)
        # The positions, and the largest change of them in the last step.
        x, change = self.first_guess(chunk), np.inf
        for _ in range(MAX_NEWTON_STEPS):
            step = equation.newton_step(x)
            if step is None:
                return None
            x = x - step
            # The change, and the last two coefficients of the Legendre series of the positions, are
            # measured as fractions of the size of the rupture.
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

        Without leaf springs (gamma = 0) the integral of tau from the entry to the front is 0. So
        if the entry moves left by a distance, the front moves right by the same distance times
        -(tau at the entry)/(tau at the front). This ratio is kept between 0.001 and 10. If it is
        not positive, or tau at the front is almost 0, it is replaced by 1.
        """
        first_entry = Entry(chunk.panel, chunk.start)
        # The source is tau dx/ds.
        dx_ds = self.value_at("x", first_entry, order=1)
        tau_at_entry = self.value_at("source", first_entry) / dx_ds
        tau_at_front = float(self.tau(np.array(self.x0)))
        ratio = 1.0
        if tau_at_front < -1e-6 and tau_at_entry > 0.0:
            ratio = min(max(tau_at_entry / -tau_at_front, 1e-3), 10.0)
        entries_x = self.curve.evaluate("x", np.full(NODE_COUNT, chunk.panel), chunk.parameters())
        return self.x0 + ratio * (self.position(first_entry) - entries_x)

    def panel_of_chunk(self, chunk: Chunk, x: np.ndarray, x_end: float) -> Panel:
        """Return the new panel of the curve for a solved chunk of entries.

        x has the positions of the front at the nodes of the chunk, and x_end is the position at its
        end. The times follow from T - x, which is the same at the front as at the entry.
        """
        nodes_and_end = np.append(chunk.parameters(), chunk.stop)
        panel_of_entries = np.full(nodes_and_end.size, chunk.panel)
        t_minus_x = self.curve.evaluate("t_minus_x", panel_of_entries, nodes_and_end)
        # The source of a panel is tau dx/ds.
        source = self.tau(x) * (NODES_TO_DERIVATIVES @ x)
        # Rounding and skipped entries leave a gap between the end of the known curve, x0, and the
        # start of the computed positions. If it is larger than rounding errors, the integral of tau
        # over the gap is added to the panel, evenly over its parameter range of length 2. Otherwise
        # all later panels would have a gap too, and a larger one where tau is nearer to 0.
        gap = float(NODES_TO_START @ x) - self.x0
        if abs(gap) > ROUNDING_MOTION * self.size:
            source += 0.5 * gap * self.tau(np.array(self.x0))
        return Panel(
            x=x,
            time=t_minus_x[:-1] + x,
            source=source,
            x_ends=(self.x0, x_end),
            time_ends=(self.t0, float(t_minus_x[-1]) + x_end),
        )

    def straight_to_mark(self, mark: float) -> Advance:
        """Continue the front at the wave speed, which is 1, to the mark if it is near.

        The mark is the end of the negative pre-stress. The front cannot be resolved just before a
        mark where tau rises to 0. If the mark is not near, no panel is returned, and the reason
        "unresolved".
        """
        if mark - self.x0 > MARK_DISTANCE * self.size:
            return Advance(None, "unresolved")
        half = 0.5 * (mark - self.x0)
        x = self.x0 + half * (1.0 + NODES)
        panel = Panel(
            x=x,
            time=self.t0 + x - self.x0,
            source=self.tau(x) * half,
            x_ends=(self.x0, mark),
            time_ends=(self.t0, self.t0 + 2.0 * half),
        )
        return Advance(panel, "mark")
