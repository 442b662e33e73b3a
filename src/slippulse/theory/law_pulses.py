"""Steady ruptures under other laws of friction: U(xi), xi = x - v t <= 0, behind a front.

Under friction that weakens linearly with slip, in the damped continuum, at speed v,

    beta v U''' + (v^2 - 1) U'' + gamma U = tau_0 - max(0, 1 - U/d_c)

with U = U' = U'' = 0 at the front: damping keeps slip velocity and its slope continuous. Where the
pulse sticks U' = U'' = 0 too. On either side of U = d_c the equation is linear, and U is a sum of
three exponentials. One of them grows behind the front; the speed is the one at which the pulse
sticks, or at which the growing exponential is absent.

Friction f(V) that depends on slip rate, V = -v U', is 0 at rest: a front does not feel it. In the
limit dx -> 0 at fixed beta/dx

    (v^2 - 1) U'' + gamma U = tau_0 - f(V),   U(0) = U'(0) = 0.
"""

import math
from dataclasses import dataclass
from itertools import count

import numpy as np

from ..model.balance import root_to_last_bit
from ..model.checks import check_number, short_repr
from ..model.friction_laws.law import Friction
from ..model.roots import root_between
from .domains import check_domains
from .front_speeds import front_speed

# Speeds between which that of the rupture is looked for.
SLOWEST, FASTEST = 0.05, 50.0
# Trial speeds on the way up from the slowest.
FASTER = 1.1
# Samples behind a front: from a fraction of the least length of the exponentials to a multiple of
# the longest, each farther than the last by this factor.
NEAREST, FARTHEST, FACTOR = 1e-2, 60.0, 1.01
# Below this fraction of the bounded exponentials the growing one is rounding.
ABSENT = 1e-6
# Half-periods of leaf springs in which slip under laws of slip rate must stop, or it creeps, and
# steps in each of them, so that no stop is missed.
HALF_PERIODS, STEPS = 12.0, 100
# The most evaluations of the slopes: they take 5 s. A law that is stiff beside weak leaf springs
# would need more.
MOST_EVALUATIONS = 10**6


@dataclass(frozen=True)
class SteadyRupture:
    """Steady rupture under a law of friction: speed (wave speeds), width (H), and slip (U).

    One that does not stick is a crack with a decaying tail, of infinite width and slip tau_0/gamma.
    `rate_pulse` alone finds the largest slip velocity.
    """

    speed: float
    width: float
    slip: float
    peak_velocity: float = math.nan

    @property
    def sticks(self) -> bool:
        """True for a pulse."""
        return math.isfinite(self.width)


