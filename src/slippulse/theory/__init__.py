"""Exact results of the theory: closed formulas and integrals, without simulation.

No module in here imports the lattice code, so that an agreement of theory and simulation is a real
test of both.
"""

import lazy_loader

from ..model.removed import describe_removal

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Load a public name when it is first used; a removed one answers with the new way."""
    if answer := describe_removal("theory", name):
        raise AttributeError(answer)
    return _load(name)
