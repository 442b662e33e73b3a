"""Error against cost, and the check that no preset could be had cheaper and better."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
import tolerances as tol

from slippulse.studies.accuracy_cost import JUDGED, QUANTITIES, dominating


@pytest.fixture(scope="module")
def trade(study) -> pd.DataFrame:
    table = study("accuracy_cost")
    return table[table["part"] == "trade"]


def setting(work: float, **errors) -> dict:
    """One row of a made-up trade, every error a thousandth unless said."""
    return (
        {"scheme": "localised", "order": 4, "step": 0.5, "dx": 0.01, "work": work}
        | dict.fromkeys(QUANTITIES, 1e-3)
        | errors
    )


@pytest.mark.parametrize(
    ("other", "dominates"),
    [
        (setting(0.5, front_speed=1e-4), True),
        (setting(2.0, front_speed=1e-4), False),
        (setting(0.5), False),
        (setting(0.5, front_speed=1e-4, width=2e-3), False),
        (setting(0.5, front_speed=1e-4, width=1.05e-3), True),
        (setting(0.5, front_speed=1e-4, width=np.nan), False),
        (setting(0.5, front_speed=1e-4, energy=1.0), True),
    ],
)
def test_what_dominates_a_preset(other, dominates):
    rows = pd.DataFrame([setting(1.0), other])
    assert bool(dominating(rows, 0)) is dominates
    assert "energy" not in JUDGED


@pytest.mark.slow
def test_every_preset_is_on_the_curve_and_compared(trade, config):
    presets = trade[trade["preset"].notna()]
    assert set(presets["preset"]) == set(config["presets"])
    # Recomputed from the table: the check names the cheapest better setting, or none.
    for index in presets.index:
        found = dominating(trade, index)
        assert found == (
            presets["dominated_by"][index] if isinstance(presets["dominated_by"][index], str) else ""
        )


@pytest.mark.parametrize("preset", ["draft", "paper"])
@pytest.mark.slow
def test_no_measured_setting_is_cheaper_and_better_than_a_preset(trade, preset):
    (row,) = trade[trade["preset"] == preset].itertuples()
    assert not isinstance(row.dominated_by, str), row.dominated_by


@pytest.mark.slow
def test_front_speed_is_set_by_the_order(trade):
    """At one spacing and step, each two orders buy at least a factor of four."""
    rows = trade[(trade["scheme"] == "localised") & (trade["dx"] == 0.01) & (trade["step"] == 0.5)].set_index(
        "order"
    )
    assert rows["front_speed"][4] > 4.0 * rows["front_speed"][6]
    assert rows["front_speed"][3] > 4.0 * rows["front_speed"][5]


@pytest.mark.slow
def test_transitions_are_set_by_the_spacing(trade):
    """First order in dx, whatever the step."""
    rows = trade[(trade["order"] == 8) & (trade["step"] == 0.5)].sort_values("dx")
    ratio = rows["transition_time"].to_numpy()[1:] / rows["transition_time"].to_numpy()[:-1]
    assert np.all(np.abs(np.log2(ratio) - 1.0) < tol.ORDER_BAND)


@pytest.mark.slow
def test_the_exact_solution_is_on_the_curve(trade):
    """Fronts and sticks owe nothing to the spacing; where a front stands is read at its multiples."""
    (row,) = trade[trade["scheme"] == "continuum"].itertuples()
    for name in ("front_speed", "peak_velocity", "width", "final_slip", "transition_time"):
        assert getattr(row, name) < tol.EXACT_RUN
    assert row.arrest_position < 2.0 * row.dx and np.isnan(row.work)


@pytest.mark.slow
def test_the_textbook_scheme_does_not_converge_in_front_speed(trade):
    """Halving its step makes the front speed worse as often as better."""
    rows = trade[trade["scheme"] == "fixed_step"].sort_values("step", ascending=False)
    assert (np.diff(rows["front_speed"]) > 0.0).any()
    assert rows["front_speed"].min() > 5e-4


@pytest.mark.slow
def test_the_textbook_front_locks_on_whole_steps_a_block(study):
    table = study("accuracy_cost")
    rows = table[(table["part"] == "locking") & (table["scheme"] == "fixed_step") & (table["step"] > 0.72)]
    assert len(rows) > 10
    assert np.allclose(rows["front_speed"] * rows["step"], 1.0, atol=tol.LOCKED)
    assert np.ptp(rows["front_speed"]) > 0.2


@pytest.mark.slow
def test_the_localised_front_does_not(study):
    table = study("accuracy_cost")
    rows = table[(table["part"] == "locking") & (table["scheme"] == "localised")]
    assert rows["front_speed"].to_numpy() == pytest.approx(rows["exact"].to_numpy(), rel=tol.FRONT_SPEED)
