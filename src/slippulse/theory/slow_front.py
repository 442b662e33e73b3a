"""The free boundary: a front into negative pre-stress, slower than the waves; and how deep a pulse enters a barrier.

Slip, slip velocity and strain vanish on it, for it needs no fracture energy. The characteristic that ends on it at
(X, t) entered the rupture at e, where T - x has the same value, and du/dt = 0 there reads

    Int_e^X tau(x) E J0( sqrt(k (xi - T + x) (eta - T - x)) ) dx = 0,   xi = T(e) - e,   eta = xi + 2 X,

with E and k = gamma - alpha^2/4 as in `riemann`.

X is marched as a function of e, in which it stays smooth where the front stops: there dX/de = 0.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from ..model.checks import check_number
from ..model.prestress import Prestress
from .curve import AT_ENDS, COUNT, CUMULATIVE, NODES, SLOPE, TO_SERIES, WEIGHTS, Curve, Panel
from .domains import check_domains
from .front_speeds import front_speed
from .fronts import analytic, straight_panel
from .pulse import pulse_behind_front
from .riemann import decay, kernel_of, partial_weights

RESOLVED = 1e-11
# The shortest fraction of a panel of entries.
SHORTEST = 1e-11
# How far from a mark a front that speeds up to the waves is taken on at their speed.
NEAR_MARK = 1e-4
# How far, relative, a look beyond the end of a panel of entries goes for the next one.
LOOK = 1e-11
# Panels behind the barrier, each so long in units of 1/sqrt(gamma), as far as the barrier remembers.
LONGEST = 2.0
MEMORY = 1.5
# Below it the estimate may be beyond floating point.
SMALLEST = 1e-100
# Levels, in units of the pre-stress before them the weakest, on which slow fronts were found to be resolved, and the
# fastest front before them, whose pulse takes 12000 panels.
SLOWEST, WEAKEST, STRONGEST, FASTEST = 1e-4, 0.005, 1e6, 5e3

# The next panel of a slow front, and why it is the last one.
Advance = tuple[Panel | None, str | None]


def advance(
    curve: Curve, prestress: Prestress, level: float, gamma: float, mark: float, alpha: float = 0.0
) -> Advance:
    """Continue the right end of a curve into negative pre-stress, by the entries of one panel at most.

    level is the side level where the front is, mark where the negative piece ends (may be infinite). The stop is "mark"
    where the new panel ends there, "dead" where the front stops for good, "unknown" where its characteristic comes from
    beyond the curve's left end, and "unresolved" where no panel is short enough.
    """
    front = _Chunk(curve, prestress, level, gamma, alpha)
    entry = front.entry()
    if entry is None:
        return None, "unknown"
    k, start = entry
    stop, corrections = -1.0, 0
    for _ in range(60):
        if start - stop < SHORTEST:
            return (None, "dead") if front.stalled() else front.straight(mark)
        solved = front.solve(k, start, stop)
        if solved is None:
            stop, corrections = 0.5 * (start + stop), 0
            continue
        x, slope = solved
        # The first parameter on the chunk, or a little beyond it, where the front stops or meets the mark.
        limit = 1.2 if corrections else 1.0
        found = [(s, "dead") for s in _roots_on(slope, limit)]
        if np.isfinite(mark):
            found += [(s, "mark") for s in _roots_on(x - mark, limit)]
        if not found:
            return front.panel(k, start, stop, x, slope), None
        s, event = min(found)
        # The chunk is made again to end there: beyond it the solution may mean nothing.
        if corrections and (abs(s - 1.0) < 1e-9 or (corrections > 5 and abs(s - 1.0) < 1e-6)):
            return front.panel(k, start, stop, x, slope, mark if event == "mark" else None), event
        stop = start + 0.5 * (stop - start) * (1.0 + s)
        corrections += 1
    return None, "unresolved"


def _roots_on(values: np.ndarray, limit: float) -> list[float]:
    series = TO_SERIES @ values
    scale = np.max(np.abs(series))
    if scale == 0.0:
        return []
    roots = legendre.legroots(legendre.legtrim(series, 1e-13 * scale))
    real = roots.real[np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots.real))]
    return real[(real > -1.0 + 1e-12) & (real <= limit)].tolist()


class _Chunk:
    """One chunk of entries, from where the last one ended leftwards, and the front's positions for them."""

    def __init__(
        self, curve: Curve, prestress: Prestress, level: float, gamma: float, alpha: float
    ) -> None:
        self.curve, self.prestress, self.level = curve, prestress, level
        self.stiffness, self.alpha = gamma - 0.25 * alpha**2, alpha
        self.x0, self.t0 = float(curve.edges[-1]), float(curve.edge_times[-1])

    def tau(self, x: np.ndarray) -> np.ndarray:
        return analytic(self.prestress, self.level, x)

    def entry(self) -> tuple[int, float] | None:
        """Panel and parameter where the front's characteristic entered; None beyond the left end."""
        xi = self.t0 - self.x0
        look = LOOK * max(1.0, abs(xi))
        # A little later: at the end of a panel it is the next one that goes on, or another part of the rupture.
        later = np.array([xi, xi + look])
        found, _ = self.curve.crossings(np.full(2, self.x0), later, later + 2.0 * self.x0)
        if not found.known[1]:
            return None
        k = int(found.panel[1])
        # Not by the look, which would leave a gap, but at the panel's very end.
        if abs(self.curve.ends[1, self.curve.row("early", found.panel)][1] - xi) < 10.0 * look:
            return k, 1.0
        return k, float(found.s[int(found.panel[0] != k)])

    def solve(self, k: int, start: float, stop: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Positions at the nodes, and their derivative; None where the chunk is too long."""
        curve, stiffness, alpha = self.curve, self.stiffness, self.alpha
        s = start + 0.5 * (stop - start) * (1.0 + NODES)
        same = np.full(COUNT, k)
        early = curve.at("early", same, s)
        cut = (WEIGHTS - partial_weights(s)) * curve.source[k]
        rest = np.tile((curve.source[k + 1 :] * WEIGHTS).ravel(), (COUNT, 1))
        weight = np.concatenate([cut, rest], axis=1)
        # At the nodes of the curve, and at those of the chunk.
        behind = early[:, None] - np.append(curve.early[k:], early)
        late, most = curve.late[k:].ravel(), max(1.0, abs(self.x0))
        x = self.guess(k, start, curve.at("x", same, s))
        change = np.inf
        for _ in range(60):
            eta = early + 2.0 * x
            ahead = eta[:, None] - np.append(late, eta)
            z = stiffness * behind * ahead
            kernel = kernel_of(stiffness, z, z)
            lasting = decay(alpha, behind + ahead) if alpha else 1.0
            value = lasting * kernel(0)
            slope = 2.0 * stiffness * lasting * kernel(1) * behind - 0.5 * alpha * value
            whole, change_of_whole = value[:, late.size :], slope[:, late.size :]
            # From x0 to each position: with a kernel of 1 exactly, and the rest of the kernel at the nodes.
            half = 0.5 * (x - self.x0)
            tau = self.tau(self.x0 + half[:, None] * np.append(1.0 + NODES, 2.0))
            area, tau = half * (tau[:, :-1] @ WEIGHTS), tau[:, -1]
            entered, growth = (
                (weight * each[:, : late.size]).sum(axis=1) for each in (value, slope)
            )
            fall = tau + growth
            if not np.all(fall < 0.0):
                return None
            # Newton's step: how x at one node changes what is left of the equation at another.
            beyond, paces = CUMULATIVE * (whole - 1.0), SLOPE @ x
            turn = CUMULATIVE * change_of_whole * (tau * paces)
            matrix = (beyond * tau) @ SLOPE + beyond * (SLOPE @ tau) - turn
            matrix += np.diag(fall + turn.sum(axis=1))
            step = np.linalg.solve(matrix, entered + area + beyond @ (tau * paces))
            # Never behind the last position.
            new = np.maximum(x - step, self.x0 + 0.1 * (x - self.x0))
            previous, change = change, float(np.max(np.abs(new - x)))
            x = new
            tail = np.max(np.abs(TO_SERIES[-2:] @ x))
            # Steps that are smaller do not resolve it either.
            if not change <= 1e3 or (tail > 2.0 * RESOLVED * most and change < 0.1 * tail):
                return None
            if change < 1e-13 * most or (change < 1e-11 and change >= 0.5 * previous):
                return (x, SLOPE @ x) if tail <= RESOLVED * most else None
        return None

    def guess(self, k: int, start: float, entries: np.ndarray) -> np.ndarray:
        """Positions that go on as they would without leaf springs."""
        at = np.array([k]), np.array([start])
        first, source = (float(self.curve.at(name, *at)[0]) for name in ("x", "source"))
        slope = float(self.curve.at("x", *at, order=1)[0])
        at_entry, here = source / slope, float(self.tau(np.array(self.x0)))
        pace = at_entry / -here if here < -1e-6 and at_entry > 0.0 else 1.0
        return self.x0 + min(max(pace, 1e-3), 10.0) * (first - entries)

    def stalled(self) -> bool:
        """Whether the front has just come to rest, at the end of the last panel of entries."""
        last = np.array([len(self.curve.panels) - 1])
        at_end = self.curve.at("x", last, np.array([1.0]), order=1)[0]
        return bool(at_end < 1e-3 * (self.curve.edges[-1] - self.curve.edges[-2]))

    def panel(self, k, start, stop, x, slope, end: float | None = None) -> Panel:
        s = np.append(start + 0.5 * (stop - start) * (1.0 + NODES), stop)
        *early, last_early = self.curve.at("early", np.full(COUNT + 1, k), s)
        last = float(AT_ENDS[1] @ x) if end is None else end
        ends = (self.x0, last), (self.t0, float(last_early) + last)
        return Panel(x, np.array(early) + x, self.tau(x) * slope, *ends)

    def straight(self, mark: float) -> Advance:
        """The last step to a mark where tau rises to 0: too short to be resolved, at the speed of the waves."""
        if not np.isfinite(mark) or mark - self.x0 > NEAR_MARK:
            return None, "unresolved"
        half = 0.5 * (mark - self.x0)
        x = self.x0 + half * (1.0 + NODES)
        ends = (self.x0, mark), (self.t0, self.t0 + 2.0 * half)
        return Panel(x, self.t0 + x - self.x0, self.tau(x) * half, *ends), "mark"


def barrier_depth(
    tau0: float,
    tau_barrier: float,
    gamma: float,
    damping_ratio: float = 0.0,
    release: str = "total",
) -> float:
    """Distance from the edge of a barrier at which a steady pulse dies; a shorter barrier is passed.

    Parameters
    ----------
    tau0, gamma : pre-stress, from 1e-4 to 1, whose front is no faster than 5000, and elasticity ratio, > 0
    tau_barrier : pre-stress of the barrier, from -1e6 to -tau0/200
    damping_ratio, release : beta/dx, from 0 to 1e100; "total" or "elastic"

    Raises ValueError: outside the domain.
    Source: the free boundary behind a front at constant speed, in the continuum limit.
    """
    check_number("tau0", tau0, at_least=SLOWEST, below=1.0)
    check_number("tau_barrier", tau_barrier, at_least=-STRONGEST, at_most=-WEAKEST * tau0)
    check_domains(gamma=gamma, damping_ratio=damping_ratio)
    speed = float(front_speed(tau0, damping_ratio, release))
    check_number(
        f"front speed at tau0 = {tau0!r}, damping_ratio = {damping_ratio!r}", speed, at_most=FASTEST
    )
    # The depth scales like 1/sqrt(gamma). Its characteristics entered no further back than the pulse remembers.
    memory = MEMORY * pulse_behind_front(tau0, 1.0, 0.0, speed).width / (speed - 1.0) * speed
    proper = math.sqrt((speed - 1.0) * (speed + 1.0)) / speed
    edges = np.linspace(-memory, 0.0, max(4, math.ceil(memory * proper / LONGEST)) + 1)
    # T rises to the right, as behind a pulse that comes from far away.
    panels = [straight_panel(a, b, 1.0 / speed, tau0) for a, b in pairwise(edges.tolist())]
    level = Prestress(left=tau_barrier, right=tau_barrier, peak=tau_barrier)
    stop = None
    while stop is None:
        panel, stop = advance(Curve(panels), level, tau_barrier, 1.0, math.inf)
        if panel is not None:
            panels.append(panel)
    if stop != "dead":
        raise ValueError(
            f"tau_barrier: {tau_barrier!r}, where the front is {stop} at tau0 = {tau0!r}, damping_ratio ="
            f" {damping_ratio!r}; allowed: levels on which it is resolved"
        )
    return panels[-1].x_ends[1] / math.sqrt(gamma)


def barrier_depth_estimate(tau0: float, tau_barrier: float, gamma: float) -> float:
    """The estimate (2/gamma) ln((tau_barrier - tau_0)/tau_barrier) of the authors' public code of later work."""
    check_domains(tau0=tau0)
    check_number("tau_barrier", tau_barrier, at_most=-SMALLEST)
    check_number("gamma", gamma, at_least=SMALLEST)
    return 2.0 / gamma * math.log((tau_barrier - tau0) / tau_barrier)
