"""The crack-pulse transition, exactly, in the continuum limit dx -> 0 at fixed beta/dx.

While tau(x) > 0 a front outruns the waves, so the curve t = T(x), T(x) = Int_0^x dx'/v(tau(x'), beta/dx), carries
slip, slip velocity and strain 0 like an initial curve, and the damping, beta = (beta/dx) dx -> 0, acts at the front
alone. Behind it the undamped equation has Riemann's solution. Each position starts to feel its pre-stress at T(x), so

    du/dt(y, t) = (1/2) Int tau(x) J0( sqrt(gamma) sqrt( (t - T(x))^2 - (x - y)^2 ) ) dx   over |x - y| < t - T(x),

until du/dt returns to 0 somewhere (Gamma = 1) or a front stops outrunning the waves (Gamma = 0).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial import Chebyshev, legendre

from ..model.balance import prestress_balance_position
from ..model.checks import check_number
from ..model.prestress import Prestress
from ..model.roots import root_between
from .front_law import front_speed, front_speed_undamped

NODES, WEIGHTS = legendre.leggauss(12)
# From values at the nodes of a panel to the Legendre coefficients of their integral from its left end.
INTEGRATE = legendre.legint(np.linalg.inv(legendre.legvander(NODES, NODES.size - 1)), lbnd=-1.0)
# Panels a Gaussian width: the profile and the front law are smooth on this scale.
PANELS_PER_WIDTH = 12
# Degree of the interpolated front law; its error is below 1e-7 in the slowness for damping ratios above 0.01.
LAW_DEGREE = 96


@lru_cache(maxsize=64)
def slowness_law(damping_ratio: float, release: str) -> Chebyshev:
    """1/v as a polynomial in the angle theta, tau_0 = sin(theta): at damping_ratio 0 it is cos(theta)."""

    def slowness(theta: np.ndarray) -> np.ndarray:
        tau = np.sin(theta)
        inside = (tau > 0.0) & (tau < 1.0)
        out = np.where(tau >= 1.0, 0.0, 1.0)
        out[inside] = 1.0 / front_speed(tau[inside], damping_ratio, release)
        return out

    return Chebyshev.interpolate(slowness, LAW_DEGREE, domain=[0.0, 0.5 * np.pi])


def slowness(tau, damping_ratio: float, release: str = "total") -> np.ndarray:
    """1/v of a front into pre-stress tau in [0, 1], by interpolation of `front_speed`; 0 where tau >= 1."""
    tau = np.clip(np.asarray(tau, dtype=float), 0.0, 1.0)
    if damping_ratio == 0.0:
        return 1.0 / front_speed_undamped(np.minimum(tau, 1.0 - 1e-16)) * (tau < 1.0)
    return slowness_law(float(damping_ratio), release)(np.arcsin(tau))


class Fronts:
    """Arrival times T(x) of the fronts that outrun the waves, on both sides of one nucleation point at x = 0.

    Parameters
    ----------
    prestress : a profile with tau(0) = 1 and one nucleation point
    damping_ratio : beta/dx, >= 0
    release : "total" or "elastic"
    reach : how far from x = 0 times are wanted (units of H)

    Raises
    ------
    ValueError
        If the profile does not nucleate at x = 0, or nucleates elsewhere too.
    """

    def __init__(self, prestress: Prestress, damping_ratio: float, release: str, reach: float) -> None:
        check_number("damping_ratio", damping_ratio, at_least=0.0)
        check_number("prestress at x = 0", float(prestress(0.0)), at_least=1.0)
        self.prestress = prestress
        self.ends, self.edges, self.times, self.within = {}, {}, {}, {}
        for sign in (-1.0, 1.0):
            edges = _panels(prestress, sign, reach)
            tau_at_edges = prestress(sign * edges)
            stopped = np.flatnonzero(tau_at_edges <= 0.0)
            # A level of exactly 0 far away still carries a front at the wave speed.
            level = float(prestress.level(np.asarray(sign * reach)))
            if stopped.size and level < 0.0:
                end = root_between(
                    lambda x, s=sign: float(prestress(s * x)), edges[stopped[0] - 1], edges[stopped[0]]
                )
                edges = np.concatenate([edges[: stopped[0]], [end]])
                self.ends[sign] = end
            else:
                self.ends[sign] = np.inf
            half = 0.5 * np.diff(edges)
            x = 0.5 * (edges[1:] + edges[:-1])[:, None] + half[:, None] * NODES
            tau = prestress(sign * x)
            if np.any(tau[1:] >= 1.0):
                raise ValueError("prestress: reaches 1 away from x = 0; allowed: one nucleation point")
            rate = slowness(tau, damping_ratio, release)
            self.edges[sign] = edges
            self.times[sign] = np.concatenate([[0.0], np.cumsum(half * (rate @ WEIGHTS))])
            self.within[sign] = INTEGRATE @ (half[:, None] * rate).T

    def arrival(self, x) -> np.ndarray:
        """T(x): when the front reaches x; NaN beyond where it outruns the waves."""
        x = np.asarray(x, dtype=float)
        out = np.full(x.shape, np.nan)
        for sign in (-1.0, 1.0):
            chosen = (sign * x >= 0.0) & (np.abs(x) <= self.edges[sign][-1])
            distance = np.abs(x[chosen])
            edges, times = self.edges[sign], self.times[sign]
            panel = np.clip(np.searchsorted(edges, distance, side="right") - 1, 0, edges.size - 2)
            inside = 2.0 * (distance - edges[panel]) / (edges[panel + 1] - edges[panel]) - 1.0
            out[chosen] = times[panel] + legendre.legval(inside, self.within[sign][:, panel], tensor=False)
        return out

    def arrival_at(self, x: float) -> float:
        """T at one point, as `arrival`: root finding asks for thousands, one at a time."""
        sign = -1.0 if x < 0.0 else 1.0
        edges, starts, within = self._lists[sign]
        distance = abs(x)
        if distance > edges[-1]:
            return math.nan
        panel = min(bisect_right(edges, distance) - 1, len(edges) - 2)
        s = 2.0 * (distance - edges[panel]) / (edges[panel + 1] - edges[panel]) - 1.0
        # Clenshaw's recurrence for a Legendre series.
        coefficients = within[panel]
        b1 = b2 = 0.0
        for k in range(len(coefficients) - 1, 0, -1):
            b1, b2 = coefficients[k] + (2 * k + 1) / (k + 1) * s * b1 - (k + 1) / (k + 2) * b2, b1
        return starts[panel] + coefficients[0] + s * b1 - 0.5 * b2

    @cached_property
    def _lists(self) -> dict[float, tuple[list, list, list]]:
        """Panel edges, times and coefficients by side as lists, which are quicker one element at a time."""
        return {
            sign: (self.edges[sign].tolist(), self.times[sign].tolist(), self.within[sign].T.tolist())
            for sign in (-1.0, 1.0)
        }

    def quadrature(self, left: float, right: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes x of an integral of tau from left to right, weights with tau in them, and T at the nodes."""
        x, weight, entered, edges = self._whole
        start, stop = np.searchsorted(edges, [left, right])
        inside = slice(int(start), int(stop) - 1)
        first, last = edges[inside.start], edges[inside.stop]
        if not first < last:
            first, last, inside = left, left, slice(0, 0)
        # The panels at both ends are cut.
        half = 0.5 * np.array([[first - left], [right - last]])
        ends = np.array([[left], [last]]) + half * (1.0 + NODES)
        cut = (half * WEIGHTS) * self.prestress(ends)
        parts = ((x[inside], ends), (weight[inside], cut), (entered[inside], self.arrival(ends)))
        return tuple(np.concatenate([a.ravel(), b.ravel()]) for a, b in parts)

    @cached_property
    def _whole(self) -> tuple[np.ndarray, ...]:
        """Nodes, weights with tau, and T at the nodes of all panels of both sides, and the panels' edges."""
        edges = np.concatenate([-self.edges[-1.0][:0:-1], self.edges[1.0]])
        half = 0.5 * np.diff(edges)[:, None]
        x = edges[:-1, None] + half * (1.0 + NODES)
        return x, half * WEIGHTS * self.prestress(x), self.arrival(x), edges

    def reached(self, time: float, sign: float) -> float:
        """How far from x = 0 the front on one side (+1 right, -1 left) is at a time."""
        last = float(self.edges[sign][-1])
        if time >= self.times[sign][-1]:
            raise ValueError(
                f"time: {time!r}; allowed: < {self.times[sign][-1]:g}, when the fronts were asked for"
            )
        return float(root_between(lambda x: self.arrival_at(sign * x) - time, 0.0, last, xtol=1e-13))

    def cone(self, y: float, time: float) -> tuple[float, float]:
        """The entry points x_l < x_r of the characteristics through (y, time): |x - y| = time - T(x)."""
        out = []
        for sign in (-1.0, 1.0):
            last = float(self.edges[sign][-1])

            def late(x: float, s: float = sign) -> float:
                return time - self.arrival_at(x) - s * (x - y)

            # From y itself when it has slipped, or from x = 0.
            start = y
            end = sign * last
            if late(end) >= 0.0:
                raise ValueError(
                    f"time: {time!r}; allowed: earlier, the cone leaves the part that outruns the waves"
                )
            out.append(root_between(late, start, end, xtol=1e-13))
        return out[0], out[1]


