"""The scheme of the authors' public solver, by its description: what its shortcuts cost in their own scene."""

from __future__ import annotations

import pytest


@pytest.mark.slow
def test_its_short_steps_cost_less_than_its_spacing(study):
    table = study("published_scheme").set_index("quantity")
    off = (table[["published", "localised"]].div(table["exact"], axis=0) - 1.0).abs()
    # Here the damped front speed is 1.4725, far from the undamped 1.25.
    assert table.loc["front_speed", "exact"] == pytest.approx(1.4725, abs=1e-4)
    assert off.loc["front_speed"].max() < 1e-3 and off.loc["pulse_slip"].max() < 1e-3
    late = off.loc["first_stick_time"]
    assert late["published"] < 2.0 * late["localised"] < 0.01
