"""The one home of the compiler's flags and of its cache.

What each flag gains, measured in turns with and without it:

- ``_nrt=False``, no counting of references to arrays, an atomic operation for each in each call: a pulse runs 1.4 times
  as fast. No kernel makes or returns an array. See the docstring of ``numba.extending.register_jitable``.
- ``forceinline``: a pulse runs 1.2 to 1.35 times as fast, since no group of arrays is handed on. For functions that are
  called in each step or event; for all, it would gain up to a tenth more and compile a third longer.
- ``inline="always"``, for functions with one caller, by numba before it compiles that: a seventh less to compile.
- ``reassoc`` and ``nsz`` in the sums over many blocks: a damped crack runs 1.1 times as fast.
- ``contract``: 1.00 to 1.07 times as fast; ``error_model="numpy"``: nothing. Without them last bits would change.

``tests/unit/test_kernel_cache.py`` fails where numba changes what is private of these.
"""

import hashlib
import os
from pathlib import Path
from typing import Any

import numba
from numba.extending import register_jitable

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
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "slippulse"
    return Path(os.environ.get("SLIPPULSE_CACHE") or user) / f"kernels-{source_digest()}"


if not os.environ.get("NUMBA_CACHE_DIR"):
    numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]

# Sums may be reordered so that they vectorise; NaN keeps its meaning, since it is how a failed run is noticed.
REORDER = {"reassoc", "contract", "nsz"}
FLAGS: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "fastmath": {"contract"}}

# A function that Python calls. Only these are cached: their machine code holds all that they call.
entry = numba.njit(cache=True, nogil=True, **FLAGS)

# A function that one kernel calls, in one place.
once = numba.njit(inline="always", **FLAGS)


def inner(*, inline: bool = False, reorder: bool = False):
    """Decorator of a function that kernels call. Called from Python, it is a function of Python.

    inline puts its machine code into that of its caller, rather than hand on groups of arrays at each call; reorder
    lets its sums vectorise.
    """
    return register_jitable(
        forceinline=inline, **FLAGS | ({"fastmath": REORDER} if reorder else {})
    )
