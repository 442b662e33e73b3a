"""The free boundary: a front into negative pre-stress, which is slower than the waves.

A fast front is driven by the pre-stress ahead of it. A front into negative pre-stress is driven by
the waves that come from behind, and its path is unknown: it is a free boundary. Slip, slip velocity
and strain vanish on it, because no fracture energy is needed to release a block.

Consider the characteristic that ends on the slow front at (X, t). It entered the rupture at the
point e of the known part of the curve, its entry:

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

where E and k = gamma - alpha^2/4 are those of `riemann`. X is computed as a function of the entry e
instead of the time, since it remains smooth where the front stops (dX/de = 0 there).

The front grows by one panel at a time (`SlowFront.next_panel`). The entries of a panel form a
chunk, which is part of one panel of the known curve, taken from right to left. `FreeBoundary` is
the equation above at the nodes of the chunk, solved by Newton's method for the positions X. The
chunk is halved if the solution is not resolved, and shortened where the front stops or reaches the
end of the negative pre-stress (a mark). The new panel belongs to the known curve from then on.
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
# A shorter remainder of a panel of entries is left to the next panel.
MIN_REMAINDER = 1e-8
# Entries that move the front by less than a small fraction of the size of the rupture are skipped.
# The first fraction is that of rounding. The larger ones are used only if the front would otherwise
# run back, since the panels do not resolve such motions.
NEGLIGIBLE_MOTIONS = (1e-13, 1e-12, 1e-11, 1e-10)
# Skipped entries end at one of these parameters of their panel, given as fractions of the remaining
# way to its left end.
ENTRY_FRACTIONS = np.linspace(0.0, 1.0, 65)
# A front that speeds up towards the waves cannot be resolved up to the mark. At this distance from
# it, as a fraction of the size of the rupture, it is continued at the wave speed.
MARK_DISTANCE = 1e-5
# Length of a panel in its parameter.
PANEL_LENGTH = 2.0
# The next entry is searched at this relative distance beyond the end of a panel of entries.
SEARCH_OFFSET = 1e-11
# An event this close to the first entry of a chunk, in its parameter, is the one that ended the
# previous chunk.
EVENT_AT_START = 1e-6
# A chunk ends at an event if the event is this close to its last entry.
EVENT_AT_END = 1e-9
# After more corrections of the end than this number, a larger distance is sufficient.
MAX_EXACT_CORRECTIONS = 5
# The larger distance.
EVENT_NEAR_END = 1e-6
# In a chunk that was shortened to end at an event, events are searched up to this parameter, a
# little beyond its end.
SEARCH_LIMIT = 1.2
# The most chunks that are tried for a panel.
MAX_CHUNKS = 60
# A front is not followed on a curve of more panels.
MAX_PANELS = 100_000
MAX_NEWTON_STEPS = 60


class Progress(NamedTuple):
    """State that a slow front keeps from one panel to the next.

    next_length is the longest chunk to try next. last_entry is the position where the
    characteristic that arrives at the front now entered the curve; NaN before the first panel.
    """

    next_length: float = PANEL_LENGTH
    last_entry: float = np.nan


class Event(NamedTuple):
    """An event of a slow front: it reaches the mark (name "mark") or stops (name None).

    s is the parameter of the event on the chunk, infinite if there is no event.
    """

    s: float
    name: str | None


class Entry(NamedTuple):
    """The next entry: its panel of the curve, and the parameter on it.

    The panel is negative if there is no further entry on the curve. skipped_motion is the motion of
    the front by the negligible entries that were skipped before this one.
    """

    panel: int
    s: float
    skipped_motion: float = 0.0


class Advance(NamedTuple):
    """The next panel, the reason why the front ends (or None), and the state for the next one."""

    panel: Panel | None
    stop: str | None
    progress: Progress = Progress()


class Chunk(NamedTuple):
    """A range of entries on one panel of the curve, by their parameters, from right to left."""

    panel: int
    start: float
    stop: float

    def parameters(self, s: np.ndarray = NODES) -> np.ndarray:
        """Return the parameters on the panel that belong to parameters s on the chunk."""
        return self.start + 0.5 * (self.stop - self.start) * (1.0 + s)

    def half(self) -> "Chunk":
        """Return the first half of the chunk."""
        return self._replace(stop=0.5 * (self.start + self.stop))


def _first_event(x: np.ndarray, mark: float, corrections: int) -> Event:
    """Return the first event of a front with positions x at the nodes of a chunk.

    The front stops where the derivative of its position with respect to the parameter is 0.
    corrections is the number of times that the end of the chunk was moved to an event. If it was
    moved, the event may lie a little beyond the end.
    """
    limit = SEARCH_LIMIT if corrections else 1.0
    stops = _roots_on_chunk(NODES_TO_DERIVATIVES @ x, limit)
    arrivals = _roots_on_chunk(x - mark, limit) if np.isfinite(mark) else []
    events = [Event(s, None) for s in stops] + [Event(s, "mark") for s in arrivals]
    return min(events, key=lambda event: event.s, default=Event(np.inf, None))


def _must_be_corrected(event: Event, corrections: int) -> bool:
    """Return True if there is an event, but the chunk does not end there yet.

    corrections is the number of times that the end was moved. The first solution is never kept.
    """
    if event.s == np.inf:
        return False
    distance = EVENT_AT_END if corrections <= MAX_EXACT_CORRECTIONS else EVENT_NEAR_END
    return corrections == 0 or abs(event.s - 1.0) >= distance


def _goes_back(x: np.ndarray) -> bool:
    """Return True if a front with positions x at the nodes runs back at the start of the chunk."""
    slope = NODES_TO_DERIVATIVES @ x
    # The sign of the slope is examined halfway between the start and the first stop of the front.
    first_stop = min(_roots_on_chunk(slope, 1.0), default=1.0)
    halfway = 0.5 * (first_stop - 1.0)
    return bool(legendre.legval(halfway, NODES_TO_SERIES @ slope) < 0.0)


def _roots_on_chunk(values: np.ndarray, limit: float) -> list[float]:
    """Return the roots of a polynomial between the start of a chunk and a limit.

    values are those of the polynomial at the nodes. A root at the very start is left out.
    """
    series = NODES_TO_SERIES @ values
    scale = np.max(np.abs(series))
    if scale == 0.0:
        return []
    roots = legendre.legroots(legendre.legtrim(series, 1e-13 * scale))
    is_real = np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots.real))
    real = roots.real[is_real]
    return real[(real > -1.0 + EVENT_AT_START) & (real <= limit)].tolist()


class FreeBoundary:
    """The equation of the free boundary on one chunk, for the positions of the front.

    There is one row for each node of the chunk. A row begins with the nodes of the known curve that
    the characteristics have crossed, whose weights include tau, and continues with the nodes of the
    chunk itself.
    """

    def __init__(self, front: "SlowFront", chunk: Chunk) -> None:
        curve, panel = front.curve, chunk.panel
        s = chunk.parameters()
        self.front = front
        # T - x at the entry of each row, which is also its value xi at the front.
        self.t_minus_x = curve.evaluate("t_minus_x", np.full(NODE_COUNT, panel), s)
        # T + x at the nodes of the known curve from the panel of the entries on.
        self.t_plus_x = curve.t_plus_x[panel:].ravel()
        # The integral over the known curve begins at the entry of the row, within the panel of the
        # entries, and covers all later panels.
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

        None if the front would be unstable: in some row, the integral of the equation would grow if
        the front moved further.
        """
        if self.has_unit_kernel:
            return self.newton_step_with_unit_kernel(x)
        kernel, kernel_slope = self.kernel_and_slope(x)
        # The integral over the known curve, from the entry of each row to x0.
        crossed = self.t_plus_x.size
        known = (self.weight * kernel[:, :crossed]).sum(axis=1)
        known_slope = (self.weight * kernel_slope[:, :crossed]).sum(axis=1)
        # The integral over the chunk, from x0 to each position X, is the sum of two: with a kernel
        # of 1, which is exact, and with the kernel minus 1, for which
        # Int tau (K - 1) dX = Int tau (K - 1) dX/ds ds is computed from the nodes.
        prestress_integral, tau = self.crossed_by_front(x)
        slope_of_integral = tau + known_slope
        if not np.all(slope_of_integral < 0.0):
            return None
        dx_ds = NODES_TO_DERIVATIVES @ x
        # Each row integrates a function times the kernel minus 1 over the chunk up to its node.
        kernel_minus_1 = NODES_TO_INTEGRALS * (kernel[:, crossed:] - 1.0)
        residual = known + prestress_integral + kernel_minus_1 @ (tau * dx_ds)
        # The matrix is the derivative of the residual of each row with respect to the positions at
        # all nodes. A position changes tau and dX/ds at its node, the kernel of its own row, and
        # the kernel between its node and the other rows, by the opposite amount.
        by_dx_ds = (kernel_minus_1 * tau) @ NODES_TO_DERIVATIVES
        by_tau = kernel_minus_1 * (NODES_TO_DERIVATIVES @ tau)
        by_kernel = NODES_TO_INTEGRALS * kernel_slope[:, crossed:] * (tau * dx_ds)
        matrix = by_dx_ds + by_tau - by_kernel
        matrix += np.diag(slope_of_integral + by_kernel.sum(axis=1))
        return np.linalg.solve(matrix, residual)

    def kernel_and_slope(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the kernel E J0, [row, node], and its derivative with respect to X of the row."""
        k, alpha = self.front.stiffness, self.front.alpha
        # t + x at the front, where t - x has its value at the entry and x is the position X.
        eta = self.t_minus_x + 2.0 * x
        d_eta = eta[:, None] - np.append(self.t_plus_x, eta)
        z = k * self.d_xi * d_eta
        bessel = kernel_function(k, z, z)
        exponential = decay(alpha, self.d_xi, d_eta) if alpha else 1.0
        kernel = exponential * bessel(0)
        # The derivative of eta with respect to X is 2.
        slope = 2.0 * k * exponential * bessel(1) * self.d_xi - 0.5 * alpha * kernel
        return kernel, slope

    def newton_step_with_unit_kernel(self, x: np.ndarray) -> np.ndarray | None:
        """Return the step of Newton's method if the kernel is 1; None as in `newton_step`."""
        prestress_integral, tau = self.crossed_by_front(x)
        if not np.all(tau < 0.0):
            return None
        return (self.known_integral + prestress_integral) / tau

    def crossed_by_front(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the integral of tau from the start of the chunk to positions x, and tau at x."""
        half = 0.5 * (x - self.front.x0)
        # Quadrature nodes between the start and each position, and the position itself.
        nodes_and_end = np.append(1.0 + NODES, 2.0)
        tau = self.front.tau(self.front.x0 + half[:, None] * nodes_and_end)
        return half * (tau[:, :-1] @ WEIGHTS), tau[:, -1]


@dataclass
class SlowFront:
    """The right end of a curve and its continuation into negative pre-stress.

    background is the linear piece of the pre-stress in which the front is. The front is at the
    point (x0, t0), the right end of the curve; size is the size of the rupture.
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
        """Continue the front by the next panel, which covers at most one panel of entries.

        mark is the end of the negative pre-stress (may be infinite). The panel ends where the front
        stops. The reason in the result is None if the front can go on, and otherwise one of

            "mark"        the new panel ends at the mark;
            "stops"       the front could only run back;
            "unknown"     the characteristic comes from beyond the left end of the curve;
            "unresolved"  no chunk is short enough.
        """
        if len(self.curve.panels) > MAX_PANELS:
            return Advance(None, "unresolved")
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
            if advance.stop != "stops":
                break
        return advance

    def advance_from(self, entry: Entry, mark: float, next_length: float) -> Advance:
        """Continue the front by one panel, whose first entry is given.

        The longest chunk that next_length allows is tried first. It is halved as long as its
        solution is not usable, and shortened to end at an event, if there is one.
        """
        last = max(entry.s - next_length, -1.0)
        chunk, corrections = Chunk(entry.panel, entry.s, last), 0
        for _ in range(MAX_CHUNKS):
            if chunk.start - chunk.stop < MIN_CHUNK:
                return self.straight(mark)
            x = self.solve(chunk)
            if x is not None and _goes_back(x):
                if mark - self.x0 >= MARK_DISTANCE * self.size:
                    return Advance(None, "stops")
                # This close to a mark the front may run back only because of rounding.
                x = None
            if x is None:
                chunk, corrections = chunk.half(), 0
                continue
            event = _first_event(x, mark, corrections)
            if _must_be_corrected(event, corrections):
                # Beyond an event the solution may be meaningless: the chunk is solved again so that
                # it ends at the event.
                chunk = chunk._replace(stop=float(chunk.parameters(np.array(event.s))))
                corrections += 1
            elif np.any(np.diff(x, prepend=self.x0) <= 0.0):
                # Where the equation hardly depends on the position of the front, rounding may put
                # the front behind its start.
                chunk, corrections = chunk.half(), 0
            else:
                x_end = mark if event.name == "mark" else float(NODES_TO_ENDS[1] @ x)
                progress = self.progress_after(chunk, ends_at_event=event.s < np.inf)
                return Advance(self.panel(chunk, x, x_end), event.name, progress)
        return Advance(None, "unresolved")

    def progress_after(self, chunk: Chunk, ends_at_event: bool) -> Progress:
        """Return the state after a chunk; a chunk that was shortened limits the next one."""
        length = PANEL_LENGTH
        if not ends_at_event and chunk.stop != -1.0:
            length = MAX_CHUNK_GROWTH * (chunk.start - chunk.stop)
        return Progress(length, self.position(Entry(chunk.panel, chunk.stop)))

    def tau(self, x: np.ndarray) -> np.ndarray:
        """Return the pre-stress ahead of the front."""
        return continued_prestress(self.prestress, self.background, x)

    def next_entry(self, last_entry: float, negligible: float) -> Entry | None:
        """Return the next entry after the position of the last one; None if it is not known.

        It follows the last one along the curve, from right to left. A search for its value of T - x
        would fail where the pre-stress is nearly 0, since T - x is constant to rounding there.
        Entries are skipped as long as all of them together move the front by no more than the
        fraction ``negligible`` of the size of the rupture.
        """
        entry = self.entry_next_to(last_entry)
        skipped_motion, has_skipped = 0.0, False
        # The panels are examined one after another. The search ends at a panel of the slow front
        # itself; an entry behind it is found in another way.
        while entry.panel >= 0 and not self.is_slow_to_right(entry.panel):
            # Samples from the entry to the left end of its panel.
            s = entry.s - (entry.s + 1.0) * ENTRY_FRACTIONS
            motions = skipped_motion + self.motion_by_entries(entry.panel, s)
            # Only entries with negative pre-stress can move the front back.
            is_negative = bool(np.min(self.curve.source[entry.panel]) < 0.0)
            largest_skipped = self.size * (NEGLIGIBLE_MOTIONS[0] if is_negative else negligible)
            # The last sample up to which all samples are skipped.
            is_skipped = np.append(np.abs(motions) <= largest_skipped, False)
            last_skipped = int(np.argmin(is_skipped)) - 1
            skipped_motion = float(motions[last_skipped])
            has_skipped = has_skipped or last_skipped > 0
            if last_skipped < ENTRY_FRACTIONS.size - 1:
                goes_on = not is_negative or motions[last_skipped + 1] >= skipped_motion
                return self.entry_after_skipped(
                    Entry(int(entry.panel), float(s[last_skipped])),
                    skipped_motion=skipped_motion,
                    has_skipped=has_skipped,
                    goes_on=goes_on,
                )
            entry = Entry(entry.panel - 1, 1.0)
        if entry.panel >= 0:
            return self.entry_behind_slow_front()
        return Entry(-1, 1.0) if has_skipped else None

    def entry_next_to(self, last_entry: float) -> Entry:
        """Return the point of the curve to the left of the position of the last entry.

        It is the right end of the curve if there was no entry yet (NaN).
        """
        if not np.isfinite(last_entry):
            return Entry(len(self.curve.panels) - 1, 1.0)
        (panel,), (s,) = self.curve.locate(np.array([last_entry]))
        # A remainder as small as rounding errors cannot be resolved and is left to the next panel.
        return Entry(panel, s) if s + 1.0 >= MIN_REMAINDER else Entry(panel - 1, 1.0)

    def motion_by_entries(self, panel: int, parameters: np.ndarray) -> np.ndarray:
        """Return how far the front moves by the entries from the first parameter to each one.

        The integral of the pre-stress over these entries equals the motion times the resistance.
        """
        weights = partial_weights(parameters)
        return (weights[0] - weights) @ self.curve.source[panel] / self.resistance

    def entry_after_skipped(
        self, entry: Entry, skipped_motion: float, has_skipped: bool, goes_on: bool
    ) -> Entry:
        """Return an entry with the motion of the front by the entries skipped before it.

        Its panel is negative if the front does not go on.
        """
        if not has_skipped:
            return entry
        if not goes_on:
            return Entry(-1, 1.0)
        return entry._replace(skipped_motion=max(skipped_motion, self.min_motion))

    @property
    def min_motion(self) -> float:
        """The smallest motion of the front that is taken into account, a tenth of rounding."""
        return 0.1 * NEGLIGIBLE_MOTIONS[0] * self.size

    @property
    def resistance(self) -> float:
        """Magnitude of the negative pre-stress immediately ahead of the front."""
        return abs(float(self.tau(np.array(self.x0 + NEGLIGIBLE_MOTIONS[0] * self.size))))

    def position(self, entry: Entry) -> float:
        """Return the position of an entry on the curve."""
        return self.value_at("x", entry)

    def value_at(self, name: str, entry: Entry, order: int = 0) -> float:
        """Return a field of the curve (see `Curve.evaluate`), or its derivative, at an entry."""
        panel, s = np.array([entry.panel]), np.array([entry.s])
        return float(self.curve.evaluate(name, panel, s, order)[0])

    def resting_panel(self, entry: Entry) -> Panel | None:
        """Return a panel on which the front hardly moves until the entry's characteristic arrives.

        It is None if no entry was skipped, or if the characteristic has arrived already.
        """
        xi = self.value_at("t_minus_x", entry)
        x_end = self.x0 + entry.skipped_motion
        time_end = xi + x_end
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
        start, end = self.curve.edge_times[panel : panel + 2]
        return bool(end > start and np.sum(self.curve.source[panel]) < 0.0)

    def entry_behind_slow_front(self) -> Entry | None:
        """Return where T - x next rises to its value at the front, or None if it is not known.

        The characteristic that arrives at the front now, and one that arrives slightly later, are
        followed back to the curve. The later one enters on the panel of the next entries, which may
        be another panel.
        """
        xi = self.t0 - self.x0
        small_delay = SEARCH_OFFSET * max(self.size, abs(xi))
        now_and_later = np.array([xi, xi + small_delay])
        entries, _ = self.curve.crossings(
            y=np.full(2, self.x0), xi=now_and_later, eta=now_and_later + 2.0 * self.x0
        )
        panel_now, panel = entries.panel.tolist()
        s_now, s_later = entries.s.tolist()
        if not entries.meets_curve[1]:
            return None
        # The delay would leave a gap of entries, so that an entry near the right end of a panel is
        # moved to this end.
        columns = self.curve.columns("t_minus_x", entries.panel)
        _, xi_at_right_end = self.curve.end_values[1, columns].tolist()
        if abs(xi_at_right_end - xi) < 10.0 * small_delay:
            return Entry(panel, 1.0)
        s = s_now if panel_now == panel else s_later
        # A remainder as small as rounding errors is left to the next panel.
        if s + 1.0 < MIN_REMAINDER and panel > 0:
            return Entry(panel - 1, 1.0)
        return Entry(panel, s)

    def solve(self, chunk: Chunk) -> np.ndarray | None:
        """Return the positions of the front at the nodes of a chunk, by Newton's method.

        It is None if the chunk is too long, so that the method fails or its result is not resolved.
        """
        equation = FreeBoundary(self, chunk)
        x, change = self.guess(chunk), np.inf
        for _ in range(MAX_NEWTON_STEPS):
            step = equation.newton_step(x)
            if step is None:
                return None
            x = x - step
            previous_change = change
            change = float(np.max(np.abs(step))) / self.size
            # The last two coefficients of the Legendre series of x.
            tail = np.max(np.abs(NODES_TO_SERIES[-2:] @ x)) / self.size
            diverges = not change <= 1e3
            # Further steps are smaller, so that they will not resolve the series either.
            stays_unresolved = tail > 2.0 * SERIES_TOLERANCE and change < 0.1 * tail
            if diverges or stays_unresolved:
                return None
            # Steps as small as rounding errors no longer become smaller.
            if change < 1e-13 or (change < 1e-11 and change >= 0.5 * previous_change):
                return x if tail <= SERIES_TOLERANCE else None
        return None

    def guess(self, chunk: Chunk) -> np.ndarray:
        """Return the positions of the front at the nodes as if there were no leaf springs.

        Then the integral of tau from the entry to the front is 0, so that the front moves by
        -tau(e)/tau(X) times the motion of the entry to the left.
        """
        start = Entry(chunk.panel, chunk.start)
        prestress_at_entry = self.value_at("source", start) / self.value_at("x", start, order=1)
        prestress_at_front = float(self.tau(np.array(self.x0)))
        ratio = 1.0
        if prestress_at_front < -1e-6 and prestress_at_entry > 0.0:
            ratio = prestress_at_entry / -prestress_at_front
        entries = self.curve.evaluate("x", np.full(NODE_COUNT, chunk.panel), chunk.parameters())
        return self.x0 + min(max(ratio, 1e-3), 10.0) * (self.position(start) - entries)

    def panel(self, chunk: Chunk, x: np.ndarray, x_end: float) -> Panel:
        """Return the new panel of the curve, with positions x at its nodes, which ends at x_end."""
        nodes_and_end = np.append(chunk.parameters(), chunk.stop)
        # T - x is the same at the front as at the entry.
        t_minus_x = self.curve.evaluate(
            "t_minus_x", np.full(NODE_COUNT + 1, chunk.panel), nodes_and_end
        )
        source = self.tau(x) * (NODES_TO_DERIVATIVES @ x)
        # Rounding and skipped entries make the computed positions begin a little off x0. If this
        # gap is larger than rounding, the panel includes its pre-stress. Otherwise all later panels
        # would begin off their start, too, and farther off where tau is nearer to 0.
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

    def straight(self, mark: float) -> Advance:
        """Return the last step to a mark where tau rises to 0, at the wave speed.

        It is used if no chunk is resolved. Farther away from the mark the front is "unresolved".
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
