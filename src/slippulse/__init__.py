"""slippulse: the onset of slip pulses in frictional rupture, replicated.

    import slippulse as sp
    prestress = sp.Prestress(left=0.6, right=0.6)
    scene = sp.Scene("displacement", prestress, duration=15.0, dx=0.01, gamma=0.65)
    run = sp.simulate(scene)                                # xarray.Dataset over x
    sp.measure(run)["transition_time"]                      # T_trans
    sp.theory.front_speed(0.6, damping_ratio=0.1)           # exact

A module is loaded at the first use of one of its names, so that this import is fast.
"""
# ruff: noqa: F401 since editors need the names of the first block, which are loaded when used

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # Absolute imports: the steps do not depend on what is not loaded (`steps.reach`).
    from slippulse import theory
    from slippulse.configuration.accuracy import settings_for
    from slippulse.data.points import point
    from slippulse.figures.run import plot
    from slippulse.model.prestress import Prestress
    from slippulse.model.samples import Samples
    from slippulse.model.scene import Scene
    from slippulse.predict.one_run import measure
    from slippulse.simulation.simulate import UnresolvedRun, run_sweep, simulate
    from slippulse.solver.lattice import UnstableRun

__version__ = "0.1.0"
_HOMES = {
    "Prestress": "model.prestress",
    "Samples": "model.samples",
    "Scene": "model.scene",
    "UnresolvedRun": "simulation.simulate",
    "UnstableRun": "solver.lattice",
    "friction": "model.friction",
    "measure": "predict.one_run",
    "plot": "figures.run",
    "point": "data.points",
    "run_sweep": "simulation.simulate",
    "settings_for": "configuration.accuracy",
    "simulate": "simulation.simulate",
    "theory": "theory",
}
__all__ = [*_HOMES]
__dir__ = __all__.copy


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f"{__name__}.{_HOMES[name]}")
    return module if name == "theory" else getattr(module, name)
