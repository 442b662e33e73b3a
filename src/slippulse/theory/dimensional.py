"""Dimensional forms: scales of the layer, and the paper's predictions in SI units."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.checks import check_choice, check_number
from .domains import broadcast_numbers, check_domains

# No product of numbers up to this overflows.
LARGEST = 1e100
POSITIVE: dict[str, Any] = {"at_least": 1.0 / LARGEST, "at_most": LARGEST}


@dataclass(frozen=True)
class Layer:
    """An elastic layer on a rigid substrate: sections II and IV A and appendix B of the paper.

    Parameters
    ----------
    thickness, density : floats, H (m), > 0, and rho (kg/m^3), > 0
    lame, shear_modulus : floats, first Lame parameter lambda (Pa), > -2G/3, and G (Pa), > 0
    static_friction, kinetic_friction : floats, mu_s > mu_k >= 0
    normal_stress : float, sigma_n (Pa), > 0

    Raises
    ------
    ValueError : outside these ranges; of a method, for a speed outside 1e-100 to 1e100 too

    Examples
    --------
    >>> rock = Layer(100.0, 2700.0, 3e10, 3e10, 0.6, 0.5, 5e7)
    >>> round(rock.gamma, 6), round(rock.wave_speed)
    (0.666667, 5774)
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
        """Unit U of slip (m): 2 H (mu_s - mu_k) sigma_n/(lambda + 2G), or half of it.

        Parameters
        ----------
        boundary : "displacement", or "stress", for which it is half

        Returns
        -------
        float
        """
        check_choice("boundary", boundary, ("displacement", "stress"))
        factor = 2.0 if boundary == "displacement" else 1.0
        return factor * self.thickness * self.friction_drop / self.modulus

    def prestress(self, shear_stress: float) -> float:
        """Non-dimensional pre-stress (tau/sigma_n - mu_k)/(mu_s - mu_k).

        Parameters
        ----------
        shear_stress : float, tau (Pa)

        Returns
        -------
        float
        """
        check_number("shear_stress", shear_stress)
        excess = shear_stress / self.normal_stress - self.kinetic_friction
        return excess / (self.static_friction - self.kinetic_friction)

    def peak_velocity(self) -> float:
        """Peak slip velocity of the paper's pulse, derived from the scales of the layer.

        Returns
        -------
        float : 2 (mu_s - mu_k) sigma_n/sqrt(2 G rho) (m/s), twice `printed_peak_velocity`
        """
        return self.slip_scale("displacement") / self.time_scale / float(np.sqrt(self.gamma))

    def printed_peak_velocity(self) -> float:
        """Peak slip velocity as printed in section IV A of the paper.

        Returns
        -------
        float : (mu_s - mu_k) sigma_n/sqrt(2 G rho) (m/s)
        """
        return self.friction_drop / float(np.sqrt(2.0 * self.shear_modulus * self.density))

    def transition_length(self, front_speed: float) -> float:
        """Transition length L_trans (section IV A of the paper).

        Parameters
        ----------
        front_speed : float, v_c/v_s (wave speeds)

        Returns
        -------
        float : 2 pi H sqrt((lambda + 2G)/2G) v_c/v_s (m)
        """
        check_number("front_speed", front_speed, **POSITIVE)
        return 2.0 * np.pi * self.thickness / float(np.sqrt(self.gamma)) * front_speed

    def pulse_width(self, tau0: float, front_speed: float) -> float:
        """Width of the paper's pulse (section IV A of the paper).

        Parameters
        ----------
        tau0, front_speed : floats, pre-stress, in (0, 1), and v_c/v_s (wave speeds)

        Returns
        -------
        float : pi tau_0 H sqrt((lambda + 2G)/2G) v_c/v_s (m)
        """
        check_domains(tau0=tau0)
        check_number("front_speed", front_speed, **POSITIVE)
        return np.pi * tau0 * self.thickness / float(np.sqrt(self.gamma)) * front_speed


def damage_zone_stress_drop(slip, shear_modulus, rock_shear_modulus, thickness, rock_thickness):
    """Static stress drop of a fault with a compliant damage zone: section IV C 2 of the paper.

    A displacement is imposed far away, on the rock beyond the zone.

    Parameters
    ----------
    slip : float or array, delta (m), -1e100 to 1e100
    shear_modulus, rock_shear_modulus : floats or arrays, G of the zone and G_r of the rock (Pa),
        1e-100 to 1e100, G_r infinite too, for a rigid one
    thickness, rock_thickness : floats or arrays, H of the zone and H_r of the rock, to the imposed
        displacement (m), 1e-100 to 1e100, H_r 0 too

    Returns
    -------
    float or array : G delta/(H + (G/G_r) H_r) (Pa)

    Raises
    ------
    ValueError : outside these ranges

    Examples
    --------
    >>> damage_zone_stress_drop(1.0, 1e9, 3e10, 100.0, 3000.0) / 1e6
    5.0
    """
    if isinstance(rock_shear_modulus, float | np.ndarray):
        # A rigid rock is one of the largest modulus, to rounding.
        rock_shear_modulus = np.where(rock_shear_modulus == np.inf, LARGEST, rock_shear_modulus)
    given = {
        "slip": slip,
        "shear_modulus": shear_modulus,
        "rock_shear_modulus": rock_shear_modulus,
        "thickness": thickness,
        "rock_thickness": rock_thickness,
    }
    domains = dict.fromkeys(given, POSITIVE)
    domains["slip"] = {"at_least": -LARGEST, "at_most": LARGEST}
    domains["rock_thickness"] = {"at_least": 0.0, "at_most": LARGEST}
    slip, zone, rock, thickness, rock_thickness = broadcast_numbers(domains, **given)
    return zone * slip / (thickness + zone / rock * rock_thickness)
