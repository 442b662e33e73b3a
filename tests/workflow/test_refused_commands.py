"""Refusals by the pipeline's own command before any job, and runs that are allowed in spite."""

import os
import runpy
import shutil
import site
import subprocess
import sys

import pytest

from slippulse.model.cost import HOW_TO_GO_ON

STEADY = "simulations: {steady_displacement: "
DRAFT, LONG = "preset: draft\n", STEADY + "{duration: {time: 1.0e+8}}}"
# Overlay, further arguments, and parts of the refusal.
COMMANDS = {
    "misspelt key": (STEADY + "{gama: [0.3]}}", "--", ["did you mean 'gamma'"]),
    "cost": (LONG, "--", ["steady_displacement.cost: up to", "allow_large=true"]),
    "rule for many files": (DRAFT, "-- simulate", ["target: 'simulate'", "a rule of a single job"]),
}
# These take the same way through the pipeline.
SLOW = {
    "python tag": ("preset: !!python/name:os.system\n", "--", ["no tags"]),
    "preset on the command line": (DRAFT, "--config preset=$(touch\twritten)", ["'$(touch"]),
    "unknown scene": (DRAFT, "-- results/scenes/bariere.html", ["mean 'results/scenes/barrier"]),
    "accuracy": ("accuracy: 1.0e-4\n", "-- fig05", ["simulations.scaling_stress.cost", "updates"]),
}
CASES = [pytest.param(*case, id=name) for name, case in COMMANDS.items()]
CASES += [pytest.param(*case, marks=pytest.mark.slow, id=name) for name, case in SLOW.items()]
SNAKEMAKE = (sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", "--cores", "1")
ODD_NOTES = ["", "5", "[]", '{"options": 5}', '{"targets": [{}]}', "[" * 99999]


@pytest.fixture
def folder(project, tmp_path):
    for part in ("Snakefile", "workflow", "config", "src", "requirements.lock"):
        (tmp_path / part).symlink_to(project / part)
    return tmp_path


def said(command, folder, code, environment=None) -> str:
    """The output of a command that must end with a code."""
    options = {"capture_output": True, "text": True, "timeout": 120, "check": False}
    result = subprocess.run(command, cwd=folder, env=environment, **options)
    assert result.returncode == code, result.stdout + result.stderr
    return result.stdout + result.stderr


@pytest.mark.parametrize(("overlay", "arguments", "refusal"), CASES)
def test_the_command_refuses_before_any_job(folder, overlay, arguments, refusal):
    (folder / "mine.yaml").write_text(overlay, encoding="utf-8")
    text = said([*SNAKEMAKE, *arguments.split(" ")], folder, 1)
    assert not any(part in text for part in ("Traceback", "localrule", "Select jobs"))
    assert all(part in text for part in refusal)
    assert not (folder / "results").exists() and not (folder / "written").exists()


def test_an_option_that_snakemake_itself_refuses_is_one_line_by_the_profile(folder, project):
    (folder / "profiles").symlink_to(project / "profiles")
    text = said([sys.executable, "-m", "snakemake", "--config", "x"], folder, 1)
    assert "name=value pairs" in text and "Traceback" not in text
    assert len([line for line in text.splitlines() if not line.startswith("Using ")]) == 1


@pytest.mark.slow
def test_what_costs_too_much_goes_on_where_that_is_allowed(folder):
    (folder / "mine.yaml").write_text(LONG, encoding="utf-8")
    allowed, target = HOW_TO_GO_ON.split()[:2], "results/data/steady_displacement.nc"
    said([*SNAKEMAKE, "--dry-run", *allowed, "--", target], folder, 0)


@pytest.fixture
def make(project, folder):
    """A function that runs make in a folder with the sources, and returns its refusal."""
    if shutil.which("make") is None:
        pytest.skip("no make on this machine")
    for part in ("Makefile", "pyproject.toml", "requirements-build.lock"):
        (folder / part).symlink_to(project / part)
    (folder / ".venv/bin").mkdir(parents=True)
    (folder / ".venv/bin/python").symlink_to(sys.executable)
    (folder / ".venv/.ready").touch()
    folders = [str(project / "src"), *site.getsitepackages()]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(folders)}
    return lambda *arguments: said(["make", *arguments], folder, 2, environment)


@pytest.mark.parametrize("overlay", ["mine.yaml: a template; allowed", "pipe: not a regular file"])
def test_make_checks_an_overlay_before_snakemake_reads_it(make, tmp_path, overlay):
    template = "__use_yte__: true\npreset: ?open('written', 'w')\n"
    (tmp_path / "mine.yaml").write_text(template, encoding="utf-8")
    # Nothing waits for a writer of the pipe.
    os.mkfifo(tmp_path / "pipe")
    assert overlay in make("replicate", f"OVERLAY={overlay.partition(':')[0]}")
    assert not (tmp_path / "written").exists() and not (tmp_path / "results").exists()


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


