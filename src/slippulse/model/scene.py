"""The scene of one rupture: all its parameters, and the checks of their values."""

import inspect
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial, wraps
from html import escape
from numbers import Real
from typing import TYPE_CHECKING, Any, NamedTuple, Self

from .checks import check_choice, check_kind, check_number, check_that, refusal, short_repr
from .friction import COULOMB, Friction, friction_from
from .prestress import BUMP_REACH_IN_WIDTHS, Prestress, attributes_of, prestress_from
from .recorded_law import read_recorded_law
from .release import RELEASES
from .removed import refuse_removed_argument
from .runaway import check_runaway
from .scene_numbers import definitions_of, number
from .stability import largest_step
from .table_resolution import check_resolved

BOUNDARIES = ("displacement", "stress")
# Two ways to solve the lattice, and the exact solution of its continuum limit.
SCHEMES = ("localised", "fixed_step", "continuum")
ORDERS = (3, 4, 5, 6, 7, 8)
# The lattice contains all bumps and all released parts of a table from the start, with 200 bytes
# for each block. The distance of such a bump or part from x = 0 may be at most this number of
# blocks.
MAX_REACH_IN_BLOCKS = 10**6
# After this number of steps, adding one more step does not change the time, by rounding.
MAX_STEPS = 2.0**52
CHOICES = {"boundary": BOUNDARIES, "release": RELEASES, "scheme": SCHEMES, "order": ORDERS}


def takes_damping_ratio(scene: type["Scene"]) -> type["Scene"]:
    """Add the argument ``damping_ratio`` to the class `Scene`, as an alternative to ``beta``.

    The dataclass itself has no such field. This decorator replaces its ``__init__`` by one that
    converts the argument to ``beta`` and then calls the original one.
    """
    original_init = scene.__init__
    signature = inspect.signature(original_init)

    @wraps(original_init)
    def initialise(
        self: "Scene", *given: Any, damping_ratio: float | None = None, **values: Any
    ) -> None:
        """Convert damping_ratio to beta, and call the original ``__init__``."""
        # Arguments of earlier versions have an error message of their own.
        for name in values.keys() - signature.parameters:
            refuse_removed_argument("Scene", name)
        # All arguments by name, including those that were given by position.
        bind_values = partial(signature.bind_partial, self, *given)
        arguments = bind_values(**values).arguments
        if damping_ratio is not None:
            allowed = f"damping_ratio or beta (here {short_repr(arguments.get('beta'))}), not both"
            check_that("beta" not in arguments, "damping_ratio", damping_ratio, allowed)
            check_number("damping_ratio", damping_ratio, at_least=0.0)
            dx = arguments.get("dx")
            check_number("dx", dx, **SCENE_NUMBERS["dx"].bounds)
            arguments["beta"] = damping_ratio * float(dx)  # type: ignore[arg-type]
        original_init(**arguments)

    # Help and editors show the signature, which gets the new argument at its end.
    added = inspect.Parameter("damping_ratio", inspect.Parameter.KEYWORD_ONLY, default=None)
    new_signature = signature.replace(parameters=[*signature.parameters.values(), added])
    initialise.__signature__ = new_signature  # type: ignore[attr-defined]
    scene.__init__ = initialise  # type: ignore[method-assign]
    return scene


class StabilityRatios(NamedTuple):
    """Dimensionless numbers on which the stable step depends (see `slippulse.model.stability`)."""

    damping_ratio: float  # beta/dx
    stiffness: float  # stiffness of the leaf spring of a block, times dx^2
    friction_slope: float  # largest derivative of friction by slip velocity, times dx


