"""Compilation of the kernels into the cache, before the first simulation needs them."""

from collections.abc import Iterable

from ..model.prestress import Prestress
from ..model.scene import Scene
from .fixed_step import LATTICES, solve_by_scheme
from .layer import LayerScene, simulate_layer


def compile_all(schemes: Iterable[str] = (*LATTICES, "layer")) -> None:
    """Compile the kernels of some schemes, by simulating a small scene with each.

    The name "layer" stands for the elastic layer in the plane, in single precision.
    """
    prestress = Prestress(0.5, 0.5)
    for scheme in schemes:
        if scheme == "layer":
            small_layer = LayerScene(
                "displacement",
                0.5,
                prestress,
                weakening=1.0,
                duration=1.0,
                cells=4,
                precision="single",
            )
            simulate_layer(small_layer)
        else:
            small_scene = Scene(
                "displacement", prestress, duration=1.0, dx=0.5, gamma=0.5, scheme=scheme
            )
            solve_by_scheme(small_scene)
