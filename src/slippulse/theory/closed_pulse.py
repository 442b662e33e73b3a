"""The steady slip pulse in closed form, with damping, and the paper's estimates."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..model.balance import prestress_balance_position
from ..model.checks import as_numbers, check_number
from ..model.prestress import Prestress
from .domains import check_domains


class PulseProfile(NamedTuple):
    """Slip, slip velocity and slip acceleration of a pulse at some positions."""

    slip: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


@dataclass(frozen=True)
class SteadyPulse:
    """A steady pulse in units of H, with xi = x - v t <= 0 behind the front at xi = 0.

    `steady_pulse` and `paper_pulse` compute one.

    Parameters
    ----------
    tau0, gamma, beta, speed, rate_strengthening : floats, as in `steady_pulse`
    width : float, distance from the front to where the slip velocity returns to 0
    slip, stress_drop : floats, slip that remains behind the pulse, and gamma times this slip
    peak_velocity : float, largest slip velocity
    growth, wavenumber : floats, p and q of the complex pair of roots p +- i q
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
        """Position xi of the largest slip velocity."""
        return -float(np.arctan2(self.wavenumber, self.growth)) / self.wavenumber

    def profile(self, xi) -> PulseProfile:
        """Return slip, slip velocity and slip acceleration; at rest outside of the pulse.

        Parameters
        ----------
        xi : float or array, positions relative to the front (units of H)

        Returns
        -------
        PulseProfile : a tuple of arrays of the shape of xi
        """
        xi = as_numbers("xi", xi)
        p, q = self.growth, self.wavenumber
        inside = (xi <= 0.0) & (xi >= -self.width)
        inner_xi = np.where(inside, xi, 0.0)
        sine, cosine = np.sin(q * inner_xi), np.cos(q * inner_xi)
        decay = np.exp(p * inner_xi)
        # The solution around u = tau_0/gamma with u = u' = 0 at the front.
        inner_slip = self.tau0 / self.gamma * (1.0 - decay * (cosine - p / q * sine))
        slip = np.select([inside, xi < -self.width], [inner_slip, self.slip])
        # Derivatives by time: d/dt = -v d/dxi.
        amplitude = self.speed * self.tau0 * (p**2 + q**2) / (self.gamma * q)
        velocity = np.where(inside, -amplitude * decay * sine, 0.0)
        inner_acceleration = self.speed * amplitude * decay * (p * sine + q * cosine)
        acceleration = np.where(inside, inner_acceleration, 0.0)
        return PulseProfile(slip, velocity, acceleration)


@np.errstate(over="raise", invalid="raise", divide="raise")
def pulse_at_speed(
    tau0: float, gamma: float, beta: float, speed: float, rate_strengthening: float = 0.0
) -> SteadyPulse:
    """Return the steady pulse (`theory.steady_pulse`) behind a front of a given speed.

    With xi = x - v t, the equation of motion inside the pulse is

        beta v u''' + (v^2 - 1) u'' - alpha v u' + gamma u = tau_0.

    Its solution oscillates as exp(p xi) cos(q xi) around u = tau_0/gamma, where p +- i q is the
    complex pair of roots of the characteristic polynomial. The pulse ends after half a wavelength,
    pi/q. Raises ValueError if the roots are not complex, or if a number overflows.
    """
    check_domains(tau0=tau0, gamma=gamma, beta=beta, rate_strengthening=rate_strengthening)
    check_number("speed", speed, above=1.0)
    tau0, gamma, beta = (float(number) for number in (tau0, gamma, beta))
    v, alpha = float(speed), float(rate_strengthening)
    inertia = (v - 1.0) * (v + 1.0)
    try:
        if beta == 0.0:
            p = 0.5 * alpha * v / inertia
            q = float(np.sqrt(gamma / inertia - p**2))
        else:
            roots = np.roots([beta * v, inertia, -alpha * v, gamma])
            complex_root = roots[np.argmax(roots.imag)]
            p, q = float(complex_root.real), float(complex_root.imag)
        # With u = u' = 0 at the front, the slip at the end xi = -pi/q follows.
        width = float(np.pi / q)
        slip = float(tau0 / gamma * (1.0 + np.exp(-p * width)))
        # The peak is where the acceleration is 0, at xi = -arctan2(q, p)/q.
        amplitude = v * tau0 * np.hypot(p, q) / gamma
        peak = float(amplitude * np.exp(-p / q * np.arctan2(q, p)))
        # Python's floats can overflow without an error.
        if not all(0.0 < size < math.inf for size in (width, slip, peak)):
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


def _reason_for_no_pulse(gamma: float, speed: float, rate_strengthening: float) -> str:
    """Return the error message for a pulse that cannot be computed.

    It names the rate strengthening if this may be too large, and the speed otherwise.
    """
    critical = critical_rate_strengthening(gamma, speed)
    place = f"at gamma = {gamma:.6g}"
    # The critical value is that without damping. With damping, pulses end at another value.
    if abs(rate_strengthening) > 0.5 * critical:
        allowed = f"less than {critical:.6g} in size {place}, speed = {speed:.6g} without beta"
        refused = f"rate_strengthening: {rate_strengthening!r}"
        return f"{refused}; allowed: {allowed}, or no pulse is steady"
    return f"speed: {speed:.6g} {place}; allowed: values whose pulse can be computed"


def critical_rate_strengthening(gamma: float, speed: float) -> float:
    """Return alpha_c = 2 sqrt(gamma) sqrt(1 - 1/v^2), beyond which no pulse is steady.

    It limits rate strengthening of either sign.
    Source: the wavenumber q of the steady pulse is 0 at alpha_c (beta -> 0). Without damping of the
    front alpha_c is 2 tau_0 sqrt(gamma). Raises ValueError: outside the domain.

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
    """Return the paper's undamped pulse (section III A and appendix C).

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
    return pulse_at_speed(tau0, gamma=gamma, beta=0.0, speed=1.0 / math.sqrt(1.0 - tau0 * tau0))


def paper_transition_displacement(tau0: float, gamma: float) -> tuple[float, float]:
    """Return the paper's estimate of the transition under a displacement boundary.

    It neglects the elastic coupling and the Gaussian at nucleation. Source: section III B.
    Raises ValueError: outside the domain.

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

    It takes both front speeds as 1. Source: section III C. It raises the same errors as
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
