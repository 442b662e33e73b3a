"""The workflow follows conventions: Snakemake's options do what Snakemake documents."""

import os
import re
import subprocess
import tarfile
from pathlib import Path

import pytest
from pipeline_copy import BY_PROFILE, WITHOUT_PROFILE, copy_project, made, planned, snakemake
from workflow.conftest import FIGURE, SMALL
from workflow.test_edits import DRAWING, edit, times

OVERLAY = {"overlay": "overlay.yaml"}
# Rules that a user adds in a separate file.
OWN_RULES = """
rule mine_by_shell:
    input: "results/measurements/mine.csv"
    output: "results/mine/lines.txt"
    shell: "wc -l < {input} > {output}"

rule mine_by_script:
    input: "results/mine/lines.txt"
    output: "results/mine/script.txt"
    script: "mine.py"

rule mine_by_run:
    input: "results/mine/script.txt"
    output: "results/mine/run.txt"
    run:
        open(output[0], "w").write(open(input[0]).read() + "run")
"""
SCRIPT = "open(snakemake.output[0], 'w').write(open(snakemake.input[0]).read() + 'script')\n"


@pytest.fixture
def project_with_own_rules(small) -> Path:
    (small / "mine.smk").write_text(OWN_RULES, encoding="utf-8")
    (small / "mine.py").write_text(SCRIPT, encoding="utf-8")
    with open(small / "Snakefile", "a", encoding="utf-8") as file:
        file.write('\n\ninclude: "mine.smk"\n')
    return small


def test_rules_of_a_user_run_by_shell_script_and_run(project_with_own_rules):
    folder = project_with_own_rules
    result = made(folder, "--", "results/mine/run.txt", **OVERLAY)
    assert (folder / "results/mine/run.txt").read_text() == "1\nscriptrun"
    # Only the new rules ran.
    assert not re.search("Simulating|Drawing|Measuring", result.stderr)


LOOKS = ("--summary", "--detailed-summary", "--list-rules", "--rulegraph mermaid-js")
LOOKS += ("--list-changes code", "--list-changes params", "--list-changes input", "--lint")


@pytest.mark.parametrize(
    "options", [LOOKS[0], *(pytest.param(look, marks=pytest.mark.slow) for look in LOOKS[1:])]
)
def test_a_look_changes_no_file_and_no_time(small, options):
    edit(small / DRAWING)
    (small / "results/data/one.nc").write_text("edited by hand", encoding="utf-8")
    before = times(small)
    listed = snakemake(small, *options.split(), "--", *SMALL, **OVERLAY)
    assert listed.returncode == 0, listed.stderr
    assert times(small) == before
    if options.endswith("params"):
        # Among them are the outputs of the job whose sources have changed. Snakemake 9.27 also
        # lists files whose parameters are the same.
        assert {*listed.stdout.split()} >= {
            FIGURE.replace("png", end) for end in ("csv", "pdf", "png")
        }


@pytest.mark.slow
def test_touch_and_forcerun_do_what_snakemake_documents(small):
    edit(small / DRAWING)
    content = (small / FIGURE).read_bytes()
    made(small, "--touch", "--", *SMALL, **OVERLAY)
    assert (small / FIGURE).read_bytes() == content
    assert planned(snakemake(small, "--dry-run", "--", *SMALL, **OVERLAY)) == {}
    forced = snakemake(small, "--dry-run", "--forcerun", "study", "--", *SMALL, **OVERLAY)
    assert planned(forced) == {"study": 1, "figure": 1}


