"""Friction that grows linearly with slip rate."""

from dataclasses import dataclass
from typing import ClassVar

from ..checks import check_number, check_runaway
from .law import Friction


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

    def check(self, gamma: float) -> None:
        """Refuse alpha <= -2 sqrt(gamma), and alpha < 0 without leaf springs."""
        check_runaway(gamma, self.alpha, "friction.alpha")

    @property
    def linear_rate(self) -> float:
        """The factor alpha."""
        return self.alpha

    @property
    def steepest(self) -> float:
        """The factor alpha, too."""
        return self.alpha
