"""Steady ruptures under other laws of friction: the slip U(xi) behind a front of speed v.

Positions are xi = x - v t, which is 0 at the front and negative behind it.

Friction that weakens linearly with slip, down to 0 at the slip d_c (`weakening_pulse`): in the
damped continuum

    beta v U''' + (v^2 - 1) U'' + gamma U = tau_0 - max(0, 1 - U/d_c)

with U = U' = U'' = 0 at the front, since damping keeps slip velocity and its slope continuous.
Where the pulse sticks, U' = U'' = 0 too. For U below d_c, and for U above it, the equation is
linear, and U is a sum of three exponentials. One of them grows with the distance from the front.
The front speed is the one at which the pulse sticks. If no pulse sticks, it is the speed at which
the growing exponential is absent.

Friction f(V) that depends on the slip velocity V = -v U' (`rate_pulse`): it is 0 at rest, so that
it does not change the front speed. In the limit dx -> 0 at fixed beta/dx

    (v^2 - 1) U'' + gamma U = tau_0 - f(V),   U(0) = U'(0) = 0.
"""

import math
from dataclasses import dataclass
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from ..model.balance import root_to_last_bit
from ..model.checks import check_number, short_repr
from ..model.friction_laws.law import Friction
from ..model.roots import root_between
from .domains import check_domains
from .front_speeds import front_speed

# Under slip weakening, the front speed is searched between these.
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
# If friction depends on slip velocity, a steady rupture that has not stuck within this number of
# half-periods of the leaf springs creeps on for ever.
MAX_HALF_PERIODS = 12.0
# Number of integration steps in each half-period, which is large enough not to miss a stick.
STEPS_PER_HALF_PERIOD = 100
# The most evaluations of a friction law, which take 5 s. A stiff law with weak leaf springs would
# need more.
MAX_EVALUATIONS = 10**6


@dataclass(frozen=True)
class SteadyRupture:
    """Steady rupture under a law of friction: speed (wave speeds), width (H), and slip (U).

    A rupture that does not stick is a crack with a decaying tail, of infinite width. Its slip tends
    to tau_0/gamma. peak_velocity, the largest slip velocity, is known only for `rate_pulse`, and
    otherwise NaN.
    """

    speed: float
    width: float
    slip: float
    peak_velocity: float = math.nan

    @property
    def sticks(self) -> bool:
        """True for a pulse, False for a crack with a decaying tail."""
        return math.isfinite(self.width)


class _VelocityMinimum(NamedTuple):
    """The first minimum of slip velocity behind its peak.

    bracket has the positions of the two samples around it, the one nearer to the front first; it is
    empty if there is no minimum.
    stops_before is True if the slip stops before the minimum.
    """

    bracket: np.ndarray
    stops_before: bool


