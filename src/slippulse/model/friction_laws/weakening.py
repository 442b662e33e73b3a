"""Slip-weakening friction, which decreases with the slip since the release of a block.

When a block sticks, its friction heals: at the next release it is 1 again.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from .law import SLIP_ROW, STEP_PER_GROWTH_TIME, Friction, LawKink, Traits


@dataclass(frozen=True)
class SlipWeakening(Friction):
    """Friction max(0, 1 - slip/d_c), and no friction within |x| < ``nucleation``.

    The zone without friction is needed to start a rupture. A block whose pre-stress is 1 does not
    move by itself, because its friction is 1 as well before it has slipped.
    """

    d_c: float
    nucleation: float

    law: ClassVar = "slip_weakening"
    schemes: ClassVar[tuple[str, ...]] = ("localised", "fixed_step")
    bounds: ClassVar = {"d_c": {"above": 0.0}, "nucleation": {"at_least": 0.0}}

    @staticmethod
    def friction(slip, velocity, d_c, nucleation):
        """Return 1 - slip/d_c, or 0 if the slip is larger than d_c."""
        return max(0.0, 1.0 - slip / d_c)

    @property
    def traits(self) -> Traits:
        """Kink at slip d_c, and a time step that resolves the growth of slip.

        Up to the kink, friction falls with slip by the slope 1/d_c, and slip grows by a factor e in
        the time sqrt(d_c). Longer steps give wrong front speeds. Beyond the kink friction is 0.
        """
        return Traits(
            law_kink=LawKink(
                argument_row=SLIP_ROW,
                weakening_slope=1.0 / self.d_c,
                argument_at_kink=self.d_c,
                friction_beyond=0.0,
            ),
            nucleation_half_length=self.nucleation,
            longest_step=STEP_PER_GROWTH_TIME * math.sqrt(self.d_c),
        )


class ExponentialWeakening(SlipWeakening):
    """Friction exp(-slip/d_c), and no friction within |x| < ``nucleation``."""

    law: ClassVar = "exponential_weakening"
    schemes: ClassVar = ("fixed_step",)

    @staticmethod
    def friction(slip, velocity, d_c, nucleation):
        """Return exp(-slip/d_c)."""
        return math.exp(-slip / d_c)

    @property
    def traits(self) -> Traits:
        """Properties of slip weakening, except that this law is not piecewise linear."""
        return super().traits._replace(law_kink=None)
