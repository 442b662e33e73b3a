"""The tutorial runs from top to bottom, its numbers are what its text says, and the reference has every public name."""

import math
import runpy

import pytest
import tolerances as tol

import slippulse as sp


def test_the_tutorial_keeps_what_it_says(project, tmp_path):
    names = runpy.run_path(str(project / "docs/run_tutorial.py"))["run"](tmp_path)
    assert len([*tmp_path.glob("*.png")]) == 3
    # Under a held stress the left front stops near where the paper has it, from below.
    balance = (1.5 + 1.0) / 0.5 * math.sqrt(math.pi / 2.0)
    assert 0.9 * balance < -names["stopped"] < 1.001 * balance
    # The lattice is near the exact solution.
    assert all(0.0 < names[error] < 2.0 * names["scene"].dx for error in ("stick_error", "slip_error"))
    # Softer springs give more slip at the same speed.
    assert names["slip"]["soft"] > 1.5 * names["slip"]["stiff"]
    assert names["fronts"]["soft"] == pytest.approx(names["fronts"]["stiff"], rel=tol.FRONT_SPEED)
    # Slip without damping is the paper's.
    slips = [2.0 * tau / 0.65 for tau in names["levels"]]
    assert names["left_behind"] == pytest.approx(slips, rel=tol.FRONT_SPEED)
    # The promise is kept.
    assert names["relative_error"] < 1e-3
    # The first barrier is passed, and the second is not.
    edges = [position for position, _ in names["barrier"].steps]
    depth = sp.theory.barrier_depth(0.5, -0.5, gamma=0.65)
    (_, end), *_ = sp.theory.Rupture(names["barrier"], 0.65, duration=30.0).front_ends
    assert edges[1] - edges[0] < depth
    assert end.reason == "stops" and edges[2] < end.x < edges[2] + 1.1 * depth


def test_the_reference_explains_every_public_name(project, tmp_path):
    runpy.run_path(str(project / "docs/reference.py"))["main"](str(tmp_path))
    for package, page in ((sp, "slippulse.html"), (sp.theory, "slippulse/theory.html")):
        text = (tmp_path / page).read_text(encoding="utf-8")
        for name in set(package.__all__) - {"theory"}:
            assert f'id="{name}"' in text, name
            assert getattr(package, name).__doc__, name
