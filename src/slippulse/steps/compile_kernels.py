"""Compile the kernels of a scheme into the cache that its simulations share, and note the digest of their sources."""

from ..data.files import write_text
from ..solver.compilation import compile_all
from ..solver.jit import source_digest


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: kernels. Settings: scheme."""
    compile_all([settings["scheme"]])
    write_text(f"{source_digest()}\n", outputs["kernels"])
