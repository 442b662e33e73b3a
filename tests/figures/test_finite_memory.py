"""A pulse behind a change of level is exactly steady from a finite distance on, and not before."""

from __future__ import annotations

import numpy as np


def test_the_exact_pulse_is_steady_beyond_its_memory_and_not_before(draw):
    table = draw("study_stability_of_pulses").table
    assert not (table["role"] == "limit").any()
    exact = table[table["role"] == "exact"]
    assert exact["level"].nunique() >= 4
    for _, rows in exact.groupby("level"):
        rest = np.abs(rows["y"] / rows["steady"] - 1.0)
        share = rows["x"] / rows["memory"]
        assert rest[share >= 1.0].max() < 1e-8 and (share >= 1.0).sum() >= 10
        assert rest[(share > 0.5) & (share < 0.9)].min() > 1e-4
        behind = rows[rows["x"] < -5.0]
        assert np.abs(behind["y"] / behind["steady_before"] - 1.0).max() < 1e-8


def test_the_lattice_follows_the_exact_slip(draw):
    table = draw("study_stability_of_pulses").table
    for level, lattice in table[table["role"] == "slip"].groupby("level"):
        exact = table[(table["role"] == "exact") & (table["level"] == level)].sort_values("x")
        inside = lattice[lattice["x"].between(exact["x"].min(), exact["x"].max())]
        off = inside["y"] / np.interp(inside["x"], exact["x"], exact["y"]) - 1.0
        assert np.abs(off).max() < 0.1
