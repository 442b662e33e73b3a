"""The one home of the compiler's flags and of its cache."""

from __future__ import annotations

import contextlib
import hashlib
import os
from pathlib import Path

import numba
from numba.core.registry import CPUDispatcher

SOURCES = Path(__file__).resolve().parent


def source_digest(folder: Path = SOURCES) -> str:
    """Digest of every kernel source: an edited helper must never meet the machine code of its caller's old self.

    numba's own cache looks only at the file that holds the compiled function, not at the files it calls into.
    """
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Where compiled kernels live: SLIPPULSE_CACHE, or the user's cache folder, under a digest of the sources."""
    base = os.environ.get("SLIPPULSE_CACHE")
    if not base:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "slippulse"
    return Path(base) / f"kernels-{source_digest()}"


def load_without_blas() -> None:
    """Load numba's array functions while they find no BLAS, which stays away from their inner product alone.

    Looking for it loads scipy.linalg, a fifth of what a job needs to start, and no kernel multiplies matrices.
    """
    with contextlib.suppress(ImportError, AttributeError):
        from numba.np import linalg

        look = linalg.ensure_blas

        def none_found() -> None:
            raise ImportError("not looked for")

        linalg.ensure_blas = none_found
        try:
            import numba.np.arraymath  # noqa: F401
        finally:
            linalg.ensure_blas = look


load_without_blas()

if not os.environ.get("NUMBA_CACHE_DIR"):
    numba.config.CACHE_DIR = str(cache_folder())

# Sums may be reordered so that they vectorise; NaN keeps its meaning, since it is how a failed run is noticed.
REORDER = {"reassoc", "contract", "nsz"}


def compiled(*, entry: bool = False, reorder: bool = False, inline: bool = False):
    """Decorator: machine code without the interpreter's lock, cached.

    ``entry`` is for what Python calls: any other kernel has no way in from there, which takes a sixth of all compiling,
    and says so. ``reorder`` lets sums vectorise. ``inline`` is for what an event calls, from one place or few: handing
    on a dozen arrays takes as long as using them. Arrays are not counted as references, which was half of the time of a
    narrow pulse (an atomic operation for each of them in each call): they belong to whoever calls from Python, and no
    kernel makes or returns one.
    """
    translate = numba.njit(
        cache=True,
        nogil=True,
        error_model="numpy",
        _nrt=False,
        forceinline=inline,
        fastmath=REORDER if reorder else {"contract"},
        no_cfunc_wrapper=True,
        no_cpython_wrapper=not entry,
    )
    return translate if entry else lambda function: _inner(translate(function))


class InnerKernel(CPUDispatcher):
    """A kernel for kernels: numba itself would jump to an address that is not there."""

    def __call__(self, *arguments):
        raise TypeError(
            f"{self.__name__}: called from Python; allowed: from a kernel, or with entry=True where it is compiled"
        )


def _inner(kernel):
    # Without the compiler (NUMBA_DISABLE_JIT) it is a function of Python.
    if isinstance(kernel, CPUDispatcher):
        kernel.__class__ = InnerKernel
    return kernel
