"""slippulse: the onset of slip pulses in frictional rupture, replicated.

    import slippulse as sp
    prestress = sp.Prestress(left=0.6, right=0.6)
    scene = sp.Scene("displacement", prestress, duration=15.0, dx=0.01, gamma=0.65)
    run = sp.simulate(scene)                                # xarray.Dataset over x
    sp.measure(run)["transition_time"]                      # T_trans
    sp.theory.front_speed(0.6, damping_ratio=0.1)           # exact

A module is loaded at the first use of one of its names (`__init__.pyi`), so that this import is
fast.
"""

import lazy_loader

__version__ = "0.1.0"
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
