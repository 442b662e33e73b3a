"""The compiled kernels give the results of the same sources run by the interpreter."""

import os
import subprocess
import sys

import numba
import numpy as np
import pytest
import tolerances as tol

import slippulse as sp

pytestmark = pytest.mark.slow
ONE_WAY = {"boundary": "stress", "gamma": 0.0, "prestress": sp.Prestress(-0.5, 0.0)}
CASES = {
    "damped": {},
    "elastic": {"release": "elastic"},
    "mirrored": {"prestress": sp.Prestress(0.5, 0.5), "order": 6},
    "undamped": {"beta": 0.0},
    "one way": ONE_WAY,
    "one way, undamped": ONE_WAY | {"beta": 0.0},
    "fixed step": {"scheme": "fixed_step", "max_step": 0.2},
}
SAVE = "import runpy, sys; runpy.run_path(sys.argv[1])['save'](sys.argv[2])"


def run(**changes) -> np.ndarray:
    values = {"boundary": "displacement", "gamma": 0.65, "beta": 0.05, "dx": 0.25, "duration": 4.0}
    values |= {"prestress": sp.Prestress(0.4, 0.6), "max_step": 0.3}
    samples = sp.Samples(np.linspace(0, 4, 9), np.linspace(-1, 1, 5))
    data = sp.simulate(sp.Scene(**values | changes), samples)
    numbers = [value for value in data.attrs.values() if isinstance(value, int | float)]
    return np.concatenate([numbers, *map(np.ravel, data.variables.values())])


def save(path: str) -> None:
    results = {name: run(**case) for name, case in CASES.items()}
    np.savez(path, jit=not numba.config.DISABLE_JIT, **results)


def test_compiled_and_interpreted_agree(tmp_path):
    path = str(tmp_path / "interpreted.npz")
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, "-c", SAVE, __file__, path], env=environment, check=True)
    interpreted = np.load(path)
    assert not interpreted["jit"] and not numba.config.DISABLE_JIT
    for name, case in CASES.items():
        expected = pytest.approx(interpreted[name], rel=tol.JIT, abs=tol.JIT, nan_ok=True)
        assert run(**case) == expected, name