class _LinearSlip:
    """Slip U(xi), xi <= 0, that solves a linear equation: a sum of exponentials."""

    def __init__(
        self, damping: float, inertia: float, stiffness: float, load: float, start: np.ndarray
    ) -> None:
        """Solve damping U''' + inertia U'' + stiffness U = load; start has U, U', U'' at xi = 0.

        U is the static slip, load/stiffness, and a sum of three terms amplitude exp(exponent xi).
        """
        # Exponents with a negative real part come first: they grow with the distance from xi = 0.
        self.exponents = np.sort_complex(np.roots([damping, inertia, 0.0, stiffness]))
        self.static_slip = load / stiffness
        # The n-th derivative of a term at xi = 0 is its amplitude times the n-th power of its
        # exponent. Row n has these powers.
        powers = np.vander(self.exponents, 3, increasing=True).T
        self.amplitudes = np.linalg.solve(powers, start - np.array([self.static_slip, 0.0, 0.0]))

    def evaluate(self, xi: float | np.ndarray, derivative: int = 0) -> np.ndarray:
        """Return U, or its first or second derivative by xi, at xi <= 0."""
        factors = self.amplitudes * self.exponents**derivative
        with np.errstate(over="ignore", invalid="ignore"):
            terms = factors * np.exp(np.multiply.outer(xi, self.exponents))
        return terms.sum(axis=-1).real + (self.static_slip if derivative == 0 else 0.0)

    def samples(self) -> np.ndarray:
        """Return positions behind xi = 0, dense enough to resolve each exponential."""
        rates = np.abs(self.exponents)
        nearest, farthest = MIN_SAMPLE_DISTANCE / rates.max(), MAX_SAMPLE_DISTANCE / rates.min()
        count = math.log(farthest / nearest) / math.log(SAMPLE_FACTOR)
        return -nearest * SAMPLE_FACTOR ** np.arange(count)

    def first_velocity_minimum(self) -> _VelocityMinimum:
        """Return the first minimum of slip velocity behind its peak, from samples.

        Slip velocity is -v U', where v is the front speed. So it decreases with the distance from
        the front where U'' < 0, and the slip has stopped where U' >= 0.
        """
        xi = self.samples()
        curvature = self.evaluate(xi, 2)
        # U'' changes from negative to positive between a sample and the next one behind it.
        minima = np.flatnonzero((curvature[:-1] < 0.0) & (curvature[1:] >= 0.0))
        # The sample before the minimum. Without a minimum it is beyond the last sample, so that the
        # bracket is empty.
        first = minima[0] if minima.size else xi.size
        has_stopped = self.evaluate(xi, 1) >= 0.0
        return _VelocityMinimum(
            bracket=xi[first : first + 2], stops_before=bool(has_stopped[: first + 1].any())
        )

    def creeps_forever(self) -> bool:
        """Return True if the slip approaches the static slip from below, without end.

        The slip does so under three conditions: no exponential grows with the distance from the
        front or oscillates, and the one that decays most slowly is negative.
        """
        # Of the exponentials, the first one grows, and the second one decays most slowly.
        growing, *decaying = np.abs(self.amplitudes)
        grows = growing > ABSENT_FRACTION * max(decaying)
        oscillates = bool(self.exponents[1:].imag.any())
        overshoots = self.amplitudes[1].real >= 0.0
        return not (grows or oscillates or overshoots)


def _weakening_zone_and_slip_beyond(
    v: float, tau0: float, gamma: float, beta: float, weakening: float
) -> tuple[float, _LinearSlip]:
    """Return the end xi of the weakening zone behind a front of speed v, and the slip beyond it.

    In the zone friction falls; it ends where the slip reaches the weakening distance d_c. Positions
    xi of the slip beyond the zone are counted from this end. If the slip stops inside the zone, the
    end is NaN, and the slip is that in the zone.
    """
    damping, inertia = beta * v, (v - 1.0) * (v + 1.0)
    # Friction 1 - U/d_c adds -1/d_c to the stiffness and -1 to the load.
    slip_in_zone = _LinearSlip(
        damping=damping,
        inertia=inertia,
        stiffness=gamma - 1.0 / weakening,
        load=tau0 - 1.0,
        start=np.zeros(3),
    )
    xi = slip_in_zone.samples()
    is_beyond_zone = slip_in_zone.evaluate(xi) >= weakening
    first_beyond = int(np.argmax(is_beyond_zone))
    has_stopped = slip_in_zone.evaluate(xi, 1) >= 0.0
    if not is_beyond_zone[first_beyond] or has_stopped[:first_beyond].any():
        return math.nan, slip_in_zone

    def excess_slip(position: float) -> float:
        """Return the slip minus the weakening distance, which is 0 at the end of the zone."""
        return float(slip_in_zone.evaluate(position)) - weakening

    # The end of the zone is between the first sample beyond it and the sample before (or xi = 0).
    before = 0.0 if first_beyond == 0 else float(xi[first_beyond - 1])
    end = root_between(excess_slip, float(xi[first_beyond]), before)
    start = np.array([float(slip_in_zone.evaluate(end, order)) for order in range(3)])
    slip_beyond_zone = _LinearSlip(
        damping=damping, inertia=inertia, stiffness=gamma, load=tau0, start=start
    )
    return end, slip_beyond_zone