def _panels(prestress: Prestress, sign: float, reach: float) -> np.ndarray:
    """Edges of quadrature panels from 0 to reach: fine where the profile varies, at every step of it."""
    step = prestress.width / PANELS_PER_WIDTH
    inner = min(reach, 12.0 * prestress.width)
    pieces = [np.linspace(0.0, inner, max(8, int(np.ceil(inner / step))) + 1)]
    if reach > inner:
        coarse = max(step, min(0.25, reach / 64.0))
        pieces.append(np.linspace(inner, reach, int(np.ceil((reach - inner) / coarse)) + 1)[1:])
    for centre, _, width in prestress.bumps:
        near = sign * centre + width * np.linspace(-10.0, 10.0, 20 * PANELS_PER_WIDTH + 1)
        pieces.append(near[(near > 0.0) & (near < reach)])
    pieces.append(np.array([abs(p) for p, _ in prestress.steps if sign * p > 0.0 and abs(p) < reach]))
    return np.unique(np.concatenate(pieces))


@dataclass(frozen=True)
class ExactTransition:
    """When and where the first block sticks (Gamma = 1) and how far apart the fronts are then."""

    time: float
    length: float


def slip_velocity(fronts: Fronts, gamma: float, y: float, time: float) -> float:
    """du/dt at one point behind the fronts and before the transition.

    Parameters
    ----------
    fronts : the fronts of the scene
    gamma : elasticity ratio; 0 under a stress boundary
    y, time : the point; 0 where no front has been

    Raises
    ------
    ValueError
        If the point's past leaves the part of the fronts that outruns the waves.

    Source: Riemann's solution (module docstring).
    """
    arrived = fronts.arrival_at(y)
    if not arrived < time:
        return 0.0
    left, right = fronts.cone(y, time)
    if gamma == 0.0:
        return 0.5 * fronts.prestress.integral(left, right)
    # Slow to load, and not needed under a stress boundary.
    from scipy.special import j0

    x, weight, entered = fronts.quadrature(left, right)
    interval = np.maximum((time - entered) ** 2 - (x - y) ** 2, 0.0)
    return float(0.5 * np.sum(weight * j0(np.sqrt(gamma * interval))))


