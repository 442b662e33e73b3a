"""A copy of the project's sources in which a test may run, edit and break things."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PARTS = (
    "CITATION.cff", "Snakefile", "workflow", "profiles", "config", "src", "manuscript", "requirements.lock",
)  # fmt: skip
# The profile of the folder logs for people; without it the plain lines are read.
BY_PROFILE = (sys.executable, "-m", "snakemake")
SNAKEMAKE = (
    *BY_PROFILE, "--workflow-profile", "none", "--rerun-incomplete", "--force-use-threads",
    "--rerun-triggers", "software-env",
)  # fmt: skip
# A user-defined sweep, in chunks so that there are the rules that join them, and a scene.
SWEEP = {
    "boundary": "displacement", "left": [0.3, 0.5], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
    "spacing": {"scale": 4.0}, "record": ["fronts", "fields"], "chunks": 2,
}  # fmt: skip
SCENE = {
    "title": "One", "boundary": "displacement", "left": 0.5, "right": 0.6, "gamma": 0.65, "dx": 0.1, "duration": 6.0,
}  # fmt: skip
OVERLAY = {"preset": "draft", "simulations": {"mine": SWEEP}, "scenes": {"one": SCENE}}


def copy_project(project: Path, folder: Path, *, link: bool = False) -> Path:
    """Copy what a run needs, or link it where nothing is edited; returns the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for part in PARTS:
        source = project / part
        if link:
            (folder / part).symlink_to(source)
        elif source.is_dir():
            # Compiled modules too, which stay valid as the times are kept.
            shutil.copytree(source, folder / part)
        else:
            shutil.copy2(source, folder / part)
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


def snakemake(
    folder: Path, *arguments, overlay="", cores=1, environment=None, command=SNAKEMAKE, **how
):
    """Run Snakemake in a folder, with that folder's library; returns the completed process."""
    overlays = [overlay] if isinstance(overlay, str | Path) else overlay
    options = ["--cores", str(cores), *(["--configfile", *overlays] if overlay else [])]
    library = {"PYTHONPATH": str((folder / "src").resolve())}
    return subprocess.run(
        [*command, *options, *arguments], env=os.environ | library | (environment or {}), text=True,
        **{"cwd": folder, "capture_output": True, "timeout": 1200, "check": False} | how,
    )  # fmt: skip


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
