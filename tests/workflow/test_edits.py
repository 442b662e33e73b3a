"""After each kind of edit, exactly the jobs that depend on it run again, for the right reason."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from faults import digests
from pipeline_copy import made, planned, refused, snakemake
from workflow.conftest import FIGURE, SMALL

from slippulse.data.files import CONFIGURATION_VARIABLE, write_text
from slippulse_paper.records.sources import sources_of
from slippulse_paper.steps.job import Job, JobFailed, run_job

DRAWING = "src/slippulse_paper/figures/fig07_damage_zone.py"
KERNEL = "src/slippulse/solver/taylor.py"
# Times and sizes of all results, which a command that only lists things does not change.
times = lambda folder: {
    path: (path.stat().st_mtime_ns, path.stat().st_size)
    for path in Path(folder, "results").rglob("*")
}


def jobs(folder: Path, *options: str, overlay="overlay.yaml"):
    """Return the jobs of a dry run by rule, and its reasons. The dry run must change nothing."""
    before = times(folder)
    result = snakemake(folder, "--dry-run", *options, "--", *SMALL, overlay=overlay)
    assert times(folder) == before
    text = result.stdout + result.stderr
    reasons = dict(re.findall(r"^Job \d+: (.+)\n(?:.*\n)?Reason: (.+)$", text, re.M))
    return planned(result), reasons


def edit(path: Path, year: int = 2020) -> None:
    """Add a comment to a source, and set the time of the file to some year."""
    path.write_text(path.read_text(encoding="utf-8") + "\n# A comment.\n", encoding="utf-8")
    os.utime(path, ((year - 1970) * 31556952,) * 2)


def test_touching_all_sources_runs_nothing(small):
    for folder in ("src", "workflow"):
        for path in [small / folder, *(small / folder).rglob("*")]:
            os.utime(path)
    assert jobs(small) == ({}, {})


def test_a_comment_in_a_figure_that_is_dated_2020_draws_that_figure_alone(small):
    edit(small / DRAWING)
    planned_jobs, reasons = jobs(small)
    assert planned_jobs == {"figure": 1}
    assert "Params have changed since last execution" in reasons["Drawing fig07_damage_zone"]


def test_an_edited_kernel_runs_what_is_computed_with_it(small):
    edit(small / KERNEL)
    planned_jobs, reasons = jobs(small)
    needed = {"compile_kernels": 1, "simulate": 3, "measure": 3, "study_grid": 1}
    assert planned_jobs == needed | {"draw_scene": 1, "join": 1}
    compiled = "results/kernels/localised.txt"
    assert "Params have changed" in reasons["Compiling the kernels: localised (once)"]
    assert reasons["Simulating one"] == f"Input files updated by another job: {compiled}"
    assert "updated by another job: results/data/one.nc" in reasons["Measuring one"]


def test_another_duration_simulates_again(small):
    (small / "other.yaml").write_text("scenes: {one: {duration: 7.0}}", encoding="utf-8")
    planned_jobs, reasons = jobs(small, overlay=("overlay.yaml", "other.yaml"))
    chain = ("simulate", "measure", "predict", "study_grid", "draw_scene")
    # The page shows the differences from the shipped configuration.
    assert planned_jobs == dict.fromkeys(chain, 1)
    assert "Params have changed" in reasons["Simulating one"]


@pytest.fixture
def job(tmp_path, monkeypatch) -> Job:
    """A job that joins tables in an empty folder, with one unchanged source."""
    monkeypatch.chdir(tmp_path)
    # The job sets this variable, and the value that it has now is restored after the test.
    monkeypatch.setenv(CONFIGURATION_VARIABLE, "")
    write_text("point\n1\n", "results/a.csv")
    sources = sources_of(("slippulse_paper.records.lock",))
    variables = {"joined": "b.csv", "threads": 1}
    return Job(
        step="join",
        name="join b.csv",
        inputs={"chunks": ["results/a.csv"], "finest": []},
        outputs={"joined": "results/b.csv"},
        settings={"kind": "measured", "record": []},
        variables=variables,
        log="results/logs/b.log",
        code=sources.digest,
        sources=sources.files,
    )


def test_a_source_edited_since_the_plan_fails_the_job_which_then_has_no_record(job):
    changed = {**job.sources, "src/slippulse_paper/records/lock.py": "0"}
    reason = r"\Asrc/slippulse_paper/records/lock.py: changed since this run was planned; run again"
    with pytest.raises(JobFailed, match=reason):
        run_job(job._replace(sources=changed))
    assert not Path("results/.records").exists()


def test_an_input_edited_during_the_job_fails_it(job, monkeypatch):
    from slippulse_paper.steps import join

    original = join.run

    def run(*arguments) -> None:
        original(*arguments)
        write_text("point\n2\n", "results/a.csv")

    monkeypatch.setattr(join, "run", run)
    reason = r"\Aresults/a.csv: changed while the job was running; run again\Z"
    with pytest.raises(JobFailed, match=reason):
        run_job(job)
    assert not Path("results/.records").exists()


def test_a_result_edited_by_hand_fails_the_job_that_reads_it(job):
    run_job(job)
    second = job._replace(
        inputs={"chunks": ["results/b.csv"], "finest": []}, outputs={"joined": "results/c.csv"}
    )
    run_job(second)
    write_text("point\n5\n", "results/b.csv")
    with pytest.raises(
        JobFailed, match=r"\Aresults/b.csv: changed since its job wrote it; delete the file"
    ):
        run_job(second)


def replicate(folder: Path, **options: str) -> str:
    """Run `make replicate` for the small targets, which must succeed, and return what it prints."""
    given = {"CORES": "2", "OVERLAY": "overlay.yaml", "TARGET": " ".join(SMALL), "PRESET": ""}
    command = [sys.executable, "workflow/run.py", "replicate"]
    how = {"cwd": folder, "env": os.environ | given | options, "text": True}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    result = subprocess.run(command, check=False, timeout=600, **how, **pipes)
    assert result.returncode == 0, result.stdout
    return result.stdout


def test_a_result_edited_by_hand_is_named_by_a_look_and_renewed_by_make(small):
    before = digests(small)
    (small / "results/data/one.nc").write_text("edited by hand", encoding="utf-8")
    # This result of another overlay is not made by any rule here.
    (small / "results/data/.records").joinpath("other.nc.json").write_text("[", encoding="utf-8")
    result = snakemake(small, "--dry-run", "--quiet", "--", *SMALL, overlay="overlay.yaml")
    line = "2 results are changed: results/data/other.nc, results/data/one.nc"
    assert sum(line in text for text in result.stderr.splitlines()) == 1
    assert "make replicate" in result.stderr
    output = replicate(small)
    reason = "results/data/one.nc: changed since its job wrote it"
    assert f"1 result is made again: {reason}" in output
    assert {*re.findall(r"^  (.+): [0-9.]+ s$", output, re.M)} == {
        "simulate one",
        "measure one",
        "study_grid one",
        "draw_scene one",
    }
    assert digests(small) == before


@pytest.mark.slow
def test_lost_records_of_snakemake_are_named_by_a_look_and_all_is_renewed_by_make(small):
    before = digests(small)
    shutil.rmtree(small / ".snakemake")
    result = snakemake(small, "--dry-run", "--quiet", "--", *SMALL, overlay="overlay.yaml")
    # The measured seconds are results, but not among the digests.
    seconds = [path for path in (small / "results/seconds").glob("*.*") if path.is_file()]
    assert f"{len(before) + len(seconds)} results are changed" in result.stderr
    output = replicate(small)
    # Only files that the targets need are made again. The next run names the other ones.
    assert re.search(r"^\d+ results are made again: results/", output, re.M)
    assert len(re.findall(r"^  (.+): [0-9.]+ s$", output, re.M)) == 13
    assert digests(small) == before


@pytest.mark.slow
def test_a_source_that_is_edited_while_a_run_is_at_work_fails_its_job(small):
    """The first job edits the module of the figure; the next run draws the figure again."""
    (small / FIGURE).unlink()
    (small / "results/studies/damage_zone.csv").unlink()
    path = small / "src/slippulse_paper/steps/job.py"
    text = path.read_text(encoding="utf-8")
    write = f"open({str(small / DRAWING)!r}, 'a').write('# A comment.')"
    loop = "for path in _paths(outputs):"
    path.write_text(text.replace(loop, f"{write}\n        {loop}"), encoding="utf-8")
    output = refused(small, "--", FIGURE, overlay="overlay.yaml")
    assert f"{DRAWING}: changed since this run was planned; run again" in output
    path.write_text(text, encoding="utf-8")
    result = made(small, "--", FIGURE, overlay="overlay.yaml")
    assert "Drawing fig07_damage_zone" in result.stderr
    assert (small / FIGURE).exists()
