"""A long run shows what is done and stops when it is asked to; a lock is freed when its holder ends."""

import io
import os
import signal
import subprocess
import sys
import time

import pytest

import slippulse as sp
from slippulse.data import lock
from slippulse.simulation.simulate import bar

LONG = (
    "import sys, slippulse as sp\n"
    "scene = sp.Scene('displacement', sp.Prestress(0.5, 0.5), 1e6, 0.01, gamma=0.65, order=8, max_step=0.9)\n"
    "sp.simulate(sp.Scene('displacement', sp.Prestress(0.5, 0.5), 1.0, 0.1, gamma=0.65))\n"
    "sys.stdout.write('started\\n'); sys.stdout.flush()\n"
)
RUNS = {
    "one": "sp.simulate(scene)\n",
    "sweep": "sp.run_sweep([scene] * 3, threads=2)\n",
    "exact": "profile = sp.Prestress(0.999999, 0.999999, steps=((-23.86, 0.3),))\n"
    "sp.run_sweep([sp.Scene('stress', profile, 40.0, 0.1, scheme='continuum')] * 3, threads=2)\n",
}


@pytest.mark.parametrize("kind", ["one", "exact", pytest.param("sweep", marks=pytest.mark.slow)])
def test_an_interrupt_stops_a_run_within_a_second(kind):
    process = subprocess.Popen(
        [sys.executable, "-c", LONG + RUNS[kind]], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert process.stdout.readline() == "started\n"
    time.sleep(0.7)
    asked = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    # A second is promised, and the machine may be busy.
    assert time.monotonic() - asked < 2.0
    assert process.returncode != 0 and "KeyboardInterrupt" in said


def test_a_bar_shows_the_share_and_the_time_left_and_a_short_run_draws_none(capsys):
    out = io.StringIO()
    draw = bar(out)
    time.sleep(0.25)
    draw(0.5)
    time.sleep(0.25)
    draw(1.0)
    assert (
        " 50%" in out.getvalue() and " left" in out.getvalue() and out.getvalue().count("\n") == 1
    )
    sp.simulate(
        sp.Scene("displacement", sp.Prestress(0.5, 0.5), 1.0, 0.1, gamma=0.65), progress=True
    )
    assert capsys.readouterr().err == ""


def test_one_holds_it_at_a_time(tmp_path):
    path = tmp_path / "new/run.lock"
    held = lock.take(path)
    assert held is not None and lock.take(path) is None and lock.main([str(path)]) == 1
    held.close()
    assert lock.main([str(path)]) == 0


@pytest.mark.parametrize("end", ["terminate", "kill"])
def test_who_waits_gets_it_when_the_holder_ends(tmp_path, end):
    path = str(tmp_path / "setup.lock")
    wait = [sys.executable, lock.__file__, path, sys.executable, "-c"]
    first = subprocess.Popen(
        [sys.executable, "-c", f"import time, {lock.__name__} as lock; held = lock.take({path!r});"
         " print('held', flush=True); time.sleep(60)"],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert first.stdout.readline() == "held\n"
    program = "print('mine'); raise SystemExit(7)"
    second = subprocess.Popen([*wait, program], stdout=subprocess.PIPE, text=True)
    assert "waiting for it" in second.stdout.readline()
    getattr(first, end)()
    first.wait()
    assert second.communicate(timeout=30)[0] == "mine\n" and second.returncode == 7
