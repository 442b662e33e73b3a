"""Refusals by the command of the workflow before any job, and unusual runs that are allowed."""

import os
import runpy
import shutil
import site
import subprocess
import sys

import pytest
from pipeline_copy import copy_project, made, refused

from slippulse.model.cost import OPTION_TO_ALLOW

STEADY = "simulations: {steady_displacement: "
DRAFT, LONG = "preset: draft\n", STEADY + "{duration: {time: 1.0e+8}}}"
# Overlay, further arguments, and parts of the refusal.
COMMANDS = [
    (STEADY + "{gama: [0.3]}}", "--", ["did you mean 'gamma'"]),
    (
        "simulations: {scaling_displacement: {left: [0.3], right: [0.5]}}",
        "-- results/figures/fig05_scaling.png",
        ["simulations.scaling_displacement: no run that fig05_scaling can draw; allowed: "],
    ),
    (LONG, "--", ["steady_displacement.cost: up to", "allow_large=true"]),
    ("", "--config preset=01", ["preset: '01'; allowed: draft, paper, reference"]),
    # Targets that do not exist are refused by Snakemake itself.
    (DRAFT, "-- simulate", ["Target rules may not contain wildcards"]),
    (DRAFT, "-- results/scenes/bariere.html", ["MissingRuleException", "bariere.html"]),
    (DRAFT, "--config preset=$(touch\twritten)", ["'$(touch"]),
    ("accuracy: 1.0e-4\n", "-- fig05", ["simulations.scaling_stress.cost", "updates"]),
]
# The first five cover every kind of refusal, and so the others are slow tests.
COMMANDS[5:] = [pytest.param(*case, marks=pytest.mark.slow) for case in COMMANDS[5:]]
ODD_NOTES = ["", "5", "[]", '{"options": 5}', '{"targets": [{}]}', "[" * 99999]


@pytest.fixture
def folder(project, tmp_path):
    return copy_project(project, tmp_path, link=True)


@pytest.mark.parametrize(("overlay", "arguments", "refusal"), COMMANDS)
def test_the_command_refuses_before_any_job(folder, overlay, arguments, refusal):
    (folder / "mine.yaml").write_text(overlay or "measure: {}", encoding="utf-8")
    text = refused(folder, *arguments.split(" "), overlay="mine.yaml")
    assert not any(part in text for part in ("localrule", "Select jobs"))
    assert all(part in text for part in refusal)
    assert not (folder / "results").exists() and not (folder / "written").exists()


@pytest.mark.slow
def test_an_odd_environment_of_the_user_does_not_stop_a_run(folder, tmp_path_factory):
    """TMPDIR is long, SOURCE_DATE_EPOCH is empty, there is no home, and a profile touches files."""
    long = tmp_path_factory.mktemp("t") / ("x" * 110)
    long.mkdir()
    profile = tmp_path_factory.mktemp("profile")
    (profile / "config.yaml").write_text("touch: true\n", encoding="utf-8")
    target = "results/figures/fig07_damage_zone.png"
    odd = {"TMPDIR": str(long), "SOURCE_DATE_EPOCH": "", "HOME": "/proc/none", "TARGET": target}
    odd |= {"XDG_CACHE_HOME": "", "SNAKEMAKE_PROFILE": str(profile), "PRESET": "draft"}
    command = [sys.executable, "workflow/run.py", "replicate"]
    how = {"cwd": folder, "env": os.environ | odd, "capture_output": True, "text": True}
    result = subprocess.run(command, check=False, timeout=300, **how)
    assert result.returncode == 0, result.stderr
    assert f"Made: {target}" in result.stdout and (folder / target).stat().st_size > 0


@pytest.mark.slow
def test_a_run_that_costs_too_much_can_be_allowed(folder):
    (folder / "mine.yaml").write_text(LONG, encoding="utf-8")
    allowed, target = OPTION_TO_ALLOW.split()[:2], "results/data/steady_displacement.nc"
    made(folder, "--dry-run", *allowed, "--", target, overlay="mine.yaml")


@pytest.fixture
def make(project, folder):
    """Return a function that runs make in a copy of the project and returns what it prints."""
    if shutil.which("make") is None:
        pytest.skip("no make on this machine")
    for part in ("Makefile", "pyproject.toml", "requirements-build.lock"):
        (folder / part).symlink_to(project / part)
    (folder / ".venv/bin").mkdir(parents=True)
    (folder / ".venv/bin/python").symlink_to(sys.executable)
    (folder / ".venv/.ready").touch()
    folders = [str(project / "src"), *site.getsitepackages()]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(folders)}

    def make(*arguments: str, code: int = 2) -> str:
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        how = {"cwd": folder, "env": environment, "timeout": 120, "check": False} | pipes
        result = subprocess.run(["make", *arguments], **how)
        assert result.returncode == code, result.stdout
        return result.stdout

    return make


