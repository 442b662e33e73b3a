"""Who made what from what: the one file of a run that holds times, and the manifest of everything it made."""

import os
import platform
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from itertools import chain
from pathlib import Path

import yaml

from .alterations import changes
from .records import file_digest, read_records
from .versions import PACKAGES

PAPER = {
    "title": "A minimal model for the onset of slip pulses in frictional rupture",
    "authors": ["Kjetil Thøgersen", "Einat Aharonov", "Fabian Barras", "François Renard"],
    "journal": "Physical Review E 103, 052802 (2021)",
    "doi": "https://doi.org/10.1103/PhysRevE.103.052802",
}


def source_files(root: str | Path) -> list[Path]:
    """Everything that a result may depend on besides the configuration: library, workflow, report."""
    found = chain(*(Path(root, folder).rglob("*") for folder in ("src", "workflow", "manuscript")))
    below = [path for path in found if path.is_file() and "__pycache__" not in path.parts]
    return [Path(root, "Snakefile"), *below]


def git_state(root: str | Path) -> dict | None:
    """Commit and whether files differ from it; None outside a repository or without git."""

    def ask(*arguments: str) -> str:
        command = ["git", "-C", str(root), *arguments]
        return subprocess.run(
            command, capture_output=True, text=True, timeout=30, check=True
        ).stdout.rstrip()

    try:
        changed = ask("status", "--porcelain", "--untracked-files=no").splitlines()
        return {
            "commit": ask("rev-parse", "HEAD"),
            "changed_files": sorted(line[3:] for line in changed),
        }
    except (OSError, subprocess.SubprocessError):
        return None


def machine_class() -> dict:
    """What kind of machine: no name of a host or a user."""
    cpuinfo = Path("/proc/cpuinfo")
    text = cpuinfo.read_text(encoding="utf-8", errors="replace") if cpuinfo.exists() else ""
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processor": text.partition("\nmodel name")[2].partition("\n")[0].strip("\t :"),
        "cores": os.cpu_count(),
        "memory_GiB": round(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30),
    }


def job_times(results: str | Path) -> dict[str, float]:
    """Seconds that the jobs of each step took, all together, from their records."""
    seconds: dict[str, float] = {}
    for record in read_records(results):
        seconds[record.step] = round(seconds.get(record.step, 0.0) + record.used["seconds"], 2)
    return seconds


def provenance(
    root: str | Path, sources: str, config: Mapping, shipped: Mapping, base: str | Path
) -> dict:
    """Everything that a result depends on; ``sources``: digest of `source_files`; ``shipped``: without overlays."""
    packages = (*PACKAGES, "snakemake", "matplotlib", "pandas")
    written = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
    return {
        "paper": PAPER,
        "overlay": changes(shipped, config),
        "config": dict(config),
        "source_digest": sources,
        "lock_digest": file_digest(Path(root) / "requirements.lock"),
        "git": git_state(root),
        "versions": {"python": platform.python_version()}
        | {name: version(name) for name in packages},
        "implementation": sys.implementation.name,
        "machine": machine_class(),
        "times": {"written": written, "seconds_of_jobs": job_times(base)},
    }


def checksums(files: Sequence[str], base: str | Path) -> str:
    """Lines as of sha256sum, with paths relative to a folder, in order of the path."""
    names = sorted(str(Path(file).relative_to(base)) for file in files)
    return "".join(f"{file_digest(Path(base) / name)}  {name}\n" for name in names)


def manifest(files: Sequence[str], base: str | Path, comments: Mapping[str, str]) -> str:
    """A CODECHECK manifest that lists every output, with what it is."""
    entries = []
    for path in sorted((Path(file).relative_to(base) for file in files), key=str):
        comment = COMMENTS.get(path.parts[0], "result")
        if path.stem in comments:
            comment = f"{comments[path.stem]} ({path.suffix[1:].upper()})"
        entries.append({"file": str(path), "comment": comment})
    authors = [{"name": name} for name in PAPER["authors"]]
    content = {
        "version": "https://codecheck.org.uk/spec/config/1.0/",
        "paper": {"title": PAPER["title"], "authors": authors, "reference": PAPER["doi"]},
        "manifest": entries,
    }
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=110)


COMMENTS = {
    "data": "simulated data, netCDF-4",
    "measurements": "measured numbers, one row a run",
    "uncertainties": "grid study of every measured number",
    "manuscript": "the replication report",
    "claims.html": "the same as a table to read",
    "explorer.html": "a rupture with sliders, the exact solution beside the paper's formulas",
    "claims.json": "what the paper says, what was measured, the verdict",
}
