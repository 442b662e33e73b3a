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
import tempfile
import warnings
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
    """Folder of compiled kernels, named by the digest of their sources.

    It is below the first of SLIPPULSE_CACHE, NUMBA_CACHE_DIR and the user's cache that is given.
    """
    given = os.environ.get("SLIPPULSE_CACHE") or os.environ.get("NUMBA_CACHE_DIR")
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return Path(given or f"{caches}/slippulse").absolute() / f"kernels-{source_digest()}"


def writable_cache() -> str:
    """Return the folder of the cache, or one beside the sources, with a warning; empty if none."""
    chosen, reason = cache_folder(), ""
    for folder in (chosen, SOURCES / "__pycache__" / chosen.name):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                break
        except OSError as error:
            reason = reason or f"{chosen}: {error.strerror}"
    else:
        folder = None
    if reason:
        instead = f"they go to {folder}" if folder else "each process compiles its own"
        remedy = "a folder that can be written in SLIPPULSE_CACHE avoids it"
        warnings.warn(f"compiled kernels: {reason}; {instead}; {remedy}", stacklevel=2)
    return str(folder or "")


# Without a folder, numba would look for one whose machine code may be of other sources.
CACHE = writable_cache()
numba.config.CACHE_DIR = CACHE  # type: ignore[attr-defined]

# Sums may be reordered so that they vectorise. NaN keeps its meaning, since it shows a blow-up.
REORDER = {"reassoc", "contract", "nsz"}
FLAGS: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "fastmath": {"contract"}}

# The decorator of functions that Python calls. Only they are cached: their machine code holds all
# that they call.
entry = numba.njit(cache=bool(CACHE), nogil=True, **FLAGS)

# The decorator of functions that one kernel calls, in one place.
once = numba.njit(inline="always", **FLAGS)


def inner(*, inline: bool = False, reorder: bool = False):
    """Decorator of functions inside kernels. If inlined, they hand on no groups of arrays."""
    flags = FLAGS | {"fastmath": REORDER} if reorder else FLAGS
    return register_jitable(forceinline=inline, **flags)