@pytest.mark.parametrize("overlay", ["mine.yaml: a template; allowed", "pipe: not a regular file"])
def test_make_checks_an_overlay_before_snakemake_reads_it(make, tmp_path, overlay):
    template = "__use_yte__: true\npreset: ?open('written', 'w')\n"
    (tmp_path / "mine.yaml").write_text(template, encoding="utf-8")
    # The command must not wait until something is written to the pipe.
    os.mkfifo(tmp_path / "pipe")
    for command in ("replicate", "rulegraph", "verify"):
        assert overlay in make(command, f"OVERLAY={overlay.partition(':')[0]}")
    assert not (tmp_path / "written").exists() and not (tmp_path / "results").exists()


def test_make_explains_a_target_that_is_no_rule(make):
    printed = make("replicate", "PRESET=draft", "TARGET=fig12 scenes fig3")
    assert "TARGET: no rule of this project makes fig12; allowed: a figure" in printed


OPTIONS = [
    *(("faults", "KILLS", value) for value in ("", "0", "-1", "1.5", "1; touch written")),
    *(("replicate", "CORES", value) for value in ("0", "-1", "08", "all")),
    *(("replicate", "PRESET", value) for value in ("draft'", "`touch written`", "a b")),
    *(("replicate", "ALLOW_LARGE", value) for value in ("NO", "maybe")),
]
ALLOWED = {"KILLS": "a whole number", "CORES": "a whole number"}
ALLOWED |= {"PRESET": "the name of a preset", "ALLOW_LARGE": "true or false"}


@pytest.mark.parametrize(("command", "name", "value"), OPTIONS)
def test_make_checks_its_options(make, tmp_path, command, name, value):
    assert f"{name}: {value}; allowed: {ALLOWED[name]}" in make(command, f"{name}={value}")
    assert not (tmp_path / "written").exists() and not (tmp_path / "results").exists()


CHECKED = {"CORES": "replicate", "PRESET": "replicate", "KILLS": "faults"}


@pytest.mark.parametrize("name", [*CHECKED, "OVERLAY", "TARGET", "AGAINST", "ALLOW_LARGE"])
@pytest.mark.parametrize("value", ["$(shell touch written)", "$(error written)", "`touch written`"])
def test_no_value_of_an_option_is_read_as_a_command(make, tmp_path, name, value):
    make("help", f"{name}={value}", "OTHER=$(shell touch written)", code=0)
    # These commands also use the option.
    if name in CHECKED:
        assert f"{name}: {value}; allowed" in make(CHECKED[name], f"{name}={value}")
    assert not (tmp_path / "written").exists()


@pytest.mark.parametrize("name", ["a b", "a'b", 'a"b', "a$b", "a`b", "a\\b"])
def test_make_refuses_a_folder_in_which_jobs_would_fail(make, tmp_path, name):
    folder = tmp_path / name
    folder.mkdir()
    for part in ("Makefile", "requirements.lock", "requirements-build.lock", "pyproject.toml"):
        (folder / part).symlink_to((tmp_path / part).resolve())
    assert "path has a space or a quote" in make("-C", str(folder), "setup")
    assert not (folder / ".venv").exists()


@pytest.mark.parametrize("text", ODD_NOTES)
def test_an_odd_note_on_the_last_run_counts_as_absent(project, tmp_path, monkeypatch, text):
    monkeypatch.chdir(tmp_path)
    verified_run = runpy.run_path(str(project / "workflow/run.py"))["verified_run"]
    (tmp_path / ".snakemake").mkdir()
    (tmp_path / ".snakemake/slippulse-last-run.json").write_text(text)
    assert verified_run({"TARGET": "fig07.csv"}) == ({}, ["results/figures/fig07_damage_zone.csv"])


@pytest.mark.slow
def test_an_environment_that_differs_from_the_lock_is_refused(folder):
    (folder / "mine.yaml").write_text(DRAFT, encoding="utf-8")
    other = folder / "elsewhere/xarray-0.0.1.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: xarray\nVersion: 0.0.1\n")
    how = {"overlay": "mine.yaml", "environment": {"PYTHONPATH": str(other.parent)}}
    text = refused(folder, "--quiet", "all", "--", "results/figures/fig07_damage_zone.png", **how)
    assert text.startswith("xarray: 0.0.1 is installed; allowed: ") and text.count("\n") == 1
    assert not (folder / "results").exists()


def test_a_short_name_of_a_figure_is_understood(project, monkeypatch):
    monkeypatch.chdir(project)
    path = "results/figures/fig07_damage_zone.png"
    short = dict.fromkeys(("fig7", "figure_07.png", path), path) | {"everything": "everything"}
    short["fig07.csv"] = path.replace("png", "csv")
    short["sweep_mine"] = "results/figures/sweep_mine.png"
    full_target = runpy.run_path("workflow/run.py")["full_target"]
    assert [*map(full_target, short)] == [*short.values()]
    # Snakemake refuses a figure that does not exist.
    assert full_target("fig99") == "fig99"
