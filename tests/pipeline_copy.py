"""A copy of the project's sources in which a test may run, edit and break things."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from numba.core.caching import _CacheLocator

from slippulse.solver import jit

PARTS = (
    "CITATION.cff", "Snakefile", "workflow", "profiles", "config", "src", "manuscript", "requirements.lock",
)  # fmt: skip


def copy_project(project: Path, folder: Path, *, link: bool = False) -> Path:
    """Copy what a run needs, or link it where nothing is edited; returns the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for part in PARTS:
        source = project / part
        if link and source.exists():
            (folder / part).symlink_to(source)
        elif source.is_dir():
            # Compiled modules too, which stay valid as the times are kept.
            shutil.copytree(source, folder / part)
        elif source.exists():
            shutil.copy2(source, folder / part)
    if not link:
        share_kernels(folder)
    return folder


# What a job does in an imitated project: each output says what it is made by and from, as quickly as possible.
IMITATION = """

class import_module:
    def __init__(self, name):
        self.name = name

    def run(self, files, outputs, settings):
        from ..data.files import configuration, write_text
        from ..data.records import file_digest

        given, made = ([path for value in all.values() for path in ([value] if isinstance(value, str) else value)]
                       for all in (files, outputs))
        digests = [file_digest(path) for path in given if path.startswith("results/")]
        for path in made:
            write_text(f"{self.name} {configuration()} {digests} {path}\\n", path)
"""


def imitate_steps(folder: Path) -> None:
    """Let every job of a copy write short texts instead of running its step; all else is as it is."""
    path = folder / "src/slippulse/steps/job.py"
    text = path.read_text(encoding="utf-8")
    assert text.count('import_module(f"slippulse.steps.') == 1
    path.write_text(text + IMITATION, encoding="utf-8")


def share_kernels(folder: Path) -> None:
    """Give a copy of the sources the kernels that are compiled already: numba keeps them under the sources' path."""
    cache = jit.cache_folder()
    compiled = cache / Path(_CacheLocator.get_suitable_cache_subpath(jit.__file__))
    copied = folder / Path(jit.__file__).relative_to(Path(__file__).resolve().parents[1])
    if compiled.exists():
        shutil.copytree(
            compiled, cache / _CacheLocator.get_suitable_cache_subpath(str(copied)), dirs_exist_ok=True
        )


def snakemake(
    folder: Path,
    *arguments: str,
    overlay: str = "",
    cores: int = 1,
    environment: dict | None = None,
    timeout: int = 300,
) -> subprocess.CompletedProcess:
    """Run Snakemake in a folder, with that folder's library."""
    # The profile of the folder logs for people; here the plain lines are read.
    command = [sys.executable, "-m", "snakemake", "--workflow-profile", "none", "--rerun-incomplete"]
    command += ["--force-use-threads", "--rerun-triggers", "software-env"]
    command += ["--cores", str(cores)]
    command += ["--configfile", overlay] if overlay else []
    library = (folder / "src").resolve()
    return subprocess.run(
        [*command, *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(library)} | (environment or {}),
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )


def planned(result: subprocess.CompletedProcess) -> dict[str, int]:
    """Rules and how often each is to run, from a dry run."""
    assert result.returncode == 0, result.stderr + result.stdout
    text = result.stdout + result.stderr
    table = re.search(r"Job stats:\njob +count\n[- ]+\n(.*?)\ntotal", text, re.S)
    if table is None:
        assert "Nothing to be done" in text
        return {}
    return {row.split()[0]: int(row.split()[1]) for row in table.group(1).splitlines()}


def edges(graph: str) -> set[tuple[str, str]]:
    """Which rule feeds which, by name, in a mermaid graph."""
    names = dict(re.findall(r"^\s*(id\d+)\[(\w+)\]", graph, re.M))
    return {(names[a], names[b]) for a, b in re.findall(r"^\s*(id\d+) --> (id\d+)", graph, re.M)}


def merged(base: dict, change: dict) -> dict:
    """A configuration with another one laid over it."""
    out = dict(base)
    for key, value in change.items():
        out[key] = merged(base[key], value) if isinstance(value, dict) and key in base else value
    return out
