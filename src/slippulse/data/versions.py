"""Versions of what a number depends on."""

from functools import cache
from importlib.metadata import distribution

PACKAGES = ("slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf")


@cache
def versions() -> str:
    """Names and versions in one line, the same on every machine with the same lock."""
    # Parsed as a whole, as asking for a version does, they take five times as long.
    texts = [(package, distribution(package).read_text("METADATA") or "") for package in PACKAGES]
    found = (f"{package} " + text.partition("\nVersion: ")[2].partition("\n")[0] for package, text in texts)
    return ", ".join(found)