@takes_damping_ratio
@dataclass(frozen=True)
class Scene:
    """One rupture: the parameters of the equation, the pre-stress, the lattice and the scheme.

    On a lattice of spacing dx, a sliding block i with slip u_i and slip velocity v_i obeys

        dv_i/dt = (u_{i+1} - 2 u_i + u_{i-1})/dx^2 - Gamma gamma u_i + tau_i
                  + beta (v_{i+1} - 2 v_i + v_{i-1})/dx^2 - f_i.

    A block is released when its stress reaches 1, and sticks when its velocity reaches 0. The
    friction f_i is a function of v_i and of the slip since the release; it is 0 in the paper.

    Source: equation (5) of the paper, with the sign of its damping corrected, section II A and
    appendix B. Other laws of friction are an addition of this project.

    Parameters
    ----------
    boundary : {"displacement", "stress"}
        Condition at the top of the layer: Gamma = 1 or Gamma = 0.
    prestress : Prestress
        Profile of the pre-stress tau(x).
    duration : float, units of H / wave speed
        Time to simulate, > 0.
    dx : float, units of H
        Block spacing, from 1e-100 to 1e40. At 1 the lattice is the Burridge-Knopoff model.
    gamma : float
        Elasticity ratio 2G/(lambda + 2G): > 0 under "displacement", 0 under "stress".
    beta : float, units of H times the wave speed
        Damping, >= 0. The front speed depends on it through the ratio beta/dx.
    damping_ratio : float, optional
        beta/dx, which can be given in place of beta. The scene itself stores beta, so that
        `dataclasses.replace` with another dx leaves beta as it is.
    release : {"total", "elastic"}
        The stress that is compared with 1 includes the damping force ("total"), or excludes it
        ("elastic").
    scheme : {"localised", "fixed_step", "continuum"}
        "localised": Taylor steps, with each release and stick at its exact time. "fixed_step":
        symplectic Euler, with releases and sticks checked once in each step. "continuum": the exact
        solution of the continuum limit.
    max_step : float, units of dx / wave speed
        Largest time step. Under "fixed_step" every step has this length; "continuum" ignores it.
    order : int
        Order of the Taylor step, 3 to 8; used only by "localised".
    half_lattice : bool
        If True, only x >= 0 is simulated when the pre-stress is symmetric.
    friction_ratio : float
        mu_k/(mu_s - mu_k), >= 0. A block slides backwards if its stress is below
        -(1 + 2 friction_ratio).
    resolved_blocks : int
        A pulse with fewer sliding blocks is flagged, since the error of its width is about a block.
    friction : Friction
        Friction law of a sliding block, made by the function `friction`. The scheme "fixed_step"
        takes any law. "continuum" takes "coulomb" and "linear_rate". "localised" takes these two,
        "rate_weakening" and "slip_weakening".

    Raises
    ------
    ValueError
        In one line that names the key, the value and what is allowed.

    Examples
    --------
    >>> profile = sp.Prestress(0.6, 0.6)
    >>> scene = sp.Scene("displacement", profile, duration=15.0, dx=0.01, gamma=0.65)
    >>> sp.Scene("stress", profile, duration=15.0, dx=0.01, damping_ratio=0.1).beta
    0.001
    """

    boundary: str
    prestress: Prestress
    duration: float = number(
        "simulated time, in units of H divided by the wave speed", "T", above=0.0
    )
    # At both limits, the square of the spacing can still be represented as a float.
    dx: float = number(
        "spacing of the blocks, in units of H",
        r"\Delta x",
        above=0.0,
        at_least=1e-100,
        at_most=1e40,
    )
    gamma: float = number(
        "elasticity ratio 2G/(lambda + 2G); 0 if the stress is held on top", r"\gamma", 0.0
    )
    beta: float = number("damping, in units of H times the wave speed", r"\beta", 0.0, at_least=0.0)
    release: str = "total"
    scheme: str = "localised"
    max_step: float = number("largest time step divided by dx", r"\Delta t/\Delta x", 0.2)
    order: int = number("order of the Taylor series of a time step", "n", 4, integer=True)
    half_lattice: bool = True
    friction_ratio: float = number(
        "ratio mu_k/(mu_s - mu_k) of kinetic friction to the drop from static to kinetic friction",
        r"\mu_k/(\mu_s - \mu_k)",
        5.0,
        at_least=0.0,
    )
    resolved_blocks: int = number(
        "number of sliding blocks below which a pulse is flagged",
        "N",
        8,
        unit="count",
        integer=True,
        at_least=1,
    )
    friction: Friction = COULOMB

    if TYPE_CHECKING:

        def __init__(
            self,
            boundary: str,
            prestress: Prestress,
            duration: float,
            dx: float,
            *given: Any,
            damping_ratio: float | None = None,
            **values: Any,
        ) -> None: ...

    def __post_init__(self) -> None:
        for name, choices in CHOICES.items():
            check_choice(name, getattr(self, name), choices)
        check_kind("half_lattice", self.half_lattice, bool)
        check_kind("prestress", self.prestress, Prestress)
        check_kind("friction", self.friction, Friction)
        self._check_physics()
        for name, definition in SCENE_NUMBERS.items():
            check_number(name, getattr(self, name), **definition.bounds)
            # A number of another type would make numba compile the kernels a second time, or would
            # be less precise.
            number_type = int if "integer" in definition.bounds else float
            object.__setattr__(self, name, number_type(getattr(self, name)))
        if self.scheme == "continuum":
            refuse_extra_terms(vars(self), "with scheme 'continuum', which has no extra terms")
        self._check_profile()
        self._check_step()

    def _check_profile(self) -> None:
        """Raise ValueError if the lattice does not resolve the pre-stress, or would be too long."""
        # The width is None if there is no Gaussian at x = 0.
        peak_width = self.prestress.width
        is_resolved = peak_width is None or peak_width >= self.dx
        allowed = f">= dx = {self.dx:g}, so that the blocks resolve the Gaussian"
        check_that(is_resolved, "prestress.width", peak_width, allowed)
        # At its start, the lattice already extends over all bumps and over all points that reach 1.
        # If they are far away, this needs too much memory.
        max_reach = MAX_REACH_IN_BLOCKS * self.dx
        # The exact solution (scheme "continuum") uses the points of a table without a lattice.
        if self.prestress.points and self.scheme != "continuum":
            check_resolved(self.prestress, self.dx)
            reach = self.prestress.nucleation_reach
            check_number("prestress.points reach", reach, at_most=max_reach)
        for centre, _, width in self.prestress.bumps:
            reach = abs(centre) + BUMP_REACH_IN_WIDTHS * width
            check_number("prestress.bumps reach", reach, at_most=max_reach)

    def _check_physics(self) -> None:
        """Raise ValueError if gamma or the friction law does not fit the other parameters.

        Leaf springs need a held top. Friction alpha v must not let slip grow without limit, and the
        scheme must be able to solve the friction law.
        """
        if self.boundary == "displacement":
            check_number("gamma", self.gamma, above=0.0)
        else:
            allowed = "0 or left out under boundary 'stress', which has no leaf springs"
            is_zero = isinstance(self.gamma, Real) and self.gamma == 0.0
            check_that(is_zero, "gamma", self.gamma, allowed)
        check_runaway(self.gamma, self.friction.traits.linear_rate, "friction.alpha")
        schemes = self.friction.schemes
        allowed = f"{' or '.join(schemes)}, with friction law {self.friction.law!r}"
        check_that(self.scheme in schemes, "scheme", self.scheme, allowed)

    def _check_step(self) -> None:
        """Raise ValueError if the time step is unstable, or too small for the duration."""
        largest = self.largest_stable_step
        damping_ratio, stiffness, _ = self.ratios
        ratios = f"beta/dx = {damping_ratio:.4g}, stiffness dx^2 = {stiffness:.4g}"
        if not (math.isfinite(stiffness) and math.isfinite(damping_ratio) and largest > 0.0):
            allowed = "numbers from which a stable time step can be computed"
            raise ValueError(f"gamma: {self.gamma!r}, at {ratios}; allowed: {allowed}")
        # Presets compute max_step from the stable step. If that overflows, max_step is 0. The
        # message above names the cause, so that max_step is checked only after it.
        check_number("max_step", self.max_step, above=0.0)
        if self.scheme != "continuum":
            longest_duration = MAX_STEPS * self.max_step * self.dx
            check_number("duration", self.duration, at_most=longest_duration)
        if self.max_step > largest:
            if self.friction != COULOMB:
                ratios += f", friction {json.dumps(self.friction.mapping())}"
            allowed = f"<= {largest:.4g} (in units of dx), the stability bound of scheme"
            refused = f"max_step: {self.max_step!r}; allowed: {allowed} {self.scheme!r}"
            raise ValueError(f"{refused} at {ratios}")

    @property
    def damping_ratio(self) -> float:
        """Ratio beta/dx, on which the front speed depends."""
        return self.beta / self.dx

    @property
    def symmetric(self) -> bool:
        """True if only half of the lattice is simulated."""
        return self.half_lattice and self.prestress.symmetric

    @property
    def reverse_threshold(self) -> float:
        """Stress -(1 + 2 mu_k/(mu_s - mu_k)) at which a block would slide backwards."""
        return -(1.0 + 2.0 * self.friction_ratio)

    @property
    def largest_stable_step(self) -> float:
        """Largest time step, in units of dx, that is stable and resolves the friction law."""
        stable = largest_step(self.scheme, self.order, *self.ratios)
        return min(stable, self.friction.traits.longest_step / self.dx)

    @property
    def ratios(self) -> StabilityRatios:
        """Dimensionless numbers on which the stable step depends."""
        return stability_ratios(vars(self), self.friction)

    def attributes(self) -> dict:
        """Return all parameters as plain numbers and texts, in the form of a data file.

        `from_attributes` makes the scene from them.
        """
        values = vars(self) | attributes_of(self.prestress)
        values["damping_ratio"] = self.damping_ratio
        # A netCDF file has neither True and False nor mappings.
        values["half_lattice"] = int(self.half_lattice)
        values["friction"] = json.dumps(self.friction.mapping())
        return {name: values[name] for name in ATTRIBUTES}

    def _repr_html_(self) -> str:
        """Return the parameters as an HTML table, which a notebook shows."""
        rows = []
        for name, value in self.attributes().items():
            rows.append(f"<tr><th>{name}</th><td>{escape(str(value))}</td></tr>")
        return f"<table>{''.join(rows)}</table>"

    @classmethod
    def from_attributes(cls, attributes: Mapping) -> Self:
        """Make a scene from the attributes of a data file, or from a row of a measured table.

        The attributes have the names that the method `attributes` returns. Older files have
        ``rate_strengthening`` in place of ``friction``, or neither. Raises ValueError if an
        attribute is missing or not allowed.
        """
        is_mapping = hasattr(attributes, "keys")
        check_that(is_mapping, "attributes", attributes, "a mapping of names to values")
        try:
            # A file that is older than an extra term does not have it.
            values: dict[str, Any] = dict(DEFAULTS_OF_EXTRA_TERMS)
            for name, value in attributes.items():
                # Numbers from a netCDF file have types of numpy.
                values[name] = value.item() if hasattr(value, "item") else value
            values["friction"] = friction_from(read_recorded_law(values))
            values["prestress"] = prestress_from(values)
            half_lattice = values["half_lattice"]
            check_number("half_lattice", half_lattice, integer=True, at_least=0, at_most=1)
            values["half_lattice"] = bool(half_lattice)
            return cls(**{name: values[name] for name in cls.__dataclass_fields__})
        except KeyError as error:
            allowed = "every attribute of a run"
            raise ValueError(f"{error.args[0]}: missing; allowed: {allowed}") from None


