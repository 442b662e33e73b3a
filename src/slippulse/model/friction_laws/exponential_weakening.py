"""Friction that falls exponentially with the slip since the release."""

import math
from dataclasses import dataclass
from typing import ClassVar

from .law import Traits
from .slip_weakening import SlipWeakening


@dataclass(frozen=True)
class ExponentialWeakening(SlipWeakening):
    """Friction exp(-slip/d_c), healed at a stick. Within |x| < ``nucleation`` it is 0."""

    law: ClassVar = "exponential_weakening"
    schemes: ClassVar = ("fixed_step",)

    @staticmethod
    def friction(slip, velocity, d_c, nucleation):
        """Return exp(-slip/d_c)."""
        return math.exp(-slip / d_c)

    @property
    def traits(self) -> Traits:
        """The traits of slip weakening that is not linear."""
        return super().traits._replace(linear_weakening=None)
