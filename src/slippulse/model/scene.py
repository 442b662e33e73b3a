"""What is modelled: one scene, its parameters, and what is refused."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from numbers import Real
from typing import Any, Self

from .checks import check_choice, check_kind, check_number, check_runaway, short_repr
from .prestress import Prestress, prestress_from
from .stability import MARGIN, largest_step

BOUNDARIES = ("displacement", "stress")
RELEASES = ("total", "elastic")
# The lattice in two ways, and the exact solution of its continuum limit.
SCHEMES = ("localised", "fixed_step", "continuum")
ORDERS = (3, 4, 5, 6, 7, 8)
# A lattice holds every bump from the start, at 200 bytes a block.
FARTHEST_BUMP = 10**6
# After this number a step no longer moves the time.
MOST_STEPS = 2.0**52
# What a data file has of each run.
ATTRIBUTES = (
    "boundary", "gamma", "beta", "damping_ratio", "left", "right", "width", "peak", "steps_and_bumps", "duration", "dx",
    "release", "scheme", "max_step", "order", "half_lattice", "friction_ratio", "resolved_blocks", "rate_strengthening",
)  # fmt: skip
# As Python has them: a data file has numbers of its own.
KINDS = {"half_lattice": bool, "order": int, "resolved_blocks": int}


@dataclass(frozen=True)
class Scene:
    """One rupture: the equation's parameters, the pre-stress, the lattice and the scheme.

    The sliding lattice obeys, for slip u_i and slip velocity v_i at spacing dx,

        dv_i/dt = (u_{i+1} - 2 u_i + u_{i-1})/dx^2 - Gamma gamma u_i + tau_i + beta (v_{i+1} - 2 v_i + v_{i-1})/dx^2
                  - alpha v_i.

    A block is released when its stress reaches 1 and sticks when its velocity reaches 0.

    Parameters
    ----------
    boundary : "displacement" or "stress", the condition at the top of the layer: Gamma = 1 or Gamma = 0
    prestress : the profile of the pre-stress tau(x)
    duration : time to simulate (units of H / wave speed), > 0
    dx : block spacing (units of H), >= 1e-100; 1 is the Burridge-Knopoff model
    gamma : elasticity ratio 2G/(lambda + 2G); > 0 under "displacement", left at 0 under "stress"
    beta : damping, >= 0; what selects the front speed is beta/dx
    release : "total" or "elastic", whether the released stress includes the damping force
    scheme : "localised" (Taylor steps with each release and stick at its instant), "fixed_step" (symplectic Euler,
        events checked once a step) or "continuum" (the exact solution of the continuum limit)
    max_step : largest time step in units of dx; the step itself under "fixed_step"; not used by "continuum"
    order : of the Taylor step, 3 to 8; used by "localised" alone
    half_lattice : simulate x >= 0 only when the pre-stress is symmetric
    friction_ratio : mu_k/(mu_s - mu_k), >= 0; sets the threshold of reverse sliding, -(1 + 2 friction_ratio)
    resolved_blocks : a pulse of fewer sliding blocks is flagged as unresolved: its width errs by about a block
    rate_strengthening : alpha (units of wave speed / H), by which friction grows (> 0) or weakens (< 0) with slip rate;
        refused where slip would run away: alpha <= -2 sqrt(gamma), alpha < 0 under "stress"

    Raises ValueError: one line naming the key, the value and what is allowed.

    Source: equation (5) of the paper with the damping's sign corrected, its section II A, and its appendix B.
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
    rate_strengthening: float = 0.0

    def __post_init__(self) -> None:
        check_choice("boundary", self.boundary, BOUNDARIES)
        check_choice("release", self.release, RELEASES)
        check_choice("scheme", self.scheme, SCHEMES)
        check_choice("order", self.order, ORDERS)
        for name, kind in KINDS.items():
            if type(getattr(self, name)) is not kind:
                allowed = "true or false" if kind is bool else "a whole number >= 1"
                raise ValueError(f"{name}: {short_repr(getattr(self, name))}; allowed: {allowed}")
        check_kind("prestress", self.prestress, Prestress)
        check_number("duration", self.duration, above=0.0)
        # Its square must be one.
        check_number("dx", self.dx, above=0.0, at_least=1e-100)
        check_number("beta", self.beta, at_least=0.0)
        check_number("friction_ratio", self.friction_ratio, at_least=0.0)
        check_number("resolved_blocks", self.resolved_blocks, at_least=1)
        if self.boundary == "displacement":
            check_number("gamma", self.gamma, above=0.0)
        elif not isinstance(self.gamma, Real) or isinstance(self.gamma, bool) or self.gamma != 0.0:
            allowed = "0 or left out under boundary 'stress' (no leaf springs)"
            raise ValueError(f"gamma: {short_repr(self.gamma)}; allowed: {allowed}")
        check_number("rate_strengthening", self.rate_strengthening)
        check_runaway(float(self.gamma), float(self.rate_strengthening))
        for centre, _, width in self.prestress.bumps:
            check_number(
                "prestress.bumps reach", abs(centre) + 4.0 * width, at_most=FARTHEST_BUMP * self.dx
            )
        if self.prestress.width < self.dx:
            raise ValueError(
                f"prestress.width: {self.prestress.width!r}; allowed: >= dx = {self.dx:g}, which must see the peak"
            )
        stiffness = float(self.gamma) * float(self.dx) ** 2
        bound = self._stable_step(
            self.max_step / MARGIN if isinstance(self.max_step, float) else math.inf
        )
        at = f"beta/dx = {self.damping_ratio:.4g}, gamma dx^2 = {stiffness:.4g}"
        if not (math.isfinite(stiffness) and math.isfinite(self.damping_ratio) and bound > 0.0):
            allowed = "numbers for which a stable step can be computed"
            raise ValueError(f"gamma: {self.gamma!r}, at {at}; allowed: {allowed}")
        check_number("max_step", self.max_step, above=0.0)
        if self.scheme != "continuum":
            check_number("duration", self.duration, at_most=MOST_STEPS * self.max_step * self.dx)
        # Single-precision or integer parameters would be computed with as such, and compiled for.
        for name in (
            "duration",
            "dx",
            "gamma",
            "beta",
            "max_step",
            "friction_ratio",
            "rate_strengthening",
        ):
            object.__setattr__(self, name, float(getattr(self, name)))
        if self.max_step > bound:
            drag = f", rate_strengthening dx = {self.rate_strengthening * self.dx:.4g}"
            raise ValueError(
                f"max_step: {self.max_step!r}; allowed: <= {bound:.4g} (in units of dx), the stability bound of scheme"
                f" {self.scheme!r} at {at}{drag if self.rate_strengthening else ''}"
            )

    @property
    def damping_ratio(self) -> float:
        """beta/dx, which selects the front speed."""
        return self.beta / self.dx

    @property
    def symmetric(self) -> bool:
        """Whether the scene is simulated on half the lattice."""
        return self.half_lattice and self.prestress.symmetric

    @property
    def reverse_threshold(self) -> float:
        """Stress at which a block would slide backwards, -(1 + 2 mu_k/(mu_s - mu_k))."""
        return -(1.0 + 2.0 * self.friction_ratio)

    @property
    def largest_stable_step(self) -> float:
        """Largest stable time step in units of dx."""
        return self._stable_step(math.inf)

    def _stable_step(self, enough: float) -> float:
        stiffness, drag = self.gamma * self.dx**2, self.rate_strengthening * self.dx
        return largest_step(self.scheme, self.order, self.damping_ratio, stiffness, drag, enough)

    def attributes(self) -> dict:
        """Every parameter as plain numbers and text, for attributes of a data file; inverse of `from_attributes`."""
        parts = {name: getattr(self.prestress, name) for name in ("steps", "bumps")}
        values = vars(self.prestress) | vars(self) | {"half_lattice": int(self.half_lattice)}
        values |= {"damping_ratio": self.damping_ratio, "steps_and_bumps": json.dumps(parts)}
        return {name: values[name] for name in ATTRIBUTES}

    def _repr_html_(self) -> str:
        """The parameters as a table, for a notebook."""
        cells = ((name, escape(str(value))) for name, value in self.attributes().items())
        rows = "".join(f"<tr><th>{name}</th><td>{value}</td></tr>" for name, value in cells)
        return f"<table>{rows}</table>"

    @classmethod
    def from_attributes(cls, attributes: Mapping) -> Self:
        """The scene of a run, of the attributes of its Dataset or its row of a measured table.

        Raises ValueError: if a parameter is missing or is none that `attributes` writes.
        """
        if not hasattr(attributes, "keys"):
            raise ValueError(
                f"attributes: {short_repr(attributes)}; allowed: a mapping of names to values"
            )
        try:
            for name, kind in KINDS.items():
                most = 1 if kind is bool else None
                check_number(name, attributes[name], whole=True, at_least=0, at_most=most)
            # Data files of the paper's model need not name the rate strengthening.
            given = {
                "rate_strengthening": 0.0,
                **attributes,
                "prestress": prestress_from(attributes),
            }
            given |= {name: kind(given[name]) for name, kind in KINDS.items()}
            return cls(**{name: given[name] for name in cls.__dataclass_fields__})
        except KeyError as error:
            raise ValueError(
                f"{error.args[0]}: missing; allowed: every attribute of a run"
            ) from None


def scene_of(run: Any) -> Scene:
    """The scene of a run: of a Dataset, of its attributes, or of a row of a measured table (itertuples or Series).

    Raises as `Scene.from_attributes` does.
    """
    attributes = run._asdict() if hasattr(run, "_asdict") else getattr(run, "attrs", None)
    return Scene.from_attributes(attributes or run)
