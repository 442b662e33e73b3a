"""Steady ruptures under other laws of friction: U(xi), xi = x - v t <= 0, behind a front.

Friction that weakens linearly with slip (`weakening_pulse`): in the damped continuum, at speed v,

    beta v U''' + (v^2 - 1) U'' + gamma U = tau_0 - max(0, 1 - U/d_c)

with U = U' = U'' = 0 at the front, since damping keeps slip velocity and its slope continuous.
Where the pulse sticks, U' = U'' = 0 too. For U below d_c, and for U above it, the equation is
linear, and U is a sum of three exponentials. One of them grows behind the front. The speed is the
one at which the pulse sticks, or, if it does not stick, at which the growing exponential is absent.

Friction f(V) that depends on slip rate V = -v U' (`rate_pulse`): it is 0 at rest, so that a front
does not feel it. In the limit dx -> 0 at fixed beta/dx

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

# The speed of a rupture is searched between these.
MIN_SPEED, MAX_SPEED = 0.05, 50.0
# Ratio of successive trial speeds from the lowest one upwards.
SPEED_FACTOR = 1.1
# The nearest sample behind a front, as a fraction of the shortest length of the exponentials.
MIN_SAMPLE_DISTANCE = 1e-2
# The farthest sample, as a multiple of the longest length of the exponentials.
MAX_SAMPLE_DISTANCE = 60.0
# Ratio of successive sample distances.
SAMPLE_FACTOR = 1.01
# The growing exponential is absent if its amplitude is below this fraction of the others.
ABSENT_FRACTION = 1e-6
# Under laws of slip rate, slip that has not stopped within this number of half-periods of leaf
# springs creeps on.
MAX_HALF_PERIODS = 12.0
# Number of steps in each half-period, which is large enough not to miss a stop.
STEPS_PER_HALF_PERIOD = 100
# The most evaluations of the slopes, which take 5 s. A stiff law with weak leaf springs would need
# more.
MAX_EVALUATIONS = 10**6


@dataclass(frozen=True)
class SteadyRupture:
    """Steady rupture under a law of friction: speed (wave speeds), width (H), and slip (U).

    A rupture that does not stick is a crack with a decaying tail, of infinite width and slip
    tau_0/gamma. The largest slip velocity is NaN except for `rate_pulse`.
    """

    speed: float
    width: float
    slip: float
    peak_velocity: float = math.nan

    @property
    def sticks(self) -> bool:
        """True for a pulse, False for a crack with a decaying tail."""
        return math.isfinite(self.width)


class _Exponentials:
    """Solution of b U''' + inertia U'' + stiffness U = load, given U, U' and U'' at xi = 0."""

    def __init__(self, b: float, inertia: float, stiffness: float, load: float, start: np.ndarray):
        self.exponents = np.sort_complex(np.roots([b, inertia, 0.0, stiffness]))
        self.static_slip = load / stiffness
        powers = np.vander(self.exponents, 3, increasing=True).T
        self.amplitudes = np.linalg.solve(powers, start - np.array([self.static_slip, 0.0, 0.0]))

    def at(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """Return U, or a derivative of it, at xi <= 0."""
        factors = self.amplitudes * self.exponents**derivative
        with np.errstate(over="ignore", invalid="ignore"):
            terms = factors * np.exp(np.multiply.outer(xi, self.exponents))
        return terms.sum(axis=-1).real + (self.static_slip if derivative == 0 else 0.0)

    def samples(self) -> np.ndarray:
        """Return positions behind xi = 0 that resolve the first turns of each exponential."""
        rates = np.abs(self.exponents)
        nearest, farthest = MIN_SAMPLE_DISTANCE / rates.max(), MAX_SAMPLE_DISTANCE / rates.min()
        count = math.log(farthest / nearest) / math.log(SAMPLE_FACTOR)
        return -nearest * SAMPLE_FACTOR ** np.arange(count)

    def first_turn(self) -> tuple[np.ndarray, bool]:
        """Return the two samples around the first minimum of slip velocity behind its peak.

        They are empty if there is no minimum. The flag is True if the slip stops before it. Slip
        velocity is -v U', so that it falls, going back from the front, where U'' < 0, and the slip
        stops where U' >= 0.
        """
        xi = self.samples()
        curvature = self.at(xi, 2)
        is_minimum = (curvature < 0.0)[:-1] & (curvature >= 0.0)[1:]
        minima = np.flatnonzero(is_minimum)
        turn = minima[0] if minima.size else xi.size
        has_stopped = self.at(xi, 1) >= 0.0
        return xi[turn : turn + 2], bool(has_stopped[: turn + 1].any())

    def creeps_forever(self) -> bool:
        """Return True if slip goes on for ever.

        This is so without a growing exponential, oscillation or overshoot. The first exponential
        grows behind the front. The second one decays most slowly, and a negative amplitude means
        that slip approaches its end from below.
        """
        growing, *decaying = np.abs(self.amplitudes)
        is_growing_absent = growing <= ABSENT_FRACTION * max(decaying)
        oscillates = bool(self.exponents[1:].imag.any())
        overshoots = self.amplitudes[1].real >= 0.0
        return bool(is_growing_absent and not oscillates and not overshoots)


def _zone_and_tail(
    v: float, tau0: float, gamma: float, beta: float, weakening: float
) -> tuple[float, _Exponentials]:
    """Return the end xi of the weakening zone behind a front at speed v, and the slip U beyond it.

    xi of the slip U is counted from the end of the zone. The end is NaN if the slip stops inside
    the zone.
    """
    b, inertia = beta * v, (v - 1.0) * (v + 1.0)
    zone = _Exponentials(
        b=b, inertia=inertia, stiffness=gamma - 1.0 / weakening, load=tau0 - 1.0, start=np.zeros(3)
    )
    xi = zone.samples()
    is_weak = zone.at(xi) >= weakening
    first_weak = int(np.argmax(is_weak))
    has_stopped = zone.at(xi, 1) >= 0.0
    if not is_weak[first_weak] or has_stopped[:first_weak].any():
        return math.nan, zone
    # The end of the zone is between the first sample beyond it and the sample before (or xi = 0).
    before = 0.0 if first_weak == 0 else float(xi[first_weak - 1])
    end = root_between(lambda x: float(zone.at(x)) - weakening, float(xi[first_weak]), before)
    start = np.array([float(zone.at(end, n)) for n in range(3)])
    return end, _Exponentials(b=b, inertia=inertia, stiffness=gamma, load=tau0, start=start)


def weakening_pulse(tau0: float, gamma: float, beta: float, weakening: float) -> SteadyRupture:
    """Return the slowest steady rupture in uniform pre-stress under slip weakening and damping.

    Source: derived in the supplement, section on friction laws.
    Raises ValueError: outside the domain, or where no steady rupture has a speed of 0.05 to 50.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0
    beta : float, damping, > 0 (H times the wave speed)
    weakening : float, slip d_c during which friction falls from 1 to 0 (U), > 0 and < 1/gamma

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
        """Return 1 if v is above the speed of the rupture, -1 if not.

        At a lower speed the slip stops before the first minimum of slip velocity.
        """
        end, tail = _zone_and_tail(v, tau0=tau0, gamma=gamma, beta=beta, weakening=weakening)
        if math.isnan(end):
            return -1.0
        _, stops = tail.first_turn()
        return -1.0 if stops else 1.0

    # The slowest rupture is between the first trial speed that is too fast and the one before.
    upper = MIN_SPEED
    while upper < MAX_SPEED and too_fast(upper) < 0.0:
        upper *= SPEED_FACTOR
    if not MIN_SPEED < upper < MAX_SPEED:
        values = f"{weakening:.4g}, at tau0 = {tau0:.4g}, gamma = {gamma:.4g}, beta = {beta:.4g}"
        allowed = f"values with a steady rupture of a speed from {MIN_SPEED} to {MAX_SPEED}"
        raise ValueError(f"weakening: {values}; allowed: {allowed}")
    speed = root_to_last_bit(too_fast, upper / SPEED_FACTOR, upper)
    zone_end, tail = _zone_and_tail(speed, tau0=tau0, gamma=gamma, beta=beta, weakening=weakening)
    turn, _ = tail.first_turn()
    if tail.creeps_forever() or not turn.size:
        return SteadyRupture(speed=speed, width=math.inf, slip=tau0 / gamma)
    # The pulse sticks where U' = U'' = 0. At this speed, U' is 0 where U'' is.
    nearer, farther = turn.tolist()
    stick = root_between(lambda xi: float(tail.at(xi, 2)), farther, nearer)
    return SteadyRupture(speed=speed, width=-(zone_end + stick), slip=float(tail.at(stick)))


def undamped_weakening_slip(tau0: float, gamma: float, weakening: float) -> float:
    """Return the final slip of an undamped pulse on a lattice under slip weakening.

    Source: the energy tau_0 u - gamma u^2/2 that the layer releases by the slip u equals the
    fracture energy d_c/2.
    """
    return (tau0 + math.sqrt(tau0**2 - gamma * weakening)) / gamma


def rate_pulse(
    tau0: float, gamma: float, damping_ratio: float, friction: Friction
) -> SteadyRupture:
    """Return the steady pulse in uniform pre-stress under friction that depends on slip rate.

    Source: derived in the supplement, section on friction that depends on slip rate.
    Raises ValueError: outside the domain, if slip velocity grows without bound, or if the pulse
    needs more than 1e6 evaluations of the law.

    Parameters
    ----------
    tau0, gamma, damping_ratio : floats, pre-stress, in (0, 1), gamma > 0, and beta/dx, >= 0
    friction : Friction, a law that is 0 at rest and does not depend on slip

    Returns
    -------
    SteadyRupture : with infinite width and slip tau_0/gamma if slip creeps on

    Examples
    --------
    >>> law = sp.friction("bounded_rate", limit=0.3, v_0=1.0)
    >>> round(rate_pulse(0.5, 2 / 3, 0.1, law).slip, 4)
    1.1605
    """
    # This module is slow to import.
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
        """Return the derivatives of slip and strain by the distance behind the front."""
        if next(evaluations) == MAX_EVALUATIONS:
            place = f"{gamma!r}, where the pulse is not found in {MAX_EVALUATIONS} evaluations"
            raise ValueError(f"gamma: {place}; allowed: larger values, or weaker friction")
        slip, strain = state
        resistance = friction.friction(slip, v * strain, *parameters)
        return [strain, (tau0 - resistance - gamma * slip) / inertia]

    def stop_event(distance: float, state: np.ndarray) -> float:
        """Return the strain, which falls to 0 where the slip stops."""
        _, strain = state
        return strain

    def peak_event(distance: float, state: np.ndarray) -> float:
        """Return the derivative of the strain, which is 0 at the peak of slip velocity."""
        _, strain_slope = slopes(distance, state)
        return strain_slope

    # The integration ends at a stop.
    stop_event.terminal, stop_event.direction = True, -1.0  # type: ignore[attr-defined]
    accuracy = {"rtol": 1e-10, "atol": 1e-12, "max_step": half_period / STEPS_PER_HALF_PERIOD}
    span = (0.0, MAX_HALF_PERIODS * half_period)
    with np.errstate(over="ignore", invalid="ignore"):
        path = solve_ivp(slopes, span, [0.0, 0.0], events=[stop_event, peak_event], **accuracy)
    _, states_at_peaks = path.y_events
    if not len(states_at_peaks):
        allowed = f"laws whose slip velocity has a peak within {MAX_HALF_PERIODS:g} half-periods"
        raise ValueError(f"friction: {short_repr(friction.mapping())}; allowed: {allowed}")
    peak = v * max(float(strain_at_peak) for _, strain_at_peak in states_at_peaks)
    # The status is 1 if the integration ended at a terminal event.
    has_stopped = path.status == 1
    if not has_stopped:
        return SteadyRupture(speed=v, width=math.inf, slip=tau0 / gamma, peak_velocity=peak)
    final_slip, _ = path.y[:, -1]
    return SteadyRupture(
        speed=v, width=float(path.t[-1]), slip=float(final_slip), peak_velocity=peak
    )
