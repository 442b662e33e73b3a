"""Friction laws that depend on slip rate only."""

from dataclasses import dataclass
from typing import ClassVar

from .law import SLIP_RATE_ROW, STEP_PER_GROWTH_TIME, Friction, LawKink, Traits


@dataclass(frozen=True)
class LinearRate(Friction):
    """Friction alpha v, which weakens with slip rate v if alpha < 0."""

    alpha: float

    law: ClassVar = "linear_rate"
    schemes: ClassVar = ("localised", "fixed_step", "continuum")

    @staticmethod
    def friction(slip, velocity, alpha, parameter_2):
        """Return alpha v."""
        return alpha * velocity

    @property
    def traits(self) -> Traits:
        """Slope alpha, which is the same at every slip rate."""
        return Traits(linear_rate=self.alpha, max_rate_slope=self.alpha)


@dataclass(frozen=True)
class BoundedRate(Friction):
    """Friction limit v/(v + v_0), which weakens with slip rate v if limit < 0."""

    limit: float
    v_0: float

    law: ClassVar = "bounded_rate"
    bounds: ClassVar = {"v_0": {"above": 0.0}}

    @staticmethod
    def friction(slip, velocity, limit, v_0):
        """Return limit v/(v + v_0)."""
        return limit * velocity / (velocity + v_0)

    @property
    def traits(self) -> Traits:
        """Slope limit/v_0 at rest, where it is steepest; friction drives slip if limit < 0."""
        return Traits(max_rate_slope=self.limit / self.v_0, max_drive=max(-self.limit, 0.0))


@dataclass(frozen=True)
class RateWeakening(Friction):
    """Friction -min(slope v, limit), which weakens with slip rate v."""

    slope: float
    limit: float

    law: ClassVar = "rate_weakening"
    schemes: ClassVar = ("localised", "fixed_step")
    bounds: ClassVar = {"slope": {"at_least": 0.0}, "limit": {"at_least": 0.0}}

    @staticmethod
    def friction(slip, velocity, slope, limit):
        """Return -min(slope v, limit)."""
        return -min(slope * velocity, limit)

    @property
    def traits(self) -> Traits:
        """Kink at slip rate limit/slope, and a time step that resolves the growth of slip rate.

        Up to the kink, slip rate grows by a factor e in the time 1/slope. Friction is never
        positive, so that it drives slip, at most by ``limit``.
        """
        # If the slope or the limit is 0, there is no friction.
        if self.slope * self.limit == 0.0:
            return Traits()
        kink_rate = self.limit / self.slope
        return Traits(
            law_kink=LawKink(
                argument_row=SLIP_RATE_ROW,
                weakening_slope=self.slope,
                argument_at_kink=kink_rate,
                friction_beyond=-self.limit,
            ),
            max_drive=self.limit,
            longest_step=STEP_PER_GROWTH_TIME / self.slope,
        )
