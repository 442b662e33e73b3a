"""What goes wrong on other people's machines: each works, or fails in one clear line and leaves what was there."""

import hashlib
import json
import math
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest
from faults import TARGETS, Report, at_work, digests, fault_run, prepare, start_by_make, stop_at
from pipeline_copy import copy_project, snakemake

from slippulse.data.files import UnreadableFile
from slippulse.data.records import Origin
from slippulse.data.tables import load_table
from slippulse.steps.job import JobFailed, Jobs

pytestmark = pytest.mark.workflow

SCENE = "results/measurements/one.csv"
DATA, RECORD = "results/data/one.nc", "results/records/data/one.nc.json"
FIGURE = "results/figures/fig07_damage_zone.png"


@pytest.fixture(scope="module")
def killed_once(tmp_path_factory) -> tuple[Path, Report]:
    """A folder with a space and an umlaut in its path, and a few results, of a run that was killed and taken up."""
    folder = tmp_path_factory.mktemp("with spaces") / "und Umläuten"
    report = fault_run(folder, kills=1, seed=3, say=lambda text: None, targets=(SCENE, FIGURE))
    return folder / "harmed", report


@pytest.fixture
def finished(killed_once) -> Path:
    return killed_once[0]


@pytest.fixture
def copy(finished, tmp_path) -> Path:
    """A copy, in which a test may do what it likes."""
    return Path(shutil.copytree(finished, tmp_path / "copy", symlinks=True))


def test_a_kill_is_survived(killed_once):
    report = killed_once[1]
    assert sum(report.kills.values()) == 1 and report.comparisons >= 1 and report.files >= 6


@pytest.mark.slow
def test_kills_are_survived(tmp_path):
    report = fault_run(tmp_path, kills=6, seed=3, say=lambda text: None)
    assert sum(report.kills.values()) == 6
    assert report.comparisons >= 1 and report.files >= 3 * len(TARGETS)


@pytest.mark.slow
def test_surroundings_do_not_change_a_byte(finished, tmp_path):
    elsewhere = prepare(tmp_path / "elsewhere")
    strange = {
        "TZ": "Pacific/Kiritimati", "LC_ALL": "C", "LANG": "tr_TR.UTF-8", "PYTHONHASHSEED": "1", "DISPLAY": "",
        "MPLBACKEND": "TkAgg", "FONTCONFIG_FILE": str(tmp_path / "no fonts"), "OMP_NUM_THREADS": "3",
    }  # fmt: skip
    result = snakemake(elsewhere, "--", SCENE, FIGURE, overlay="overlay.yaml", cores=1, environment=strange)
    assert result.returncode == 0, result.stderr
    assert digests(elsewhere) == digests(finished)


@pytest.mark.slow
def test_it_can_be_started_from_anywhere(finished, tmp_path):
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--dry-run", "--directory", str(finished)]
    command += ["--snakefile", str(finished / "Snakefile"), "--configfile", str(finished / "overlay.yaml")]
    result = subprocess.run(
        [*command, "--", SCENE], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    assert "Nothing to be done" in result.stdout + result.stderr


SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL)
# Seconds. SIGKILL leaves nobody who could end what was started: that ends itself when it has begun to work.
AT_ONCE = 2.0


@pytest.mark.parametrize("each", [1, pytest.param(20, marks=pytest.mark.slow)])
def test_a_signal_ends_a_run_at_once_and_the_next_gives_the_same(tmp_path, each):
    targets = (FIGURE,) if each == 1 else (FIGURE, SCENE)
    quiet, harmed = prepare(tmp_path / "quiet"), prepare(tmp_path / "harmed")
    began = time.monotonic()
    assert start_by_make(quiet, targets).wait(timeout=600) == 0
    duration, chance = time.monotonic() - began, random.Random(5)
    expected = digests(quiet)
    met = Counter()
    while min(met[number] for number in SIGNALS) < each:
        number = min(SIGNALS, key=met.__getitem__)
        seconds = stop_at(harmed, number, chance.uniform(0.02, 0.9) * duration, targets)
        assert number == signal.SIGKILL or not seconds > AT_ONCE, (number, seconds)
        met[number] += not math.isnan(seconds)
        # Otherwise it goes on from what is there, and is done before the next signal at last.
        if math.isnan(seconds) or chance.random() < 0.3:
            shutil.rmtree(harmed / "results", ignore_errors=True)
    assert start_by_make(harmed, targets).wait(timeout=600) == 0
    assert digests(harmed) == expected


