"""The physical parameters of one run, which are all that theory needs to know of it."""

from collections.abc import Mapping
from typing import NamedTuple

from .prestress import Prestress


class Run(NamedTuple):
    """Physical parameters of one run; a `Scene` adds the duration and the numerical method."""

    boundary: str
    prestress: Prestress
    gamma: float
    dx: float
    beta: float
    release: str
    friction: Mapping  # name of the friction law ("law") and its parameters

    @property
    def damping_ratio(self) -> float:
        """Ratio beta/dx, on which the front speed depends."""
        return self.beta / self.dx
