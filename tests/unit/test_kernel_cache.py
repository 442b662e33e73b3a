"""Compiled kernels are never older than the sources that they were compiled from."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import numba
import numpy as np
import pytest

from slippulse.model.scene import SCHEMES
from slippulse.solver import jit, polynomials


@pytest.fixture
def copied(tmp_path):
    folder = tmp_path / "lattice"
    shutil.copytree(jit.SOURCES, folder, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def test_a_copy_has_the_same_digest(copied):
    assert jit.source_digest(copied) == jit.source_digest()


@pytest.mark.parametrize("name", sorted(path.name for path in jit.SOURCES.glob("*.py")))
def test_an_edit_of_any_source_changes_the_digest(copied, name):
    path = copied / name
    path.write_bytes(path.read_bytes() + b"\n")
    assert jit.source_digest(copied) != jit.source_digest()


def test_a_new_source_and_a_new_name_change_the_digest(copied):
    digests = {jit.source_digest(copied)}
    (copied / "more.py").write_text("")
    digests.add(jit.source_digest(copied))
    (copied / "more.py").rename(copied / "other.py")
    digests.add(jit.source_digest(copied))
    assert len(digests) == 3


def test_the_cache_folder_is_named_by_the_digest(monkeypatch, tmp_path):
    monkeypatch.setenv("SLIPPULSE_CACHE", str(tmp_path / "mine"))
    assert jit.cache_folder() == tmp_path / "mine" / f"kernels-{jit.source_digest()}"
    monkeypatch.delenv("SLIPPULSE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    assert jit.cache_folder().parent == tmp_path / "user/slippulse"


def test_an_edited_helper_is_not_met_by_the_machine_code_of_its_callers_old_self(tmp_path):
    """numba's own cache would: the file that holds the caller is unchanged."""
    package = tmp_path / "edited"
    package.mkdir()
    shutil.copy2(jit.__file__, package / "jit.py")
    (package / "__init__.py").write_text("")
    (package / "helper.py").write_text(
        "from .jit import inner\n\n\n@inner()\ndef helper(x):\n    return x + 1\n"
    )
    (package / "caller.py").write_text(
        "from .helper import helper\nfrom .jit import entry\n\n\n"
        "@entry\ndef caller(x):\n    return 10 * helper(x)\n"
    )

    def call() -> str:
        done = subprocess.run(
            [sys.executable, "-c", "from edited.caller import caller; print(caller(1))"],
            cwd=tmp_path,
            env={
                "PATH": "",
                "SLIPPULSE_CACHE": str(tmp_path / "cache"),
                "PYTHONPATH": str(tmp_path),
                # Python's own cache tells files apart by the second of their last change.
                "PYTHONDONTWRITEBYTECODE": "1",
            },
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.strip()

    assert call() == "20"
    assert list((tmp_path / "cache").rglob("*.nbi")), "nothing was cached"
    (package / "helper.py").write_text(
        "from .jit import inner\n\n\n@inner()\ndef helper(x):\n    return x + 2\n"
    )
    assert call() == "30"
    assert len(list((tmp_path / "cache").iterdir())) == 2


def test_a_function_of_kernels_is_one_of_python_too():
    """With the same result, and without anything compiled for it."""
    coefficients = np.array([0.3, -0.2, 0.7])
    assert polynomials.polynomial(coefficients, 2, 0.5) == 0.3 + 0.5 * (-0.2 + 0.5 * 0.7)
    assert not hasattr(polynomials.polynomial, "py_func")


def run_with(folder, program: str, **more: str) -> None:
    """Run a program with its kernels in a folder of its own."""
    environment = os.environ | {"SLIPPULSE_CACHE": str(folder)} | more
    subprocess.run([sys.executable, "-c", program], env=environment, check=True)


COMPILE_ALL = "from slippulse.solver.compilation import compile_all; compile_all()"


@pytest.mark.slow
def test_a_simulation_finds_every_kernel_compiled(untouched_kernels):
    """Another type of an argument would be compiled for once more."""
    compiled = {path.name for path in untouched_kernels.rglob("*.nbc")}
    assert len(compiled) == 2
    for scheme in SCHEMES:
        scene = (
            f"sp.Scene('stress', sp.Prestress(-0.3, 0.2), 5.0, 0.1, beta=0.01, scheme={scheme!r}, order=8)"
        )
        sample = "sp.Samples([0.0, 1.0], [0.0, 0.5])"
        run_with(untouched_kernels, f"import slippulse as sp; sp.simulate({scene}, {sample})")
    assert {path.name for path in untouched_kernels.rglob("*.nbc")} == compiled


@pytest.mark.slow
def test_kernels_that_are_compiled_are_not_compiled_again(untouched_kernels, tmp_path):
    """What went missing in the meantime is, and nothing else."""
    folder = tmp_path / "kernels"
    shutil.copytree(untouched_kernels, folder)

    def times() -> dict[str, int]:
        return {path.name: path.stat().st_mtime_ns for path in folder.rglob("*.nbc")}

    before = times()
    run_with(folder, COMPILE_ALL)
    assert times() == before
    textbook = next(path for path in folder.rglob("*advance_fixed*.nbc"))
    textbook.unlink()
    run_with(folder, COMPILE_ALL)
    after = times()
    assert set(after) == set(before)
    assert {name for name in before if before[name] != after[name]} == {textbook.name}


def test_nothing_is_compiled_where_the_compiler_is_switched_off(tmp_path):
    """Whoever looks for a fault with a debugger runs the pipeline so."""
    run_with(tmp_path, COMPILE_ALL, NUMBA_DISABLE_JIT="1")
    assert not list(tmp_path.rglob("*.nbc"))


def test_numba_takes_the_private_option():
    """`_nrt=False`: no counting of references in the machine code, and an error where an array is made.

    Should numba drop or rename the option, remove it from `jit.FLAGS` and measure narrow pulses.
    """
    assert {name for name in jit.FLAGS if name.startswith("_")} == {"_nrt"}

    def first(values):
        return values

    def made(count):
        return np.zeros(count)

    counted, uncounted = (numba.njit(**flags)(first) for flags in ({}, {"_nrt": False}))
    for kernel in (counted, uncounted):
        kernel.compile((numba.float64[::1],))
    assert "NRT_incref" in next(iter(counted.inspect_llvm().values()))
    assert "NRT_incref" not in next(iter(uncounted.inspect_llvm().values()))
    with pytest.raises(numba.core.errors.NumbaError):
        numba.njit(_nrt=False)(made)(3)
