"""Friction that grows with slip rate up to a limit."""

from dataclasses import dataclass
from typing import ClassVar

from ..checks import check_number
from .law import Friction, Traits


@dataclass(frozen=True)
class BoundedRate(Friction):
    """Friction F v/(v + v_0): ``limit`` is F; it weakens with slip rate where F < 0."""

    limit: float
    v_0: float

    law: ClassVar = "bounded_rate"

    def __post_init__(self) -> None:
        check_number("limit", self.limit)
        check_number("v_0", self.v_0, above=0.0)

    @staticmethod
    def friction(slip, velocity, limit, v_0):
        """Return F v/(v + v_0)."""
        return limit * velocity / (velocity + v_0)

    @property
    def traits(self) -> Traits:
        """The slope at rest is the steepest, and the law drives slip where F < 0."""
        return Traits(steepest=self.limit / self.v_0, drive=max(-self.limit, 0.0))
