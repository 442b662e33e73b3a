"""Friction that depends on slip rate alone."""

from dataclasses import dataclass
from typing import ClassVar

from .law import RESOLVED, Bend, Friction, Traits


@dataclass(frozen=True)
class LinearRate(Friction):
    """Friction alpha v; it weakens with slip rate where alpha < 0."""

    alpha: float

    law: ClassVar = "linear_rate"
    schemes: ClassVar = ("localised", "fixed_step", "continuum")

    @staticmethod
    def friction(slip, velocity, alpha, second):
        """Return alpha v."""
        return alpha * velocity

    @property
    def traits(self) -> Traits:
        """The slope is alpha at any slip rate."""
        return Traits(linear_rate=self.alpha, steepest=self.alpha)


@dataclass(frozen=True)
class BoundedRate(Friction):
    """Friction F v/(v + v_0): ``limit`` is F; it weakens with slip rate where F < 0."""

    limit: float
    v_0: float

    law: ClassVar = "bounded_rate"
    bounds: ClassVar = {"v_0": {"above": 0.0}}

    @staticmethod
    def friction(slip, velocity, limit, v_0):
        """Return F v/(v + v_0)."""
        return limit * velocity / (velocity + v_0)

    @property
    def traits(self) -> Traits:
        """The slope at rest is the steepest, and the law drives slip where F < 0."""
        return Traits(steepest=self.limit / self.v_0, drive=max(-self.limit, 0.0))


@dataclass(frozen=True)
class RateWeakening(Friction):
    """Friction -min(a v, F): ``slope`` is a, and ``limit`` is F."""

    slope: float
    limit: float

    law: ClassVar = "rate_weakening"
    schemes: ClassVar = ("localised", "fixed_step")
    bounds: ClassVar = {"slope": {"at_least": 0.0}, "limit": {"at_least": 0.0}}

    @staticmethod
    def friction(slip, velocity, slope, limit):
        """Return -min(a v, F)."""
        return -min(slope * velocity, limit)

    @property
    def traits(self) -> Traits:
        """The law drives slip by up to F. Slip rate grows e-fold in the time 1/a until F/a."""
        if self.slope * self.limit == 0.0:
            return Traits()
        bend = Bend(1, self.slope, self.limit / self.slope, -self.limit)
        return Traits(drive=self.limit, bend=bend, longest_step=RESOLVED / self.slope)
