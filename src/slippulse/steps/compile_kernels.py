"""Compile every kernel into the cache that the simulations share, and note the digest of their sources."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.files import write_text
from ..solver.compilation import compile_all
from ..solver.jit import source_digest


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Outputs: kernels."""
    compile_all()
    write_text(f"{source_digest()}\n", outputs["kernels"])
