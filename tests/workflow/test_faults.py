"""Faults of machines: a run works, or it fails with one clear line and keeps existing results."""

import multiprocessing
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from faults import SIGNALS, digests, fault_run, prepare, start
from pipeline_copy import BY_PROFILE, copy_project, made, planned, refused, snakemake

from slippulse.data.files import UnreadableFile
from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse_paper.steps.job import Job, JobFailed, logged
from slippulse_paper.steps.worker_pool import WorkerPool

SCENE = "results/measurements/one.csv"
FIGURE = "results/figures/fig07_damage_zone.png"


def test_a_run_is_stopped_by_each_signal_and_the_next_gives_the_same(tmp_path):
    output = fault_run(tmp_path / "und Umläuten", len(SIGNALS), 3, [FIGURE])
    assert all(f"1 by {signal}" in output for signal in SIGNALS)


@pytest.mark.slow
def test_surroundings_do_not_change_a_byte_and_it_can_be_started_from_anywhere(tmp_path):
    elsewhere, finished = prepare(tmp_path / "elsewhere"), prepare(tmp_path / "und Umläuten")
    assert start(finished, (SCENE, FIGURE)).wait() == 0
    strange = {"TZ": "Pacific/Kiritimati", "LC_ALL": "C", "LANG": "tr_TR.UTF-8", "DISPLAY": ""}
    strange |= {"PYTHONHASHSEED": "1", "MPLBACKEND": "wrong", "OMP_NUM_THREADS": "3"}
    strange["FONTCONFIG_FILE"] = str(tmp_path / "no fonts")
    how = {"overlay": "overlay.yaml", "environment": strange}
    made(elsewhere, "--", SCENE, FIGURE, **how)
    assert digests(elsewhere) == digests(finished)
    how = {"overlay": finished / "overlay.yaml", "command": BY_PROFILE, "cwd": tmp_path}
    folder = ("--directory", finished, "--snakefile", finished / "Snakefile")
    assert planned(snakemake(finished, *folder, "--dry-run", "--", SCENE, **how)) == {}


@pytest.mark.parametrize(("name", "load"), [("one.csv", load_table), ("one.nc", load_dataset)])
def test_a_result_that_cannot_be_read_is_named(tmp_path, name, load):
    (tmp_path / name).write_text('a,b\n1,2,3\n"4', encoding="utf-8")
    with pytest.raises(
        UnreadableFile, match=rf"{name}: cannot be read .* delete the file and run again"
    ):
        load(tmp_path / name)


def test_a_log_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "logs").write_text("a file")
    reason = r"allowed: a results folder that can be written\Z"
    with pytest.raises(JobFailed, match=reason), logged(tmp_path / "logs/one.log"):
        pass


def test_a_file_in_place_of_the_results_fails_in_one_line(project, tmp_path):
    folder = copy_project(project, tmp_path / "copy", link=True)
    (folder / "results").write_text("mine")
    output = refused(folder, "--", FIGURE)
    assert "results is a file; remove or rename it: a folder of that name is needed" in output
    assert (folder / "results").read_text() == "mine"


@pytest.mark.parametrize("kind", ["table", "dataset"])
def test_a_full_disk_leaves_the_old_file(kind, tmp_path):
    path, numbers = tmp_path / kind, pd.DataFrame({"a": np.arange(1e5)})
    path.write_text("what was there\n")
    # With a limit on the size of files, writing fails in the same place as on a full disk.
    least, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    reason = r"free some space and run again[^\n]+\Z"
    with pytest.raises(JobFailed, match=reason), logged(tmp_path / "log"), ExitStack() as after:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, most))
        after.callback(resource.setrlimit, resource.RLIMIT_FSIZE, (least, most))
        save_table(numbers, path) if kind == "table" else save_dataset(numbers.to_xarray(), path)
    assert path.read_text() == "what was there\n"
    assert {entry.name for entry in tmp_path.iterdir()} == {"log", "log.traceback", kind}


def job_of(step: str) -> Job:
    """Return a job that writes a page and has no inputs."""
    return Job(
        step=step,
        name="a job",
        inputs={},
        outputs={"html": "results/scenes.html"},
        settings={"scenes": {}},
        variables={},
        log="results/logs/one.log",
        code="",
        sources={},
    )


@pytest.fixture
def pool(tmp_path, monkeypatch) -> WorkerPool:
    monkeypatch.chdir(tmp_path)
    return WorkerPool()


def test_a_job_that_fails_says_why(pool, capfd):
    # The worker survives the first failure and runs the next job.
    for _ in range(2):
        with pytest.raises(JobFailed, match=r"\A[^\n]+No module named[^\n]+one.traceback\)\Z"):
            pool.run(job_of("no_such_step"), workers=1)
    assert capfd.readouterr().err == ""
    assert "Traceback" in Path("results/logs/one.traceback").read_text()
    assert Path("results/logs/one.log").read_text() == ""


def test_jobs_run_one_after_another_in_a_process_until_it_ends(pool):
    job = job_of("write_scenes_page")
    before = set(multiprocessing.active_children())
    for _ in range(3):
        pool.run(job, workers=1)
    (kept,) = set(multiprocessing.active_children()) - before
    kept.kill()
    kept.join()
    with pytest.raises(JobFailed, match="its process was killed"):
        pool.run(job, workers=1)
    pool.run(job, workers=1)
    assert Path("results/.records/scenes.html.json").exists()


@pytest.mark.skipif(os.getuid() != 0, reason="needs root, to become somebody without rights")
def test_sources_that_cannot_be_written_are_enough(project):
    with tempfile.TemporaryDirectory(prefix="read-only-") as base:
        folder = copy_project(project, Path(base) / "copy")
        for name in ("results", ".snakemake", "home"):
            (folder / name).mkdir()
            os.chown(folder / name, 65534, 65534)
        Path(base).chmod(0o755)
        if subprocess.run(["test", "-x", sys.executable], user=65534, check=False).returncode != 0:
            pytest.skip("the environment cannot be read by others")
        theirs = {"HOME": str(folder / "home"), "XDG_CACHE_HOME": "", "SLIPPULSE_CACHE": ""}
        how = {"environment": theirs, "user": 65534, "group": 65534, "command": BY_PROFILE}
        made(folder, "--", FIGURE, **how)
        assert (folder / FIGURE).stat().st_size > 0
        (folder / FIGURE).unlink()
        os.chown(folder / "results", 0, 0)
        shutil.rmtree(folder / "results/figures")
        result = snakemake(folder, "--", FIGURE, **how)
        assert result.returncode != 0 and "Permission denied" in result.stdout + result.stderr


@pytest.mark.slow
def test_of_two_first_runs_in_a_fresh_clone_one_sets_up_and_one_runs(project, tmp_path):
    folder, run = tmp_path / "clone", ["make", "replicate", "PRESET=draft", "TARGET=fig07"]
    subprocess.run(["git", "clone", "--quiet", project, folder], check=True)
    options = {"cwd": folder, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    runs = [subprocess.Popen(run, **options) for _ in range(2)]
    output = [process.communicate(timeout=500)[0] for process in runs]
    both = "".join(output)
    assert both.count("Setting up") == 1 and "Traceback" not in both
    # The second run is not refused if it begins after the first has ended.
    refused = [process.returncode for process in runs if process.returncode]
    assert len(refused) == both.count("Another run is using this folder") <= 1
    assert (folder / FIGURE).exists()
    assert subprocess.run(run, cwd=folder, check=False, timeout=100).returncode == 0
