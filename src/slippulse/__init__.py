"""slippulse: the onset of slip pulses in frictional rupture, replicated.

    import slippulse as sp
    scene = sp.Scene(boundary="displacement", gamma=0.65, beta=1e-3, dx=0.01, duration=15.0,
                     prestress=sp.Prestress(left=0.6, right=0.6))
    run = sp.simulate(scene)                                # xarray.Dataset over x
    sp.theory.front_speed(0.6, damping_ratio=0.1)           # exact

Importing is light: the compiled kernels and xarray are loaded when the first scene is simulated.
"""

from importlib import import_module

from . import theory
from .model import Scene
from .prestress import Prestress

__version__ = "0.1.0"
_LAZY = {
    "simulate": "simulation",
    "Samples": "simulation",
    "UnstableRun": "simulation",
    "UnresolvedRun": "simulation",
    "run_sweep": "sweep",
    "settings_for": "accuracy",
}

__all__ = [
    "Prestress", "Samples", "Scene", "UnresolvedRun", "UnstableRun", "run_sweep", "settings_for", "simulate", "theory",
]  # fmt: skip


def __getattr__(name: str):
    if name in _LAZY:
        return getattr(import_module(f".{_LAZY[name]}", __name__), name)
    raise AttributeError(f"module 'slippulse' has no attribute {name!r}")
