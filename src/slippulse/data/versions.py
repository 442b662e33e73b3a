"""Versions of the packages that a number depends on."""

import re
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf")


@cache
def versions() -> str:
    """Names and versions in one line, the same on every machine with the same lock."""
    return ", ".join(f"{package} {version(package)}" for package in PACKAGES)


def unlike(lock: str | Path) -> str:
    """First package whose installed version is not in a lock, in one line; empty if there is none.

    Another system, or another Python, needs other packages: the lock names those of all.
    """
    named: dict[str, set[str]] = {}
    for name, wanted in re.findall(r"^([\w.-]+)==([^\s;\\]+)", Path(lock).read_text(), re.M):
        named.setdefault(name, set()).add(wanted)
    for name, wanted in named.items():
        try:
            installed = version(name)
        except PackageNotFoundError:
            continue
        if installed not in wanted:
            allowed = f"{' or '.join(sorted(wanted))}, as in requirements.lock"
            return f"{name}: {installed} is installed; allowed: {allowed} (rm -r .venv; make setup)"
    return ""
