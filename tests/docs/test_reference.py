"""The reference of the Python interface has every public name, with what it is for."""

from __future__ import annotations

import runpy

import pytest

import slippulse
from slippulse import theory


@pytest.fixture(scope="module")
def pages(project, tmp_path_factory) -> dict[str, str]:
    """The pages of the reference, by package."""
    folder = tmp_path_factory.mktemp("reference")
    runpy.run_path(str(project / "docs/reference.py"))["main"](str(folder))
    return {
        "slippulse": (folder / "slippulse.html").read_text(encoding="utf-8"),
        "slippulse.theory": (folder / "slippulse/theory.html").read_text(encoding="utf-8"),
    }


@pytest.mark.parametrize("package", [slippulse, theory], ids=lambda package: package.__name__)
def test_every_public_name_is_there_and_explained(pages, package):
    for name in set(package.__all__) - {"theory"}:
        assert f'id="{name}"' in pages[package.__name__], name
        assert getattr(package, name).__doc__, name
