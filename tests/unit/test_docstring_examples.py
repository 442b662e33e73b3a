"""The examples of the docstrings of all public names show what they say."""

import doctest

import pytest
import xarray

import slippulse as sp

NAMES = [(sp, name) for name in sp.__all__ if name != "theory"]
NAMES += [(sp.theory, name) for name in sp.theory.__all__]


@pytest.mark.parametrize(("package", "name"), NAMES, ids=[name for _, name in NAMES])
def test_an_example_shows_what_it_says(package, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = {"sp": sp, "xarray": xarray}
    known |= {one: getattr(owner, one) for owner in (sp.theory, sp) for one in owner.__all__}
    if name == "point":
        (tmp_path / "results/data").mkdir(parents=True)
        scene = sp.Scene("stress", sp.Prestress(-0.5, 0.0), 1.0, 0.1)
        sp.run_sweep([scene]).to_netcdf("results/data/arrest.nc")
    failures = []
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for test in doctest.DocTestFinder(recurse=False).find(
        getattr(package, name), name, globs=known
    ):
        runner.run(test, out=failures.append)
    assert not failures, "".join(failures)
