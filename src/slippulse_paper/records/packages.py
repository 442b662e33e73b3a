"""Comparison of the installed packages with the versions in requirements.lock."""

import re
from collections import defaultdict
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def package_problem(lock: str | Path) -> str:
    """Return a line on the first package whose version is not in the lock, or no text."""
    pins: defaultdict[str, set[str]] = defaultdict(set)
    text = Path(lock).read_text(encoding="utf-8")
    for name, pinned in re.findall(r"^([\w.-]+)==([^\s;\\]+)", text, re.M):
        pins[name].add(pinned)
    for name, versions in pins.items():
        # The lock also has packages that only other systems or versions of Python need, and which
        # are not installed here.
        with suppress(PackageNotFoundError):
            if version(name) not in versions:
                allowed = f"{' or '.join(sorted(versions))}, as in requirements.lock"
                remedy = "(rm -r .venv; make setup)"
                return f"{name}: {version(name)} is installed; allowed: {allowed} {remedy}"
    return ""
