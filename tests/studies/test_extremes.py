"""No edge of the solver's domain ends in a wrong number without a flag."""

from __future__ import annotations

import math

import pytest

from slippulse.figures import study_extremes
from slippulse.report.tables import edges
from slippulse.simulation.simulate import UnstableRun
from slippulse.studies.edges import Edge, Measured
from slippulse.studies.outcomes import FLAGGED, NO_NUMBER, REFUSED, RIGHT, STOPPED, VERDICTS, WRONG


def judged(measured) -> str:
    """Verdict of an edge whose run gives, or raises, this; tolerance one per cent."""

    def run() -> Measured:
        if isinstance(measured, Exception):
            raise measured
        return measured

    return Edge("family", "value", "quantity", RIGHT, 0.01, run).row()["verdict"]


@pytest.mark.parametrize(
    ("measured", "verdict"),
    [
        (Measured(2.0, 2.01), RIGHT),
        (Measured(2.0, 2.03), WRONG),
        (Measured(2.0, 2.03, "energy"), FLAGGED),
        (Measured(math.nan, 2.0), WRONG),
        (Measured(2.0, math.nan), NO_NUMBER),
        (Measured(0.0, 0.005), RIGHT),
        (Measured(0.0, 0.02), WRONG),
        (ValueError("dx: -1; allowed: > 0"), REFUSED),
        (UnstableRun("at t = 1"), STOPPED),
    ],
)
def test_the_verdict_is_computed(measured, verdict):
    assert judged(measured) == verdict


def test_every_edge_ends_as_it_should(study):
    table = study("extremes")
    assert (table["verdict"] == table["should"]).all(), table[table["verdict"] != table["should"]].to_string()
    assert WRONG not in set(table["should"])


def test_the_edges_reach_as_far_as_stated(config):
    rule = config["studies"]["extremes"]
    assert max(rule["level_near_one"]["levels"]) == 0.9999
    assert min(level for level, *_ in rule["level_near_zero"]["level_dx_duration"]) == 0.01
    assert min(rule["gamma"]["small"]) == 1e-8
    assert (min(rule["damping_ratio"]["total"]), max(rule["damping_ratio"]["total"])) == (0.0, 100.0)
    assert max(rule["dx"]["pulse"]) == 1.0 and min(rule["dx"]["transition"]) == 1e-3
    assert min(rule["width"]["blocks"]) == 0.5 and max(rule["width"]["wide"]) == 1000.0
    assert min(level for level, *_ in rule["negative_level"]["level_dx_friction_ratio_damping"]) == -100.0
    assert rule["long_run"]["duration"] == 1e5


def test_what_is_refused_says_the_bound(study):
    table = study("extremes")
    for row in table[table["verdict"] == REFUSED].itertuples():
        assert "allowed: " in row.message


def test_flags_name_their_reason(study):
    table = study("extremes")
    flagged = table[table["verdict"] == FLAGGED]
    found = {flag for text in flagged["message"] for flag in text.split(",")}
    assert {"died_out", "unresolved_pulse", "reverse_sliding", "unsteady", "stalled"} <= found


def marks(table) -> dict:
    """Number of marks of each outcome that the figure shows."""
    (axes,) = study_extremes.plot(table).axes
    return {line.get_gid(): len(line.get_xdata()) for line in axes.lines if line.get_gid() in VERDICTS}


def test_the_figure_shows_every_outcome(study):
    table = study("extremes")
    assert marks(table) == dict(table["verdict"].value_counts())


def test_a_wrong_number_would_be_seen(study):
    table = study("extremes").copy()
    table.loc[0, "verdict"] = WRONG
    assert marks(table)[WRONG] == 1
    assert WRONG in edges(table)


def test_the_table_has_every_edge(study):
    table = study("extremes")
    assert len(edges(table).splitlines()) == len(table) + 2
