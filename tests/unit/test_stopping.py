"""A long run shows its progress and stops on a signal; a lock is freed when its holder ends."""

import os
import resource
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

import slippulse as sp
from slippulse.simulation.progress_bar import make_bar
from slippulse_paper.records import lock

LONG = (
    "import sys, slippulse as sp\n"
    "level = sp.Prestress(0.5, 0.5)\n"
    "fast = {'gamma': 0.65, 'order': 8, 'max_step': 0.9}\n"
    "scene = sp.Scene('displacement', level, 3e4, 0.01, **fast)\n"
    "sp.simulate(sp.Scene('displacement', level, 1.0, 0.1, gamma=0.65))\n"
    "print('started', flush=True)\n"
)
RUNS = {
    "one": "sp.simulate(scene)\n",
    "sweep": "sp.run_sweep([scene] * 3, threads=2)\n",
    "exact": "profile = sp.Prestress(0.999999, 0.999999, steps=((-23.86, 0.3),))\n"
    "sp.run_sweep([sp.Scene('stress', profile, 40.0, 0.1, scheme='continuum')] * 3, threads=2)\n",
}


def cpu_seconds_of_ended_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def cpu_seconds_of_running(process):
    """Processor time of a running process, from the fields utime and stime of Linux."""
    after_name = Path(f"/proc/{process.pid}/stat").read_text().rpartition(") ")[2].split()
    return (int(after_name[11]) + int(after_name[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("kind", ["one", "exact", pytest.param("sweep", marks=pytest.mark.slow)])
def test_an_interrupt_stops_a_run_within_a_second(kind):
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    handle = partial(signal.signal, signal.SIGINT, signal.default_int_handler)
    command = [sys.executable, "-c", LONG + RUNS[kind]]
    before_process = cpu_seconds_of_ended_children()
    process = subprocess.Popen(command, **pipes, preexec_fn=handle)
    assert process.stdout.readline() == "started\n"
    time.sleep(0.7)
    before_signal = cpu_seconds_of_running(process)
    process.send_signal(signal.SIGINT)
    _, error_output = process.communicate(timeout=30)
    # Processor time, unlike the time of a clock, does not depend on other work of the machine.
    seconds = cpu_seconds_of_ended_children() - before_process - before_signal
    # The exact solution computes in Python, where threads take turns.
    busy_threads = 2 if kind == "sweep" else 1
    assert seconds < busy_threads * 1.0
    assert process.returncode != 0 and "KeyboardInterrupt" in error_output


def test_a_bar_shows_the_share_and_the_time_left_and_a_short_run_draws_none(capsys):
    draw = make_bar()
    time.sleep(0.25)
    draw(0.5)
    time.sleep(0.25)
    draw(1.0)
    shown = capsys.readouterr().err
    assert " 50%" in shown and " left" in shown and shown.count("\n") == 1
    scene = sp.Scene("displacement", sp.Prestress(0.5, 0.5), 1.0, 0.1, gamma=0.65)
    sp.simulate(scene, progress=True)
    assert capsys.readouterr().err == ""


def test_only_one_process_holds_a_lock_at_a_time(tmp_path):
    path = tmp_path / "new/run.lock"
    held = lock.take(path)
    assert held is not None and lock.take(path) is None and lock.main([str(path)]) == 1
    held.close()
    assert lock.main([str(path)]) == 0


@pytest.mark.parametrize("end", ["terminate", "kill"])
def test_a_waiting_process_gets_the_lock_when_its_holder_ends(tmp_path, end):
    path = str(tmp_path / "setup.lock")
    wait = [sys.executable, lock.__file__, path, sys.executable, "-c"]
    hold = (
        f"import time, {lock.__name__} as lock; held = lock.take({path!r});"
        " print('held', flush=True); time.sleep(60)"
    )
    first = subprocess.Popen([sys.executable, "-c", hold], stdout=subprocess.PIPE, text=True)
    assert first.stdout.readline() == "held\n"
    program = "print('mine'); raise SystemExit(7)"
    second = subprocess.Popen([*wait, program], stdout=subprocess.PIPE, text=True)
    assert "waiting for it" in second.stdout.readline()
    getattr(first, end)()
    first.wait()
    assert second.communicate(timeout=30)[0] == "mine\n" and second.returncode == 7


def test_an_interrupt_before_a_run_has_started_prints_no_traceback(tmp_path):
    """A module that waits takes the place of one that `make replicate` loads for an overlay."""
    waits = "import time\nprint('loads', flush=True)\ntime.sleep(60.0)\n"
    (tmp_path / "pydantic.py").write_text(waits, encoding="utf-8")
    script = Path(__file__).resolve().parents[2] / "workflow/run.py"
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "OVERLAY": "mine.yaml"}
    command = [sys.executable, str(script), "replicate"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, env=environment, cwd=tmp_path, text=True, **pipes) as run:
        assert run.stdout.readline() == "loads\n"
        run.send_signal(signal.SIGINT)
        _, errors = run.communicate(timeout=20.0)
    assert run.returncode == -signal.SIGINT and errors == ""