@pytest.mark.parametrize("name", ["a b", "a'b", 'a"b', "a$b", "a`b", "a\\b"])
def test_make_refuses_a_folder_in_which_jobs_would_fail(make, tmp_path, name):
    folder = tmp_path / name
    folder.mkdir()
    for part in ("Makefile", "requirements.lock", "requirements-build.lock", "pyproject.toml"):
        (folder / part).symlink_to((tmp_path / part).resolve())
    assert "path has a space or a quote" in make("-C", str(folder), "setup")
    assert not (folder / ".venv").exists()


# Commands with too few or wrong arguments: module, arguments, exit code, words of the message.
USES = {
    "overlay": ("slippulse.configuration.read", "", 2, "usage: "),
    "benchmarks": ("tests.benchmark", "", 2, "usage: "),
    "benchmarks without a configuration": ("tests.benchmark", "Makefile {folder}", 1, "Makefile: "),
    "benchmarks into a file": ("tests.benchmark", "config/config.yaml {folder}/file", 1, "file: "),
    "reference": ("docs.reference", "", 2, "usage: "),
    "reference into a file": ("docs.reference", "{folder}/file", 1, "file: "),
}


@pytest.mark.filterwarnings("ignore:.*found in sys.modules")
@pytest.mark.parametrize("case", USES)
def test_a_command_says_in_one_line_how_it_is_used(project, tmp_path, monkeypatch, capsys, case):
    module, arguments, code, named = USES[case]
    (tmp_path / "file").touch()
    monkeypatch.chdir(project)
    monkeypatch.setattr(sys, "argv", [module, *arguments.format(folder=tmp_path).split()])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module(module, run_name="__main__")
    # Python prints a text that a process ends with, and the code is 1.
    text = ended.value.code if code == 1 else capsys.readouterr().err.rstrip("\n")
    assert code in (1, ended.value.code) and named in text and "\n" not in text


@pytest.mark.parametrize("text", ODD_NOTES)
def test_an_odd_note_on_the_last_run_counts_as_absent(project, tmp_path, monkeypatch, text):
    monkeypatch.chdir(tmp_path)
    arguments = runpy.run_path(str(project / "workflow/run.py"))["arguments"]
    (tmp_path / "results/records").mkdir(parents=True)
    (tmp_path / "results/records/.call").write_text(text)
    assert arguments("verify")[-3:] == ["1", "--", "verify"]


@pytest.mark.slow
def test_an_environment_that_differs_from_the_lock_is_refused(folder):
    (folder / "mine.yaml").write_text(DRAFT, encoding="utf-8")
    other = folder / "elsewhere/xarray-0.0.1.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: xarray\nVersion: 0.0.1\n")
    environment = os.environ | {"PYTHONPATH": str(other.parent)}
    text = said([*SNAKEMAKE, "--quiet", "all", "--", "verify"], folder, 1, environment)
    assert text.startswith("xarray: 0.0.1 is installed; allowed: ") and text.count("\n") == 1
    assert not (folder / "results").exists()


@pytest.mark.parametrize(
    "command",
    [
        "workflow/run.py verify",
        pytest.param("-m snakemake --cores 1 -- fig07", marks=pytest.mark.slow),
    ],
)
def test_a_folder_of_caches_that_cannot_be_written_is_one_line(folder, project, command):
    where = "/proc/none"
    (folder / "profiles").symlink_to(project / "profiles")
    environment = os.environ | {"XDG_CACHE_HOME": where}
    lines = said([sys.executable, *command.split()], folder, 1, environment).splitlines()
    # Snakemake names the profile that it uses; make verify uses none.
    (line,) = [line for line in lines if not line.startswith("Using ")]
    assert where in line and "Error" in line


def test_a_short_name_of_a_figure_is_understood(project, monkeypatch):
    monkeypatch.chdir(project)
    path = "results/figures/fig07_damage_zone.png"
    short = dict.fromkeys(("fig7", "figure_07.png", path), path) | {"everything": "everything"}
    short["fig07.csv"] = path.replace("png", "csv")
    short["sweep_mine"] = "results/figures/sweep_mine.png"
    full_target = runpy.run_path("workflow/run.py")["full_target"]
    assert [*map(full_target, short)] == [*short.values()]
    with pytest.raises(SystemExit, match=r"TARGET: fig99; allowed: fig01_system_sketch, .*sweep_"):
        full_target("fig99")
