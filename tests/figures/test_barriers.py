"""Lattices tend to the exact depth of a pulse in a barrier, which decides what is passed."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.theory.barrier import barrier_depth, barrier_depth_estimate


@pytest.fixture(scope="module")
def table(draw):
    return draw("study_barriers").table


def test_lattices_tend_to_the_exact_depth(table):
    runs = table[table["part"] == "depth"]
    assert len(runs.groupby(["tau0", "barrier"])) >= 12
    orders = []
    for (*_, ratio), line in runs.groupby(["tau0", "barrier", "gamma", "damping_ratio"]):
        line = line.sort_values("dx")
        assert len(line) == 3
        off = np.abs(line["measured"] / line["exact"] - 1.0).to_numpy()
        assert off[0] < 0.03 and off[0] < off[-1]
        if ratio > 0.0:
            assert (np.diff(off) > 0.0).all()
            orders.append(np.polyfit(np.log(line["dx"]), np.log(off), 1)[0])
    # Depths are whole blocks.
    assert 0.85 < np.median(orders) < 1.15


def test_a_barrier_is_passed_if_and_only_if_it_is_shorter(study):
    rows = study("barriers")
    rows = rows[rows["part"] == "passing"]
    assert (rows["length"] < 1.0).sum() == (rows["length"] > 1.0).sum() >= 24
    assert ((rows["measured"] == 1.0) == (rows["length"] < 1.0)).all()


def test_the_fine_map_is_the_exact_depth(table):
    fine = table[table["part"] == "fine"].iloc[::397]
    for _, row in fine.iterrows():
        exact = barrier_depth(row["tau0"], row["barrier"], 1.0, row["damping_ratio"])
        assert row["exact"] == pytest.approx(exact, rel=5e-3)


def test_depth_falls_with_the_barrier_and_the_estimate_is_short_of_it_at_low_levels(table):
    curves = table[table["part"] == "curve"]
    for (tau0, _), line in curves.groupby(["tau0", "damping_ratio"]):
        line = line.sort_values("barrier")
        assert (np.diff(line["exact"]) > 0.0).all()
        estimate = [barrier_depth_estimate(*row) for row in line[["tau0", "barrier", "gamma"]].to_numpy()]
        assert line["paper"].to_numpy() == pytest.approx(estimate, rel=1e-3)
        if tau0 < 0.3:
            assert (line["paper"] < 0.5 * line["exact"]).all()
