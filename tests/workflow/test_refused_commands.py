"""The pipeline's own command refuses wrong input before any job, and goes on where that is asked for."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from slippulse.configuration.cost import HOW_TO_GO_ON

STEADY = "simulations: {steady_displacement: "

# The pipeline's own command: overlay, more arguments, what is named.
COMMANDS = {
    "misspelt key": ("simulations: {steady_displacement: {gama: [0.3]}}", [], ["did you mean 'gamma'"]),
    "cost": (STEADY + "{duration: {time: 1.0e+8}}}", [], ["hours on one core", "allow_large=true"]),
    "alias": ("model: &a {release: total}\n", [], ["anchor or alias"]),
    "python tag": ("preset: !!python/name:os.system\n", [], ["no tags"]),
    "list": ("[1, 2]\n", [], ["with keys at top level"]),
    "preset on the command line": ("preset: draft\n", ["--config", "preset=$(touch written)"], ["'$(touch written)'"]),
    "accuracy that costs too much": (
        "accuracy: 1.0e-4\n",
        ["results/figures/fig05_scaling.png"],
        ["simulations.scaling_stress.cost", "hours on one core", "allow_large=true"],
    ),
    "unknown figure": ("preset: draft\n", ["results/figures/fig05_scalling.png"], ["mean 'results/figures/fig05"]),
    "unknown scene": ("preset: draft\n", ["results/scenes/bariere.html"], ["did you mean 'results/scenes/barrier"]),
}  # fmt: skip


# The others go the same way, and the text of each refusal is tested without the command.
QUICK = ("misspelt key", "cost", "unknown figure")


@pytest.mark.workflow
@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=() if case in QUICK else pytest.mark.slow) for case in COMMANDS]
)
def test_the_command_refuses_before_any_job(project, tmp_path, case):
    overlay, arguments, named = COMMANDS[case]
    for part in ("Snakefile", "workflow", "config", "src", "requirements.lock"):
        (tmp_path / part).symlink_to(project / part)
    (tmp_path / "mine.yaml").write_text(overlay, encoding="utf-8")
    options = arguments if arguments[:1] == ["--config"] else []
    targets = [] if options else arguments
    result = subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", "1", *options, "--configfile", "mine.yaml", "--", *targets],
        cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    said = result.stdout + result.stderr
    assert result.returncode != 0
    assert "Traceback" not in said and "localrule" not in said and "Select jobs" not in said
    for part in named:
        assert part in said
    assert not (tmp_path / "results").exists() and not (tmp_path / "written").exists()


@pytest.mark.slow
@pytest.mark.workflow
def test_what_costs_too_much_goes_on_where_that_is_allowed(project, tmp_path):
    """As the refusal says it."""
    for part in ("Snakefile", "workflow", "config", "src", "requirements.lock"):
        (tmp_path / part).symlink_to(project / part)
    (tmp_path / "mine.yaml").write_text(COMMANDS["cost"][0], encoding="utf-8")
    result = subprocess.run(
        [sys.executable, "-m", "snakemake", "--dry-run", *HOW_TO_GO_ON.split()[:2], "--configfile", "mine.yaml",
         "--", "results/data/steady_displacement.nc"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.workflow
@pytest.mark.skipif(shutil.which("make") is None, reason="no make on this machine")
def test_make_checks_an_overlay_before_snakemake_reads_it(project, tmp_path):
    (tmp_path / "mine.yaml").write_text(
        "__use_yte__: true\npreset: ?open('written', 'w')\n", encoding="utf-8"
    )
    for part in ("Snakefile", "workflow", "config", "src", "requirements.lock", "Makefile", "pyproject.toml"):
        (tmp_path / part).symlink_to(project / part)
    (tmp_path / "requirements-build.lock").symlink_to(project / "requirements-build.lock")
    (tmp_path / ".venv/bin").mkdir(parents=True)
    (tmp_path / ".venv/bin/python").symlink_to(sys.executable)
    (tmp_path / ".venv/.ready").touch()
    environment = os.environ | {"PYTHONPATH": str(project / "src")}
    result = subprocess.run(
        ["make", "replicate", "OVERLAY=mine.yaml"],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert result.returncode != 0
    assert "template key '__use_yte__'" in result.stderr
    assert not Path(tmp_path / "written").exists() and not Path(tmp_path / "results").exists()
