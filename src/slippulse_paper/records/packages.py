"""Comparison of the installed packages with the lock."""

import re
from collections import defaultdict
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def package_problem(lock: str | Path) -> str:
    """Return one line on the first package that is not of the version in a lock, or empty text."""
    pins: defaultdict[str, set[str]] = defaultdict(set)
    text = Path(lock).read_text(encoding="utf-8")
    for name, pinned in re.findall(r"^([\w.-]+)==([^\s;\\]+)", text, re.M):
        pins[name].add(pinned)
    for name, versions in pins.items():
        # Another system, or another Python, needs other packages: the lock names those of all.
        with suppress(PackageNotFoundError):
            if version(name) not in versions:
                allowed = f"{' or '.join(sorted(versions))}, as in requirements.lock"
                remedy = "(rm -r .venv; make setup)"
                return f"{name}: {version(name)} is installed; allowed: {allowed} {remedy}"
    return ""
