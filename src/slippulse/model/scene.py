"""One scene, its parameters, and the values that are refused."""

import inspect
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import wraps
from html import escape
from numbers import Real
from typing import TYPE_CHECKING, Any, Self

from .checks import check_choice, check_kind, check_number, check_that, short_repr
from .friction import COULOMB, Friction, friction_from
from .prestress import Prestress, attributes_of, prestress_from
from .recorded_law import law_of
from .release import RELEASES
from .removed import answer_removed
from .runaway import check_runaway
from .stability import largest_step
from .table_resolution import check_resolved

BOUNDARIES = ("displacement", "stress")
# The lattice in two ways, and the exact solution of its continuum limit.
SCHEMES = ("localised", "fixed_step", "continuum")
ORDERS = (3, 4, 5, 6, 7, 8)
# A lattice holds every bump and each released part of a table from the start, at 200 bytes a block.
FARTHEST_BUMP = 10**6
# After this number of steps, one more no longer moves the time.
MOST_STEPS = 2.0**52
# The attributes of each simulation in a data file.
ATTRIBUTES = """
    boundary gamma beta damping_ratio left right width peak steps_and_bumps duration dx release
    scheme max_step order half_lattice friction_ratio resolved_blocks friction
"""
CHOICES = {"boundary": BOUNDARIES, "release": RELEASES, "scheme": SCHEMES, "order": ORDERS}
# Bounds of the numbers, for `check_number`. The square of the least spacing is still a number.
NUMBERS: dict[str, dict[str, Any]] = {
    "duration": {"above": 0.0},
    "dx": {"above": 0.0, "at_least": 1e-100, "at_most": 1e40},
    "beta": {"at_least": 0.0},
    "friction_ratio": {"at_least": 0.0},
    "gamma": {},
    "max_step": {},
    "order": {"integer": True},
    "resolved_blocks": {"integer": True, "at_least": 1},
}


def takes_damping_ratio(scene: type["Scene"]) -> type["Scene"]:
    """Let the class of scenes be called with ``damping_ratio`` in place of ``beta``."""
    by_fields = scene.__init__
    signature = inspect.signature(by_fields)

    @wraps(by_fields)
    def initialise(
        self: "Scene", *given: Any, damping_ratio: float | None = None, **values: Any
    ) -> None:
        for name in values.keys() - signature.parameters:
            answer_removed("Scene", name)
        arguments = signature.bind_partial(self, *given, **values).arguments
        if damping_ratio is not None:
            allowed = f"damping_ratio or beta (here {short_repr(arguments.get('beta'))}), not both"
            check_that("beta" not in arguments, "damping_ratio", damping_ratio, allowed)
            check_number("damping_ratio", damping_ratio, at_least=0.0)
            spacing = arguments.get("dx")
            check_number("dx", spacing, **NUMBERS["dx"])
            arguments["beta"] = damping_ratio * float(spacing)  # type: ignore[arg-type]
        by_fields(**arguments)

    added = inspect.Parameter("damping_ratio", inspect.Parameter.KEYWORD_ONLY, default=None)
    shown = signature.replace(parameters=[*signature.parameters.values(), added])
    initialise.__signature__ = shown  # type: ignore[attr-defined]
    scene.__init__ = initialise  # type: ignore[method-assign]
    return scene


