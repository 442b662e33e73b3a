"""The steady slip pulse, with damping, and the paper's estimates of where and when a crack becomes a pulse."""

import math
from dataclasses import dataclass

import numpy as np

from ..model.checks import as_numbers, check_number
from ..model.prestress import Prestress, prestress_balance_position
from .domains import check_domains


def front_speed_undamped(tau0: float | np.ndarray) -> float | np.ndarray:
    """Front speed without damping, 1/sqrt(1 - tau_0^2), of tau_0 in [0, 1) or an array of them.

    Raises ValueError: outside the domain.
    Source: section III A of the paper.
    """
    return 1.0 / np.sqrt(1.0 - as_numbers("tau0", tau0, at_least=0.0, below=1.0) ** 2)


@dataclass(frozen=True)
class SteadyPulse:
    """A steady pulse; lengths in units of H, xi = x - v t <= 0 behind the front at xi = 0.

    Width is the distance from the front to where the velocity returns to 0, slip what is left behind, stress_drop gamma
    times that; growth and wavenumber are p and q of the complex pair p +- i q.
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
        """xi of the largest slip velocity."""
        return -float(np.arctan2(self.wavenumber, self.growth)) / self.wavenumber

    def profile(self, xi) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Slip, slip velocity and slip acceleration at xi: at rest ahead of the front, stuck behind the pulse.

        Raises ValueError: if xi is not a finite number or an array of them.
        """
        xi = as_numbers("xi", xi)
        p, q, v = self.growth, self.wavenumber, self.speed
        inside = (xi <= 0.0) & (xi >= -self.width)
        y = np.where(inside, xi, 0.0)
        size = v * self.tau0 * (p**2 + q**2) / (self.gamma * q)
        decay = np.exp(p * y)
        sine, cosine = np.sin(q * y), np.cos(q * y)
        offset = self.tau0 / self.gamma
        slip = np.where(inside, offset * (1.0 - decay * (cosine - p / q * sine)), 0.0)
        slip = np.where(xi < -self.width, self.slip, slip)
        velocity = np.where(inside, -size * decay * sine, 0.0)
        acceleration = np.where(inside, v * size * decay * (p * sine + q * cosine), 0.0)
        return slip, velocity, acceleration


def pulse_behind_front(
    tau0: float, gamma: float, beta: float, speed: float, rate_strengthening: float = 0.0
) -> SteadyPulse:
    """Steady pulse in uniform pre-stress behind a front of given speed.

    tau0, gamma : pre-stress, in (0, 1), and elasticity ratio, > 0
    beta, speed : damping, >= 0 (0 is the limit dx -> 0 at any damping ratio), and front speed, > 1
    rate_strengthening : alpha, of a term -alpha du/dt, at most `critical_rate_strengthening` in size

    Raises ValueError: outside the domain.
    Source: beta v U''' + (v^2 - 1) U'' - alpha v U' + gamma U = tau_0 with U(0) = U'(0) = 0 on the complex pair of
    roots; the real root, -(v^2 - 1)/(beta v) nearly, grows away from the front and is dropped. alpha = beta = 0 gives
    appendix C of the paper before its last step, with any speed.
    """
    check_domains(tau0=tau0, gamma=gamma)
    check_number("beta", beta, at_least=0.0)
    check_number("speed", speed, above=1.0)
    check_number("rate_strengthening", rate_strengthening)
    given, alpha = (float(tau0), float(gamma), float(beta), float(speed)), float(rate_strengthening)
    try:
        pulse = SteadyPulse(*given, *_shape(*given, alpha), alpha)
    except (ArithmeticError, ValueError):
        pulse = None
    # Floats of Python overflow without a word.
    if not pulse or not all(
        0.0 < size < math.inf for size in (pulse.width, pulse.slip, pulse.peak_velocity)
    ):
        critical = critical_rate_strengthening(gamma, speed) if alpha else 0.0
        if abs(alpha) > 0.5 * critical:
            at = f"at gamma = {gamma:.4g}, speed = {speed:.6g} without beta, or no pulse is steady"
            raise ValueError(
                f"rate_strengthening: {alpha!r}; allowed: less than {critical:.6g} in size {at}"
            )
        point = f"speed: {speed:.4g}, at gamma = {gamma:.4g}, beta = {beta:.4g}"
        raise ValueError(f"{point}; allowed: numbers whose pulse can be computed")
    return pulse


@np.errstate(over="raise", invalid="raise", divide="raise")
def _shape(
    tau0: float, gamma: float, beta: float, speed: float, alpha: float
) -> tuple[float, float, float, float, float, float]:
    """Width, slip, peak velocity, stress drop, growth and wavenumber."""
    stiffness = (speed - 1.0) * (speed + 1.0)
    if beta == 0.0:
        p = 0.5 * alpha * speed / stiffness
        q = float(np.sqrt(gamma / stiffness - p**2))
    else:
        roots = np.roots([beta * speed, stiffness, -alpha * speed, gamma])
        pair = roots[np.argmax(roots.imag)]
        p, q = float(pair.real), float(pair.imag)
    width = np.pi / q
    slip = tau0 / gamma * (1.0 + np.exp(-p * width))
    modulus = np.hypot(p, q)
    peak = speed * tau0 * modulus / gamma * np.exp(-p / q * np.arctan2(q, p))
    return float(width), float(slip), float(peak), float(gamma * slip), p, q


def critical_rate_strengthening(gamma: float, speed: float) -> float:
    """alpha_c = 2 sqrt(gamma) sqrt(1 - 1/v^2), gamma > 0, speed v > 1: no pulse is steady beyond +- alpha_c.

    Raises ValueError: outside the domain.
    Source: where the wavenumber q of the steady pulse is 0 (beta -> 0); 2 tau_0 sqrt(gamma) without damping.
    """
    check_domains(gamma=gamma)
    check_number("speed", speed, above=1.0)
    return 2.0 * math.sqrt(gamma) * math.sqrt((speed - 1.0) * (speed + 1.0)) / speed


def paper_pulse(tau0: float, gamma: float) -> SteadyPulse:
    """The paper's undamped pulse, tau0 in (0, 1), gamma > 0: v = 1/sqrt(1 - tau_0^2), peak velocity 1/sqrt(gamma).

    Source: section III A and appendix C of the paper.
    """
    check_domains(tau0=tau0)
    return pulse_behind_front(tau0, gamma, 0.0, float(front_speed_undamped(tau0)))


def paper_transition_displacement(tau0: float, gamma: float) -> tuple[float, float]:
    """T_trans = pi/sqrt(gamma), L_trans = 2 T_trans/sqrt(1 - tau_0^2): displacement boundary, 0 < tau0 < 1, gamma > 0.

    Source: section III B of the paper. It neglects the elastic coupling and the Gaussian at nucleation.
    """
    check_domains(tau0=tau0, gamma=gamma)
    time = np.pi / np.sqrt(float(gamma))
    return float(time), float(2.0 * time / np.sqrt(1.0 - tau0**2))


def paper_transition_stress(prestress: Prestress) -> tuple[float, float]:
    """The paper's T_trans = |x_minus| and L_trans = 2 |x_minus|, stress boundary, front speeds taken as 1 (III C)."""
    distance = abs(prestress_balance_position(prestress))
    return distance, 2.0 * distance
