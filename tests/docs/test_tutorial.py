"""The tutorial runs from top to bottom, and its numbers are what its text says of them."""

from __future__ import annotations

import jupytext
import pytest
import tolerances as tol

import slippulse as sp


@pytest.fixture(scope="module")
def names(project) -> dict:
    """What the cells of the tutorial define, run in order."""
    found = {}
    for number, cell in enumerate(jupytext.read(project / "docs/tutorial.md").cells):
        if cell.cell_type == "code":
            exec(compile(cell.source, f"tutorial, cell {number}", "exec"), found)
    return found


def test_the_lattice_is_near_the_exact_solution(names):
    assert 0.0 < names["stick_error"] < 2.0 * names["scene"].dx
    assert 0.0 < names["slip_error"] < 2.0 * names["scene"].dx


def test_softer_springs_give_more_slip_at_the_same_speed(names):
    assert names["slip"]["soft"] > 1.5 * names["slip"]["stiff"]
    assert names["fronts"]["soft"] == pytest.approx(names["fronts"]["stiff"], rel=tol.FRONT_SPEED)


def test_slip_without_damping_is_the_papers(names):
    assert names["left_behind"] == pytest.approx(
        [2.0 * tau / 0.65 for tau in names["levels"]], rel=tol.FRONT_SPEED
    )


def test_the_promise_is_kept(names):
    assert names["relative_error"] < 1e-3


def test_the_first_barrier_is_passed_and_the_second_is_not(names):
    edges = [position for position, _ in names["barrier"].steps]
    depth = sp.theory.barrier_depth(0.5, -0.5, gamma=0.65)
    assert edges[1] - edges[0] < depth
    (_, end), *_ = sp.theory.Rupture(names["barrier"], 0.65, duration=30.0).front_ends
    assert end.reason == "stops" and edges[2] < end.x < edges[2] + 1.1 * depth
