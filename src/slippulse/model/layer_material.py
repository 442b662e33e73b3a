"""The material of an elastic layer in SI units, and the units of the model that follow from it.

`LayerMaterial` has the parameters of a layer. It computes the units of the model, and converts
single numbers between them and SI units. Its subclass `Layer` converts scenes and runs.
"""

import math
import sys
from dataclasses import KW_ONLY, asdict, dataclass
from typing import Any, NamedTuple

import numpy as np

from .checks import check_choice, check_number, check_that
from .si_quantities import UNITS

# Boundary condition of a scene for each condition at the top of a layer.
BOUNDARY_OF_TOP = {"held": "displacement", "stress": "stress"}
# Allowed ranges, in the form that `check_number` takes.
NUMBER_RANGES: dict[str, dict[str, Any]] = {
    "thickness": {"above": 0.0},
    "shear_modulus": {"above": 0.0},
    "density": {"above": 0.0},
    "static_friction": {"above": 0.0},
    "kinetic_friction": {"at_least": 0.0},
    "normal_stress": {"above": 0.0},
}


class Scales(NamedTuple):
    """The units of the model, in SI units.

    A non-dimensional number is converted to SI units by multiplying it by the scale of its
    quantity. A stress also has another zero in SI units, see `LayerMaterial.convert_to_si`.
    """

    length: float
    time: float
    speed: float
    slip: float
    slip_velocity: float
    slip_acceleration: float
    stress: float
    damping: float
    energy: float


