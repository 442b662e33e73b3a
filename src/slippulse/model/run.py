"""The physical parameters of one run. The theory needs to know no others."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

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
    extra_terms: Mapping[str, float] = MappingProxyType({})  # coefficients of extra terms by name

    @property
    def damping_ratio(self) -> float:
        """Ratio beta/dx, on which the front speed depends."""
        return self.beta / self.dx

    def parameters(self) -> dict[str, Any]:
        """Return all parameters, including the extra terms, by their names in `Scene`."""
        values = self._asdict()
        extra_terms = values.pop("extra_terms")
        return values | extra_terms
