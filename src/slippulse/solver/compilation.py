"""Compiles kernels into the cache."""

from collections.abc import Iterable

import numba

from ..model.prestress import Prestress
from ..model.scene import Scene
from .fixed_step import LATTICES, solve_by_scheme


def compile_all(schemes: Iterable[str] = LATTICES) -> None:
    """Compile the kernels of schemes that are not in the cache, unless the compiler is off."""
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        return
    for scheme in schemes:
        prestress = Prestress(0.5, 0.5)
        solve_by_scheme(Scene("displacement", prestress, 1.0, 0.5, gamma=0.5, scheme=scheme))
