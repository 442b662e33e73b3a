"""slippulse: the onset of slip pulses in frictional rupture, replicated.

    import slippulse as sp
    prestress = sp.Prestress(left=0.6, right=0.6)
    scene = sp.Scene("displacement", prestress, duration=15.0, dx=0.01, gamma=0.65)
    run = sp.simulate(scene)                                # xarray.Dataset over x
    sp.measure(run)["transition_time"]                      # T_trans
    sp.theory.front_speed(0.6, damping_ratio=0.1)           # exact

A module is loaded at the first use of one of its names, so that this import is fast.
"""

from importlib import import_module

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
    "point": "data.point",
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
