"""The compiled kernels against the same sources run by the interpreter."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
import tolerances as tol

pytestmark = pytest.mark.slow

SCRIPT = """
import sys
import numpy as np
import numba
import slippulse as sp

def run(**changes):
    values = {"boundary": "displacement", "gamma": 0.65, "beta": 0.05, "dx": 0.25, "duration": 4.0,
              "prestress": sp.Prestress(0.4, 0.6), "max_step": 0.3}
    values.update(changes)
    scene = sp.Scene(**values)
    data = sp.simulate(scene, sp.Samples(np.linspace(0.0, 4.0, 9), np.linspace(-1.0, 1.0, 5)))
    numbers = [data.attrs[name] for name in (
        "steps", "block_updates", "releases", "sticks", "re_releases", "energy_residual", "viscous_loss",
        "work_of_prestress", "min_stuck_stress", "first_stick_time")]
    fields = [data[name].values.ravel() for name in sorted(data.variables)]
    return np.concatenate([np.array(numbers, dtype=float), *fields])

np.savez(
    sys.argv[1],
    jit=not numba.config.DISABLE_JIT,
    damped=run(),
    elastic=run(release="elastic"),
    mirrored=run(prestress=sp.Prestress(0.5, 0.5), order=6),
    undamped=run(beta=0.0),
    one_way=run(boundary="stress", gamma=0.0, prestress=sp.Prestress(-0.5, 0.0)),
    one_way_undamped=run(boundary="stress", gamma=0.0, beta=0.0, prestress=sp.Prestress(-0.5, 0.0)),
    fixed=run(scheme="fixed_step", max_step=0.2),
)
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("jit")
    out = {}
    for name, disabled in (("compiled", "0"), ("interpreted", "1")):
        path = folder / f"{name}.npz"
        subprocess.run(
            [sys.executable, "-c", SCRIPT, str(path)],
            env=os.environ | {"NUMBA_DISABLE_JIT": disabled},
            check=True,
        )
        out[name] = np.load(path)
    return out


def test_one_was_compiled_and_the_other_was_not(results):
    assert bool(results["compiled"]["jit"]) and not bool(results["interpreted"]["jit"])


@pytest.mark.parametrize(
    "case", ["damped", "elastic", "mirrored", "undamped", "one_way", "one_way_undamped", "fixed"]
)
def test_compiled_and_interpreted_agree(results, case):
    compiled, interpreted = results["compiled"][case], results["interpreted"][case]
    assert compiled == pytest.approx(interpreted, rel=tol.JIT, abs=tol.JIT, nan_ok=True)
