"""Comparison of the installed packages with the versions in requirements.lock."""

import re
from collections import defaultdict
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def package_problem(lock: str | Path) -> str:
    """Return a line on the first installed package that does not agree with requirements.lock.

    The text is empty if all agree. ``lock`` is the path of the file, which may list several
    versions of a package.
    """
    locked_versions: defaultdict[str, set[str]] = defaultdict(set)
    text = Path(lock).read_text(encoding="utf-8")
    for name, locked_version in re.findall(r"^([\w.-]+)==([^\s;\\]+)", text, re.M):
        locked_versions[name].add(locked_version)
    for name, versions in locked_versions.items():
        # The file also lists packages that only other systems or versions of Python need. These
        # packages are not installed here.
        with suppress(PackageNotFoundError):
            if version(name) not in versions:
                allowed = f"{' or '.join(sorted(versions))}, as in requirements.lock"
                remedy = "(rm -r .venv; make setup)"
                return f"{name}: {version(name)} is installed; allowed: {allowed} {remedy}"
    return ""
