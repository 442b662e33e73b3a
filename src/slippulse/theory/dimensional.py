"""Dimensional forms: scales of the layer, and the paper's predictions in SI units."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.checks import check_choice, check_number
from .domains import broadcast_numbers, check_domains

# So that no product overflows.
LARGEST = 1e100
POSITIVE: dict[str, Any] = {"at_least": 1.0 / LARGEST, "at_most": LARGEST}


@dataclass(frozen=True)
class Layer:
    """An elastic layer on a rigid substrate.

    Parameters
    ----------
    thickness, density : H (m), > 0, and rho (kg/m^3), > 0
    lame, shear_modulus : first Lame parameter lambda (Pa), > -2G/3, and G (Pa), > 0
    static_friction, kinetic_friction : mu_s > mu_k >= 0
    normal_stress : sigma_n (Pa), > 0

    Raises ValueError: outside these ranges; its methods, for a speed outside 1e-100 to 1e100 too.
    Source: sections II and IV A and appendix B of the paper.
    """

    thickness: float
    density: float
    lame: float
    shear_modulus: float
    static_friction: float
    kinetic_friction: float
    normal_stress: float

    def __post_init__(self) -> None:
        for name in ("thickness", "density", "shear_modulus", "normal_stress"):
            check_number(name, getattr(self, name), above=0.0)
        check_number("lame", self.lame, above=-2.0 * self.shear_modulus / 3.0)
        check_number("kinetic_friction", self.kinetic_friction, at_least=0.0)
        check_number("static_friction", self.static_friction, above=self.kinetic_friction)

    @property
    def modulus(self) -> float:
        """lambda + 2G (Pa)."""
        return self.lame + 2.0 * self.shear_modulus

    @property
    def gamma(self) -> float:
        """Elasticity ratio 2G/(lambda + 2G)."""
        return 2.0 * self.shear_modulus / self.modulus

    @property
    def wave_speed(self) -> float:
        """sqrt((lambda + 2G)/rho) (m/s), the unit of front speed."""
        return float(np.sqrt(self.modulus / self.density))

    @property
    def time_scale(self) -> float:
        """T = H / wave speed (s)."""
        return self.thickness / self.wave_speed

    @property
    def friction_drop(self) -> float:
        """(mu_s - mu_k) sigma_n (Pa), the unit of stress."""
        return (self.static_friction - self.kinetic_friction) * self.normal_stress

    def slip_scale(self, boundary: str) -> float:
        """U (m): 2 H (mu_s - mu_k) sigma_n/(lambda + 2G) under "displacement", half of it under "stress"."""
        check_choice("boundary", boundary, ("displacement", "stress"))
        factor = 2.0 if boundary == "displacement" else 1.0
        return factor * self.thickness * self.friction_drop / self.modulus

    def prestress(self, shear_stress: float) -> float:
        """Non-dimensional pre-stress (tau/sigma_n - mu_k)/(mu_s - mu_k) of a shear stress (Pa)."""
        check_number("shear_stress", shear_stress)
        above = shear_stress / self.normal_stress - self.kinetic_friction
        return above / (self.static_friction - self.kinetic_friction)

    def peak_velocity(self) -> float:
        """Peak slip velocity (m/s) of the paper's pulse, from its own scales: 2 (mu_s - mu_k) sigma_n / sqrt(2 G rho).

        The paper prints half of this (section IV A).
        """
        return self.slip_scale("displacement") / self.time_scale / float(np.sqrt(self.gamma))

    def printed_peak_velocity(self) -> float:
        """Peak slip velocity (m/s) as printed in section IV A of the paper."""
        return self.friction_drop / float(np.sqrt(2.0 * self.shear_modulus * self.density))

    def transition_length(self, front_speed: float) -> float:
        """L_trans (m) for a front speed in wave speeds: 2 pi H sqrt((lambda + 2G)/2G) v_c/v_s (section IV A)."""
        check_number("front_speed", front_speed, **POSITIVE)
        return 2.0 * np.pi * self.thickness / float(np.sqrt(self.gamma)) * front_speed

    def pulse_width(self, tau0: float, front_speed: float) -> float:
        """Width (m) of the paper's pulse: pi tau_0 H sqrt((lambda + 2G)/2G) v_c/v_s (section IV A)."""
        check_domains(tau0=tau0)
        check_number("front_speed", front_speed, **POSITIVE)
        return np.pi * tau0 * self.thickness / float(np.sqrt(self.gamma)) * front_speed


def damage_zone_stress_drop(slip, shear_modulus, rock_shear_modulus, thickness, rock_thickness):
    """Static stress drop of a fault with a compliant damage zone, sheared by a far imposed displacement.

    Parameters
    ----------
    slip : delta (m), a number or an array, as the others, which are 1e-100 at least, and all 1e100 at most
    shear_modulus, rock_shear_modulus : G of the damage zone, and G_r of the host rock (Pa), infinite for a rigid one
    thickness, rock_thickness : H of the damage zone, and H_r of the rock beyond it, to the displacement (m), 0 too

    Returns G delta / (H + (G/G_r) H_r) in Pa, a float or an array.
    Raises ValueError: outside these ranges.
    Source: section IV C 2 of the paper.
    """
    if isinstance(rock_shear_modulus, float | np.ndarray):
        # To rounding the same.
        rock_shear_modulus = np.where(rock_shear_modulus == np.inf, LARGEST, rock_shear_modulus)
    least = {"slip": -LARGEST, "rock_thickness": 0.0}
    given = {"slip": slip, "shear_modulus": shear_modulus, "rock_shear_modulus": rock_shear_modulus}
    given |= {"thickness": thickness, "rock_thickness": rock_thickness}
    domains = {key: POSITIVE | ({"at_least": least[key]} if key in least else {}) for key in given}
    slip, zone, rock, thickness, beyond = broadcast_numbers(domains, **given)
    return zone * slip / (thickness + zone / rock * beyond)
