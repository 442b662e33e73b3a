"""Friction that falls with the slip since the release, and is healed at a stick."""

import math
from dataclasses import dataclass
from typing import ClassVar

from .law import RESOLVED, Bend, Friction, Traits


@dataclass(frozen=True)
class SlipWeakening(Friction):
    """Friction 1 - slip/d_c until it is 0. Within |x| < ``nucleation`` it is 0.

    A pre-stress of 1 at x = 0 alone starts nothing, since friction is 1 there too at first.
    """

    d_c: float
    nucleation: float

    law: ClassVar = "slip_weakening"
    schemes: ClassVar[tuple[str, ...]] = ("localised", "fixed_step")
    bounds: ClassVar = {"d_c": {"above": 0.0}, "nucleation": {"at_least": 0.0}}

    @staticmethod
    def friction(slip, velocity, d_c, nucleation):
        """Return 1 - slip/d_c, or 0 beyond d_c."""
        return max(0.0, 1.0 - slip / d_c)

    @property
    def traits(self) -> Traits:
        """Slip grows e-fold in the time sqrt(d_c); a step beyond makes front speeds wrong."""
        step = RESOLVED * math.sqrt(self.d_c)
        bend = Bend(0, 1.0 / self.d_c, self.d_c, 0.0)
        return Traits(bend=bend, zone=self.nucleation, longest_step=step)


class ExponentialWeakening(SlipWeakening):
    """Friction exp(-slip/d_c). Within |x| < ``nucleation`` it is 0."""

    law: ClassVar = "exponential_weakening"
    schemes: ClassVar = ("fixed_step",)

    @staticmethod
    def friction(slip, velocity, d_c, nucleation):
        """Return exp(-slip/d_c)."""
        return math.exp(-slip / d_c)

    @property
    def traits(self) -> Traits:
        """The traits of slip weakening that is not linear."""
        return super().traits._replace(bend=None)