def exact_transition_displacement(
    prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> ExactTransition:
    """T_trans and L_trans of a symmetric scene under a displacement boundary, in the continuum limit.

    Parameters
    ----------
    prestress : a symmetric profile, tau(0) = 1, positive everywhere
    gamma : elasticity ratio, > 0
    damping_ratio : beta/dx, >= 0
    release : "total" or "elastic"

    Raises
    ------
    ValueError
        If the profile is not symmetric and positive, or nucleates elsewhere too.

    Source: the first zero of du/dt at x = 0 (module docstring); symmetric scenes stick there first.
    """
    check_number("gamma", gamma, above=0.0)
    if not prestress.symmetric or float(prestress.level(np.asarray(1e300))) <= 0.0:
        raise ValueError("prestress: not symmetric and positive; allowed: equal levels > 0 on both sides")
    period = np.pi / np.sqrt(gamma)
    # The cone of (0, t) enters at x + T(x) = t, so x < t; the fronts run at most v t.
    tau0 = float(prestress.level(np.asarray(1e300)))
    fronts = Fronts(prestress, damping_ratio, release, 2.5 * period)

    def velocity(time: float) -> float:
        return slip_velocity(fronts, gamma, 0.0, time)

    # Slip velocity swings no faster than the leaf springs: steps of a tenth of their half period miss no zero.
    times = np.linspace(0.0, 2.0 * period, 21)[1:]
    before = times[0]
    for time in times[1:]:
        if velocity(time) <= 0.0:
            break
        before = time
    stick = float(root_between(velocity, before, time, xtol=1e-12))
    speed = float(front_speed(tau0, damping_ratio, release))
    reach = Fronts(prestress, damping_ratio, release, speed * stick + 20.0 * prestress.width)
    return ExactTransition(stick, 2.0 * reach.reached(stick, 1.0))


class ArrestingCrack:
    """Gamma = 0, tau = 0 far to the right and negative far to the left: the crack whose left front slows for ever.

    du/dt - du/dx grows by tau along x - t = const and du/dt + du/dx by tau along x + t = const, both from 0 where a
    front outruns the waves. Where tau < 0 the left front is slower than the waves and, with no fracture energy, slip,
    slip velocity and strain vanish there. So a characteristic that entered at e ends on the left front at X with

        Int_X^e tau dx = 0,   t = e + T(e) - X,

    and X -> x_minus only as e -> infinity: the left front never arrives, and the arrest time is infinite.

    Parameters
    ----------
    prestress : a profile, tau(0) = 1, level 0 far to the right and negative far to the left
    damping_ratio : beta/dx, >= 0
    release : "total" or "elastic"

    Raises
    ------
    ValueError
        If the levels are otherwise.
    """

    def __init__(self, prestress: Prestress, damping_ratio: float = 0.0, release: str = "total") -> None:
        self.balance_position = prestress_balance_position(prestress)
        self.prestress = prestress
        # Beyond this the profile is 0 to rounding and the right front runs at the wave speed.
        self.far = 12.0 * prestress.width
        self.fronts = Fronts(prestress, damping_ratio, release, 4.0 * self.far)
        self.zero = -float(self.fronts.ends[-1.0])

    def entry_for(self, position: float) -> float:
        """Entry point e of the characteristic that ends on the slow left front at a position between x_minus and x*."""
        return float(
            root_between(
                lambda e: self.prestress.integral(position, e), self.zero, 4.0 * self.far - 1e-9, xtol=1e-13
            )
        )

    def time_at(self, position: float) -> float:
        """When the left front reaches a position in (x_minus, 0]."""
        if position >= self.zero:
            return self.fronts.arrival_at(position)
        entry = self.entry_for(position)
        return entry + self.fronts.arrival_at(entry) - position

    def share_time(self, share: float) -> float:
        """When the left front has covered a share of |x_minus|, in (0, 1)."""
        check_number("share", share, above=0.0, below=1.0)
        return self.time_at(share * self.balance_position)

    def share_length(self, share: float) -> float:
        """Distance between the fronts then."""
        time = self.share_time(share)
        if time >= self.fronts.times[1.0][-1]:
            right = float(self.fronts.edges[1.0][-1]) + time - float(self.fronts.times[1.0][-1])
        else:
            right = self.fronts.reached(time, 1.0)
        return right - share * self.balance_position

    @property
    def peak_velocity(self) -> float:
        """Largest slip velocity of the far-field pulse: half the integral of tau to the right of its zero x*."""
        return 0.5 * self.prestress.integral(self.zero, 4.0 * self.far)

    def far_pulse(self, count: int = 400) -> tuple[np.ndarray, np.ndarray]:
        """The pulse far to the right: x - t of each characteristic and du/dt on it, from the front backwards."""
        right = np.linspace(4.0 * self.far * 0.5, 0.0, count)
        left = np.linspace(0.0, self.zero, count)[1:]
        entries = np.concatenate([right, left])
        delay = entries - self.fronts.arrival(entries)
        # Crowded towards x_minus, which takes for ever.
        share = 1.0 - np.geomspace(1.0, 1e-9, count)[1:]
        slow = self.zero + (self.balance_position - self.zero) * share
        slow_delay = np.array([x - self.time_at(x) for x in slow])
        positions = np.concatenate([entries, slow])
        velocity = np.array([0.5 * self.prestress.integral(x, 4.0 * self.far) for x in positions])
        return np.concatenate([delay, slow_delay]), velocity
