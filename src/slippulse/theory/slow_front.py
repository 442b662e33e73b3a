"""The free boundary: a front into negative pre-stress, slower than the waves.

Slip, slip velocity and strain vanish on it, for it needs no fracture energy. The characteristic that ends on it at
(X, t) entered the rupture at e, where T - x has the same value, and du/dt = 0 there reads

    Int_e^X tau(x) J0( sqrt(gamma (xi - T + x) (eta - T - x)) ) dx = 0,   xi = T(e) - e,   eta = xi + 2 X.

X is marched as a function of e, in which it stays smooth where the front stops: there dX/de = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from ..model.prestress import Prestress
from .curve import AT_ENDS, COUNT, CUMULATIVE, NODES, SLOPE, TO_SERIES, WEIGHTS, Curve, Panel
from .kernel import riemann, riemann_slope
from .profile import smooth
from .riemann import partial_weights

RESOLVED = 1e-11
# The shortest share of a panel of entries.
SHORTEST = 1e-11
# How far from a mark a front that speeds up to the waves is taken on at their speed.
NEAR_MARK = 1e-4


@dataclass(frozen=True)
class Advance:
    """The next panel of a slow front, and why it is the last one: see `advance`."""

    panel: Panel | None
    stop: str | None


def advance(curve: Curve, prestress: Prestress, level: float, gamma: float, mark: float) -> Advance:
    """Continue the right end of a curve into negative pre-stress, by the entries of one panel at most.

    Parameters
    ----------
    curve : all that has slipped, from left to right
    prestress, level : the pre-stress, and the side level where the front is
    gamma : elasticity ratio, or 0
    mark : where the negative piece ends (may be infinite)

    Returns
    -------
    The new panel; stop is "mark" where it ends at the mark, "dead" where the front stops for good, and "unknown"
    where its characteristic comes from beyond the curve's left end; "unresolved" where no panel is short enough.

    Source: the free boundary (module docstring).
    """
    front = _Chunk(curve, prestress, level, gamma)
    entry = front.entry()
    if entry is None:
        return Advance(None, "unknown")
    k, start = entry
    stop = -1.0
    corrections = 0
    for _ in range(60):
        if start - stop < SHORTEST and not corrections:
            return Advance(None, "dead") if front.stalled() else front.straight(mark)
        solved = front.solve(k, start, stop)
        if solved is None:
            stop, corrections = 0.5 * (start + stop), 0
            continue
        x, slope = solved
        found = _first_event(x, slope, mark, limit=1.2 if corrections else 1.0)
        if found is None:
            return Advance(front.panel(k, start, stop, x, slope), None)
        place, event = found
        # The chunk is made again to end there: beyond it the solution may mean nothing.
        if corrections and (abs(place - 1.0) < 1e-9 or (corrections > 5 and abs(place - 1.0) < 1e-6)):
            return Advance(
                front.panel(k, start, stop, x, slope, end=mark if event == "mark" else None), event
            )
        stop = start + 0.5 * (stop - start) * (1.0 + place)
        corrections += 1
    return Advance(None, "unresolved")


def _first_event(x: np.ndarray, slope: np.ndarray, mark: float, limit: float) -> tuple[float, str] | None:
    """The first place on the chunk, or up to a limit beyond it, where the front stops or meets the mark."""
    found = []
    series = TO_SERIES @ slope
    roots = _roots_on(series, limit)
    if roots.size:
        found.append((float(roots[0]), "dead"))
    if np.isfinite(mark):
        series = TO_SERIES @ x
        series = series - np.eye(COUNT)[0] * mark
        roots = _roots_on(series, limit)
        if roots.size:
            found.append((float(roots[0]), "mark"))
    if not found:
        return None
    return min(found)


def _roots_on(series: np.ndarray, limit: float) -> np.ndarray:
    scale = np.max(np.abs(series))
    if scale == 0.0:
        return np.empty(0)
    roots = legendre.legroots(legendre.legtrim(series, 1e-13 * scale))
    real = roots.real[np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots.real))]
    return np.sort(real[(real > -1.0 + 1e-12) & (real <= limit)])


class _Chunk:
    """One chunk of entries, from where the last one ended leftwards, and the front's positions for them."""

    def __init__(self, curve: Curve, prestress: Prestress, level: float, gamma: float) -> None:
        self.curve, self.prestress, self.level, self.gamma = curve, prestress, level, gamma
        self.x0, self.t0 = float(curve.edges[-1]), float(curve.edge_times[-1])

    def tau(self, x: np.ndarray) -> np.ndarray:
        return smooth(self.prestress, self.level, x)

    def entry(self) -> tuple[int, float] | None:
        """Panel and place where the front's characteristic entered; None beyond the left end."""
        y = np.array([self.x0])
        xi = np.array([self.t0 - self.x0])
        for _ in range(2):
            cross = self.curve.left(y, xi)
            if not cross.known[0]:
                return None
            k, place = int(cross.panel[0]), float(cross.place[0])
            if place > -1.0 + 1e-7:
                break
            # At the panel's end: the next one goes on, if it is not another part of the rupture that does.
            xi = xi + 1e-11 * np.maximum(1.0, np.abs(xi))
        return k, place

    def solve(self, k: int, start: float, stop: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Positions at the nodes, and their derivative; None where the chunk is too long."""
        curve, gamma = self.curve, self.gamma
        places = start + 0.5 * (stop - start) * (1.0 + NODES)
        same = np.full(COUNT, k)
        early = curve.at("early", same, places)
        cut = curve.weight[k] - partial_weights(places) * curve.source[k]
        rest = np.broadcast_to(curve.weight[k + 1 :].ravel(), (COUNT, curve.weight[k + 1 :].size))
        weight = np.concatenate([cut, rest], axis=1)
        behind = gamma * (early[:, None] - curve.early[k:].ravel())
        late = curve.late[k:].ravel()
        own = gamma * (early[:, None] - early)
        entries = curve.at("x", same, places)
        x = self.guess(k, start, entries)
        change = np.inf
        for _ in range(60):
            eta = early + 2.0 * x
            z = behind * (eta[:, None] - late)
            bounds = (float(z[:, :COUNT].min()), float(z.max()))
            ahead = np.add.reduce(weight * riemann(z, bounds), axis=1)
            # From x0 to each position: with a kernel of 1 exactly, and the rest of the kernel at the nodes.
            half = 0.5 * (x - self.x0)
            area = half * (self.tau(self.x0 + half[:, None] * (1.0 + NODES)) @ WEIGHTS)
            tau = self.tau(x)
            source = tau * (SLOPE @ x)
            z_own = own * 2.0 * (0.5 * (eta[:, None] - eta))
            z_bounds = (float(z_own.min()), float(z_own.max()))
            near = np.add.reduce(CUMULATIVE * source * (riemann(z_own, z_bounds) - 1.0), axis=1)
            residual = ahead + area + near
            fall = tau + 2.0 * np.add.reduce(weight * riemann_slope(z, bounds) * behind, axis=1)
            if not np.all(fall < 0.0):
                return None
            step = residual / fall
            new = x - step
            # Never behind the last position.
            new = np.maximum(new, self.x0 + 0.1 * (x - self.x0))
            previous, change = change, float(np.max(np.abs(new - x)))
            x = new
            if not np.isfinite(change) or change > 1e3:
                return None
            if change < 1e-13 * max(1.0, abs(self.x0)) or (change < 1e-11 and change >= 0.5 * previous):
                break
        else:
            return None
        series = TO_SERIES @ x
        if np.max(np.abs(series[-2:])) > RESOLVED * max(1.0, abs(self.x0)):
            return None
        return x, SLOPE @ x

    def guess(self, k: int, start: float, entries: np.ndarray) -> np.ndarray:
        """Positions that go on as they would without leaf springs."""
        first = float(self.curve.at("x", np.array([k]), np.array([start]))[0])
        gone = first - entries
        at_entry = float(self.prestress_at_entry(k, start))
        here = float(self.tau(np.array(self.x0)))
        pace = at_entry / -here if here < -1e-6 and at_entry > 0.0 else 1.0
        return self.x0 + min(max(pace, 1e-3), 10.0) * gone

    def prestress_at_entry(self, k: int, start: float) -> float:
        place, panel = np.array([start]), np.array([k])
        return self.curve.at("source", panel, place)[0] / self.curve.slope("x", panel, place)[0]

    def stalled(self) -> bool:
        """Whether the front has just come to rest, at the end of the last panel of entries."""
        last = np.array([len(self.curve.panels) - 1])
        at_end = self.curve.slope("x", last, np.array([1.0]))[0]
        return bool(at_end < 1e-3 * (self.curve.edges[-1] - self.curve.edges[-2]))

    def panel(self, k, start, stop, x, slope, end: float | None = None) -> Panel:
        places = start + 0.5 * (stop - start) * (1.0 + NODES)
        early = self.curve.at("early", np.full(COUNT, k), places)
        last = float(AT_ENDS[1] @ x) if end is None else end
        last_early = float(self.curve.at("early", np.array([k]), np.array([stop]))[0])
        return Panel(x, early + x, self.tau(x) * slope, (self.x0, last), (self.t0, last_early + last))

    def straight(self, mark: float) -> Advance:
        """The last step to a mark where tau rises to 0: too short to be resolved, at the speed of the waves."""
        if not np.isfinite(mark) or mark - self.x0 > NEAR_MARK:
            return Advance(None, "unresolved")
        half = 0.5 * (mark - self.x0)
        x = self.x0 + half * (1.0 + NODES)
        time = self.t0 + x - self.x0
        return Advance(
            Panel(x, time, self.tau(x) * half, (self.x0, mark), (self.t0, self.t0 + 2.0 * half)), "mark"
        )
