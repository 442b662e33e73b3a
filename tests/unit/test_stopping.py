"""A long run shows its share done, and stops within a second when it is asked to."""

import io
import os
import signal
import subprocess
import sys
import time

import pytest

import slippulse as sp
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
    """Two are allowed here, since the machine may be busy."""
    process = subprocess.Popen(
        [sys.executable, "-c", LONG + RUNS[kind]], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert process.stdout.readline() == "started\n"
    time.sleep(0.7)
    asked = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    assert time.monotonic() - asked < 2.0
    assert process.returncode != 0 and "KeyboardInterrupt" in said


def test_progress_is_reported_on_the_way():
    shares = []
    scene = sp.Scene("displacement", sp.Prestress(0.5, 0.5), 400.0, 0.02, gamma=0.65, order=8, max_step=0.9)
    sp.simulate(scene, progress=shares.append)
    assert len(shares) > 2 and shares == sorted(shares) and shares[-1] <= 1.0


def test_a_bar_shows_the_share_and_the_time_left():
    out = io.StringIO()
    draw = bar(out)
    time.sleep(0.25)
    draw(0.5)
    time.sleep(0.25)
    draw(1.0)
    assert " 50%" in out.getvalue() and " left" in out.getvalue() and out.getvalue().count("\n") == 1


def test_a_short_run_draws_no_bar(capsys):
    sp.simulate(sp.Scene("displacement", sp.Prestress(0.5, 0.5), 1.0, 0.1, gamma=0.65), progress=True)
    assert capsys.readouterr().err == ""
