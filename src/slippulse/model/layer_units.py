"""An elastic layer in SI units, and conversions between SI units and the units of the model.

`Layer` has the material parameters. It computes the units of the model, builds scenes and samples
from numbers in SI units, and converts runs and measured numbers to SI units and back.
"""

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import KW_ONLY, asdict, dataclass
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .checks import as_numbers, check_choice, check_number, check_that, first_true, short_repr
from .prestress import Prestress
from .samples import Samples
from .scene import Scene
from .si_quantities import QUANTITIES, UNITS, VARIABLES, converted_numbers, converted_run
from .si_stress_file import read_in_si

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
# Parameters of a scene that follow from the layer and from numbers in SI units. `Layer.scene`
# refuses them as arguments.
DERIVED_PARAMETERS = ("boundary", "gamma", "friction_ratio", "prestress", "duration", "dx")
# A run belongs to a layer if their elasticity ratios differ by at most this relative amount.
GAMMA_TOLERANCE = 1e-9


class Scales(NamedTuple):
    """The units of the model, in SI units.

    A non-dimensional number multiplied by the scale of its quantity is in SI units.
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
class Layer:
    """A thin elastic layer on a frictional interface, in SI units.

    With c^2 = (lambda + 2G)/rho and the strength drop D = (mu_s - mu_k) sigma_n the units of the
    model are H (length), H/c (time) and D (stress, counted from the kinetic friction mu_k sigma_n).
    The unit of slip depends on the condition at the top of the layer:

    - "held": the top does not move and displacement falls linearly from the interface to it, so
      that its mean is half the slip u. The mean equation of motion
      rho H u''/2 = H (lambda + 2G)/2 d2u/dx2 - G u/H + tau - friction has half the inertia of the
      layer, and the unit of slip is U = 2 H D/(lambda + 2G).
    - "stress": the stress on top is fixed and the layer slips as a whole: all of its inertia counts
      and U = H D/(lambda + 2G).

    Slip velocity has the unit U c/H and slip acceleration U c^2/H^2. Source: section II A and
    appendices A and B of the paper.

    Parameters
    ----------
    thickness : float, m
        Thickness H of the layer, > 0: from the interface to where displacement or stress is given.
    shear_modulus : float, Pa
        Shear modulus G, > 0.
    density : float, kg/m3
        Density rho, > 0.
    static_friction, kinetic_friction : float
        Coefficients of friction mu_s > mu_k >= 0.
    normal_stress : float, Pa
        Normal stress sigma_n on the interface, > 0 in compression.
    lame_parameter : float, Pa, or None
        Lame parameter lambda, > -2G/3, unless ``poisson_ratio`` is given.
    poisson_ratio : float or None
        Poisson's ratio, between -1 and 0.5, unless ``lame_parameter`` is given.
    top : {"held", "stress"}
        What does not change at the top of the layer while the interface slips: the displacement or
        the shear stress.

    Raises
    ------
    ValueError
        In one line that names the key, the value and what is allowed.

    Examples
    --------
    >>> block = sp.Layer(0.02, 2e9, poisson_ratio=0.3, density=1200.0, static_friction=0.6,
    ...                  kinetic_friction=0.5, normal_stress=5e6, top="held")
    >>> f"{block.wave_speed:.0f} m/s, {block.scales.time * 1e6:.2f} us"
    '2415 m/s, 8.28 us'
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
        higher = self.static_friction > self.kinetic_friction
        check_that(higher, "static_friction", self.static_friction, allowed)
        check_choice("top", self.top, tuple(BOUNDARY_OF_TOP))
        self._check_second_modulus()
        try:
            usable = all(math.isfinite(scale) and scale > 0.0 for scale in self.scales)
        except ArithmeticError:
            usable = False
        check_that(usable, "layer", self.mapping(), "numbers near those of a material")

    def _check_second_modulus(self) -> None:
        """Raise ValueError unless exactly one of the two moduli is given, within its range."""
        given = {"lame_parameter": self.lame_parameter, "poisson_ratio": self.poisson_ratio}
        names = [name for name, value in given.items() if value is not None]
        if len(names) != 1:
            text = " and ".join(names) or "missing"
            raise ValueError(f"lame_parameter, poisson_ratio: {text}; allowed: one of the two")
        if self.poisson_ratio is None:
            # The bulk modulus is positive, which is a Poisson's ratio above -1.
            check_number(
                "lame_parameter", self.lame_parameter, above=-2.0 / 3.0 * self.shear_modulus
            )
        else:
            check_number("poisson_ratio", self.poisson_ratio, above=-1.0, below=0.5)
        object.__setattr__(self, names[0], float(getattr(self, names[0])))

    @property
    def boundary(self) -> str:
        """Boundary condition of the scenes of this layer: "displacement" or "stress"."""
        return BOUNDARY_OF_TOP[self.top]

    @property
    def longitudinal_modulus(self) -> float:
        """Modulus lambda + 2G of uniaxial strain (Pa)."""
        if self.lame_parameter is not None:
            return self.lame_parameter + 2.0 * self.shear_modulus
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
        """Kinetic friction mu_k sigma_n, where non-dimensional stress is 0 (Pa)."""
        return self.kinetic_friction * self.normal_stress

    @property
    def friction_ratio(self) -> float:
        """Ratio mu_k/(mu_s - mu_k), on which the stress for backward slip depends."""
        return self.kinetic_friction / (self.static_friction - self.kinetic_friction)

    @property
    def scales(self) -> Scales:
        """Units of the model in SI units; energy is per metre of interface width."""
        factor = 2.0 if self.top == "held" else 1.0
        time, speed = self.thickness / self.wave_speed, self.wave_speed
        slip = factor * self.thickness * self.strength_drop / self.longitudinal_modulus
        return Scales(
            length=self.thickness,
            time=time,
            speed=speed,
            slip=slip,
            slip_velocity=slip / time,
            slip_acceleration=slip / time**2,
            stress=self.strength_drop,
            damping=self.thickness * speed,
            energy=self.strength_drop * slip * self.thickness,
        )

    @property
    def units_in_words(self) -> str:
        """Text with the units of the model, for messages about non-dimensional numbers."""
        length, time = f"{self.scales.length:.4g} m", f"{self.scales.time:.4g} s"
        stresses = f"{self.kinetic_strength:.6g} and 1 at {self.static_strength:.6g} Pa"
        return f"in units of the layer: {length}, {time}; stress is 0 at {stresses}"

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
        return values * self._scale(quantity)

    def convert_from_si(self, values: Any, quantity: str) -> Any:
        """Convert numbers in SI units to non-dimensional ones; the inverse of `convert_to_si`.

        Static friction becomes exactly 1.

        Parameters
        ----------
        values : float or array
        quantity : str

        Returns
        -------
        float or array
        """
        if quantity != "stress":
            return values / self._scale(quantity)
        tau = (values - self.kinetic_strength) / self.strength_drop
        # Rounding must not move static friction below 1, since blocks are released at 1.
        rounding = 8.0 * sys.float_info.epsilon * (1.0 + self.friction_ratio)
        tau = np.where(np.abs(tau - 1.0) <= rounding, 1.0, tau)
        return tau if np.ndim(values) else float(tau)

    def _scale(self, quantity: str) -> float:
        """Return the unit of a quantity in SI units."""
        check_choice("quantity", quantity, tuple(UNITS))
        return getattr(self.scales, "stress" if quantity == "stress_difference" else quantity)

    def scene(
        self,
        prestress_in_pascal: Any,
        duration_in_seconds: float,
        dx_in_metres: float,
        *,
        width_in_metres: float | None = None,
        peak_in_pascal: float | None = None,
        damping_ratio: float | None = None,
        **parameters: Any,
    ) -> Scene:
        """Build the non-dimensional scene of this layer under an initial shear stress.

        Parameters
        ----------
        prestress_in_pascal : float, pair of sequences, or path
            Shear stress along the interface: one value everywhere; positions (m) and stresses (Pa),
            linear between them and constant beyond; or a file with such a table (see
            `Prestress.from_file`). Two values at one position are a jump.
        duration_in_seconds : float
        dx_in_metres : float
            Spacing of the blocks.
        width_in_metres : float, optional
            Standard deviation of a Gaussian at x = 0 that raises the stress there to its peak.
            Without it, rupture starts where the table reaches static friction.
        peak_in_pascal : float, optional
            Stress at x = 0 with a width; by default static friction.
        damping_ratio : float, optional
            beta/dx, in place of ``beta``.
        **parameters
            Other parameters of `Scene`, non-dimensional as there: beta, release, scheme, max_step,
            order, half_lattice, resolved_blocks, friction.

        Returns
        -------
        Scene

        Raises
        ------
        ValueError
            If a value is not allowed, if nothing would move or everything at once, or if some
            stress would make the interface slide backwards; in one line, in SI units.

        Examples
        --------
        >>> block = sp.Layer(0.02, 2e9, poisson_ratio=0.3, density=1200.0, static_friction=0.6,
        ...                  kinetic_friction=0.5, normal_stress=5e6)
        >>> x, stress = [-0.1, -0.02, 0.0, 0.02, 0.1], [2.7e6, 2.7e6, 3.0e6, 2.7e6, 2.7e6]
        >>> scene = block.scene((x, stress), 60e-6, 2e-4, damping_ratio=0.1)
        """
        for name in DERIVED_PARAMETERS:
            allowed = "none, since it follows from the layer or from the arguments in SI units"
            check_that(name not in parameters, name, parameters.get(name), allowed)
        check_number("dx_in_metres", dx_in_metres, above=0.0)
        check_number("duration_in_seconds", duration_in_seconds, above=0.0)
        profile = self.prestress(
            prestress_in_pascal, width_in_metres=width_in_metres, peak_in_pascal=peak_in_pascal
        )
        dx = self.convert_from_si(float(dx_in_metres), "length")
        self._check_that_something_moves(profile, dx)
        if damping_ratio is not None:
            beta = parameters.get("beta")
            check_that(beta is None, "beta", beta, "none, since damping_ratio is given")
            check_number("damping_ratio", damping_ratio, at_least=0.0)
            parameters["beta"] = damping_ratio * dx
        try:
            return Scene(
                boundary=self.boundary,
                prestress=profile,
                duration=self.convert_from_si(float(duration_in_seconds), "time"),
                dx=dx,
                gamma=self.gamma if self.top == "held" else 0.0,
                friction_ratio=self.friction_ratio,
                **parameters,
            )
        except ValueError as error:
            raise ValueError(f"{error} ({self.units_in_words})") from None

    def prestress(
        self,
        prestress_in_pascal: Any,
        *,
        width_in_metres: float | None = None,
        peak_in_pascal: float | None = None,
    ) -> Prestress:
        """Convert an initial shear stress in pascal to the non-dimensional profile of a scene.

        Parameters
        ----------
        prestress_in_pascal, width_in_metres, peak_in_pascal
            As in `scene`.

        Returns
        -------
        Prestress
        """
        width, peak = None, 1.0
        if width_in_metres is not None:
            check_number("width_in_metres", width_in_metres, above=0.0)
            width = self.convert_from_si(float(width_in_metres), "length")
        if peak_in_pascal is not None:
            allowed = "none without width_in_metres, since there is then no Gaussian"
            check_that(width is not None, "peak_in_pascal", peak_in_pascal, allowed)
            peak = float(self.stress_from_pascal("peak_in_pascal", peak_in_pascal))
        if isinstance(prestress_in_pascal, Real) and not isinstance(prestress_in_pascal, bool):
            (level,) = self.table_from_pascal("prestress_in_pascal", [prestress_in_pascal]).tolist()
            return Prestress(left=level, right=level, width=width, peak=peak)
        if isinstance(prestress_in_pascal, str | PathLike):
            key, table = str(prestress_in_pascal), read_in_si(Path(prestress_in_pascal))
        else:
            key, table = "prestress_in_pascal", _columns(prestress_in_pascal)
        x, stress = table
        tau = self.table_from_pascal(key, stress)
        try:
            x = self.convert_from_si(x, "length")
            return Prestress.through(x, tau, width=width, peak=peak)
        except ValueError as error:
            raise ValueError(f"{error} ({self.units_in_words})") from None

    def stress_from_pascal(self, key: str, stress: Any) -> np.ndarray:
        """Convert stresses (Pa) to non-dimensional ones.

        Stresses at which the interface would slide backwards are refused.

        Parameters
        ----------
        key : str
            Name of the argument, for the message of a refusal.
        stress : float or array

        Returns
        -------
        array
        """
        stress, lowest = as_numbers(key, stress), -self.static_strength
        if stress.min(initial=math.inf) <= lowest:
            reason = "since otherwise the interface slides backwards"
            allowed = f"> {lowest:g} Pa, which is minus static friction, {reason}"
            raise ValueError(f"{key}: {stress.min():.6g} Pa; allowed: {allowed}")
        return np.asarray(self.convert_from_si(stress, "stress"))

    def level_from_pascal(self, key: str, stress: float) -> float:
        """Convert the stress of a level, or of a peak, to a non-dimensional one.

        Parameters
        ----------
        key : str
            Name of the argument, for the message of a refusal. Only a "peak" may reach static
            friction.
        stress : float

        Returns
        -------
        float
        """
        tau = float(self.stress_from_pascal(key, stress))
        allowed = f"below static friction, {self.static_strength:g} Pa"
        if tau >= 1.0 and key != "peak":
            raise ValueError(f"{key}: {stress:.6g} Pa; allowed: {allowed}")
        return tau

    def table_from_pascal(self, key: str, stress: Any) -> np.ndarray:
        """Convert the stresses of a table to non-dimensional ones.

        They are refused if they reach static friction everywhere, or at the first or last point,
        beyond which the stress is constant.

        Parameters
        ----------
        key : str
            Name of the argument, for the message of a refusal.
        stress : array

        Returns
        -------
        array
        """
        tau = self.stress_from_pascal(key, stress)
        below = f"below static friction, {self.static_strength:g} Pa"
        lowest = self.convert_to_si(float(tau.min()), "stress")
        everywhere = f"at least {lowest:g} Pa everywhere"
        if tau.min() >= 1.0:
            raise ValueError(f"{key}: {everywhere}; allowed: {below} somewhere")
        for name, row in (("first", 0), ("last", -1)):
            stress = self.convert_to_si(float(tau[row]), "stress")
            if tau[row] >= 1.0:
                raise ValueError(f"{key}: {name} value {stress:.6g} Pa; allowed: {below}")
        return tau

    def _check_that_something_moves(self, profile: Prestress, dx: float) -> None:
        """Raise ValueError if the initial stress reaches static friction at no block."""
        # The stress is largest at x = 0 or at a point of the table. It is examined at the blocks
        # next to these positions.
        x = np.array([0.0, *(x for x, _ in profile.points)])
        blocks = np.concatenate([np.floor(x / dx), np.ceil(x / dx)]) * dx
        largest = float(profile(blocks).max())
        if largest < 1.0:
            stress = self.convert_to_si(largest, "stress")
            reached = f"at most {stress:.9g} Pa at a block"
            allowed = (
                f"static friction, {self.static_strength:g} Pa, somewhere, or a width_in_metres of"
                " the Gaussian at x = 0 that starts the rupture"
            )
            raise ValueError(f"prestress_in_pascal: {reached}; allowed: {allowed}")

    def samples(self, times_in_seconds: Any, positions_in_metres: Any) -> Samples:
        """Build the times and positions at which slip is recorded.

        Parameters
        ----------
        times_in_seconds, positions_in_metres : arrays

        Returns
        -------
        Samples
        """
        times = as_numbers("times_in_seconds", times_in_seconds)
        positions = as_numbers("positions_in_metres", positions_in_metres)
        return Samples(
            self.convert_from_si(times, "time"), self.convert_from_si(positions, "length")
        )

    def to_si(self, run: Any) -> Any:
        """Convert a run to SI units.

        Parameters
        ----------
        run : xarray.Dataset
            One run of a scene of this layer, as `simulate` or `point` returned it.

        Returns
        -------
        xarray.Dataset
            The same run; each variable has its unit in ``units``. Attributes with a dimension are
            in SI as well, with their units as JSON in ``units_of_attributes``; ``layer`` has the
            parameters of the layer as JSON. The parameters of a friction law stay non-dimensional.

        Raises
        ------
        ValueError
            If `run` is not such a Dataset, or its boundary condition or elasticity ratio is not
            that of the layer.
        """
        _check_run(run)
        if "layer" in run.attrs:
            raise ValueError("run: in SI units; allowed: a run without units")
        self._check_same_layer(run.attrs)
        data = converted_run(run, self.convert_to_si)
        units = {name: UNITS[QUANTITIES[name]] for name in run.attrs if name in QUANTITIES}
        data.attrs["units_of_attributes"] = json.dumps(units)
        data.attrs["layer"] = json.dumps(self.mapping())
        for name in data.variables:
            quantity, long_name = VARIABLES[name]
            data[name].attrs = {"units": UNITS[quantity], "long_name": long_name}
        return data

    def from_si(self, run: Any) -> Any:
        """Convert a run in SI units back to the units of the model; the inverse of `to_si`.

        Parameters
        ----------
        run : xarray.Dataset
            A run that the method `to_si` of this layer returned.

        Returns
        -------
        xarray.Dataset

        Raises
        ------
        ValueError
            If `run` is not such a Dataset, or was converted by another layer.
        """
        _check_run(run)
        recorded = layer_of(run.attrs)
        if recorded is None:
            raise ValueError("run: without units; allowed: a run that to_si returned")
        check_that(recorded == self, "layer", recorded, "the layer that converted the run")
        for name in run.variables:
            unit, expected = run[name].attrs.get("units"), UNITS[QUANTITIES[name]]
            check_that(unit == expected, f"run: units of {name}", unit, repr(expected))
        data = converted_run(run, self.convert_from_si)
        for name in ("units_of_attributes", "layer"):
            del data.attrs[name]
        for name in data.variables:
            data[name].attrs = {"units": "1"}
        return data

    def numbers_to_si(self, numbers: Mapping[str, Any]) -> dict[str, Any]:
        """Convert measured numbers, or attributes of a run, to SI units.

        Parameters
        ----------
        numbers : mapping
            Numbers by their names in docs/columns.md. Numbers without a unit are not changed.

        Returns
        -------
        dict
        """
        return converted_numbers(numbers, self.convert_to_si)

    def mapping(self) -> dict[str, Any]:
        """Return the parameters by name, without the modulus that was not given.

        Returns
        -------
        dict
        """
        return {name: value for name, value in asdict(self).items() if value is not None}

    def _check_same_layer(self, attributes: Mapping) -> None:
        """Raise ValueError if the boundary or the gamma of a run is not that of this layer."""
        boundary, gamma = attributes["boundary"], attributes["gamma"]
        check_that(boundary == self.boundary, "run: boundary", boundary, repr(self.boundary))
        expected = self.gamma if self.top == "held" else 0.0
        is_equal = math.isclose(gamma, expected, rel_tol=GAMMA_TOLERANCE)
        check_that(is_equal, "run: gamma", gamma, f"{expected!r}, as in the layer")


