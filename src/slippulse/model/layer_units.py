"""An elastic layer in SI units: conversion of scenes, samples and runs to the model and back.

`Layer` builds scenes and samples from numbers in SI units, and converts runs and measured numbers
to SI units and back. Its base class `LayerMaterial` has its parameters and converts single numbers.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .checks import as_numbers, check_number, check_that, index_of_first_true, short_repr
from .layer_material import LayerMaterial
from .prestress import Prestress
from .samples import Samples
from .scene import Scene
from .si_quantities import QUANTITIES, UNITS, VARIABLES, converted_numbers, converted_run
from .si_stress_file import read_in_si

# Parameters of a scene that follow from the layer and from numbers in SI units. `Layer.scene`
# refuses them as arguments.
DERIVED_PARAMETERS = ("boundary", "gamma", "friction_ratio", "prestress", "duration", "dx")
# A run belongs to a layer if their elasticity ratios differ by at most this relative amount.
GAMMA_TOLERANCE = 1e-9


class _Gaussian(NamedTuple):
    """Non-dimensional width and peak of the Gaussian at x = 0; the width is None without one."""

    width: float | None
    peak: float


@dataclass(frozen=True)
class Layer(LayerMaterial):
    """A thin elastic layer on a frictional interface, in SI units.

    The units of the model are the thickness H of the layer (length), H/c (time) and D (stress).
    Here c is the wave speed, c^2 = (lambda + 2G)/rho, and D is the strength drop,
    D = (mu_s - mu_k) sigma_n. Non-dimensional stress is 0 at the kinetic friction mu_k sigma_n.
    The unit U of slip depends on the condition at the top of the layer:

    - "held": The top does not move. Displacement falls linearly from the slip u at the interface to
      0 at the top, so that its mean is u/2. The mean equation of motion is therefore
      rho H u''/2 = H (lambda + 2G)/2 d2u/dx2 - G u/H + tau - friction, with half the inertia of the
      layer. The unit of slip is U = 2 H D/(lambda + 2G).
    - "stress": The stress on top is fixed, and the layer slips as a whole. All of its inertia
      counts, and U = H D/(lambda + 2G).

    Slip velocity has the unit U c/H and slip acceleration U c^2/H^2. Source: section II A and
    appendices A and B of the paper.

    Parameters
    ----------
    thickness : float, m
        Thickness H of the layer, > 0, from the interface to the top.
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
            Shear stress along the interface, in one of three forms. A number is the same stress
            everywhere. A pair has positions (m) and stresses (Pa), between which the stress is
            linear; beyond them it is constant, and two values at one position are a jump. A path
            leads to a file with such a table (see `Prestress.from_file`).
        duration_in_seconds : float
            Time to simulate.
        dx_in_metres : float
            Spacing of the blocks.
        width_in_metres : float, optional
            Standard deviation of a Gaussian at x = 0 that raises the stress there to its peak.
            Without it, rupture starts where the table reaches static friction.
        peak_in_pascal : float, optional
            Stress at x = 0, if there is a Gaussian; by default static friction.
        damping_ratio : float, optional
            beta/dx, which can be given in place of ``beta``.
        **parameters
            Other parameters of `Scene`, in the units of the model: beta, release, scheme, max_step,
            order, half_lattice, resolved_blocks, friction.

        Returns
        -------
        Scene

        Raises
        ------
        ValueError
            If a value is not allowed, if no block or every block would be released at once, or if
            the interface would slide backwards somewhere. The message is one line in SI units.

        Examples
        --------
        >>> block = sp.Layer(0.02, 2e9, poisson_ratio=0.3, density=1200.0, static_friction=0.6,
        ...                  kinetic_friction=0.5, normal_stress=5e6)
        >>> x, stress = [-0.1, -0.02, 0.0, 0.02, 0.1], [2.7e6, 2.7e6, 3.0e6, 2.7e6, 2.7e6]
        >>> scene = block.scene((x, stress), 60e-6, 2e-4, damping_ratio=0.1)
        """
        for name in DERIVED_PARAMETERS:
            allowed = "no value, since the layer or the arguments in SI units determine it"
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
        # Errors of the scene are about non-dimensional numbers. The units are added to the message.
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
        prestress_in_pascal : float, pair of sequences, or path
            Shear stress along the interface: a number for the same stress everywhere, a pair of
            positions (m) and stresses (Pa), or the path of a file with such a table. See `scene`.
        width_in_metres, peak_in_pascal : float, optional
            Standard deviation and peak of a Gaussian at x = 0, as in `scene`.

        Returns
        -------
        Prestress
        """
        # The key is the name with which messages about the stress begin.
        stress, key = prestress_in_pascal, "prestress_in_pascal"
        width, peak = self._gaussian_from_si(width_in_metres, peak_in_pascal)
        if isinstance(stress, Real) and not isinstance(stress, bool):
            (level,) = self.table_from_pascal(key, [stress]).tolist()
            return Prestress(left=level, right=level, width=width, peak=peak)
        if isinstance(stress, str | PathLike):
            key = str(stress)
            positions, stresses = read_in_si(Path(stress))
        else:
            positions, stresses = _positions_and_stresses(stress)
        tau = self.table_from_pascal(key, stresses)
        # Errors of the profile are about non-dimensional numbers. The units are added to them.
        try:
            x = self.convert_from_si(positions, "length")
            return Prestress.through(x, tau, width=width, peak=peak)
        except ValueError as error:
            raise ValueError(f"{error} ({self.units_in_words})") from None

    def _gaussian_from_si(
        self, width_in_metres: float | None, peak_in_pascal: float | None
    ) -> _Gaussian:
        """Convert width and peak of the Gaussian at x = 0 to numbers without units.

        If there is no width, there is no Gaussian. The default peak is 1, which is static friction.
        """
        width, peak = None, 1.0
        if width_in_metres is not None:
            check_number("width_in_metres", width_in_metres, above=0.0)
            width = self.convert_from_si(float(width_in_metres), "length")
        if peak_in_pascal is not None:
            allowed = "none unless width_in_metres is given: without a width there is no Gaussian"
            check_that(width is not None, "peak_in_pascal", peak_in_pascal, allowed)
            peak = float(self.stress_from_pascal("peak_in_pascal", peak_in_pascal))
        return _Gaussian(width, peak)

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
        stresses, limit = as_numbers(key, stress), -self.static_strength
        if stresses.min(initial=math.inf) <= limit:
            reason = "since otherwise the interface slides backwards"
            allowed = f"> {limit:g} Pa, which is minus static friction, {reason}"
            raise ValueError(f"{key}: {stresses.min():.6g} Pa; allowed: {allowed}")
        return np.asarray(self.convert_from_si(stresses, "stress"))

    def level_from_pascal(self, key: str, stress: float) -> float:
        """Convert the stress of a level, or of a peak, to a non-dimensional one.

        A level that reaches static friction is refused. A peak may reach it.

        Parameters
        ----------
        key : str
            Name of the argument, for the message of a refusal. The name of a peak is "peak".
        stress : float
            In pascal.

        Returns
        -------
        float
        """
        tau = float(self.stress_from_pascal(key, stress))
        allowed = f"below static friction ({self.static_strength:g} Pa)"
        if tau >= 1.0 and key != "peak":
            raise ValueError(f"{key}: {stress:.6g} Pa; allowed: {allowed}")
        return tau

    def table_from_pascal(self, key: str, stress: Any) -> np.ndarray:
        """Convert the stresses of a table to non-dimensional ones.

        A table is refused if it reaches static friction everywhere, or at its first or last point.
        The stress beyond these two points is constant, so that infinitely many blocks would be
        released at once.

        Parameters
        ----------
        key : str
            Name of the argument, for the message of a refusal.
        stress : array
            In pascal.

        Returns
        -------
        array
        """
        tau = self.stress_from_pascal(key, stress)
        allowed = f"below static friction ({self.static_strength:g} Pa)"
        if tau.min() >= 1.0:
            lowest = self.convert_to_si(float(tau.min()), "stress")
            everywhere = f"at least {lowest:g} Pa everywhere"
            raise ValueError(f"{key}: {everywhere}; allowed: somewhere {allowed}")
        for end, value in (("first", float(tau[0])), ("last", float(tau[-1]))):
            if value >= 1.0:
                refused = self.convert_to_si(value, "stress")
                raise ValueError(f"{key}: {end} value {refused:.6g} Pa; allowed: {allowed}")
        return tau

    def _check_that_something_moves(self, profile: Prestress, dx: float) -> None:
        """Raise ValueError if the initial stress reaches static friction at no block.

        dx : non-dimensional spacing of the blocks, which lie at its multiples
        """
        # The stress is largest at x = 0 or at a point of the table. It is examined at the blocks
        # next to these positions.
        x = np.array([0.0, *(x for x, _ in profile.points)])
        positions_of_blocks = np.concatenate([np.floor(x / dx), np.ceil(x / dx)]) * dx
        largest = float(profile(positions_of_blocks).max())
        if largest < 1.0:
            stress = self.convert_to_si(largest, "stress")
            reached = f"at most {stress:.9g} Pa at a block"
            allowed = (
                f"at least static friction ({self.static_strength:g} Pa) at a block, or a"
                " width_in_metres for a Gaussian at x = 0 that starts the rupture"
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
            If `run` is not such a Dataset, is in SI units already, or has another boundary
            condition or elasticity ratio than the layer.
        """
        _check_run(run)
        if "layer" in run.attrs:
            raise ValueError("run: already in SI units; allowed: a run in the units of the model")
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
        run_layer = layer_of(run.attrs)
        if run_layer is None:
            raise ValueError("run: not in SI units; allowed: a run that to_si returned")
        for field in fields(self):
            value, allowed = getattr(self, field.name), getattr(run_layer, field.name)
            allowed_text = f"{allowed!r}, as in the layer that converted the run"
            check_that(value == allowed, f"layer.{field.name}", value, allowed_text)
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

    def _check_same_layer(self, attributes: Mapping) -> None:
        """Raise ValueError if the boundary or the gamma of a run is not that of this layer."""
        boundary, gamma = attributes["boundary"], attributes["gamma"]
        check_that(boundary == self.boundary, "run: boundary", boundary, repr(self.boundary))
        # Without a held top there are no leaf springs, and gamma of the run is 0.
        expected = self.gamma if self.top == "held" else 0.0
        is_equal = math.isclose(gamma, expected, rel_tol=GAMMA_TOLERANCE)
        check_that(is_equal, "run: gamma", gamma, f"{expected!r}, as in the layer")


def layer_of(attributes: Mapping) -> Layer | None:
    """Return the layer that converted a run to SI units; None if the run is not in SI units.

    attributes : the attributes of the run
    """
    return Layer(**json.loads(attributes["layer"])) if "layer" in attributes else None


def _check_run(run: Any) -> None:
    """Raise ValueError unless the argument is the Dataset of one run."""
    has_fields = hasattr(run, "variables") and "x" in run.variables and "end_time" in run.attrs
    # The Dataset of a sweep has further variables.
    is_run = has_fields and set(run.variables) <= set(VARIABLES)
    allowed = "a Dataset that simulate returned; the function point takes one run out of a sweep"
    check_that(is_run, "run", type(run).__name__, allowed)


def _positions_and_stresses(pair: Any) -> tuple[np.ndarray, np.ndarray]:
    """Convert a pair of sequences to arrays: positions (m) from left to right, and stresses (Pa).

    Raises ValueError if the pair is not a table of at least two points in this order.
    """
    try:
        x, stress = pair
    except (TypeError, ValueError):
        allowed = "a stress in Pa, a pair (positions in m, stresses in Pa), or a file"
        raise ValueError(f"prestress_in_pascal: {short_repr(pair)}; allowed: {allowed}") from None
    positions = as_numbers("prestress_in_pascal positions", x)
    stresses = as_numbers("prestress_in_pascal stresses", stress)
    have_equal_shapes = positions.ndim == 1 and positions.shape == stresses.shape
    are_valid = have_equal_shapes and positions.size >= 2
    allowed = "two or more positions, and as many stresses"
    check_that(are_valid, "prestress_in_pascal", (positions.shape, stresses.shape), allowed)
    before = index_of_first_true(np.diff(positions) < 0.0)
    if before is not None:
        # The position in the row after ``before`` is lower. Rows are counted from 1 in messages.
        wrong = f"position {positions[before + 1]:.10g} m in row {before + 2}"
        allowed = f">= {positions[before]:.10g} m, the position in the row before"
        raise ValueError(f"prestress_in_pascal: {wrong}; allowed: {allowed}")
    return positions, stresses
