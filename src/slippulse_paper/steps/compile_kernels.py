"""Compile the kernels of a scheme into the cache of its simulations; write their digest."""

from slippulse.data.files import write_text
from slippulse.solver.compilation import compile_all
from slippulse.solver.jit import source_digest


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Compile the kernels of the scheme in the settings, and write the file ``kernels``."""
    compile_all([settings["scheme"]])
    write_text(f"{source_digest()}\n", outputs["kernels"])
