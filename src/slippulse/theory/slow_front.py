"""The free boundary: a front into negative pre-stress, slower than the waves.

Slip, slip velocity and strain vanish on it, for it needs no fracture energy. The characteristic
that ends on it at (X, t) entered the rupture at e, where T - x has the same value. du/dt = 0 there
reads, with xi = T(e) - e and eta = xi + 2 X,

    Int_e^X tau(x) E J0( sqrt(k (xi - T + x) (eta - T - x)) ) dx = 0,

with E and k = gamma - alpha^2/4 as in `riemann`. X is found as a function of e, in which it stays
smooth where the front stops: there dX/de = 0.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ..model.prestress import Interval, Prestress
from .curve import AT_ENDS, COUNT, CUMULATIVE, NODES, SLOPE, TO_SERIES, WEIGHTS, Curve, Panel
from .prestress_pieces import analytic
from .riemann import decay, kernel_of, partial_weights

RESOLVED = 1e-11
# The next chunk is at most this factor longer than one that was cut.
GROWTH = 4.0
# The shortest fraction of a panel of entries.
SHORTEST = 1e-11
# A remainder of a panel that is left to the next one.
REMAINDER = 1e-8
# Entries that move the front by less than a fraction of the rupture are passed over: those that are
# rounding at first, and then, as long as they would send the front back, those that the panels do
# not resolve.
NEGLIGIBLE = (1e-13, 1e-12, 1e-11, 1e-10)
# Parameters of a panel at which such entries may end, as fractions of the way to its left end.
FRACTIONS = np.linspace(0.0, 1.0, 65)
# Fraction of the rupture: distance from a mark from which a front that speeds up to the waves is
# continued at their speed.
NEAR_MARK = 1e-5
# Length of a whole panel in its parameter.
WHOLE = 2.0
# Relative distance of a look beyond the end of a panel of entries for the next one.
LOOK = 1e-11
# An event this close to the first entry of a chunk, in its parameter, has ended the last chunk.
AT_START = 1e-6
# A chunk ends at an event this close to its last entry, the less exactly after many corrections.
AT_END, NEAR_END, MANY = 1e-9, 1e-6, 5
# A chunk that was shortened to end at an event is searched a little beyond its end.
BEYOND = 1.2
MOST_CHUNKS = 60
# A front is not followed on a curve of more panels.
MOST_PANELS = 100_000
MOST_NEWTON_STEPS = 60


class Progress(NamedTuple):
    """What a slow front keeps from one panel to the next.

    The longest chunk that it tries next, and the position where the characteristic that has reached
    it entered the curve; NaN before its first panel.
    """

    longest: float = WHOLE
    entered: float = np.nan


class Entry(NamedTuple):
    """Panel (below 0: none on the curve) and parameter of the next entry.

    The entries between it and the last one, which are negligible, move the front so far.
    """

    panel: int
    s: float
    passed: float = 0.0


class Advance(NamedTuple):
    """The next panel, the reason why it is the last one, and what the following panel needs."""

    panel: Panel | None
    stop: str | None
    progress: Progress = Progress()


class Chunk(NamedTuple):
    """A range of entries on a panel of the curve, by their parameters, from right to left."""

    panel: int
    start: float
    stop: float

    def parameters(self, s: np.ndarray = NODES) -> np.ndarray:
        """Parameters on the panel of the entries, from their parameters on the chunk."""
        return self.start + 0.5 * (self.stop - self.start) * (1.0 + s)

    def half(self) -> "Chunk":
        """The first half."""
        return self._replace(stop=0.5 * (self.start + self.stop))


def _first_event(x: np.ndarray, mark: float, limit: float) -> tuple[float, str | None]:
    """The first parameter, up to a limit, where a front stops or meets the mark, or inf."""
    events: list[tuple[float, str | None]] = [(s, None) for s in _roots_on(SLOPE @ x, limit)]
    if np.isfinite(mark):
        events += [(s, "mark") for s in _roots_on(x - mark, limit)]
    return min(events, key=lambda event: event[0], default=(np.inf, None))


def _goes_back(x: np.ndarray) -> bool:
    """Tell whether a front would go back from the start of the chunk on."""
    slope = SLOPE @ x
    first = min(_roots_on(slope, 1.0), default=1.0)
    return bool(legendre.legval(0.5 * (first - 1.0), TO_SERIES @ slope) < 0.0)


def _roots_on(values: np.ndarray, limit: float) -> list[float]:
    """Roots from -1 to a limit of the polynomial with these values at the nodes."""
    series = TO_SERIES @ values
    scale = np.max(np.abs(series))
    if scale == 0.0:
        return []
    roots = legendre.legroots(legendre.legtrim(series, 1e-13 * scale))
    real = roots.real[np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots.real))]
    return real[(real > -1.0 + AT_START) & (real <= limit)].tolist()


class FreeBoundary:
    """The equation of the free boundary on one chunk, as a function of the positions of the front.

    One row is one node of the chunk. The curve that its characteristics have crossed comes first
    in a row (its weight includes tau), and then the nodes of the chunk.
    """

    def __init__(self, front: "SlowFront", chunk: Chunk) -> None:
        curve, panel, s = front.curve, chunk.panel, chunk.parameters()
        self.front = front
        self.early = curve.evaluate("early", np.full(COUNT, panel), s)
        self.late = curve.late[panel:].ravel()
        cut = (WEIGHTS - partial_weights(s)) * curve.source[panel]
        later = np.tile((curve.source[panel + 1 :] * WEIGHTS).ravel(), (COUNT, 1))
        self.weight = np.concatenate([cut, later], axis=1)
        self.d_xi = self.early[:, None] - np.append(curve.early[panel:], self.early)
        # Without leaf springs and drag the kernel is 1.
        self.is_plain = front.stiffness == front.alpha == 0.0
        self.plain_sum = self.weight.sum(axis=1) if self.is_plain else np.zeros(0)

    def newton_step(self, x: np.ndarray) -> np.ndarray | None:
        """The step to subtract from positions; None where the front would not be stable."""
        if self.is_plain:
            return self.plain_step(x)
        k, alpha = self.front.stiffness, self.front.alpha
        eta = self.early + 2.0 * x
        d_eta = eta[:, None] - np.append(self.late, eta)
        z = k * self.d_xi * d_eta
        kernel = kernel_of(k, z, z)
        lasting = decay(alpha, self.d_xi, d_eta) if alpha else 1.0
        # The kernel of each row, and its derivative by the position of the row.
        value = lasting * kernel(0)
        slope = 2.0 * k * lasting * kernel(1) * self.d_xi - 0.5 * alpha * value
        crossed = self.late.size
        entered = (self.weight * value[:, :crossed]).sum(axis=1)
        growth = (self.weight * slope[:, :crossed]).sum(axis=1)
        # From x0 to each position: with a kernel of 1 exactly, and what the kernel adds to 1 at the
        # nodes.
        area, tau = self.crossed_by_front(x)
        fall = tau + growth
        if not np.all(fall < 0.0):
            return None
        # A change of x at one node changes what is left of the equation at another.
        excess, slopes = CUMULATIVE * (value[:, crossed:] - 1.0), SLOPE @ x
        turn = CUMULATIVE * slope[:, crossed:] * (tau * slopes)
        matrix = (excess * tau) @ SLOPE + excess * (SLOPE @ tau) - turn
        matrix += np.diag(fall + turn.sum(axis=1))
        return np.linalg.solve(matrix, entered + area + excess @ (tau * slopes))

    def plain_step(self, x: np.ndarray) -> np.ndarray | None:
        """The same with a kernel of 1."""
        area, tau = self.crossed_by_front(x)
        return (self.plain_sum + area) / tau if np.all(tau < 0.0) else None

    def crossed_by_front(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Integral of the pre-stress from the start of the chunk to positions, and its values."""
        half = 0.5 * (x - self.front.x0)
        tau = self.front.tau(self.front.x0 + half[:, None] * np.append(1.0 + NODES, 2.0))
        return half * (tau[:, :-1] @ WEIGHTS), tau[:, -1]


