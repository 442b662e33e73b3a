"""Friction that falls linearly with slip rate down to a limit."""

from dataclasses import dataclass
from typing import ClassVar

from ..checks import check_number
from .law import Friction, Traits


@dataclass(frozen=True)
class RateWeakening(Friction):
    """Friction -min(a v, F): ``slope`` is a, and ``limit`` is F."""

    slope: float
    limit: float

    law: ClassVar = "rate_weakening"

    def __post_init__(self) -> None:
        check_number("slope", self.slope, at_least=0.0)
        check_number("limit", self.limit, at_least=0.0)

    @staticmethod
    def friction(slip, velocity, slope, limit):
        """Return -min(a v, F)."""
        return -min(slope * velocity, limit)

    @property
    def traits(self) -> Traits:
        """The law drives slip by up to F."""
        return Traits(drive=self.limit)
