"""Versions of the packages that a number depends on."""

from functools import cache
from importlib.metadata import version

PACKAGES = ("slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf")


@cache
def versions() -> str:
    """Names and versions in one line, the same on every machine with the same lock."""
    return ", ".join(f"{package} {version(package)}" for package in PACKAGES)