class _Exponentials:
    """Solution of b U''' + inertia U'' + stiffness U = load, by U, U', U'' at xi = 0."""

    def __init__(self, b: float, inertia: float, stiffness: float, load: float, start: np.ndarray):
        self.exponents = np.sort_complex(np.roots([b, inertia, 0.0, stiffness]))
        self.rest = load / stiffness
        powers = np.vander(self.exponents, 3, increasing=True).T
        self.sizes = np.linalg.solve(powers, start - np.array([self.rest, 0.0, 0.0]))

    def at(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """U or a derivative of it at xi <= 0."""
        factors = self.sizes * self.exponents**derivative
        with np.errstate(over="ignore", invalid="ignore"):
            terms = factors * np.exp(np.multiply.outer(xi, self.exponents))
        return terms.sum(axis=-1).real + (self.rest if derivative == 0 else 0.0)

    def samples(self) -> np.ndarray:
        """Positions behind xi = 0 that resolve the first turns of each exponential."""
        rates = np.abs(self.exponents)
        nearest, farthest = NEAREST / rates.max(), FARTHEST / rates.min()
        return -nearest * FACTOR ** np.arange(math.log(farthest / nearest) / math.log(FACTOR))

    def first_turn(self) -> tuple[np.ndarray, bool]:
        """Samples around where slip velocity turns behind its peak; True if it stops before."""
        xi = self.samples()
        falls = self.at(xi, 2) < 0.0
        turns = np.flatnonzero(falls[:-1] & (self.at(xi, 2) >= 0.0)[1:])
        turn = turns[0] if turns.size else xi.size
        return xi[turn : turn + 2], bool((self.at(xi, 1) >= 0.0)[: turn + 1].any())

    def creeps(self) -> bool:
        """Tell if slip goes on for ever: no growing exponential, oscillation or overshoot."""
        growing = abs(self.sizes[0]) > ABSENT * np.abs(self.sizes[1:]).max()
        return bool(self.sizes[1].real < 0.0 and not growing and not self.exponents[1:].imag.any())


def _tail(
    v: float, tau0: float, gamma: float, beta: float, weakening: float
) -> tuple[float, _Exponentials]:
    """End of the weakening zone, NaN where the slip stops in it, and U from there."""
    b, inertia = beta * v, (v - 1.0) * (v + 1.0)
    zone = _Exponentials(b, inertia, gamma - 1.0 / weakening, tau0 - 1.0, np.zeros(3))
    xi = zone.samples()
    weak = zone.at(xi) >= weakening
    first = int(np.argmax(weak))
    if not weak[first] or (zone.at(xi, 1) >= 0.0)[:first].any():
        return math.nan, zone
    before = 0.0 if first == 0 else float(xi[first - 1])
    end = root_between(lambda x: float(zone.at(x)) - weakening, float(xi[first]), before)
    start = np.array([float(zone.at(end, n)) for n in range(3)])
    return end, _Exponentials(b, inertia, gamma, tau0, start)


def weakening_pulse(tau0: float, gamma: float, beta: float, weakening: float) -> SteadyRupture:
    """The slowest steady rupture in uniform pre-stress under slip weakening and damping.

    Source: derived in the supplement, section on friction laws.
    Raises ValueError: outside the domain, or where no steady rupture has a speed of 0.05 to 50.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0
    beta : float, damping, > 0 (H times the wave speed)
    weakening : float, slip d_c over which friction falls from 1 to 0 (U), > 0 and < 1/gamma

    Returns
    -------
    SteadyRupture : the slowest one, for roots of the conditions need not be unique

    Examples
    --------
    >>> round(weakening_pulse(0.8, 2 / 3, 0.05, 0.1).speed, 4)
    1.1079
    """
    check_domains(tau0=tau0, gamma=gamma)
    check_number("beta", beta, above=0.0)
    check_number("weakening", weakening, above=0.0, below=1.0 / gamma)
    tau0, gamma, beta, weakening = map(float, (tau0, gamma, beta, weakening))

    def too_fast(v: float) -> float:
        end, tail = _tail(v, tau0, gamma, beta, weakening)
        return -1.0 if math.isnan(end) or tail.first_turn()[1] else 1.0

    upper = SLOWEST
    while upper < FASTEST and too_fast(upper) < 0.0:
        upper *= FASTER
    if not SLOWEST < upper < FASTEST:
        numbers = f"{weakening:.4g}, at tau0 = {tau0:.4g}, gamma = {gamma:.4g}, beta = {beta:.4g}"
        allowed = f"numbers with a steady rupture of a speed from {SLOWEST} to {FASTEST}"
        raise ValueError(f"weakening: {numbers}; allowed: {allowed}")
    speed = root_to_last_bit(too_fast, upper / FASTER, upper)
    zone_end, tail = _tail(speed, tau0, gamma, beta, weakening)
    turn, _ = tail.first_turn()
    if tail.creeps() or not turn.size:
        return SteadyRupture(speed, math.inf, tau0 / gamma)
    stick = root_between(lambda x: float(tail.at(x, 2)), float(turn[1]), float(turn[0]))
    return SteadyRupture(speed, -(zone_end + stick), float(tail.at(stick)))


def undamped_weakening_slip(tau0: float, gamma: float, weakening: float) -> float:
    """Final slip of an undamped pulse on a lattice: it releases its fracture energy d_c/2.

    Source: the layer releases tau_0 u - gamma u^2/2.
    """
    return (tau0 + math.sqrt(tau0**2 - gamma * weakening)) / gamma


def rate_pulse(
    tau0: float, gamma: float, damping_ratio: float, friction: Friction
) -> SteadyRupture:
    """Steady pulse in uniform pre-stress under friction that depends on slip rate alone.

    Source: derived in the supplement, section on friction that depends on slip rate.
    Raises ValueError: outside the domain, where slip velocity grows without bound, or where the
    pulse takes more than 1e6 evaluations of the law.

    Parameters
    ----------
    tau0, gamma, damping_ratio : floats, pre-stress, in (0, 1), gamma > 0, and beta/dx, >= 0
    friction : Friction, a law that is 0 at rest and does not depend on slip

    Returns
    -------
    SteadyRupture : of infinite width and slip tau_0/gamma where slip creeps on

    Examples
    --------
    >>> law = sp.friction("bounded_rate", limit=0.3, v_0=1.0)
    >>> round(rate_pulse(0.5, 2 / 3, 0.1, law).slip, 4)
    1.1605
    """
    # Slow to load.
    from scipy.integrate import solve_ivp

    check_domains(tau0=tau0, gamma=gamma)
    parameters = friction.kernel_parameters
    if friction.friction(0.0, 0.0, *parameters) != 0.0:
        allowed = "laws that depend on slip rate alone"
        raise ValueError(f"friction.law: {short_repr(friction.law)}; allowed: {allowed}")
    v = float(front_speed(tau0, damping_ratio))
    inertia = (v - 1.0) * (v + 1.0)
    half_period = math.pi * math.sqrt(inertia / gamma)

    evaluations = count()

    def slopes(distance: float, state: np.ndarray) -> list[float]:
        if next(evaluations) == MOST_EVALUATIONS:
            place = f"{gamma!r}, where the pulse is not found in {MOST_EVALUATIONS} evaluations"
            raise ValueError(f"gamma: {place}; allowed: larger numbers, or weaker friction")
        slip, strain = state
        resistance = friction.friction(slip, v * strain, *parameters)
        return [strain, (tau0 - resistance - gamma * slip) / inertia]

    def strain(distance: float, state: np.ndarray) -> float:
        return state[1]

    def curvature(distance: float, state: np.ndarray) -> float:
        return slopes(distance, state)[1]

    strain.terminal, strain.direction = True, -1.0  # type: ignore[attr-defined]
    accuracy = {"rtol": 1e-10, "atol": 1e-12, "max_step": half_period / STEPS}
    span = (0.0, HALF_PERIODS * half_period)
    with np.errstate(over="ignore", invalid="ignore"):
        path = solve_ivp(slopes, span, [0.0, 0.0], events=[strain, curvature], **accuracy)
    if not len(path.y_events[1]):
        allowed = f"laws whose slip velocity has a peak within {HALF_PERIODS:g} half-periods"
        raise ValueError(f"friction: {short_repr(friction.mapping())}; allowed: {allowed}")
    peak = v * max(float(state[1]) for state in path.y_events[1])
    if path.status != 1:
        return SteadyRupture(v, math.inf, tau0 / gamma, peak)
    return SteadyRupture(v, float(path.t[-1]), float(path.y[0, -1]), peak)