@dataclass
class SlowFront:
    """The right end of a curve, continued into negative pre-stress for chunks of entries."""

    curve: Curve
    prestress: Prestress
    background: Interval  # where the front is
    gamma: float
    alpha: float = 0.0

    def __post_init__(self) -> None:
        self.stiffness = self.gamma - 0.25 * self.alpha**2
        edges = self.curve.edges
        self.x0, self.t0 = float(edges[-1]), float(self.curve.edge_times[-1])
        self.size = max(float(edges[-1] - edges[0]), abs(self.x0))

    def next_panel(self, mark: float, progress: Progress) -> Advance:
        """Continue the front by one panel of entries at most, or a shorter length.

        mark is the end of the negative piece (may be infinite). The stop is "mark" where the new
        panel ends there, "stops" where the front could only go back, as the solution beyond shows,
        "unknown" where its characteristic comes from beyond the left end of the curve, and
        "unresolved" where no panel is short enough. A panel ends where the front stops.
        """
        if len(self.curve.panels) > MOST_PANELS:
            return Advance(None, "unresolved")
        for negligible in NEGLIGIBLE:
            entry = self.entry(progress.entered, negligible)
            if entry is None:
                return Advance(None, "unknown")
            if entry.panel < 0:
                return Advance(None, "stops")
            rest = self.rest(entry)
            if rest is not None:
                return Advance(rest, None, Progress(entered=self.position(entry)))
            advance = self.advance_from(entry, mark, progress.longest)
            if advance.stop != "stops":
                break
        return advance

    def advance_from(self, entry: Entry, mark: float, longest: float) -> Advance:
        """Continue the front by one panel with the entries from one on."""
        panel, s, _ = entry
        chunk, corrections = Chunk(panel, s, max(s - longest, -1.0)), 0
        for _ in range(MOST_CHUNKS):
            if chunk.start - chunk.stop < SHORTEST:
                return self.straight(mark)
            x = self.solve(chunk)
            if x is not None and _goes_back(x):
                if mark - self.x0 >= NEAR_MARK * self.size:
                    return Advance(None, "stops")
                # This close to a mark rounding may send a front back.
                x = None
            if x is None:
                chunk, corrections = chunk.half(), 0
                continue
            s, stop = _first_event(x, mark, BEYOND if corrections else 1.0)
            near = AT_END if corrections <= MANY else NEAR_END
            if s < np.inf and (corrections == 0 or abs(s - 1.0) >= near):
                # Beyond an event the solution may mean nothing: it is solved again to end there.
                chunk = chunk._replace(stop=float(chunk.parameters(np.array(s))))
                corrections += 1
            elif np.any(np.diff(x, prepend=self.x0) <= 0.0):
                # Where the equation hardly depends on the front rounding may put it behind its
                # start.
                chunk, corrections = chunk.half(), 0
            else:
                to_the_end = s < np.inf or chunk.stop == -1.0
                length = WHOLE if to_the_end else GROWTH * (chunk.start - chunk.stop)
                entered = self.position(Entry(chunk.panel, chunk.stop))
                end = mark if stop == "mark" else None
                return Advance(self.panel(chunk, x, end), stop, Progress(length, entered))
        return Advance(None, "unresolved")

    def tau(self, x: np.ndarray) -> np.ndarray:
        """Pre-stress ahead of the front."""
        return analytic(self.prestress, self.background, x)

    def entry(self, entered: float, negligible: float) -> Entry | None:
        """The next entry after the position of the last one; None where it is not known.

        T - x is the same to rounding on panels before the front where the pre-stress is nearly 0.
        So an entry follows the last one along the curve, and is not looked for by its T - x. It
        passes over entries that are negligible.
        """
        panel, s = len(self.curve.panels) - 1, 1.0
        if np.isfinite(entered):
            (panel,), (s,) = self.curve.locate(np.array([entered]))
            # A remainder near rounding cannot be resolved: the next panel takes it over.
            panel, s = (panel, s) if s + 1.0 >= REMAINDER else (panel - 1, 1.0)
        gain, passed = 0.0, False
        while panel >= 0 and not self.is_slow(panel):
            parameters = s - (s + 1.0) * FRACTIONS
            moves = gain + self.moves(panel, parameters)
            # Only pre-stress that is not negative moves no front back.
            negative = bool(np.min(self.curve.source[panel]) < 0.0)
            most = self.size * (NEGLIGIBLE[0] if negative else negligible)
            last = int(np.argmin(np.append(np.abs(moves) <= most, False))) - 1
            gain, passed = float(moves[last]), passed or last > 0
            if last < FRACTIONS.size - 1:
                goes_on = not negative or moves[last + 1] >= moves[last]
                return self.chosen(
                    Entry(int(panel), float(parameters[last])), gain, passed, goes_on
                )
            panel, s = panel - 1, 1.0
        if panel >= 0:
            return self.entry_behind_slow_front()
        return Entry(-1, 1.0) if passed else None

    def moves(self, panel: int, parameters: np.ndarray) -> np.ndarray:
        """Motion of the front by the entries on a panel from its first parameter to each one."""
        weights = partial_weights(parameters)
        return (weights[0] - weights) @ self.curve.source[panel] / self.resistance

    def chosen(self, entry: Entry, gain: float, passed: bool, goes_on: bool) -> Entry:
        """The entry with what was passed before it; below 0 where the front does not go on."""
        if not passed:
            return entry
        return entry._replace(passed=max(gain, self.least)) if goes_on else Entry(-1, 1.0)

    @property
    def least(self) -> float:
        """The least motion that counts."""
        return 0.1 * NEGLIGIBLE[0] * self.size

    @property
    def resistance(self) -> float:
        """Size of the negative pre-stress right ahead of the front."""
        return abs(float(self.tau(np.array(self.x0 + NEGLIGIBLE[0] * self.size))))

    def position(self, entry: Entry) -> float:
        """Position of an entry on the curve."""
        return float(self.curve.evaluate("x", np.array([entry.panel]), np.array([entry.s]))[0])

    def rest(self, entry: Entry) -> Panel | None:
        """A panel of a front that hardly moves until the characteristic of an entry comes."""
        early = self.curve.evaluate("early", np.array([entry.panel]), np.array([entry.s]))[0]
        x_ends = self.x0, self.x0 + entry.passed
        time_ends = self.t0, float(early) + x_ends[1]
        if entry.passed == 0.0 or time_ends[1] - self.t0 < NEGLIGIBLE[0] * self.size:
            return None
        x, time = (a + 0.5 * (b - a) * (1.0 + NODES) for a, b in (x_ends, time_ends))
        source = np.full(COUNT, -0.5 * self.resistance * entry.passed)
        return Panel(x, time, source, x_ends, time_ends)

    def is_slow(self, panel: int) -> bool:
        """True if the front that made a panel goes right and is slower than the waves."""
        start, end = self.curve.edge_times[panel : panel + 2]
        return bool(end > start and np.sum(self.curve.source[panel]) < 0.0)

    def entry_behind_slow_front(self) -> Entry | None:
        """Panel and parameter where T - x next rises to its value at the front, or None."""
        xi = self.t0 - self.x0
        look = LOOK * max(self.size, abs(xi))
        # A little later the next panel goes on, or another part of the rupture.
        later = np.array([xi, xi + look])
        entries, _ = self.curve.crossings(np.full(2, self.x0), later, later + 2.0 * self.x0)
        if not entries.known[1]:
            return None
        panel = int(entries.panel[1])
        # The look would leave a gap: such an entry is taken at the very end of the panel.
        end = self.curve.ends[1, self.curve.row("early", entries.panel)][1]
        if abs(end - xi) < 10.0 * look:
            return Entry(panel, 1.0)
        s = float(entries.s[0] if entries.panel[0] == panel else entries.s[1])
        return Entry(panel - 1, 1.0) if s + 1.0 < REMAINDER and panel > 0 else Entry(panel, s)

    def solve(self, chunk: Chunk) -> np.ndarray | None:
        """Positions of the front by Newton's method; None where the chunk is too long."""
        equation = FreeBoundary(self, chunk)
        x, change = self.guess(chunk), np.inf
        for _ in range(MOST_NEWTON_STEPS):
            step = equation.newton_step(x)
            if step is None:
                return None
            x = x - step
            previous, change = change, float(np.max(np.abs(step))) / self.size
            tail = np.max(np.abs(TO_SERIES[-2:] @ x)) / self.size
            # Further steps, which are smaller, do not resolve it either.
            if not change <= 1e3 or (tail > 2.0 * RESOLVED and change < 0.1 * tail):
                return None
            if change < 1e-13 or (change < 1e-11 and change >= 0.5 * previous):
                return x if tail <= RESOLVED else None
        return None

    def guess(self, chunk: Chunk) -> np.ndarray:
        """Positions of the front as if there were no leaf springs."""
        entries = self.curve.evaluate("x", np.full(COUNT, chunk.panel), chunk.parameters())
        start = np.array([chunk.panel]), np.array([chunk.start])
        first, source = (float(self.curve.evaluate(name, *start)[0]) for name in ("x", "source"))
        at_entry = source / float(self.curve.evaluate("x", *start, order=1)[0])
        here = float(self.tau(np.array(self.x0)))
        pace = at_entry / -here if here < -1e-6 and at_entry > 0.0 else 1.0
        return self.x0 + min(max(pace, 1e-3), 10.0) * (first - entries)

    def panel(self, chunk: Chunk, x: np.ndarray, end: float | None) -> Panel:
        """The new panel of the curve; its end may be known to be a mark."""
        s = np.append(chunk.parameters(), chunk.stop)
        *early, last_early = self.curve.evaluate("early", np.full(COUNT + 1, chunk.panel), s)
        last = float(AT_ENDS[1] @ x) if end is None else end
        x_ends, time_ends = (self.x0, last), (self.t0, float(last_early) + last)
        return Panel(x, np.array(early) + x, self.tau(x) * (SLOPE @ x), x_ends, time_ends)

    def straight(self, mark: float) -> Advance:
        """The last step to a mark where tau rises to 0, too short to be resolved, at wave speed."""
        if mark - self.x0 > NEAR_MARK * self.size:
            return Advance(None, "unresolved")
        half = 0.5 * (mark - self.x0)
        x = self.x0 + half * (1.0 + NODES)
        x_ends, time_ends = (self.x0, mark), (self.t0, self.t0 + 2.0 * half)
        panel = Panel(x, self.t0 + x - self.x0, self.tau(x) * half, x_ends, time_ends)
        return Advance(panel, "mark")
