"""The compiled kernels against the same sources run by the interpreter."""

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
    samples = sp.Samples(np.linspace(0.0, 4.0, 9), np.linspace(-1.0, 1.0, 5))
    data = sp.simulate(sp.Scene(**values | changes), samples)
    numbers = [data.attrs[name] for name in (
        "steps", "block_updates", "releases", "sticks", "re_releases", "energy_residual", "viscous_loss",
        "work_of_prestress", "min_stuck_stress", "first_stick_time")]
    fields = [data[name].values.ravel() for name in sorted(data.variables)]
    return np.concatenate([np.array(numbers, dtype=float), *fields])

one_way = {"boundary": "stress", "gamma": 0.0, "prestress": sp.Prestress(-0.5, 0.0)}
np.savez(
    sys.argv[1],
    jit=not numba.config.DISABLE_JIT,
    damped=run(),
    elastic=run(release="elastic"),
    mirrored=run(prestress=sp.Prestress(0.5, 0.5), order=6),
    undamped=run(beta=0.0),
    one_way=run(**one_way),
    one_way_undamped=run(**one_way, beta=0.0),
    fixed=run(scheme="fixed_step", max_step=0.2),
)
"""


def test_compiled_and_interpreted_agree(tmp_path):
    results = []
    for disabled in ("0", "1"):
        path = tmp_path / f"{disabled}.npz"
        environment = os.environ | {"NUMBA_DISABLE_JIT": disabled}
        subprocess.run([sys.executable, "-c", SCRIPT, str(path)], env=environment, check=True)
        results.append(np.load(path))
    compiled, interpreted = results
    assert bool(compiled["jit"]) and not bool(interpreted["jit"])
    for case in set(compiled) - {"jit"}:
        expected = pytest.approx(interpreted[case], rel=tol.JIT, abs=tol.JIT, nan_ok=True)
        assert compiled[case] == expected, case
