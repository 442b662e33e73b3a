"""The steady slip pulse in closed form, with damping, and the paper's estimates."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..model.balance import prestress_balance_position
from ..model.checks import as_numbers, check_number, check_that
from ..model.prestress import Prestress
from .domains import check_domains


class PulseProfile(NamedTuple):
    """Slip, slip velocity and slip acceleration of a pulse at some positions."""

    slip: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


@dataclass(frozen=True)
class SteadyPulse:
    """A steady pulse, in units of H and of the wave speed.

    In the frame of the front, a position is xi = x - v t: 0 at the front and negative behind it.
    The functions `steady_pulse` and `paper_pulse` return such a pulse.

    Parameters
    ----------
    tau0, gamma, beta, speed, rate_strengthening : floats, as in `steady_pulse`
    width : float, distance from the front to where the slip velocity returns to 0
    slip, stress_drop : floats, slip that remains behind the pulse, and gamma times this slip
    peak_velocity : float, largest slip velocity
    growth, wavenumber : floats, p and q, where slip velocity is proportional to
        exp(p xi) sin(q xi)
    """

    tau0: float
    gamma: float
    beta: float
    speed: float
    width: float
    slip: float
    peak_velocity: float
    stress_drop: float
    growth: float
    wavenumber: float
    rate_strengthening: float = 0.0

    @property
    def peak_position(self) -> float:
        """Position xi of the largest slip velocity, which is negative: it is behind the front."""
        # The derivative of exp(p xi) sin(q xi) is 0 where tan(q xi) = -q/p.
        return -float(np.arctan2(self.wavenumber, self.growth)) / self.wavenumber

    def profile(self, xi) -> PulseProfile:
        """Return slip, slip velocity and slip acceleration at positions.

        Ahead of the pulse the slip is 0, and behind the pulse it is the final slip. In both regions
        velocity and acceleration are 0.

        Parameters
        ----------
        xi : float or array, positions relative to the front (units of H)

        Returns
        -------
        PulseProfile : a tuple of arrays of the shape of xi
        """
        xi = as_numbers("xi", xi)
        p, q = self.growth, self.wavenumber
        is_behind = xi < -self.width
        is_in_pulse = (xi <= 0.0) & ~is_behind
        xi_in_pulse = np.where(is_in_pulse, xi, 0.0)
        sine, cosine = np.sin(q * xi_in_pulse), np.cos(q * xi_in_pulse)
        decay = np.exp(p * xi_in_pulse)
        # The slip oscillates around tau_0/gamma. At the front, xi = 0, slip and strain are 0.
        slip_in_pulse = self.tau0 / self.gamma * (1.0 - decay * (cosine - p / q * sine))
        slip = np.select([is_in_pulse, is_behind], [slip_in_pulse, self.slip])
        # The derivative by time is -v times the derivative by xi.
        amplitude = self.speed * self.tau0 * (p**2 + q**2) / (self.gamma * q)
        velocity = np.where(is_in_pulse, -amplitude * decay * sine, 0.0)
        acceleration_in_pulse = self.speed * amplitude * decay * (p * sine + q * cosine)
        acceleration = np.where(is_in_pulse, acceleration_in_pulse, 0.0)
        return PulseProfile(slip, velocity, acceleration)


@np.errstate(over="raise", invalid="raise", divide="raise")
def pulse_at_speed(
    tau0: float, gamma: float, beta: float, speed: float, rate_strengthening: float = 0.0
) -> SteadyPulse:
    """Return the steady pulse (`theory.steady_pulse`) behind a front of speed v.

    A position in the pulse is xi = x - v t. Slip and strain are 0 at the front, xi = 0, so that

        slip     = tau_0/gamma {1 - exp(p xi) [cos(q xi) - p/q sin(q xi)]},
        velocity = -v tau_0/gamma (p^2 + q^2)/q exp(p xi) sin(q xi).

    p and q follow from the equation of motion (`_growth_and_wavenumber`), in which alpha is the
    rate strengthening. The pulse ends where the velocity returns to 0, at xi = -pi/q. Raises
    ValueError if slip does not oscillate, or if a number overflows.
    """
    check_domains(tau0=tau0, gamma=gamma, beta=beta, rate_strengthening=rate_strengthening)
    check_number("speed", speed, above=1.0)
    tau0, gamma, beta = (float(number) for number in (tau0, gamma, beta))
    v, alpha = float(speed), float(rate_strengthening)
    try:
        p, q = _growth_and_wavenumber(v, gamma=gamma, beta=beta, alpha=alpha)
        width = float(np.pi / q)
        slip = float(tau0 / gamma * (1.0 + np.exp(-p * width)))
        # The largest slip velocity is at xi = -arctan2(q, p)/q, where sin(q xi) is -q/hypot(p, q).
        amplitude = v * tau0 * np.hypot(p, q) / gamma
        peak = float(amplitude * np.exp(-p / q * np.arctan2(q, p)))
        # Python's floats can overflow without an error.
        if not all(0.0 < number < math.inf for number in (width, slip, peak)):
            raise OverflowError
    except (ArithmeticError, ValueError):
        raise ValueError(_reason_for_no_pulse(gamma, v, alpha)) from None
    return SteadyPulse(
        tau0=tau0,
        gamma=gamma,
        beta=beta,
        speed=v,
        width=width,
        slip=slip,
        peak_velocity=peak,
        stress_drop=float(gamma * slip),
        growth=p,
        wavenumber=q,
        rate_strengthening=alpha,
    )


def _growth_and_wavenumber(
    v: float, gamma: float, beta: float, alpha: float
) -> tuple[float, float]:
    """Return p and q of the slip in a pulse, which oscillates as exp(p xi) cos(q xi).

    The equation of motion at the front speed v is

        beta v u''' + (v^2 - 1) u'' - alpha v u' + gamma u = tau_0.

    Its characteristic polynomial has the roots p +- i q, and a real one if beta > 0.
    """
    inertia = (v - 1.0) * (v + 1.0)
    if beta == 0.0:
        p = 0.5 * alpha * v / inertia
        return p, float(np.sqrt(gamma / inertia - p**2))
    roots = np.roots([beta * v, inertia, -alpha * v, gamma])
    root_above_axis = roots[np.argmax(roots.imag)]
    return float(root_above_axis.real), float(root_above_axis.imag)


def _reason_for_no_pulse(gamma: float, speed: float, rate_strengthening: float) -> str:
    """Return the error message for a pulse that cannot be computed.

    The message names the rate strengthening if its value may be too large, and the speed otherwise.
    """
    critical = critical_rate_strengthening(gamma, speed)
    # The critical value is exact without damping. Since damping changes it, rate strengthening is
    # named from half of this value on.
    if abs(rate_strengthening) > 0.5 * critical:
        refused = f"rate_strengthening: {rate_strengthening!r} at {gamma = :.6g}, {speed = :.6g}"
        allowed = f"less than {critical:.6g} in absolute value (if beta is 0)"
        return f"{refused}; allowed: {allowed}, since otherwise no pulse is steady"
    allowed = "values at which width, slip and velocities of the pulse are finite and not 0"
    return f"speed: {speed:.6g} at {gamma = :.6g}; allowed: {allowed}"


def critical_rate_strengthening(gamma: float, speed: float) -> float:
    """Return the rate strengthening alpha_c beyond which no pulse is steady.

    Friction that is linear in slip rate adds a term -alpha du/dt to the equation of motion. A
    steady pulse needs abs(alpha) < alpha_c = 2 sqrt(gamma) sqrt(1 - 1/v^2).
    Source: at alpha_c the pulse is infinitely wide (as beta -> 0). Behind an undamped front, of
    speed v = 1/sqrt(1 - tau_0^2), alpha_c is 2 tau_0 sqrt(gamma). Raises ValueError: outside the
    domain.

    Parameters
    ----------
    gamma, speed : floats, elasticity ratio, > 0, and front speed v (wave speeds), > 1

    Returns
    -------
    float : alpha_c

    Examples
    --------
    >>> critical_rate_strengthening(0.25, 1.25)
    0.6
    """
    check_domains(gamma=gamma, speed=speed)
    return 2.0 * math.sqrt(gamma) * math.sqrt((speed - 1.0) * (speed + 1.0)) / speed


def paper_pulse(tau0: float, gamma: float) -> SteadyPulse:
    """Return the paper's steady pulse without damping (section III A and appendix C).

    Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0

    Returns
    -------
    SteadyPulse : of speed 1/sqrt(1 - tau_0^2) and peak velocity 1/sqrt(gamma)

    Examples
    --------
    >>> round(paper_pulse(0.6, 0.25).peak_velocity, 6)
    2.0
    """
    check_domains(tau0=tau0)
    speed = 1.0 / math.sqrt(1.0 - tau0 * tau0)
    allowed = "above about 1e-8, so that the front is faster than the waves in spite of rounding"
    check_that(speed > 1.0, "tau0", tau0, allowed)
    return pulse_at_speed(tau0, gamma=gamma, beta=0.0, speed=speed)


def paper_transition_displacement(tau0: float, gamma: float) -> tuple[float, float]:
    """Return the paper's estimate of the transition under a displacement boundary.

    The estimate neglects the elastic coupling of neighbouring points, and the higher pre-stress at
    the nucleation. Source: section III B. Raises ValueError: outside the domain.

    Parameters
    ----------
    tau0, gamma : floats, pre-stress, in (0, 1), and elasticity ratio, > 0

    Returns
    -------
    tuple of floats : T_trans = pi/sqrt(gamma) and L_trans = 2 T_trans/sqrt(1 - tau_0^2)

    Examples
    --------
    >>> [round(number, 4) for number in paper_transition_displacement(0.6, 0.25)]
    [6.2832, 15.708]
    """
    check_domains(tau0=tau0, gamma=gamma)
    time = np.pi / np.sqrt(float(gamma))
    return float(time), float(2.0 * time / np.sqrt(1.0 - tau0**2))


def paper_transition_stress(prestress: Prestress) -> tuple[float, float]:
    """Return the paper's estimate of the transition under a stress boundary.

    The estimate assumes that both fronts run at the wave speed, until the left one arrives at the
    balance position x_minus. Source: section III C. Raises the same errors as
    `prestress_balance_position`.

    Parameters
    ----------
    prestress : Prestress, with the conditions of `prestress_balance_position`

    Returns
    -------
    tuple of floats : ``T_trans = |x_minus|`` and ``L_trans = 2 |x_minus|``
    """
    distance = abs(prestress_balance_position(prestress))
    return distance, 2.0 * distance