@pytest.mark.slow
def test_a_run_ends_with_the_server_of_its_jobs(tmp_path):
    folder = prepare(tmp_path / "run")
    run, servers = start_by_make(folder, (SCENE,)), []
    # It and a job.
    while len(servers) < 2:
        assert run.poll() is None
        commands = {number: Path(f"/proc/{number}/cmdline").read_bytes() for number in at_work(folder)}
        servers = [number for number, command in commands.items() if b"forkserver" in command]
        time.sleep(0.02)
    os.kill(min(servers), signal.SIGKILL)
    assert run.wait(timeout=60) != 0
    said = (folder / "said.txt").read_text(encoding="utf-8")
    assert "Traceback" not in said, said
    time.sleep(0.5)
    assert not at_work(folder)
    assert start_by_make(folder, (SCENE,)).wait(timeout=600) == 0


@pytest.mark.slow
def test_only_a_run_removes_what_was_changed(copy):
    (copy / RECORD).unlink()
    for option in ("--dry-run", "--summary", "--rulegraph"):
        result = snakemake(copy, option, "--", SCENE, overlay="overlay.yaml")
        assert f"as {DATA}: no record; would be removed, and made anew" in result.stderr, option
        assert (copy / DATA).exists(), option


@pytest.mark.slow
def test_a_failing_job_says_so_in_one_line(copy):
    """As `make replicate` runs it, whose logger prints the logs of jobs that fail."""
    (copy / SCENE).unlink()
    (copy / DATA).write_bytes(b"no data")
    outputs = {"data/one.nc": hashlib.sha256(b"no data").hexdigest()}
    (copy / RECORD).write_text(json.dumps(json.loads((copy / RECORD).read_text()) | {"outputs": outputs}))
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--configfile", "overlay.yaml", "--", SCENE]
    environment = os.environ | {"PYTHONPATH": str((copy / "src").resolve())}
    result = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True, check=False)
    said = result.stdout + result.stderr
    assert result.returncode != 0 and "one.nc: cannot be read" in said
    assert "delete it and run again" in said and "(details: results/logs/measure/one.traceback)" in said
    assert "Traceback" not in said and not (copy / SCENE).exists()
    assert "Traceback" in (copy / "results/logs/measure/one.traceback").read_text()


def test_an_unreadable_table_is_named(tmp_path):
    path = tmp_path / "edited.csv"
    path.write_text('a,b\n1,2,3\n"4', encoding="utf-8")
    with pytest.raises(UnreadableFile, match=r"edited\.csv: cannot be read .* delete it and run again"):
        load_table(path)


# A file where a folder goes, or a folder where a file goes.
PLACES = {
    "results": "file", "results/data": "file", "results/logs": "file",
    ".snakemake": "file", "results/kernels.txt": "folder", "results/measurements/arrest.csv": "folder",
    "results/records/data/arrest.nc.json": "folder",
}  # fmt: skip
QUICK = ("results",)


@pytest.mark.parametrize(
    "place", [pytest.param(place, marks=() if place in QUICK else pytest.mark.slow) for place in PLACES]
)
def test_a_place_that_is_taken_fails_in_one_line(tmp_path, place):
    folder = copy_project(Path(__file__).resolve().parents[2], tmp_path / "copy", link=True)
    path, kind = folder / place, PLACES[place]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.mkdir() if kind == "folder" else path.write_text("mine")
    result = snakemake(folder, "--", FIGURE)
    said = result.stdout + result.stderr
    assert result.returncode != 0 and "Traceback" not in said
    assert f"{place} is a {kind}; remove or rename it" in said and path.exists()


