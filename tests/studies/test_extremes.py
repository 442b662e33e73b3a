"""No edge of the solver's domain ends in a wrong number without a flag."""

import math

import pytest

from slippulse.report.tables import edges
from slippulse.simulation.simulate import UnstableRun
from slippulse.studies import extremes

WRONG = "WRONG WITHOUT A FLAG"
# Each family, its number of edges, and the value at its last edge.
FAMILIES = {
    "level near 1": (3, "tau_0 = 0.9999"), "level near 0": (6, "tau_0 = 0.01, dx = 0.01"),
    "gamma": (8, "gamma dx^2 = 10"), "damping": (7, "beta/dx = 100, elastic"), "spacing": (7, "dx = 0.001"),
    "nucleation": (4, "W = 1000"), "negative level": (8, "tau_l = -100, dx 0.001, b 0.1, r 60"),
    "duration": (3, "t = 100000"), "float32": (3, "state, gamma = 0.001"), "peak": (4, "1 + 0.001"),
    "two nucleations": (2, "20 apart"), "barrier": (2, "depth 0.2"), "damping sign": (1, "as printed"),
    "step": (2, "3 dx, fixed_step"),
}  # fmt: skip


@pytest.mark.parametrize(
    ("expected", "found", "verdict"),
    [
        # Within one per cent.
        (2.0, (2.01, "", 1), "right"), (2.0, (2.03, "", 1), WRONG), (2.0, (2.03, "energy", 1), "flagged"),
        (0.0, (0.005, "", 1), "right"), (0.0, (0.02, "", 1), WRONG), (math.nan, (2.0, "", 1), WRONG),
        (2.0, (math.nan, "", 1), "no number"), (2.0, (math.inf, "", 1), WRONG),
        (2.0, ValueError("dx: -1; allowed: > 0"), "refused"), (2.0, UnstableRun("at t = 1"), "stopped"),
    ],
)  # fmt: skip
def test_the_verdict_is_computed(monkeypatch, expected, found, verdict):
    def measured(edge, window):
        if isinstance(found, Exception):
            raise found
        return found

    monkeypatch.setattr(extremes, "measured", measured)
    edge = extremes.Edge("family", "value", "front speed", "right", expected, {})
    assert extremes.row(edge, 0.3)["verdict"] == verdict


def test_every_edge_ends_as_it_should(study):
    table = study("extremes")
    assert (table["verdict"] == table["should"]).all(), table[
        table["verdict"] != table["should"]
    ].to_string()
    assert {
        name: (len(rows), rows["value"].iloc[-1]) for name, rows in table.groupby("family")
    } == FAMILIES
    assert len(edges(table).splitlines()) == len(table) + 2
    # Refusals say the bound, flags their reason.
    messages = table.set_index("verdict")["message"]
    assert messages["refused"].str.contains("allowed: ").all()
    found = {flag for text in messages["flagged"] for flag in text.split(",")}
    assert {"died_out", "unresolved_pulse", "reverse_sliding", "unsteady", "stalled"} <= found
    table.loc[0, "verdict"] = WRONG
    assert WRONG in edges(table)
