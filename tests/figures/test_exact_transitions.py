"""What the Gaussian costs, one-way pulses under leaf springs, and the exact edges over the space-time map."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture(scope="module")
def table(draw):
    return draw("study_exact_transition").table


def test_uniform_prestress_leaves_the_papers_estimate_from_above(table):
    uniform = table[table["role"] == "uniform"].sort_values("left")
    found = uniform.set_index("left")["exact"]
    assert found[[0.1, 0.4, 0.9]].to_numpy() == pytest.approx([1.219, 1.206, 1.112], abs=1e-3)
    assert (np.diff(uniform["exact"]) < 0.0).all()
    peaks = table[table["role"] == "peak"].merge(
        uniform[["left", "exact"]], on="left", suffixes=("", "_uniform")
    )
    assert (peaks["exact"] < peaks["exact_uniform"]).all(), "the peak brings the transition forward"


def test_one_way_pulses_of_the_grid(table):
    assert not (table["role"] == "limit").any()
    rows = table[table["role"] == "one_way"]
    for quantity, group in rows.groupby("quantity"):
        grid = group.pivot(index="left", columns="right", values="exact").to_numpy()
        assert grid.size >= 20 and np.isfinite(grid).all()
        assert (np.diff(grid, axis=0) > 0.0).all(), "a weaker barrier lets everything come later and farther"
        if quantity != "stop":
            assert (np.diff(grid, axis=1) > 0.0).all()


def test_the_lattice_of_the_space_time_figure_lies_on_the_exact_edges(draw):
    rows = draw("fig04_space_time").table
    rows = rows[rows["panel"] == "displacement"]
    assert not (rows["role"] == "limit").any()
    for lattice, exact in (("front", "exact_front"), ("trailing", "exact_trailing")):
        line = rows[rows["role"] == exact].sort_values("position")
        found = rows[rows["role"] == lattice].dropna(subset="time")
        found = found[found["position"].between(line["position"].min(), line["position"].max())]
        off = found["time"] - np.interp(found["position"], line["position"], line["time"])
        assert len(found) > 100 and np.abs(off).max() < 0.12
