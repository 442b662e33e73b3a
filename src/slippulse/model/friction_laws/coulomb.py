"""Amontons-Coulomb friction: kinetic from the release on, which is 0 here."""

from dataclasses import dataclass
from typing import ClassVar

from .law import Friction


@dataclass(frozen=True)
class Coulomb(Friction):
    """The law of the paper, without parameters."""

    law: ClassVar = "coulomb"
    schemes: ClassVar = ("localised", "fixed_step", "continuum")

    @staticmethod
    def friction(slip, velocity, first, second):
        """Return 0, the kinetic friction."""
        return 0.0
