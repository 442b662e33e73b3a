"""Copies of the project in which tests run the workflow and may edit or break files."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

FOLDERS = ("workflow", "profiles", "config", "src", "manuscript")
PARTS = ("CITATION.cff", "Snakefile", "requirements.lock", *FOLDERS)
# Without the profile of the project, the log has plain lines that tests can read.
BY_PROFILE = (sys.executable, "-m", "snakemake")
WITHOUT_PROFILE = (*BY_PROFILE, "--workflow-profile", "none")
SNAKEMAKE = (*WITHOUT_PROFILE, "--rerun-incomplete", "--force-use-threads")
# A user-defined sweep and a scene. The sweep has chunks so that the rules that join them take part.
SWEEP = {"boundary": "displacement", "left": [0.3, 0.5], "right": "same", "gamma": [0.65]}
SWEEP |= {"duration": {"time": 6.0}, "spacing": {"scale": 4.0}}
SWEEP |= {"record": ["fronts", "fields"], "chunks": 2}
SCENE = {"title": "One", "boundary": "displacement", "left": 0.5, "right": 0.6, "gamma": 0.65}
SCENE |= {"dx": 0.1, "duration": 6.0}
OVERLAY = {"preset": "draft", "simulations": {"mine": SWEEP}, "scenes": {"one": SCENE}}


def copy_project(project: Path, folder: Path, *, link: bool = False) -> Path:
    """Copy the files that a run needs, or link them if the test does not edit them.

    Returns the folder.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for part in PARTS:
        source = project / part
        if link:
            (folder / part).symlink_to(source)
        elif source.is_dir():
            # Compiled modules are copied too. They stay valid, since copies keep the times.
            shutil.copytree(source, folder / part)
        else:
            shutil.copy2(source, folder / part)
    return folder


# A replacement for all steps: each output contains the step, the settings and the digests of
# inputs.
IMITATION = """

class import_module:
    def __init__(self, name):
        self.name = name

    def run(self, files, outputs, settings):
        from slippulse.data.files import configuration_digest, write_text
        from slippulse_paper.records.job_records import file_digest

        digests = [file_digest(path) for path in _paths(files) if "results/" in path]
        for path in _paths(outputs):
            write_text(f"{self.name} {configuration_digest()} {digests} {path}\\n", path)
"""


def imitate_steps(folder: Path) -> None:
    """Let the jobs of a copy write short texts instead of running their steps."""
    steps = folder / "src/slippulse_paper/steps"
    text = (steps / "job.py").read_text(encoding="utf-8")
    assert text.count('import_module(f"slippulse_paper.steps.') == 1
    (steps / "job.py").write_text(text + IMITATION, encoding="utf-8")
    (steps / "worker_libraries.py").write_text("", encoding="utf-8")


# Variables that make sets for the tests, and which a run that a test starts must not get.
VARIABLES_OF_MAKE = (
    "MAKELEVEL",
    "MAKEFLAGS",
    "CORES",
    "PRESET",
    "OVERLAY",
    "TARGET",
    "ALLOW_LARGE",
)


def snakemake(
    folder: Path,
    *arguments,
    overlay="",
    cores=1,
    environment=None,
    command=SNAKEMAKE,
    **process_options,
):
    """Run Snakemake in a folder and return the completed process.

    ``overlay`` is a path or several paths, and ``environment`` has additional variables.
    """
    all_options = [*command, "--cores", str(cores)]
    if overlay:
        overlays = [overlay] if isinstance(overlay, str | Path) else overlay
        all_options += ["--configfile", *overlays]
    variables = {name: value for name, value in os.environ.items() if name not in VARIABLES_OF_MAKE}
    defaults = {
        "cwd": folder,
        "env": variables | (environment or {}),
        "capture_output": True,
        "text": True,
        "timeout": 1200,
        "check": False,
    }
    all_options += arguments
    return subprocess.run(all_options, **(defaults | process_options))


def made(folder: Path, *arguments, **options) -> subprocess.CompletedProcess:
    """Run `snakemake`, which must succeed, and return the completed process."""
    result = snakemake(folder, *arguments, **options)
    assert result.returncode == 0, result.stderr
    return result


def refused(folder: Path, *arguments, **options) -> str:
    """Run `snakemake`, which must fail without a traceback, and return what it prints."""
    result = snakemake(folder, *arguments, **options)
    text = result.stdout + result.stderr
    assert result.returncode != 0 and "Traceback" not in text, text
    return text


def planned(result: subprocess.CompletedProcess) -> dict[str, int]:
    """Return the number of jobs of each rule that a dry run has planned."""
    assert result.returncode == 0, result.stderr + result.stdout
    text = result.stdout + result.stderr
    table = re.search(r"Job stats:\njob +count\n[- ]+\n(.*?)\ntotal", text, re.S)
    if table is None:
        assert "Nothing to be done" in text
        return {}
    counts = {}
    for row in table.group(1).splitlines():
        rule, count = row.split()
        counts[rule] = int(count)
    return counts


def planned_by_name(result: subprocess.CompletedProcess) -> dict[str, int]:
    """Return the jobs of a dry run, with figures and studies counted by their names."""
    jobs = planned(result)
    text = result.stdout + result.stderr
    names = re.findall(r"^Job \d+: Drawing (?!scene )(\S+)$", text, re.M)
    names += [f"study_of_{name}" for name in re.findall(r"^Job \d+: Studying (\S+)$", text, re.M)]
    assert jobs.pop("figure", 0) + jobs.pop("study", 0) == len(names)
    return jobs | dict.fromkeys(names, 1)


def edges(graph: str) -> set[tuple[str, str]]:
    """Return the edges of a mermaid graph: pairs of rules, the second of which needs the first."""
    names = dict(re.findall(r"^\s*(id\d+)\[(\w+)\]", graph, re.M))
    arrows = re.findall(r"^\s*(id\d+) --> (id\d+)", graph, re.M)
    return {(names[start], names[end]) for start, end in arrows}
