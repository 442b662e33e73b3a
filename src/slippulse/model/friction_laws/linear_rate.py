"""Friction that grows linearly with slip rate."""

from dataclasses import dataclass
from typing import ClassVar

from ..checks import check_number
from .law import Friction, Traits


@dataclass(frozen=True)
class LinearRate(Friction):
    """Friction alpha v; it weakens with slip rate where alpha < 0."""

    alpha: float

    law: ClassVar = "linear_rate"
    schemes: ClassVar = ("localised", "fixed_step", "continuum")

    def __post_init__(self) -> None:
        check_number("alpha", self.alpha)

    @staticmethod
    def friction(slip, velocity, alpha, second):
        """Return alpha v."""
        return alpha * velocity

    @property
    def traits(self) -> Traits:
        """The slope is alpha at any slip rate."""
        return Traits(linear_rate=self.alpha, steepest=self.alpha)
