"""Exact results of the theory: closed formulas and integrals, without simulation.

No module in here imports the lattice code, so that an agreement of theory and simulation is a real
test of both.
"""

import lazy_loader

from ..model.removed import describe_removal

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Load a public name when it is first used.

    For a name of an older version, the error says what to use instead.
    """
    if what_to_use_instead := describe_removal("theory", name):
        raise AttributeError(what_to_use_instead)
    return _load(name)
