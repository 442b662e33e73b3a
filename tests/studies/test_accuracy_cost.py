"""Error against cost, and the check that no preset could be had cheaper and better."""

import numpy as np
import pandas as pd
import pytest
import tolerances as tol

from slippulse_paper.figures.shared.error_panels import QUANTITIES, error_rows
from slippulse_paper.steps.measure_seconds import draw, timed
from slippulse_paper.studies.accuracy_cost import ORDERS

pytestmark = pytest.mark.slow

# One setting is better than another by these. The energy balance is a check, not a result, and the
# arrest is never reached in the continuum.
JUDGED = ["front_speed", "peak_velocity", "width", "final_slip", "transition_time", "share_time"]
# Errors, and work, within this factor are equal, since the spacing sets some whatever the step; so
# are errors below the second number.
EQUAL, NEGLIGIBLE = 1.1, 1e-5


@pytest.fixture(scope="module")
def trade(study) -> pd.DataFrame:
    return study("accuracy_cost").query("part == 'trade'")


@pytest.mark.parametrize("preset", ["draft", "paper", "reference"])
def test_no_setting_is_cheaper_and_better_than_a_preset(trade, preset):
    (chosen,) = trade[trade["preset"] == preset].index
    lattices = trade[trade["scheme"] != "continuum"]
    cheaper = lattices[EQUAL * lattices["work"] <= trade["work"][chosen]]
    errors = trade[JUDGED].clip(lower=NEGLIGIBLE)
    errors = errors.loc[cheaper.index] / errors.loc[chosen]
    better = (errors <= EQUAL).all(axis=1) & (EQUAL * errors < 1.0).any(axis=1)
    assert len(cheaper) >= 10 and not better.any(), cheaper[better].to_string()


def test_front_speed_is_set_by_the_order_and_transitions_by_the_spacing(trade):
    """At one spacing and step, each two orders buy at least a factor of four."""
    rows = trade[(trade["scheme"] == "localised") & (trade["dx"] == 0.01) & (trade["step"] == 0.5)]
    speed = rows.set_index("order")["front_speed"]
    assert speed[4] > 4.0 * speed[6] and speed[3] > 4.0 * speed[5]
    rows = trade[(trade["order"] == 8) & (trade["step"] == 0.5)].sort_values("dx")
    assert np.all(np.abs(np.diff(np.log2(rows["transition_time"])) - 1.0) < tol.ORDER_BAND)


def test_the_exact_solution_is_beside_the_lattices(trade):
    """Fronts and sticks do not depend on the spacing; a front stands at one of its multiples."""
    (row,) = trade[trade["scheme"] == "continuum"].to_dict("records")
    assert all(row[name] < tol.EXACT_RUN for name in JUDGED[:-1])
    assert row["arrest_position"] < 2.0 * row["dx"] and np.isnan(row["work"])
    # The textbook scheme does not converge in front speed, neither with the step nor the spacing.
    textbook = trade[trade["scheme"] == "fixed_step"].sort_values("step", ascending=False)
    assert sorted({*textbook["dx"]}) == [0.01, 0.02, 0.04]
    for _, rows in textbook.groupby("dx"):
        assert (np.diff(rows["front_speed"]) > 0.0).any() or len(rows) < 5
    assert textbook["front_speed"].min() > 5e-4


def test_the_seconds_of_a_run_are_measured_and_the_best_settings_of_each_order_are_drawn(trade):
    """Some settings are enough: one of each order, one of the textbook scheme, and the exact."""
    coarse = trade[(trade["dx"] == 0.04) & (trade["step"] == 0.5)]
    few = pd.concat([coarse, trade[trade["scheme"] == "continuum"]])
    table = timed(few)
    assert (table["seconds"] > 0.0).all() and {*table["quantity"]} == {*QUANTITIES}
    assert {*table["role"]} == {"textbook", "preset", "exact", "frontier"}
    for _, rows in table[table["role"] == "frontier"].groupby(["quantity", "scheme", "order"]):
        assert rows["seconds"].is_monotonic_increasing
        assert (np.diff(rows["error"]) < 0.0).all()
    # The textbook scheme has a point for each of its settings, and a stick time for each order.
    times = table[table["quantity"] == "transition_time"]
    assert len(times[times["role"] == "textbook"]) == len(few[few["scheme"] == "fixed_step"]) == 1
    assert sorted({*times.loc[times["role"] == "frontier", "order"]}) == [1, *ORDERS]
    figure = draw(table)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [f"order {order}" for order in ORDERS] + [
        "textbook scheme",
        "presets",
        "exact solution",
    ]


def test_a_missing_error_does_not_hide_the_next_setting():
    """At the coarsest spacing the crack never covers its path, so that it has no error."""
    rows = {"scheme": "localised", "order": 4, "step": 1.0, "dx": [0.08, 0.04, 0.02, 0.01]}
    trade = pd.DataFrame(rows).assign(work=[1.0, 2.0, 3.0, 4.0], preset=None)
    trade = trade.assign(**{name: [np.nan, 0.4, 0.5, 0.2] for name in QUANTITIES})
    rows = error_rows(trade, "work", lambda quantity: "work")
    kept = rows[(rows["role"] == "frontier") & (rows["quantity"] == "share_time")]
    assert kept["work"].tolist() == [2.0, 4.0]


def test_the_textbook_front_locks_on_whole_steps_a_block_and_the_localised_does_not(study):
    locking = study("accuracy_cost").query("part == 'locking'").set_index("scheme")
    local, rows = locking.loc["localised"], locking.loc["fixed_step"].query("step > 0.72")
    assert len(rows) > 10
    assert np.allclose(rows["front_speed"] * rows["step"], 1.0, atol=tol.LOCKED)
    assert np.ptp(rows["front_speed"]) > 0.2
    assert np.allclose(local["front_speed"], local["exact"], rtol=tol.FRONT_SPEED, atol=0.0)
