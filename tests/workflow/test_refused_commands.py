"""The pipeline's own command refuses wrong input before any job, and goes on where that is asked for."""

import os
import runpy
import shutil
import site
import subprocess
import sys

import pytest

from slippulse.configuration.limits import HOW_TO_GO_ON

STEADY = "simulations: {steady_displacement: "

# The pipeline's own command: overlay, more arguments, what is named.
COMMANDS = {
    "misspelt key": ("simulations: {steady_displacement: {gama: [0.3]}}", [], ["did you mean 'gamma'"]),
    "cost": (STEADY + "{duration: {time: 1.0e+8}}}", [], ["steady_displacement.cost: up to", "allow_large=true"]),
    "python tag": ("preset: !!python/name:os.system\n", [], ["no tags"]),
    "list": ("[1, 2]\n", [], ["with keys at top level"]),
    "preset on the command line": ("preset: draft\n", ["--config", "preset=$(touch written)"], ["'$(touch written)'"]),
    "accuracy that costs too much": (
        "accuracy: 1.0e-4\n", ["results/figures/fig05_scaling.png"],
        ["simulations.scaling_stress.cost", "block updates", "allow_large=true"],
    ),
    "unknown figure": ("preset: draft\n", ["results/figures/fig05_scalling.png"], ["mean 'results/figures/fig05"]),
    "rule for many files": ("preset: draft\n", ["simulate"], ["target: 'simulate'", "a rule of a single job"]),
    "unknown scene": ("preset: draft\n", ["results/scenes/bariere.html"], ["did you mean 'results/scenes/barrier"]),
}  # fmt: skip
# The others go the same way.
QUICK = ("misspelt key", "cost", "unknown figure", "rule for many files")
REST = [pytest.param(case, marks=pytest.mark.slow) for case in COMMANDS if case not in QUICK]


@pytest.fixture
def folder(project, tmp_path):
    """A folder with the sources of the project."""
    for part in ("Snakefile", "workflow", "config", "src", "requirements.lock"):
        (tmp_path / part).symlink_to(project / part)
    return tmp_path


def said(command, folder, code, environment=None) -> str:
    """What a command says that ends with a code."""
    how = {"cwd": folder, "env": environment, "capture_output": True, "text": True, "timeout": 120}
    result = subprocess.run(command, **how, check=False)
    assert result.returncode == code, result.stdout + result.stderr
    return result.stdout + result.stderr


SNAKEMAKE = (sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", "--cores", "1")


@pytest.mark.parametrize("case", [*QUICK, *REST])
def test_the_command_refuses_before_any_job(folder, case):
    overlay, arguments, named = COMMANDS[case]
    (folder / "mine.yaml").write_text(overlay, encoding="utf-8")
    text = said(
        [*SNAKEMAKE, *(() if arguments[:1] == ["--config"] else ["--"]), *arguments], folder, 1
    )
    assert not any(part in text for part in ("Traceback", "localrule", "Select jobs"))
    assert all(part in text for part in named)
    assert not (folder / "results").exists() and not (folder / "written").exists()


def test_an_option_that_snakemake_itself_refuses_is_one_line_by_the_profile(folder, project):
    (folder / "profiles").symlink_to(project / "profiles")
    text = said([sys.executable, "-m", "snakemake", "--config", "x"], folder, 1)
    assert "name=value pairs" in text and "Traceback" not in text
    assert len([line for line in text.splitlines() if not line.startswith("Using ")]) == 1


@pytest.mark.slow
def test_what_costs_too_much_goes_on_where_that_is_allowed(folder):
    (folder / "mine.yaml").write_text(COMMANDS["cost"][0], encoding="utf-8")
    allowed, target = HOW_TO_GO_ON.split()[:2], "results/data/steady_displacement.nc"
    said([*SNAKEMAKE, "--dry-run", *allowed, "--", target], folder, 0)


@pytest.fixture
def make(project, folder):
    """A function that runs make in a folder with the sources and an environment, and returns what it refuses."""
    if shutil.which("make") is None:
        pytest.skip("no make on this machine")
    for part in ("Makefile", "pyproject.toml", "requirements-build.lock"):
        (folder / part).symlink_to(project / part)
    (folder / ".venv/bin").mkdir(parents=True)
    (folder / ".venv/bin/python").symlink_to(sys.executable)
    (folder / ".venv/.ready").touch()
    paths = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(project / "src"), *site.getsitepackages()])
    }
    return lambda *arguments: said(["make", *arguments], folder, 2, paths)


@pytest.mark.parametrize("overlay", ["mine.yaml: a template; allowed", "pipe: not a regular file"])
def test_make_checks_an_overlay_before_snakemake_reads_it(make, tmp_path, overlay):
    template = "__use_yte__: true\npreset: ?open('written', 'w')\n"
    (tmp_path / "mine.yaml").write_text(template, encoding="utf-8")
    # Nothing waits for it.
    os.mkfifo(tmp_path / "pipe")
    assert overlay in make("replicate", f"OVERLAY={overlay.partition(':')[0]}")
    assert not (tmp_path / "written").exists() and not (tmp_path / "results").exists()


@pytest.mark.parametrize(
    ("command", "name", "value", "allowed"),
    [
        *(("faults", "KILLS", value, "a whole number") for value in ("", "0", "-1", "1.5", "1; touch written")),
        *(("replicate", "CORES", value, "a whole number") for value in ("0", "-1", "08", "all")),
        *(("replicate", "PRESET", value, "the name of a preset") for value in ("draft'", "`touch written`", "a b")),
        *(("replicate", "ALLOW_LARGE", value, "true or false") for value in ("NO", "maybe")),
    ],
)  # fmt: skip
def test_make_checks_its_options(make, tmp_path, command, name, value, allowed):
    assert f"{name}: {value}; allowed: {allowed}" in make(command, f"{name}={value}")
    assert not (tmp_path / "written").exists() and not (tmp_path / "results").exists()


@pytest.mark.parametrize("name", ["a b", "a'b", 'a"b', "a$b", "a`b", "a\\b"])
def test_make_refuses_a_folder_in_which_jobs_would_fail(make, tmp_path, name):
    folder = tmp_path / name
    folder.mkdir()
    for part in ("Makefile", "requirements.lock", "requirements-build.lock", "pyproject.toml"):
        (folder / part).symlink_to((tmp_path / part).resolve())
    assert "path has a space or a quote" in make("-C", str(folder), "setup")
    assert not (folder / ".venv").exists()


# Commands with too few or wrong arguments, the exit code, and what is said.
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


def test_a_short_name_of_a_figure_is_understood(project, monkeypatch):
    monkeypatch.chdir(project)
    path = "results/figures/fig07_damage_zone.png"
    short = {
        "fig7": "fig07_damage_zone",
        "figure_07.png": path,
        path: path,
        "fig07_x.png": "fig07_x.png",
    }
    assert [*map(runpy.run_path("workflow/run.py")["meant"], short)] == [*short.values()]
