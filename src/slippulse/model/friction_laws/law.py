"""The type that all laws of friction have, and the law of the paper."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, astuple, dataclass
from typing import Any, ClassVar, NamedTuple

from ..checks import check_number

# The longest step over the time in which slip or slip rate grows e-fold where friction weakens.
RESOLVED = 0.5


class Bend(NamedTuple):
    """Friction that falls linearly with slip or slip rate, and is constant beyond a bend."""

    rate: int  # 0: it falls with the slip since the release; 1: with slip rate
    fall: float  # its slope before the bend
    end: float  # slip or slip rate at the bend
    lowest: float  # friction from there on


class Traits(NamedTuple):
    """Properties of a law that solvers need besides its friction."""

    linear_rate: float = 0.0  # alpha, where friction is alpha du/dt
    bend: Bend | None = None  # where friction is piecewise linear
    steepest: float = 0.0  # upper bound on the slope of friction over slip rate
    drive: float = 0.0  # upper bound on the friction that drives slip instead of resisting it
    zone: float = 0.0  # half-length around x = 0 without friction, which nucleates the rupture
    longest_step: float = math.inf  # longest time step that resolves the law


@dataclass(frozen=True)
class Friction(ABC):
    """Friction of a sliding block: 0 at the kinetic, 1 at the static friction of the paper.

    A law is a subclass. Its fields are its parameters, with ``bounds`` as `check_number` takes
    them. `friction` is compiled into the textbook scheme; it gets the slip since the release, the
    slip velocity and the first two parameters, 0 where there are fewer.
    """

    law: ClassVar[str]
    schemes: ClassVar[tuple[str, ...]] = ("fixed_step",)
    bounds: ClassVar[Mapping[str, Mapping[str, Any]]] = {}

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            check_number(name, value, **self.bounds.get(name, {}))
            # Whole numbers would be computed with as such, and compiled for.
            object.__setattr__(self, name, float(value))

    @staticmethod
    @abstractmethod
    def friction(slip, velocity, first, second):
        """Friction of a block."""

    @property
    def traits(self) -> Traits:
        """Traits of the law and its parameters."""
        return Traits()

    @property
    def constants(self) -> tuple[float, float]:
        """The first two parameters, which `friction` gets."""
        first, second, *_ = (*astuple(self), 0.0, 0.0)
        return first, second

    def mapping(self) -> dict[str, Any]:
        """The law and its parameters by name, as the configuration spells them."""
        return {"law": self.law, **asdict(self)}


class Coulomb(Friction):
    """Amontons-Coulomb friction: kinetic from the release on, which is 0 here."""

    law: ClassVar = "coulomb"
    schemes: ClassVar = ("localised", "fixed_step", "continuum")

    @staticmethod
    def friction(slip, velocity, first, second):
        """Return 0, the kinetic friction."""
        return 0.0
