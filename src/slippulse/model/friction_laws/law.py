"""The base class of all friction laws, and Coulomb friction, the law of the paper."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, astuple, dataclass
from typing import Any, ClassVar, NamedTuple

from ..checks import check_number

# Where friction weakens, slip or slip rate grows exponentially. The longest time step is this
# fraction of the time in which it grows by a factor e.
STEP_PER_GROWTH_TIME = 0.5


# Values of `LawKink.argument_row`: rows of the table of time derivatives of slip in the kernels.
SLIP_ROW, SLIP_RATE_ROW = 0, 1


class LawKink(NamedTuple):
    """Friction that decreases linearly with its argument up to a kink, and is constant beyond.

    The argument is the slip since the release, or the slip rate.
    """

    argument_row: int  # SLIP_ROW or SLIP_RATE_ROW
    weakening_slope: float  # decrease of friction per unit of the argument, before the kink
    argument_at_kink: float
    friction_beyond: float  # friction at the kink and beyond


class Traits(NamedTuple):
    """Properties of a law that the solvers need in addition to its friction."""

    linear_rate: float = 0.0  # alpha of a law alpha du/dt; 0 for any other law
    law_kink: LawKink | None = None  # kink of a piecewise linear law; None for any other law
    max_rate_slope: float = 0.0  # upper bound on the derivative of friction by slip rate
    max_drive: float = 0.0  # upper bound on friction that drives slip instead of resisting it
    nucleation_half_length: float = 0.0  # friction is 0 within this distance from x = 0
    longest_step: float = math.inf  # longest time step that resolves the law


@dataclass(frozen=True)
class Friction(ABC):
    """Friction of a sliding block, scaled so that kinetic friction is 0 and static friction is 1.

    Each law is a subclass. Its fields are the parameters of the law, and ``bounds`` has their
    allowed ranges in the form that `check_number` takes. The method `friction` is compiled into the
    textbook scheme. Its arguments are the slip since the release, the slip velocity and the first
    two parameters of the law; a missing parameter is 0.
    """

    law: ClassVar[str]
    schemes: ClassVar[tuple[str, ...]] = ("fixed_step",)
    bounds: ClassVar[Mapping[str, Mapping[str, Any]]] = {}

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            check_number(name, value, **self.bounds.get(name, {}))
            # An integer would make numba compile the kernels a second time.
            object.__setattr__(self, name, float(value))

    @staticmethod
    @abstractmethod
    def friction(slip, velocity, parameter_1, parameter_2):
        """Return the friction of a block."""

    @property
    def traits(self) -> Traits:
        """Properties that the solvers need, for the parameters of this law."""
        return Traits()

    @property
    def kernel_parameters(self) -> tuple[float, float]:
        """The first two parameters, which are passed to `friction`; 0 if there are fewer."""
        padded = (*astuple(self), 0.0, 0.0)
        return padded[0], padded[1]

    def mapping(self) -> dict[str, Any]:
        """Return the name of the law and its parameters, with the keys of the configuration."""
        return {"law": self.law, **asdict(self)}


class Coulomb(Friction):
    """Amontons-Coulomb friction: a sliding block has kinetic friction, which is 0 here."""

    law: ClassVar = "coulomb"
    schemes: ClassVar = ("localised", "fixed_step", "continuum")

    @staticmethod
    def friction(slip, velocity, parameter_1, parameter_2):
        """Return 0, the kinetic friction."""
        return 0.0
