"""The lattice tends to the exact solution at first order, in every quantity of every scene that is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.figures import study_exact_solution as study


@pytest.fixture(scope="module")
def table(draw):
    return draw("study_exact_solution").table


def test_every_quantity_converges_at_first_order(table):
    lines = table[table["role"] == "difference"].groupby(["scene", "quantity"])
    assert len(lines) == 11, "nothing sticks without leaf springs"
    for _, line in lines:
        line = line.sort_values("dx")
        assert 0.9 < study.slope(line["dx"], line["value"]) < 1.1
        assert (np.diff(line["value"]) > 0.0).all()
        assert line["value"].iloc[0] < 0.005
        assert line["places"].min() >= 20


def test_markers_lie_on_the_exact_curves(table):
    edges = table[table["role"] == "edge"]
    for (scene, quantity), rows in edges.groupby(["scene", "quantity"]):
        exact = rows[rows["source"] == "exact"].dropna(subset="value").sort_values("position")
        lattice = rows[rows["source"] == "lattice"].dropna(subset="value")
        if exact.empty:
            assert (scene, quantity) == ("exact_stress", "stick") and lattice.empty
            continue
        inside = lattice[lattice["position"].between(exact["position"].min(), exact["position"].max())]
        off = np.abs(inside["value"] - np.interp(inside["position"], exact["position"], exact["value"]))
        assert off.median() < 0.03 * exact["value"].max()


def test_the_trailing_edge_follows_the_front(table):
    edges = table[(table["role"] == "edge") & (table["source"] == "exact")]
    for _, rows in edges.groupby("scene"):
        wide = rows.pivot(index="position", columns="quantity", values="value")
        known = wide.dropna(subset="stick")
        assert (known["stick"] > known["release"]).all()
        assert (wide["slip"] >= 0.0).all()


def test_the_figure_says_where_a_construction_ends(draw, table):
    assert not (table["role"] == "limit").any()
    row = {"role": "limit", "scene": study.SCENES[0], "time": 5.0, "position": 3.0}
    more = table.copy()
    more.loc[len(more)] = row
    texts = [text.get_text() for axes in study.plot(more).axes for text in axes.texts]
    assert "exact solution ends" in texts


def test_both_halves_of_the_map_agree(table):
    samples = table[table["role"] == "map"]
    halves = [rows.assign(position=rows["position"].abs().round(6)) for _, rows in samples.groupby("source")]
    wide = [half.pivot(index="time", columns="position", values="value").to_numpy() for half in halves]
    assert wide[0].shape == wide[1].shape
    assert np.abs(wide[0] - wide[1]).mean() < 0.02 * wide[0].max()
