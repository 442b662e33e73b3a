"""The physics of one run, which is all that theory needs of it."""

from collections.abc import Mapping
from typing import NamedTuple

from .prestress import Prestress


class Run(NamedTuple):
    """One run of a simulation; a `Scene` has its duration and its numerical method, too."""

    boundary: str
    prestress: Prestress
    gamma: float
    dx: float
    beta: float
    release: str
    friction: Mapping  # law of friction, and its parameters by name

    @property
    def damping_ratio(self) -> float:
        """The ratio beta/dx, which selects the front speed."""
        return self.beta / self.dx
