"""Provenance of the results, their checksums, and a manifest for CODECHECK.

Only the provenance and the folder ``seconds`` contain times, which differ from run to run. They
have no checksums, and so all results with a checksum can be compared byte by byte.
"""

import os
import platform
import re
import subprocess
import time
from collections.abc import Mapping, Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path

import yaml

from .job_records import digest_of, file_digest, job_seconds

PACKAGES = ["slippulse", "numpy", "numba", "scipy", "xarray", "h5netcdf"]
PACKAGES += ["snakemake", "matplotlib", "pandas"]
PAPER = {
    "title": "A minimal model for the onset of slip pulses in frictional rupture",
    "authors": ["Kjetil Thøgersen", "Einat Aharonov", "Fabian Barras", "François Renard"],
    "journal": "Physical Review E 103, 052802 (2021)",
    "doi": "https://doi.org/10.1103/PhysRevE.103.052802",
}


def changes(shipped: object, config: object, key: str = "") -> list[dict]:
    """List all values that differ between the shipped and another configuration.

    Each entry has the dotted ``key``, the value in the ``shipped`` configuration, and the value
    ``here``, in ``config``. The value of an absent key is None. If ``key`` is given, ``shipped``
    and ``config`` are only the values at this key.
    """
    if not (isinstance(shipped, Mapping) and isinstance(config, Mapping)):
        return [] if shipped == config else [{"key": key, "shipped": shipped, "here": config}]
    changed = []
    for name in dict.fromkeys([*shipped, *config]):
        dotted = f"{key}.{name}" if key else str(name)
        changed += changes(shipped.get(name), config.get(name), dotted)
    return changed


def source_files(root: str | Path) -> list[Path]:
    """List all files of the project that a result may depend on, except the configuration."""
    files = [Path(root, "Snakefile")]
    for folder in ("src", "workflow", "manuscript"):
        paths = Path(root, folder).rglob("*")
        files += [path for path in paths if path.is_file() and "__pycache__" not in path.parts]
    return files


def git_state(root: str | Path) -> dict | None:
    """Return the current commit of the project, and the files that differ from it.

    Returns None if the project is not in a git repository, or if git is not installed.
    """
    # Without its environment variables, git cannot be led to another repository.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    options = {"stderr": subprocess.DEVNULL, "timeout": 30, "cwd": root, "env": environment}
    git = partial(subprocess.check_output, **options)
    try:
        commit = git(["git", "rev-parse", "HEAD"], text=True).strip()
        status = git(["git", "status", "--porcelain", "--untracked-files=no"], text=True)
    except (OSError, subprocess.SubprocessError):
        return None
    # Each line has two letters and a space before the path.
    changed_files = sorted(line[3:] for line in status.splitlines())
    return {"commit": commit, "changed_files": changed_files}


def machine_class() -> dict:
    """Describe the machine without the name of the host or of the user."""
    cpuinfo = Path("/proc/cpuinfo")
    text = cpuinfo.read_text(encoding="utf-8", errors="replace") if cpuinfo.exists() else ""
    model = re.search(r"^model name\s*:(.*)", text, re.MULTILINE)
    bytes_of_memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processor": model[1].strip() if model else "",
        "cores": os.cpu_count(),
        "memory_GiB": round(bytes_of_memory / 2**30),
    }


def provenance(root: str | Path, config: Mapping, shipped: Mapping, base: str | Path) -> dict:
    """Collect everything that the results in the folder ``base`` depend on.

    ``config`` is the configuration of the results, and ``shipped`` the one without overlays.
    """
    versions = {"python": platform.python_version()}
    versions |= {name: version(name) for name in PACKAGES}
    written = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
    source_digests = {
        path.relative_to(root).as_posix(): file_digest(path) for path in source_files(root)
    }
    return {
        "paper": PAPER,
        "overlay": changes(shipped, config),
        "config": dict(config),
        "source_digest": digest_of(source_digests),
        "lock_digest": file_digest(Path(root) / "requirements.lock"),
        "git": git_state(root),
        "versions": versions,
        "machine": machine_class(),
        "times": {"written": written, "seconds_of_jobs": job_seconds(base)},
    }


def checksums(files: Sequence[str], base: str | Path) -> str:
    """Return the SHA-256 of files in the format of the program sha256sum.

    The files are sorted by their path below the folder ``base``.
    """
    names = sorted(str(Path(file).relative_to(base)) for file in files)
    return "".join(f"{file_digest(Path(base) / name)}  {name}\n" for name in names)


def manifest(files: Sequence[str], base: str | Path, comments: Mapping[str, str]) -> str:
    """Return a CODECHECK manifest, which lists every file with a comment.

    Parameters
    ----------
    files : sequence of str
        paths of the results
    base : str or Path
        folder of the results
    comments : mapping
        titles of figures by name, which are the comments on their files
    """
    entries = []
    for path in sorted([Path(file).relative_to(base) for file in files], key=str):
        # The comment on its folder, or else the title of its figure.
        folder_or_file = path.parts[0]
        comment = COMMENTS.get(folder_or_file, comments.get(path.stem, "result"))
        if folder_or_file in COMPARISON_ADVICE:
            comment += f"; {COMPARISON_ADVICE[folder_or_file]}"
        entries.append({"file": str(path), "comment": comment})
    authors = [{"name": name} for name in PAPER["authors"]]
    paper = {"title": PAPER["title"], "authors": authors, "reference": PAPER["doi"]}
    summary = (
        "make compare AGAINST=FOLDER shows figures, verdicts and tables beside those of another run"
    )
    content = {
        "version": "https://codecheck.org.uk/spec/config/1.0/",
        "paper": paper,
        "manifest": entries,
        "summary": summary,
    }
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=110)


# Advice for a comparison with results of another machine, by the folder of a file in results, or by
# its name if it is in no folder.
COMPARISON_ADVICE = {
    "claims.json": "compare first: the verdicts must be the same",
    "claims.html": "read it",
    "figures": "compare the numbers in the CSV file; look at the PNG and PDF files",
    "measurements": "numbers must agree within the uncertainties listed in uncertainties/",
    "studies": "numbers must agree to a relative difference of 1e-6",
    "manuscript": "read the report; its numbers follow from the tables",
}
# Comments on files, by their folder or name.
COMMENTS = {
    "data": "simulated data, netCDF-4",
    "measurements": "measured numbers, one row for each run",
    "uncertainties": "grid study of every measured number",
    "manuscript": "the replication report",
    "claims.html": "the content of claims.json as a table",
    "explorer.html": "a rupture with sliders: the exact solution and the paper's formulas",
    "claims.json": "the statements of the paper, the measured numbers and the verdicts",
}