def layer_of(attributes: Mapping) -> Layer | None:
    """Return the layer that a run was converted with; None if the run is not in SI units."""
    return Layer(**json.loads(attributes["layer"])) if "layer" in attributes else None


def _check_run(run: Any) -> None:
    """Raise ValueError unless the argument is the Dataset of one run."""
    is_run = hasattr(run, "variables") and "x" in run.variables and "end_time" in run.attrs
    is_run = is_run and set(run.variables) <= set(VARIABLES)
    allowed = "a Dataset that simulate returned; point takes one run out of a sweep"
    check_that(is_run, "run", type(run).__name__, allowed)


def _columns(given: Any) -> tuple[np.ndarray, np.ndarray]:
    """Convert a pair of sequences, positions (m) and stresses (Pa), to arrays."""
    try:
        x, stress = given
    except (TypeError, ValueError):
        allowed = "a stress in Pa, a pair (positions in m, stresses in Pa), or a file"
        raise ValueError(f"prestress_in_pascal: {short_repr(given)}; allowed: {allowed}") from None
    positions = as_numbers("prestress_in_pascal positions", x)
    stresses = as_numbers("prestress_in_pascal stresses", stress)
    have_equal_shapes = positions.ndim == 1 and positions.shape == stresses.shape
    allowed = "two or more positions, and as many stresses"
    are_valid = have_equal_shapes and positions.size >= 2
    check_that(are_valid, "prestress_in_pascal", (positions.shape, stresses.shape), allowed)
    before = first_true(np.diff(positions) < 0.0)
    if before is not None:
        # Rows are counted from 1 in messages.
        given = f"position {positions[before + 1]:.10g} m in row {before + 2}"
        allowed = f">= {positions[before]:.10g} m, the position in the row before"
        raise ValueError(f"prestress_in_pascal: {given}; allowed: {allowed}")
    return positions, stresses
