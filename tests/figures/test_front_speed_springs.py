"""Front speeds with leaf springs and damping: simulations on the lines, and the lines end where theory does."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture(scope="module")
def table(draw):
    return draw("study_front_speed_springs").table


def test_simulations_of_wide_pulses_lie_on_theory(table):
    runs = table[(table["role"] == "simulation") & table["run_flags"].isna()]
    springs = runs[runs["part"] == "springs"]
    assert len(springs) >= 20 and (springs["dx"] == 1.0).sum() >= 10
    assert set(springs["release"]) == {"total", "elastic"}
    assert np.max(np.abs(runs["speed"] / runs["theory"] - 1.0)) < 3e-4


def test_lines_go_through_the_exact_speeds_and_fall_with_the_springs(table):
    rows = table[table["part"] == "springs"]
    runs = rows[rows["role"] == "simulation"].dropna(subset="theory")
    for key, line in rows[rows["role"] == "theory"].groupby(["release", "damping_ratio", "tau0"]):
        line = line.dropna(subset="speed").sort_values("springs")
        assert (np.diff(line["speed"]) < 0.0).all()
        same = (runs["release"] == key[0]) & (runs["damping_ratio"] == key[1]) & (runs["tau0"] == key[2])
        chosen = runs[same & (runs["springs"] < 0.5)]
        found = np.interp(np.log(chosen["springs"]), np.log(line["springs"]), line["speed"])
        assert found == pytest.approx(chosen["theory"].to_numpy(), rel=0.01)


def test_at_fixed_damping_the_lattice_tends_to_the_closed_form(table):
    rows = table[table["part"] == "fixed_beta"]
    for _, group in rows.groupby(["tau0", "beta"]):
        closed = group.loc[group["role"] == "continuum", "speed"].iloc[0]
        line = group[group["role"] == "theory"].sort_values("dx")
        off = 1.0 - line["speed"].to_numpy() / closed
        assert (off > 0.0).all() and (np.diff(off) > 0.0).all() and off[0] < 0.02