def weakening_pulse(tau0: float, gamma: float, beta: float, weakening: float) -> SteadyRupture:
    """Return the slowest steady rupture in uniform pre-stress under slip weakening and damping.

    Friction falls linearly with slip, from static to kinetic friction.

    Source: derived in the supplement, section on friction laws.
    Raises ValueError: outside the domain, or where no steady rupture has a speed of 0.05 to 50.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0
    beta : float, damping, > 0 (H times the wave speed)
    weakening : float, slip d_c (in units of U) during which friction falls from 1 to 0, > 0 and
        < 1/gamma

    Returns
    -------
    SteadyRupture : the slowest one, because there may be several

    Examples
    --------
    >>> round(weakening_pulse(0.8, 2 / 3, 0.05, 0.1).speed, 4)
    1.1079
    """
    check_domains(tau0=tau0, gamma=gamma)
    check_number("beta", beta, above=0.0)
    check_number("weakening", weakening, above=0.0, below=1.0 / gamma)
    tau0, gamma, beta, weakening = map(float, (tau0, gamma, beta, weakening))

    speed = _slowest_weakening_speed(tau0, gamma=gamma, beta=beta, weakening=weakening)
    zone_end, slip_beyond_zone = _weakening_zone_and_slip_beyond(
        speed, tau0=tau0, gamma=gamma, beta=beta, weakening=weakening
    )
    minimum = slip_beyond_zone.first_velocity_minimum()
    # In these two cases the rupture never sticks: the slip tends to tau_0/gamma and creeps on for
    # ever, or slip velocity has no minimum at which it could be 0.
    if slip_beyond_zone.creeps_forever() or not minimum.bracket.size:
        return SteadyRupture(speed=speed, width=math.inf, slip=tau0 / gamma)
    # The pulse sticks at the minimum of slip velocity, where U'' = 0. At the speed of the steady
    # rupture, slip velocity is 0 there too. The bracket has a sample on each side of the minimum.
    nearer, farther = minimum.bracket.tolist()
    stick = root_between(lambda xi: float(slip_beyond_zone.evaluate(xi, 2)), farther, nearer)
    final_slip = float(slip_beyond_zone.evaluate(stick))
    # Both positions are negative: the end of the zone in which friction weakens, and the stick as
    # seen from there.
    return SteadyRupture(speed=speed, width=-(zone_end + stick), slip=final_slip)


def _slowest_weakening_speed(tau0: float, gamma: float, beta: float, weakening: float) -> float:
    """Return the speed of the slowest steady rupture under slip weakening (`weakening_pulse`)."""

    def sign_of_speed_error(v: float) -> float:
        """Return 1 if the speed v is too high for a steady rupture, and -1 if it is too low.

        If it is too low, slip velocity falls to 0 before its first minimum. If it is too high, slip
        velocity is still above 0 at the minimum, and grows again farther behind the front.
        """
        zone_end, slip_beyond_zone = _weakening_zone_and_slip_beyond(
            v, tau0=tau0, gamma=gamma, beta=beta, weakening=weakening
        )
        if math.isnan(zone_end):
            # The slip stops inside the weakening zone, where friction still falls.
            return -1.0
        return -1.0 if slip_beyond_zone.first_velocity_minimum().stops_before else 1.0

    # The speed of the slowest rupture is between the first trial speed that is too high and the
    # trial speed before.
    upper = MIN_SPEED
    while upper < MAX_SPEED and sign_of_speed_error(upper) < 0.0:
        upper *= SPEED_FACTOR
    if not MIN_SPEED < upper < MAX_SPEED:
        values = f"{weakening:.4g}, at tau0 = {tau0:.4g}, gamma = {gamma:.4g}, beta = {beta:.4g}"
        allowed = f"values at which a steady rupture has a speed from {MIN_SPEED} to {MAX_SPEED}"
        raise ValueError(f"weakening: {values}; allowed: {allowed}")
    return root_to_last_bit(sign_of_speed_error, upper / SPEED_FACTOR, upper)


def undamped_weakening_slip(tau0: float, gamma: float, weakening: float) -> float:
    """Return the final slip of an undamped pulse on a lattice under slip weakening.

    weakening is the slip d_c during which friction falls from 1 to 0.
    Source: the energy tau_0 u - gamma u^2/2 that the layer releases by the slip u equals the
    fracture energy d_c/2.
    """
    return (tau0 + math.sqrt(tau0**2 - gamma * weakening)) / gamma