@pytest.mark.slow
def test_it_runs_in_another_working_directory_and_by_its_snakefile_from_elsewhere(small, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    snakefile = ("--snakefile", str(small / "Snakefile"))
    how = {"cwd": tmp_path, "overlay": small / "overlay.yaml"}
    made(elsewhere, *snakefile, "--directory", str(elsewhere), "--", FIGURE, **how)
    assert (elsewhere / FIGURE).read_bytes() == (small / FIGURE).read_bytes()
    # In the folder itself, the same command line finds nothing to do.
    here = snakemake(small, *snakefile, "-d", str(small), "--dry-run", "--", *SMALL, **how)
    assert planned(here) == {}


MODULES = {
    "plain": ("", "results/"),
    "prefix": ('prefix: "below"', "below/results/"),
    "replace_prefix": ('replace_prefix: {"results": "other"}', "other/"),
}


@pytest.mark.slow
@pytest.mark.parametrize("form", MODULES)
def test_it_is_a_module_of_another_workflow(small, tmp_path, form):
    modifier, place = MODULES[form]
    (tmp_path / "Snakefile").write_text(
        f"""
module paper:
    snakefile: "{small}/Snakefile"
    config: {{"preset": "draft", "figures": {{"fig07_damage_zone": {{"thickness_ratios": [0.3]}}}}}}
    {modifier}

use rule * from paper as paper_*

rule counted:
    default_target: True
    input: "{place}figures/fig07_damage_zone.csv"
    output: "counted.txt"
    shell: "wc -l < {{input}} > {{output}}"
""",
        encoding="utf-8",
    )
    result = made(tmp_path)
    assert (tmp_path / "counted.txt").read_text() == "1\n"
    assert (tmp_path / f"{place}figures/.records").is_dir()
    assert "Drawing fig07_damage_zone" in result.stderr
    # With a prefix, all results are below it.
    assert (tmp_path / "results").exists() is (form == "plain")


@pytest.mark.slow
def test_jobs_run_without_the_profile_in_processes_of_snakemake(small):
    (small / FIGURE).unlink()
    surroundings = {"MPLBACKEND": "wrong", "SOURCE_DATE_EPOCH": ""}
    how = {"command": WITHOUT_PROFILE, "environment": surroundings}
    result = made(small, "--", FIGURE, **how, **OVERLAY)
    assert "Drawing fig07_damage_zone" in result.stderr and (small / FIGURE).exists()
    assert planned(snakemake(small, "--dry-run", "--", *SMALL, **OVERLAY)) == {}


@pytest.mark.slow
def test_an_archive_has_each_file_once_and_no_compiled_module(small):
    author = "-c user.name=a -c user.email=b"
    for command in (
        "init -q",
        "add -A -- . :!results :!.snakemake :!*.pyc",
        f"{author} commit -qm a",
    ):
        subprocess.run(["git", *command.split()], cwd=small, check=True)
    made(small, "--archive", "archive.tar.gz", "--", FIGURE, **OVERLAY)
    with tarfile.open(small / "archive.tar.gz") as archive:
        names = archive.getnames()
    assert len(names) == len({*names}) > 100
    assert not [name for name in names if name.endswith(".pyc")]
    assert {"Snakefile", "workflow/rules/common.smk", DRAWING} <= {*names}


@pytest.mark.slow
def test_its_lint_and_format_are_clean(project):
    assert made(project, "--lint", cores=1).returncode == 0
    files = ["Snakefile", "workflow/rules"]
    command = [*BY_PROFILE[:2], "snakefmt.snakefmt", "--check", *files]
    formatted = subprocess.run(command, cwd=project, capture_output=True, check=False)
    assert formatted.returncode == 0, formatted.stderr


@pytest.mark.slow
def test_the_report_shows_captions_and_labels(small):
    made(small, "--report", "report.html", "--", FIGURE, **OVERLAY)
    text = (small / "report.html").read_text(encoding="utf-8")
    assert '"Figures of the paper"' in text and "damage zone" in text.lower()
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?://", text)


@pytest.mark.slow
def test_a_copy_runs_its_own_sources_whatever_is_installed(project, tmp_path):
    """The environment of another clone is active, and PYTHONPATH names that clone."""
    folder = copy_project(project, tmp_path / "copy")
    path = folder / "src/slippulse_paper/studies/damage_zone.py"
    mark = "\n__import__('pathlib').Path('imported').write_text(__file__)\n"
    path.write_text(path.read_text(encoding="utf-8") + mark, encoding="utf-8")
    foreign = {"PYTHONPATH": str(project / "src")}
    made(folder, "--", "results/studies/damage_zone.csv", environment=foreign)
    assert (folder / "imported").read_text() == str(path)
    os.unlink(folder / "imported")


@pytest.mark.slow
def test_waiting_jobs_are_considered_only_when_a_job_has_ended(small):
    """With its limit of the rate of jobs, Snakemake would consider them at least every second."""
    rule = 'rule {0}:\n    output: "{0}.txt"\n    shell: "sleep 4; touch {{output}}"\n'
    with (small / "Snakefile").open("a") as file:
        file.write(rule.format("first") + rule.format("second"))
    result = made(small, "--verbose", "--", "first.txt", "second.txt", **OVERLAY)
    assert (result.stdout + result.stderr).count("Ready jobs: ") <= 4
