"""The public names, which editors see in stubs, are loaded from there when they are used."""

import pytest

import slippulse
from slippulse import theory


@pytest.mark.parametrize("package", [slippulse, theory])
def test_each_public_name_can_be_loaded(package):
    assert {"theory"} < {*slippulse.__all__} and {"Rupture"} < {*theory.__all__}
    for name in package.__all__:
        assert getattr(package, name).__name__.rpartition(".")[2] == name