@pytest.mark.parametrize(("kind", "home"), [("table", "tables"), ("dataset", "store")])
def test_a_full_disk_leaves_the_old_file(kind, home, tmp_path):
    """A limit on the size of files stands for a disk without room: writing fails in the same place."""
    path = tmp_path / kind
    path.write_text("what was there\n")
    program = (
        "import sys, numpy, pandas\n"
        f"from slippulse.steps.job import logged\nfrom slippulse.data.{home} import save_{kind} as save\n"
        "numbers = pandas.DataFrame({'a': numpy.arange(1e5)})\n"
        "with logged(sys.argv[2]):\n"
        f"    save(numbers{'.to_xarray()' if kind == 'dataset' else ''}, sys.argv[1])\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", program, str(path), str(tmp_path / "log")], capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
    )  # fmt: skip
    assert result.returncode == 1
    assert "make room and run again" in result.stderr and result.stderr.count("\n") == 1
    assert path.read_text() == "what was there\n"
    assert sorted(entry.name for entry in tmp_path.iterdir()) == sorted(["log", "log.traceback", kind])


def test_a_log_that_cannot_be_written_fails_in_one_line(tmp_path):
    (tmp_path / "logs").write_text("a file")
    program = "import sys\nfrom slippulse.steps.job import logged\nwith logged(sys.argv[1]): pass\n"
    command = [sys.executable, "-c", program, str(tmp_path / "logs/one.log")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert result.stderr.count("\n") == 1 and "allowed: a results folder that can be written" in result.stderr


def test_a_job_that_fails_has_said_why(tmp_path, capfd):
    with pytest.raises(JobFailed, match="exit code 1"):
        origin = Origin(("one",), "no_such_step", "", "", frozenset())
        Jobs().run(origin, "a job", {}, {}, {}, tmp_path / "logs/one.log")
    said = capfd.readouterr().err
    assert said.count("\n") == 1 and "No module named" in said and "one.traceback" in said
    assert "Traceback" in (tmp_path / "logs/one.traceback").read_text()
    # The logger prints the log.
    assert (tmp_path / "logs/one.log").read_text() == ""


@pytest.mark.skipif(os.getuid() != 0, reason="needs root, to become somebody without rights")
def test_sources_that_cannot_be_written_are_enough():
    project = Path(__file__).resolve().parents[2]
    base = Path(tempfile.mkdtemp(prefix="read-only-"))
    try:
        folder = copy_project(project, base / "copy")
        for name in ("results", ".snakemake", "home"):
            (folder / name).mkdir()
            os.chown(folder / name, 65534, 65534)
        theirs = os.environ | {"HOME": str(folder / "home"), "PYTHONPATH": str(folder / "src")}
        theirs |= {"XDG_CACHE_HOME": "", "SLIPPULSE_CACHE": ""}
        base.chmod(0o755)
        if subprocess.run(["test", "-x", sys.executable], user=65534, check=False).returncode != 0:
            pytest.skip("the environment cannot be read by others")

        def run() -> subprocess.CompletedProcess:
            return subprocess.run(
                [sys.executable, "-m", "snakemake", "--cores", "1", "--", FIGURE],
                cwd=folder, user=65534, group=65534, capture_output=True, text=True, check=False, env=theirs,
            )  # fmt: skip

        result = run()
        assert result.returncode == 0, result.stderr
        assert (folder / FIGURE).stat().st_size > 0
        (folder / FIGURE).unlink()
        os.chown(folder / "results", 0, 0)
        shutil.rmtree(folder / "results/figures")
        result = run()
        assert result.returncode != 0 and "Permission denied" in result.stdout + result.stderr
    finally:
        shutil.rmtree(base)