@dataclass(frozen=True)
class LayerMaterial:
    """Thickness, material, friction and normal stress of a layer; see `Layer` for the parameters.

    The properties are the numbers that follow from the parameters.
    """

    thickness: float
    shear_modulus: float
    _: KW_ONLY
    density: float
    static_friction: float
    kinetic_friction: float
    normal_stress: float
    lame_parameter: float | None = None
    poisson_ratio: float | None = None
    top: str = "held"

    def __post_init__(self) -> None:
        for name, bounds in NUMBER_RANGES.items():
            check_number(name, getattr(self, name), **bounds)
            object.__setattr__(self, name, float(getattr(self, name)))
        allowed = f"a number above kinetic_friction = {self.kinetic_friction:g}"
        is_higher = self.static_friction > self.kinetic_friction
        check_that(is_higher, "static_friction", self.static_friction, allowed)
        check_choice("top", self.top, tuple(BOUNDARY_OF_TOP))
        self._convert_lame_or_poisson()
        # Numbers that are far too large or too small for a material overflow in the scales.
        try:
            are_usable = all(math.isfinite(scale) and scale > 0.0 for scale in self.scales)
        except ArithmeticError:
            are_usable = False
        check_that(
            are_usable, "layer", self.mapping(), "numbers of a size that real materials have"
        )

    def _convert_lame_or_poisson(self) -> None:
        """Convert ``lame_parameter`` or ``poisson_ratio`` to a float, whichever is given.

        Raises ValueError unless exactly one of them is given, and is within its range.
        """
        moduli = {"lame_parameter": self.lame_parameter, "poisson_ratio": self.poisson_ratio}
        given_names = [name for name, value in moduli.items() if value is not None]
        if len(given_names) != 1:
            text = " and ".join(given_names) or "missing"
            raise ValueError(f"lame_parameter, poisson_ratio: {text}; allowed: one of the two")
        if self.poisson_ratio is None:
            # At this bound the bulk modulus is 0, and Poisson's ratio is -1.
            check_number(
                "lame_parameter", self.lame_parameter, above=-2.0 / 3.0 * self.shear_modulus
            )
        else:
            check_number("poisson_ratio", self.poisson_ratio, above=-1.0, below=0.5)
        (name,) = given_names
        object.__setattr__(self, name, float(getattr(self, name)))

    @property
    def boundary(self) -> str:
        """Boundary condition of the scenes of this layer: "displacement" or "stress"."""
        return BOUNDARY_OF_TOP[self.top]

    @property
    def longitudinal_modulus(self) -> float:
        """Modulus lambda + 2G of uniaxial strain (Pa)."""
        if self.lame_parameter is not None:
            return self.lame_parameter + 2.0 * self.shear_modulus
        # Here Poisson's ratio is not None, but type checkers do not know that.
        poisson_ratio = self.poisson_ratio or 0.0
        return 2.0 * self.shear_modulus * (1.0 - poisson_ratio) / (1.0 - 2.0 * poisson_ratio)

    @property
    def gamma(self) -> float:
        """Elasticity ratio 2G/(lambda + 2G), between 0 and 1.5."""
        return 2.0 * self.shear_modulus / self.longitudinal_modulus

    @property
    def wave_speed(self) -> float:
        """Speed c = sqrt((lambda + 2G)/rho) of waves along the layer (m/s)."""
        return math.sqrt(self.longitudinal_modulus / self.density)

    @property
    def strength_drop(self) -> float:
        """Difference (mu_s - mu_k) sigma_n of static and kinetic friction (Pa)."""
        return (self.static_friction - self.kinetic_friction) * self.normal_stress

    @property
    def static_strength(self) -> float:
        """Static friction mu_s sigma_n, at which the interface is released (Pa)."""
        return self.static_friction * self.normal_stress

    @property
    def kinetic_strength(self) -> float:
        """Kinetic friction mu_k sigma_n, at which non-dimensional stress is 0 (Pa)."""
        return self.kinetic_friction * self.normal_stress

    @property
    def friction_ratio(self) -> float:
        """Ratio mu_k/(mu_s - mu_k), on which the stress for backward slip depends."""
        return self.kinetic_friction / (self.static_friction - self.kinetic_friction)

    @property
    def scales(self) -> Scales:
        """Units of the model in SI units; energy is per metre of interface width."""
        length, stress = self.thickness, self.strength_drop
        time, speed = length / self.wave_speed, self.wave_speed
        # If the top is held, the mean displacement of the layer is half the slip.
        factor = 2.0 if self.top == "held" else 1.0
        slip = factor * length * stress / self.longitudinal_modulus
        return Scales(
            length=length,
            time=time,
            speed=speed,
            slip=slip,
            slip_velocity=slip / time,
            slip_acceleration=slip / time**2,
            stress=stress,
            damping=length * speed,
            energy=stress * slip * length,
        )

    @property
    def units_in_words(self) -> str:
        """Text with the units of the model, for messages about non-dimensional numbers."""
        length, time = f"{self.scales.length:.4g} m", f"{self.scales.time:.4g} s"
        units = f"lengths are in units of {length}, times in units of {time}"
        zero, one = f"{self.kinetic_strength:.6g} Pa", f"{self.static_strength:.6g} Pa"
        return f"{units}; a stress of 0 means {zero}, and a stress of 1 means {one}"

    def convert_to_si(self, values: Any, quantity: str) -> Any:
        """Convert non-dimensional numbers to SI units.

        Parameters
        ----------
        values : float or array
        quantity : str
            A name of `Scales`, or "stress_difference". A "stress" is counted from the kinetic
            friction if it is non-dimensional, and from 0 if it is in pascal.

        Returns
        -------
        float or array
        """
        if quantity == "stress":
            return self.kinetic_strength + self.strength_drop * values
        return values * self._si_unit(quantity)

    def convert_from_si(self, values: Any, quantity: str) -> Any:
        """Convert numbers in SI units to non-dimensional ones; the inverse of `convert_to_si`.

        Static friction becomes exactly 1.

        Parameters
        ----------
        values : float or array
        quantity : str
            As in `convert_to_si`.

        Returns
        -------
        float or array
        """
        if quantity != "stress":
            return values / self._si_unit(quantity)
        tau = (values - self.kinetic_strength) / self.strength_drop
        # Rounding must not move static friction below 1, since blocks are released at 1. The
        # difference from kinetic friction loses more digits if the two are nearly equal.
        rounding_error = 8.0 * sys.float_info.epsilon * (1.0 + self.friction_ratio)
        tau = np.where(np.abs(tau - 1.0) <= rounding_error, 1.0, tau)
        return tau if np.ndim(values) else float(tau)

    def _si_unit(self, quantity: str) -> float:
        """Return the unit of a quantity in SI units."""
        check_choice("quantity", quantity, tuple(UNITS))
        return getattr(self.scales, "stress" if quantity == "stress_difference" else quantity)

    def mapping(self) -> dict[str, Any]:
        """Return the parameters by name, without the modulus that was not given.

        Returns
        -------
        dict
        """
        return {name: value for name, value in asdict(self).items() if value is not None}
