"""Simulate, measure and predict slip pulses in frictional rupture.

    import slippulse as sp
    prestress = sp.Prestress(left=0.6, right=0.6)
    scene = sp.Scene("displacement", prestress, duration=15.0, dx=0.01, gamma=0.65)
    run = sp.simulate(scene)                                # xarray.Dataset over x
    sp.measure(run)["transition_time"]                      # T_trans
    sp.theory.front_speed(0.6, damping_ratio=0.1)           # exact

The package replicates a paper on the onset of slip pulses. Its public names are listed in
`__init__.pyi`. A module is loaded when one of its names is first used, which keeps this import
fast.
"""

import lazy_loader

__version__ = "0.1.0"
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