def rate_pulse(
    tau0: float, gamma: float, damping_ratio: float, friction: Friction
) -> SteadyRupture:
    """Return the steady pulse in uniform pre-stress under friction that depends on slip velocity.

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
    check_domains(tau0=tau0, gamma=gamma)
    if friction.friction(0.0, 0.0, *friction.kernel_parameters) != 0.0:
        allowed = "laws without friction at rest that depend on slip rate alone"
        raise ValueError(f"friction.law: {short_repr(friction.law)}; allowed: {allowed}")
    v = float(front_speed(tau0, damping_ratio))
    path = _integrate_behind_front(v, tau0=tau0, gamma=gamma, friction=friction)
    # The first event is the stick, and the second one a peak of slip velocity.
    _, states_at_peaks = path.y_events
    if not len(states_at_peaks):
        limit = f"{MAX_HALF_PERIODS:g} half-periods of the leaf springs"
        allowed = f"laws whose slip velocity has a peak within {limit}"
        raise ValueError(f"friction: {short_repr(friction.mapping())}; allowed: {allowed}")
    peak = v * max(float(strain_at_peak) for _, strain_at_peak in states_at_peaks)
    # The status is 1 if the integration ended at a terminal event.
    has_stuck = path.status == 1
    if not has_stuck:
        return SteadyRupture(speed=v, width=math.inf, slip=tau0 / gamma, peak_velocity=peak)
    # The last values of the independent variable, the distance, and of the state.
    width, (final_slip, _) = float(path.t[-1]), path.y[:, -1]
    return SteadyRupture(speed=v, width=width, slip=float(final_slip), peak_velocity=peak)


def _integrate_behind_front(v: float, tau0: float, gamma: float, friction: Friction) -> Any:
    """Return slip and strain behind a front of speed v, as the result of scipy's `solve_ivp`.

    The integration goes from the front backwards, and ends where the slip stops. Events of the
    result are this stop, and the peaks of slip velocity. Strain here is the derivative of slip by
    the distance behind the front, so that slip velocity is v times the strain.
    """
    # This module is slow to import.
    from scipy.integrate import solve_ivp

    parameters = friction.kernel_parameters
    inertia = (v - 1.0) * (v + 1.0)
    half_period = math.pi * math.sqrt(inertia / gamma)
    evaluation_numbers = count()

    def slopes(distance: float, state: np.ndarray) -> list[float]:
        """Return the derivatives of slip and strain by the distance behind the front.

        That of the strain follows from inertia U'' + gamma U = tau_0 - friction, where inertia is
        v^2 - 1.
        """
        # The evaluations are counted, because a stiff law would take for ever.
        if next(evaluation_numbers) == MAX_EVALUATIONS:
            needed = f"the pulse needs more than {MAX_EVALUATIONS} evaluations of the friction law"
            allowed = "a larger gamma, or weaker friction"
            raise ValueError(f"gamma: {gamma!r}, where {needed}; allowed: {allowed}")
        slip, strain = state
        resistance = friction.friction(slip, v * strain, *parameters)
        return [strain, (tau0 - resistance - gamma * slip) / inertia]

    def stick_event(distance: float, state: np.ndarray) -> float:
        """Return the strain, which falls to 0 where the slip stops."""
        _, strain = state
        return strain

    def peak_event(distance: float, state: np.ndarray) -> float:
        """Return the derivative of the strain, which is 0 at the peak of slip velocity."""
        _, strain_slope = slopes(distance, state)
        return strain_slope

    stick_event.terminal, stick_event.direction = True, -1.0  # type: ignore[attr-defined]
    accuracy = {"rtol": 1e-10, "atol": 1e-12, "max_step": half_period / STEPS_PER_HALF_PERIOD}
    distances = (0.0, MAX_HALF_PERIODS * half_period)
    at_front = [0.0, 0.0]
    with np.errstate(over="ignore", invalid="ignore"):
        return solve_ivp(slopes, distances, at_front, events=[stick_event, peak_event], **accuracy)
