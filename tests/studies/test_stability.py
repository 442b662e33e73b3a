"""The measured stability boundary on the derived one."""

from __future__ import annotations

import tolerances as tol

from slippulse.model.stability import MARGIN, WEAK_ORDERS
from slippulse.studies.stability import boundary, chain


def boundaries(study):
    table = study("stability")
    return table[table["kind"] == "boundary"]


def test_no_scheme_blows_up_below_its_bound(study):
    rows = boundaries(study)
    for column in ("measured_ratio", "measured_rupture_ratio"):
        assert rows[column].min() >= 1.0 - tol.BOUNDARY_BELOW


def test_the_chain_blows_up_at_the_bound(study):
    """Where damping makes the growth beyond it fast enough to be seen, at every order and under both schemes."""
    rows = boundaries(study)
    damped = rows[rows["damping_ratio"] >= 0.1]
    assert len(damped) == 28
    assert damped["measured_ratio"].max() <= 1.0 + tol.BOUNDARY_ABOVE
    undamped = rows[(rows["damping_ratio"] == 0.0) & (rows["order"] <= 4)]
    assert undamped["measured_ratio"].max() <= 1.0 + tol.BOUNDARY_ABOVE_UNDAMPED


def test_weak_orders_are_held_below_what_a_run_shows(study):
    rows = boundaries(study)
    weak = rows[(rows["order"].isin(WEAK_ORDERS)) & (rows["damping_ratio"] == 0.0)]
    assert (weak["measured_ratio"] > 1.0).all()


def test_every_preset_steps_within_the_margin(study):
    table = study("stability")
    presets = table[table["kind"] != "boundary"]
    bound = MARGIN * presets["derived"] * (1.0 + tol.CSV_DIGITS)
    assert len(presets) and (presets["measured"] <= bound).all()


def test_the_bisection_reports_the_end_beyond_which_it_does_not_look():
    settings = {"between": [0.2, 0.4], "resolution": 0.01, "blocks": 100, "steps": 100}
    assert boundary(chain, "localised", 4, 1.0, 1.0, settings) == 0.4
    settings["between"] = [3.0, 4.0]
    assert boundary(chain, "localised", 4, 1.0, 1.0, settings) == 3.0
