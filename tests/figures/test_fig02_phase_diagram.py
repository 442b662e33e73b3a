"""The phase diagram has the exact regime of every run where the run is, and marks runs that end in another."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgba
from matplotlib.path import Path

from slippulse.figures import fig02_phase_diagram as figure
from slippulse.measure.regime import REGIMES


@pytest.fixture(scope="module")
def drawn(draw):
    return draw("fig02_phase_diagram")


def test_areas_and_lines_have_the_regime_that_the_runs_on_them_end_in(drawn):
    told = 0
    for sweep in figure.DRAWN:
        for run in drawn.measured[sweep].itertuples():
            rows = drawn.table[drawn.table["boundary"] == run.boundary]
            role, at = ("line" if run.left * run.right == 0.0 else "area"), [run.left, run.right]
            if run.exact_regime not in REGIMES or (role == "line" and max(at) > 0.0) or at == [0.0, 0.0]:
                continue
            parts = rows[rows["role"] == role].groupby("series")
            found = [
                part for _, part in parts if Path(part[["left", "right"]]).contains_point(at, radius=1e-9)
            ]
            if role == "line":
                found = [part for _, part in parts if (part[["left", "right"]].sum() * at).sum() > 0.0]
            # The wedge of growing pulses lies upon the quadrant of cracks.
            assert found[-1]["regime"].iloc[0] == run.exact_regime, run
            told += 1
    assert told > 200


def test_runs_are_filled_where_they_end_as_theory_says_and_crossed_out_where_flagged(drawn):
    runs = drawn.table[drawn.table["role"] == "run"].copy()
    runs.loc[runs.index[0], "run_flags"] = "energy"
    out = drawn.module.plot(pd.concat([drawn.table[drawn.table["role"] != "run"], runs]))
    marks = [line for axes in out.axes for line in axes.lines if line.get_gid() == "run"]
    assert len(marks) == len(runs)
    assert [mark.get_marker() for mark in marks].count("x") == runs["run_flags"].notna().sum() > 0
    sound = runs[runs["run_flags"].isna()]
    faces = {(*np.ravel(mark.get_xydata()), *to_rgba(mark.get_markerfacecolor())) for mark in marks}
    for run in sound.itertuples():
        early = run.exact_regime in REGIMES and run.exact_regime != run.regime
        colour = "white" if early else figure.LOOKS[run.regime][0]
        assert (run.left, run.right, *to_rgba(colour)) in faces


def test_looks_tell_all_regimes_apart():
    assert set(figure.LOOKS) == set(REGIMES)
    for looks in zip(*figure.LOOKS.values(), strict=True):
        assert len(set(looks)) == len(REGIMES)
