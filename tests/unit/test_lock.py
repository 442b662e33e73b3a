"""A lock that the system frees when its holder ends, however that happens."""

import subprocess
import sys

import pytest

from slippulse.data import lock


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
    second = subprocess.Popen(
        [*wait, "print('mine'); raise SystemExit(7)"], stdout=subprocess.PIPE, text=True
    )
    assert "waiting for it" in second.stdout.readline()
    getattr(first, end)()
    first.wait()
    assert second.communicate(timeout=30)[0] == "mine\n" and second.returncode == 7