@takes_damping_ratio
@dataclass(frozen=True)
class Scene:
    """One rupture: the equation's parameters, the pre-stress, the lattice and the scheme.

    The sliding lattice obeys, for slip u_i and slip velocity v_i at spacing dx,

        dv_i/dt = (u_{i+1} - 2 u_i + u_{i-1})/dx^2 - Gamma gamma u_i + tau_i
                  + beta (v_{i+1} - 2 v_i + v_{i-1})/dx^2 - f_i.

    A block is released when its stress reaches 1 and sticks when its velocity reaches 0. The
    friction f_i is what a law makes of v_i and of the slip since the release; it is 0 in the paper.

    Source: equation (5) of the paper with the sign of its damping corrected, section II A and
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
        Damping, >= 0. The ratio beta/dx selects the front speed.
    damping_ratio : float, optional
        beta/dx, given by its name in place of beta. A scene keeps beta: `dataclasses.replace` with
        another dx leaves beta as it is.
    release : {"total", "elastic"}
        The stress compared with 1 includes the damping force ("total") or not.
    scheme : {"localised", "fixed_step", "continuum"}
        Taylor steps with each release and stick at its instant; symplectic Euler with events
        checked once a step; or the exact solution of the continuum limit.
    max_step : float, units of dx / wave speed
        Largest time step, the step itself under "fixed_step"; not used by "continuum".
    order : int
        Order of the Taylor step, 3 to 8; used by "localised" alone.
    half_lattice : bool
        Simulate only x >= 0 when the pre-stress is symmetric.
    friction_ratio : float
        mu_k/(mu_s - mu_k), >= 0. Reverse sliding begins at the stress -(1 + 2 friction_ratio).
    resolved_blocks : int
        A pulse of fewer sliding blocks is flagged: its width errs by about a block.
    friction : Friction
        Law of friction of a sliding block, which `friction` makes. "fixed_step" takes any;
        "continuum" takes "coulomb" and "linear_rate"; "localised" takes "rate_weakening" and
        "slip_weakening", too.

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
    duration: float
    dx: float
    gamma: float = 0.0
    beta: float = 0.0
    release: str = "total"
    scheme: str = "localised"
    max_step: float = 0.2
    order: int = 4
    half_lattice: bool = True
    friction_ratio: float = 5.0
    resolved_blocks: int = 8
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
        for name, bounds in NUMBERS.items():
            check_number(name, getattr(self, name), **bounds)
            # Numbers of other types would be computed with as such, and compiled for.
            kind = int if "integer" in bounds else float
            object.__setattr__(self, name, kind(getattr(self, name)))
        width, allowed = self.prestress.width, f">= dx = {self.dx:g}, which must see the peak"
        check_that(width is None or width >= self.dx, "prestress.width", width, allowed)
        if self.prestress.points and self.scheme != "continuum":
            check_resolved(self.prestress, self.dx)
            reach = self.prestress.nucleation_reach
            check_number("prestress.points reach", reach, at_most=FARTHEST_BUMP * self.dx)
        for centre, _, width in self.prestress.bumps:
            reach = abs(centre) + 4.0 * width
            check_number("prestress.bumps reach", reach, at_most=FARTHEST_BUMP * self.dx)
        self._check_step()

    def _check_physics(self) -> None:
        if self.boundary == "displacement":
            check_number("gamma", self.gamma, above=0.0)
        else:
            allowed = "0 or left out under boundary 'stress' (no leaf springs)"
            absent = isinstance(self.gamma, Real) and self.gamma == 0.0
            check_that(absent, "gamma", self.gamma, allowed)
        check_runaway(self.gamma, self.friction.traits.linear_rate, "friction.alpha")
        schemes = self.friction.schemes
        allowed = f"{' or '.join(schemes)}, with friction law {self.friction.law!r}"
        check_that(self.scheme in schemes, "scheme", self.scheme, allowed)

    def _check_step(self) -> None:
        bound = self.largest_stable_step
        damping_ratio, stiffness, _ = self.ratios
        ratios = f"beta/dx = {damping_ratio:.4g}, gamma dx^2 = {stiffness:.4g}"
        if not (math.isfinite(stiffness) and math.isfinite(damping_ratio) and bound > 0.0):
            allowed = "numbers for which a stable step can be computed"
            raise ValueError(f"gamma: {self.gamma!r}, at {ratios}; allowed: {allowed}")
        # An overflow above makes the step of a preset 0, and is then what must be named.
        check_number("max_step", self.max_step, above=0.0)
        if self.scheme != "continuum":
            check_number("duration", self.duration, at_most=MOST_STEPS * self.max_step * self.dx)
        if self.max_step > bound:
            if self.friction != COULOMB:
                ratios += f", friction {json.dumps(self.friction.mapping())}"
            allowed = f"<= {bound:.4g} (in units of dx), the stability bound of scheme"
            refused = f"max_step: {self.max_step!r}; allowed: {allowed} {self.scheme!r}"
            raise ValueError(f"{refused} at {ratios}")

    @property
    def damping_ratio(self) -> float:
        """The ratio beta/dx, which selects the front speed."""
        return self.beta / self.dx

    @property
    def symmetric(self) -> bool:
        """True where half the lattice is simulated."""
        return self.half_lattice and self.prestress.symmetric

    @property
    def reverse_threshold(self) -> float:
        """Stress -(1 + 2 mu_k/(mu_s - mu_k)) at which a block would slide backwards."""
        return -(1.0 + 2.0 * self.friction_ratio)

    @property
    def largest_stable_step(self) -> float:
        """Largest stable time step in units of dx."""
        bound = largest_step(self.scheme, self.order, *self.ratios)
        return min(bound, self.friction.traits.longest_step / self.dx)

    @property
    def ratios(self) -> tuple[float, float, float]:
        """The numbers that a stable step follows from, for `slippulse.model.stability`."""
        traits = self.friction.traits
        return self.damping_ratio, self.gamma * self.dx**2, traits.steepest * self.dx

    def attributes(self) -> dict:
        """Every parameter as a plain number or text, for a data file; see `from_attributes`."""
        values = vars(self) | attributes_of(self.prestress)
        values |= {"half_lattice": int(self.half_lattice), "damping_ratio": self.damping_ratio}
        values["friction"] = json.dumps(self.friction.mapping())
        return {name: values[name] for name in ATTRIBUTES.split()}

    def _repr_html_(self) -> str:
        """The parameters as a table, for a notebook."""
        cells = ((name, escape(str(value))) for name, value in self.attributes().items())
        rows = "".join(f"<tr><th>{name}</th><td>{value}</td></tr>" for name, value in cells)
        return f"<table>{rows}</table>"

    @classmethod
    def from_attributes(cls, attributes: Mapping) -> Self:
        """The scene of a simulation's attributes, or of its row in a measured table.

        The attributes are as `attributes` writes them; older files have rate_strengthening, or no
        friction.
        """
        given = hasattr(attributes, "keys")
        check_that(given, "attributes", attributes, "a mapping of names to values")
        try:
            # A netCDF file returns numbers of numpy's types.
            values = {name: getattr(v, "item", lambda v=v: v)() for name, v in attributes.items()}
            values |= {"friction": friction_from(law_of(values))}
            values["prestress"] = prestress_from(values)
            check_number("half_lattice", values["half_lattice"], True, at_least=0, at_most=1)
            values["half_lattice"] = bool(values["half_lattice"])
            return cls(**{name: values[name] for name in cls.__dataclass_fields__})
        except KeyError as error:
            allowed = "every attribute of a run"
            raise ValueError(f"{error.args[0]}: missing; allowed: {allowed}") from None


# Numbers of a run that everything that reads it computes with.
COUNTED = ("end_time", "releases", "re_releases", "half_lattice_used", "first_stick_time")


def check_run_attributes(attributes: Mapping) -> None:
    """Refuse attributes of a run, such as those of a file, that are not of their kind."""
    Scene.from_attributes(attributes)
    for name in COUNTED:
        value = attributes.get(name)
        check_that(isinstance(value, Real), name, value, "a number, as simulate returns it")
