"""The solver's functions take what a reader can keep in mind."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

import slippulse.solver
from slippulse.solver import arrays

FOLDER = Path(slippulse.solver.__file__).parent
MOST_ARGUMENTS = 12


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_no_function_takes_more_than_twelve_arguments(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.Lambda):
            given = node.args
            count = len(given.posonlyargs) + len(given.args) + len(given.kwonlyargs)
            assert count <= MOST_ARGUMENTS, f"{path.name}:{node.lineno}"


def test_no_record_or_group_is_indexed_by_place():
    """Their fields have names."""
    grouped = {
        "tally",
        "medium",
        "motion",
        "segments",
        "forecast",
        "scratch",
        "history",
        "recorder",
        "limits",
    }
    for path in sorted(FOLDER.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Subscript):
                name = getattr(node.value, "attr", getattr(node.value, "id", ""))
                assert name not in grouped, f"{path.name}:{node.lineno}"


def test_a_record_is_one_place_for_python_and_kernels():
    tally = arrays.record(arrays.TALLY)
    tally.steps += 3
    tally.viscous_loss = 0.5
    assert (tally.steps, tally.viscous_loss, tally.time) == (3, 0.5, 0.0)
    assert type(tally) is np.record and tally.dtype is arrays.TALLY
