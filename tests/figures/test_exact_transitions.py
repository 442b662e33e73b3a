"""What the Gaussian costs, one-way pulses under leaf springs, and the exact edges over the space-time map."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import Rupture


def test_uniform_prestress_leaves_the_papers_estimate_from_above(study):
    rows = study("gaussian_transition")
    uniform = rows[rows["gamma"].isna()].set_index("left")["over_paper"]
    assert uniform[[0.1, 0.4, 0.9]].to_numpy() == pytest.approx([1.219, 1.206, 1.112], abs=1e-3)
    assert (np.diff(uniform) < 0.0).all()
    peaks = rows.dropna(subset="gamma")
    assert (peaks["over_paper"].to_numpy() < uniform[peaks["left"]].to_numpy()).all(), (
        "the peak brings the transition forward"
    )


def test_a_weaker_barrier_lets_a_one_way_pulse_come_later_and_farther():
    found = np.array(
        [
            [
                (-end.x, rupture.transition_time, rupture.transition_length)
                for right in (0.1, 0.5, 0.9)
                for rupture in [Rupture(Prestress(left, right), 0.65, 0.1, duration=9.0)]
                for end in [rupture.front_ends[0][0]]
                if end.reason == "stops" and not rupture.limit
            ]
            for left in (-1.0, -0.3, -0.1)
        ]
    )
    assert found.shape == (3, 3, 3) and np.isfinite(found).all()
    assert (np.diff(found, axis=0) > 0.0).all()
    assert (np.diff(found[:, :, 1:], axis=1) > 0.0).all()


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
