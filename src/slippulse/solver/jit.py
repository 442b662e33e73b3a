"""Flags of the compiler, and the folder of its cache.

What each flag gains, measured in turns with and without it:

- ``_nrt=False`` counts no references to arrays, which is an atomic operation for each array in each
  call: a pulse runs 1.4 times as fast. No kernel makes or returns an array. See the docstring of
  ``numba.extending.register_jitable``.
- ``forceinline`` hands on no group of arrays: a pulse runs 1.2 to 1.35 times as fast. It is for
  functions that are called in each step or event; for all, it would gain up to a tenth more and
  compile a third longer.
- ``inline="always"``, for functions with one caller, is done before compiling: a seventh less time.
- ``reassoc`` and ``nsz`` in the sums over many blocks: a damped crack runs 1.1 times as fast.
- ``contract``: 1.00 to 1.07 times as fast. ``error_model="numpy"``: nothing. Both change last bits.

``tests/unit/test_kernel_cache.py`` fails where numba changes those of these that are private.
"""

import hashlib
import os
from pathlib import Path
from typing import Any

import numba
from numba.extending import register_jitable

SOURCES = Path(__file__).resolve().parent
# Laws of friction, which the kernels compile too.
LAWS = SOURCES.parent / "model" / "friction_laws"


def source_digest(folder: Path = SOURCES) -> str:
    """Digest of every source of kernels; numba looks only at the file of the compiled function."""
    digest = hashlib.sha256()
    for path in [*sorted(folder.glob("*.py")), *sorted(LAWS.glob("*.py"))]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Folder of compiled kernels: in SLIPPULSE_CACHE or the user's cache, by digest of sources."""
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "slippulse"
    return Path(os.environ.get("SLIPPULSE_CACHE") or user) / f"kernels-{source_digest()}"


if not os.environ.get("NUMBA_CACHE_DIR"):
    numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]

# Sums may be reordered so that they vectorise. NaN keeps its meaning, since it shows a blow-up.
REORDER = {"reassoc", "contract", "nsz"}
FLAGS: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "fastmath": {"contract"}}

# The decorator of functions that Python calls. Only they are cached: their machine code holds all
# that they call.
entry = numba.njit(cache=True, nogil=True, **FLAGS)

# The decorator of functions that one kernel calls, in one place.
once = numba.njit(inline="always", **FLAGS)


def inner(*, inline: bool = False, reorder: bool = False):
    """Decorator of functions inside kernels. If inlined, they hand on no groups of arrays."""
    flags = FLAGS | {"fastmath": REORDER} if reorder else FLAGS
    return register_jitable(forceinline=inline, **flags)
