"""The type that all laws of friction have."""

import math
from dataclasses import asdict, astuple, dataclass
from typing import Any, ClassVar


@dataclass(frozen=True)
class Friction:
    """Friction of a sliding block: 0 at the kinetic, 1 at the static friction of the paper.

    A law is a subclass. Its fields are its parameters, and ``__post_init__`` refuses those out of
    range. `friction` is compiled into the textbook scheme; it gets the slip since the release, the
    slip velocity and the first two parameters, 0 where there are fewer.
    """

    law: ClassVar[str]
    schemes: ClassVar[tuple[str, ...]] = ("fixed_step",)

    @staticmethod
    def friction(slip, velocity, first, second):
        """Friction of a block."""
        raise NotImplementedError

    def check(self, gamma: float) -> None:
        """Refuse a law by which slip runs away against leaf springs of stiffness ``gamma``."""

    @property
    def linear_rate(self) -> float:
        """The factor alpha of a term alpha du/dt; 0 for laws that are not linear in slip rate."""
        return 0.0

    @property
    def linear_weakening(self) -> float | None:
        """The slip d_c over which friction falls linearly; None for other laws."""
        return None

    @property
    def steepest(self) -> float:
        """Upper bound on the slope of friction over slip rate."""
        return 0.0

    @property
    def drive(self) -> float:
        """Upper bound on the friction that drives slip instead of resisting it."""
        return 0.0

    @property
    def zone(self) -> float:
        """Half-length around x = 0 without friction, which nucleates the rupture."""
        return 0.0

    @property
    def longest_step(self) -> float:
        """Longest time step that resolves the law."""
        return math.inf

    @property
    def constants(self) -> tuple[float, float]:
        """The first two parameters, which `friction` gets."""
        first, second, *_ = (*astuple(self), 0.0, 0.0)
        return first, second

    def mapping(self) -> dict[str, Any]:
        """The law and its parameters by name, as the configuration spells them."""
        return {"law": self.law, **asdict(self)}
