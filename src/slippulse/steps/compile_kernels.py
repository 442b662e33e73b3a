"""Compile every kernel into the cache that the simulations share, and note the digest of their sources."""

from ..data.files import write_text
from ..solver.compilation import compile_all
from ..solver.jit import source_digest


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: kernels."""
    compile_all()
    write_text(f"{source_digest()}\n", outputs["kernels"])
