"""Compiled kernels are never older than the sources that they were compiled from."""

import os
import shutil
import subprocess
import sys

import numba
import pytest

from slippulse.model.scene import SCHEMES
from slippulse.solver import compile_notice, jit

COMPILE_ALL = "from slippulse.solver.compilation import compile_all; compile_all()"


def run_with(folder, program: str, **variables: str) -> str:
    environment = os.environ | {"SLIPPULSE_CACHE": str(folder)} | variables
    command = [sys.executable, "-c", program]
    return subprocess.check_output(command, env=environment, text=True).strip()


def test_any_edit_changes_the_digest_and_with_it_the_cache_folder(tmp_path, monkeypatch):
    copied = tmp_path / "solver"
    shutil.copytree(jit.SOLVER_FOLDER, copied, ignore=shutil.ignore_patterns("__pycache__"))
    digests = [jit.source_digest()]
    assert jit.source_digest(copied) == digests[0]
    for path in sorted(copied.glob("*.py")):
        path.write_bytes(path.read_bytes() + b"\n")
        digests.append(jit.source_digest(copied))
    (copied / "more.py").write_text("")
    digests.append(jit.source_digest(copied))
    (copied / "more.py").rename(copied / "other.py")
    digests.append(jit.source_digest(copied))
    assert len(set(digests)) == len(digests) > 5
    monkeypatch.setenv("SLIPPULSE_CACHE", str(tmp_path / "mine"))
    assert jit.cache_folder() == tmp_path / "mine" / f"kernels-{jit.source_digest()}"
    monkeypatch.delenv("SLIPPULSE_CACHE")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cluster"))
    assert jit.cache_folder() == tmp_path / "cluster" / f"kernels-{jit.source_digest()}"
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    assert jit.cache_folder().parent == tmp_path / "user/slippulse"


@pytest.mark.parametrize("variable", ["SLIPPULSE_CACHE", "NUMBA_CACHE_DIR"])
def test_an_edited_helper_function_makes_its_caller_be_compiled_again(tmp_path, variable):
    """Numba's own cache would return old machine code, as the file of the caller is unchanged."""
    package, cache = tmp_path / "edited", tmp_path / "cache"
    package.mkdir()
    shutil.copy2(jit.__file__, package / "jit.py")
    (package / "__init__.py").write_text("")
    imports = "from .helper import helper\nfrom .jit import kernel_entry\n"
    (package / "caller.py").write_text(
        imports + "@kernel_entry\ndef caller(x): return 10 * helper(x)\n"
    )
    program = "from edited.caller import caller; print(caller(1))"
    for added, result in ((1, "20"), (2, "30")):
        decorator = "from .jit import kernel_function\n@kernel_function()\n"
        helper = f"{decorator}def helper(x): return x + {added}\n"
        (package / "helper.py").write_text(helper)
        # Python's own cache would miss a second edit within the same second.
        environment = {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
        environment |= {"SLIPPULSE_CACHE": "", variable: str(cache)}
        assert run_with(cache, program, **environment) == result
        assert len(list(cache.iterdir())) == added
        assert list(cache.rglob("*.nbi")), "nothing was cached"


def test_a_cache_that_cannot_be_written_is_a_warning(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("SLIPPULSE_CACHE", str(tmp_path / "file"))
    monkeypatch.setattr(jit, "SOLVER_FOLDER", tmp_path / "solver")
    with pytest.warns(UserWarning, match="compiled kernels cannot .*SLIPPULSE_CACHE") as warned:
        folder = jit.writable_cache()
    # The name of the folder next to the sources contains the digest, too.
    assert folder == str(tmp_path / "solver/__pycache__" / jit.cache_folder().name)
    assert folder in str(warned[0].message)
    monkeypatch.setattr(jit, "SOLVER_FOLDER", tmp_path / "file")
    with pytest.warns(UserWarning, match="each process compiles them again"):
        assert jit.writable_cache() == ""


@pytest.mark.slow
def test_a_simulation_finds_every_kernel_compiled_and_compiles_none_again(tmp_path):
    times = lambda: {path.name: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")}
    run_with(tmp_path, COMPILE_ALL)
    kernels = times()
    assert {name.partition(".")[0] for name in kernels} == {"taylor", "fixed_step", "layer"}
    run_with(tmp_path, COMPILE_ALL)
    for scheme in SCHEMES:
        profile = "'stress', sp.Prestress(-0.3, 0.2), 5.0, 0.1"
        scene = f"sp.Scene({profile}, beta=0.01, scheme={scheme!r}, order=8)"
        samples = "sp.Samples([0.0, 1.0], [0.0, 0.5])"
        run_with(tmp_path, f"import slippulse as sp; sp.simulate({scene}, {samples})")
    assert times() == kernels
    # A missing kernel is compiled, and no other one.
    textbook = next(tmp_path.rglob("*advance_fixed*.nbc"))
    textbook.unlink()
    run_with(tmp_path, COMPILE_ALL)
    assert {name for name, time in times().items() if time != kernels[name]} == {textbook.name}


def test_the_first_compilation_of_a_kernel_is_announced_once(capsys, monkeypatch):
    monkeypatch.setattr(compile_notice.COMPILE_LISTENER, "printed", False)

    def compiled(module: str):
        kernel = lambda x: x + 1
        kernel.__module__ = module
        return numba.njit(kernel)

    with compile_notice.announced_compilation():
        compiled("somebody.else")(1)
        assert capsys.readouterr().err == ""
        kernel = compiled("slippulse.solver.taylor")
        kernel(1)
        assert capsys.readouterr().err == f"{compile_notice.NOTICE_TEXT}\n"
        # Existing machine code is not announced, and no announcement is repeated.
        kernel(2)
        compiled("slippulse.solver.events")(1)
    compiled("slippulse.solver.layer")(1)
    assert capsys.readouterr().err == ""
