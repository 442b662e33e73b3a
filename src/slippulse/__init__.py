"""slippulse: the onset of slip pulses in frictional rupture, replicated.

    import slippulse as sp
    scene = sp.Scene(boundary="displacement", gamma=0.65, beta=1e-3, dx=0.01, duration=15.0,
                     prestress=sp.Prestress(left=0.6, right=0.6))
    run = sp.simulate(scene)                                # xarray.Dataset over x
    sp.plot(run)                                            # its fronts and slip, as a figure
    sp.theory.front_speed(0.6, damping_ratio=0.1)           # exact

Importing is light: the compiled kernels and xarray are loaded when the first scene is simulated.
"""

from .model.lazy import lazy_names

__version__ = "0.1.0"

_HOMES = {
    "Prestress": "model.prestress",
    "Samples": "model.samples",
    "Scene": "model.scene",
    "UnresolvedRun": "simulation.simulate",
    "UnstableRun": "solver.lattice",
    "plot": "figures.run",
    "point": "data.points",
    "run_sweep": "simulation.simulate",
    "settings_for": "configuration.accuracy",
    "simulate": "simulation.simulate",
    "theory": "theory",
}
__all__ = list(_HOMES)
__getattr__, __dir__ = lazy_names(__name__, _HOMES)
