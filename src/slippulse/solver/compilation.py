"""Compilation of the kernels into the cache, before the first simulation needs them."""

from collections.abc import Iterable

from ..model.prestress import Prestress
from ..model.scene import Scene
from .fixed_step import LATTICES, solve_by_scheme
from .layer import LayerScene, simulate_layer


def compile_all(schemes: Iterable[str] = (*LATTICES, "layer")) -> None:
    """Compile the kernels of the given schemes. The name "layer" stands for the elastic layer."""
    prestress = Prestress(0.5, 0.5)
    for scheme in schemes:
        if scheme == "layer":
            simulate_layer(LayerScene("displacement", 0.5, prestress, 1.0, 1.0, cells=4))
            continue
        solve_by_scheme(Scene("displacement", prestress, 1.0, 0.5, gamma=0.5, scheme=scheme))