# The numbers of a scene in the order of its fields.
SCENE_NUMBERS = definitions_of(Scene)
# The numbers that are coefficients of terms that the paper's equation does not have.
EXTRA_TERMS = {name: term for name, term in SCENE_NUMBERS.items() if term.extra_term}
DEFAULTS_OF_EXTRA_TERMS = {name: term.default for name, term in EXTRA_TERMS.items()}
# Names of the attributes that describe a simulation in a data file.
ATTRIBUTES = (
    "boundary",
    "gamma",
    "beta",
    "damping_ratio",
    "left",
    "right",
    "width",
    "peak",
    "steps_and_bumps",
    "duration",
    "dx",
    "release",
    "scheme",
    "max_step",
    "order",
    "half_lattice",
    "friction_ratio",
    "resolved_blocks",
    "friction",
    *EXTRA_TERMS,
)


def used_extra_terms(values: Mapping) -> dict[str, float]:
    """Return the coefficients of the extra terms that a scene or a run has.

    An extra term is used if its coefficient differs from the default value.

    values : parameters of the scene or run by name
    """
    used_terms = {}
    for name, default in DEFAULTS_OF_EXTRA_TERMS.items():
        value = values.get(name, default)
        if value != default:
            used_terms[name] = value
    return used_terms


def refuse_extra_terms(values: Mapping, condition: str) -> None:
    """Raise ValueError if an extra term is used.

    values : parameters of a scene or run by name
    condition : the end of the message, which names the condition for which no extra term is allowed
    """
    for name, value in used_extra_terms(values).items():
        raise refusal(name, value, f"{DEFAULTS_OF_EXTRA_TERMS[name]:g} {condition}")


def gamma_without_extra_terms(attributes: Mapping) -> float:
    """Return gamma of a run; NaN if it has extra terms, which may resist slip as leaf springs do.

    attributes : parameters of the run by name
    """
    return math.nan if used_extra_terms(attributes) else attributes["gamma"]


def stability_ratios(values: Mapping, friction: Friction) -> StabilityRatios:
    """Return the dimensionless numbers on which the stable step depends: parameters in units of dx.

    values : parameters of a scene by name
    """
    dx = values["dx"]
    return StabilityRatios(
        damping_ratio=values["beta"] / dx,
        stiffness=values["gamma"] * dx**2,
        friction_slope=friction.traits.max_rate_slope * dx,
    )


# Results among the attributes of a run that measurements and figures need.
REQUIRED_RESULTS = ("end_time", "releases", "re_releases", "half_lattice_used", "first_stick_time")


def check_run_attributes(attributes: Mapping) -> None:
    """Raise ValueError if attributes of a run are missing or not allowed.

    The attributes are the parameters of the scene, and the results that measurements and figures
    need.
    """
    Scene.from_attributes(attributes)
    for name in REQUIRED_RESULTS:
        value = attributes.get(name)
        check_that(isinstance(value, Real), name, value, "a number, which simulate records")
