"""Decorators that compile the kernels, with their compiler flags, and the folder of the cache.

Each flag was chosen by timing runs with and without it in alternation:

- ``_nrt=False`` switches off the counting of references to arrays, which costs an atomic operation
  for each array in each call. A pulse runs 1.4 times as fast. It is allowed because no kernel
  makes or returns an array.
- ``forceinline`` avoids passing groups of arrays from function to function. A pulse runs 1.2 to
  1.35 times as fast. It is used for functions that are called in each step or event. For all
  functions, it would gain up to another tenth, and compilation would take a third longer.
- ``inline="always"``, for functions with one caller, is done before compilation and makes it a
  seventh shorter.
- ``reassoc`` and ``nsz`` allow sums over many blocks to be reordered. A damped crack runs 1.1 times
  as fast.
- ``contract`` makes runs 1.00 to 1.07 times as fast, and ``error_model="numpy"`` has no effect on
  speed. Both change the last bits of results.

Some of these flags are private to numba. ``tests/unit/test_kernel_cache.py`` fails if a new version
of numba changes them.
"""

import hashlib
import os
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numba
from numba.extending import register_jitable

SOLVER_FOLDER = Path(__file__).resolve().parent
# Laws of friction, which are compiled into the kernels.
LAWS_FOLDER = SOLVER_FOLDER.parent / "model" / "friction_laws"


def source_digest(folder: Path = SOLVER_FOLDER) -> str:
    """Return a digest of all source files that are compiled into the kernels.

    Numba itself checks only the file of the compiled function, and not the files of its callees.

    folder : the folder of the solver
    """
    digest = hashlib.sha256()
    for path in [*sorted(folder.glob("*.py")), *sorted(LAWS_FOLDER.glob("*.py"))]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Return the folder of compiled kernels, whose name contains the digest of their sources.

    The folder lies in the one given by SLIPPULSE_CACHE, otherwise by NUMBA_CACHE_DIR, otherwise in
    the cache folder of the user.
    """
    given = os.environ.get("SLIPPULSE_CACHE") or os.environ.get("NUMBA_CACHE_DIR")
    user_cache = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return Path(given or f"{user_cache}/slippulse").absolute() / f"kernels-{source_digest()}"


def writable_cache() -> str:
    """Return a folder for compiled kernels in which files can be written.

    If the usual folder cannot be written, warn and use one next to the sources. If neither can be
    written, return an empty text.
    """
    usual = cache_folder()
    problem = _write_problem(usual)
    if not problem:
        return str(usual)
    substitute = SOLVER_FOLDER / "__pycache__" / usual.name
    is_usable = not _write_problem(substitute)
    consequence = f"they go to {substitute}" if is_usable else "each process compiles them again"
    remedy = "to avoid this, set SLIPPULSE_CACHE to a folder that can be written"
    cannot_write = f"compiled kernels cannot be written to {usual}: {problem}"
    warnings.warn(f"{cannot_write}; {consequence}; {remedy}", stacklevel=2)
    return str(substitute) if is_usable else ""


def _write_problem(folder: Path) -> str:
    """Make a folder, and return the reason why no file can be written in it, empty if one can."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return ""
    except OSError as error:
        return str(error.strerror)


# Without this setting, numba would choose a folder itself. The machine code in it might be of other
# sources.
CACHE_FOLDER = writable_cache()
numba.config.CACHE_DIR = CACHE_FOLDER  # type: ignore[attr-defined]

# Sums may be reordered so that they vectorise. NaN keeps its meaning, because it shows a blow-up.
REORDERING_FLAGS = {"reassoc", "contract", "nsz"}
COMPILER_FLAGS: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "fastmath": {"contract"}}

# Decorator of the functions that Python calls. Only these are cached: their machine code contains
# all functions that they call.
kernel_entry = numba.njit(cache=bool(CACHE_FOLDER), nogil=True, **COMPILER_FLAGS)

# Decorator of functions that one kernel calls in one place.
inlined_kernel = numba.njit(inline="always", **COMPILER_FLAGS)


def kernel_function(*, inline: bool = False, reorder: bool = False):
    """Return the decorator of functions that kernels call.

    inline : the machine code of the function is always inserted into that of its callers
    reorder : sums over blocks may be reordered, so that they are faster
    """
    flags = COMPILER_FLAGS | {"fastmath": REORDERING_FLAGS} if reorder else COMPILER_FLAGS
    return register_jitable(forceinline=inline, **flags)
