"""Compile the kernels of a scheme, so that the simulations find them in the cache of numba."""

from slippulse.data.files import write_text
from slippulse.solver.compilation import compile_all
from slippulse.solver.jit import source_digest


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Compile the kernels of the ``scheme`` in the settings.

    The file ``kernels`` gets the digest of the sources of all kernels.
    """
    compile_all([settings["scheme"]])
    write_text(f"{source_digest()}\n", outputs["kernels"])
