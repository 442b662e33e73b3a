"""The lattice tends to the exact solution at first order, in every quantity of every scene that is drawn."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture(scope="module")
def table(draw):
    return draw("study_exact_solution").table


def test_every_quantity_converges_at_first_order(table):
    lines = table[table["role"] == "difference"].groupby(["scene", "quantity"])
    assert len(lines) == 11, "nothing sticks without leaf springs"
    for _, line in lines:
        line = line.sort_values("dx")
        assert 0.9 < np.polyfit(np.log(line["dx"]), np.log(line["difference"]), 1)[0] < 1.1
        assert (np.diff(line["difference"]) > 0.0).all()
        assert line["difference"].iloc[0] < 0.005
        assert line["places"].min() >= 20


def test_marks_lie_on_the_exact_curves_and_the_trailing_edge_follows_the_front(table):
    for _, rows in table[table["role"].isin(["exact", "lattice"])].groupby("scene"):
        exact, lattice = rows[rows["role"] == "exact"], rows[rows["role"] == "lattice"]
        assert (exact["release"].notna() & (exact["slip"] >= 0.0)).all(), (
            "the construction does not end early"
        )
        known = exact.dropna(subset="stick")
        assert len(known) > 100 and (known["stick"] > known["release"]).all()
        for quantity in ("release", "stick", "slip"):
            line, marks = exact.dropna(subset=quantity), lattice.dropna(subset=quantity)
            marks = marks[marks["position"].between(line["position"].min(), line["position"].max())]
            off = np.abs(marks[quantity] - np.interp(marks["position"], line["position"], line[quantity]))
            assert off.median() < 0.03 * line[quantity].max()


def test_both_halves_of_the_map_agree(table):
    halves = [
        table[table["role"] == f"map_{source}"]
        .assign(position=lambda rows: rows["position"].abs().round(6))
        .pivot(index="time", columns="position", values="slip_velocity")
        for source in ("exact", "lattice")
    ]
    exact, lattice = halves[0].fillna(0.0).align(halves[1].fillna(0.0), fill_value=0.0)
    assert (exact - lattice).abs().to_numpy().mean() < 0.02 * exact.to_numpy().max()
