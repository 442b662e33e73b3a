"""Versions of the packages that a number depends on."""

import re
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf")


@cache
def versions() -> str:
    """Names and versions in one line, the same on every machine with the same lock."""
    return ", ".join(f"{package} {version(package)}" for package in PACKAGES)


def unlike(lock: str | Path) -> str:
    """First package whose installed version is not in a lock, in one line; or an empty text."""
    named: dict[str, set[str]] = {}
    for name, pinned in re.findall(r"^([\w.-]+)==([^\s;\\]+)", Path(lock).read_text(), re.M):
        named.setdefault(name, set()).add(pinned)
    for name, wanted in named.items():
        # Another system, or another Python, needs other packages: the lock names those of all.
        with suppress(PackageNotFoundError):
            installed = version(name)
            if installed not in wanted:
                allowed = f"{' or '.join(sorted(wanted))}, as in requirements.lock"
                remedy = "(rm -r .venv; make setup)"
                return f"{name}: {installed} is installed; allowed: {allowed} {remedy}"
    return ""
