"""Figures 5, 10 and 11: every run is drawn once, at its measured place."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.figures.shared.scaling import deviations


def offsets(axes, gid: str) -> np.ndarray:
    """Places of the markers with a name."""
    return np.concatenate([c.get_offsets() for c in axes.collections if c.get_gid() == gid])


def test_every_run_is_drawn(draw):
    drawn = draw("fig05_scaling")
    panels = [axes for axes in drawn.figure.axes if any(c.get_gid() == "runs" for c in axes.collections)]
    assert len(panels) == 4
    for axes, (boundary, column) in zip(
        panels,
        [("displacement", "length"), ("stress", "length"), ("displacement", "time"), ("stress", "time")],
        strict=True,
    ):
        measured = drawn.measured[f"scaling_{boundary}"]
        sound = measured[measured["run_flags"].isna()]
        places = offsets(axes, "runs")
        assert len(places) == len(sound)
        drawn_y = np.ma.getdata(places[:, 1])
        expected = sound[f"transition_{column}"].to_numpy()
        assert np.allclose(
            np.sort(drawn_y[np.isfinite(drawn_y)]), np.sort(expected[np.isfinite(expected)]), rtol=1e-6
        )
        assert axes.get_xscale() == axes.get_yscale() == "log"
        (line,) = [line for line in axes.lines if line.get_gid() == "one to one"]
        assert np.array_equal(line.get_xdata(), line.get_ydata())


def test_face_and_rim_tell_runs_apart(draw):
    axes = draw("fig05_scaling").figure.axes[0]
    (runs,) = [c for c in axes.collections if c.get_gid() == "runs"]
    assert len(np.unique(runs.get_facecolors(), axis=0)) > 1
    assert len(np.unique(runs.get_edgecolors(), axis=0)) > 1


def test_times_under_stress_exceed_the_papers_estimate(draw):
    rows = draw("fig05_scaling").table
    rows = rows[(rows["role"] == "marker") & (rows["panel"] == "stress_time")].dropna(subset=["y"])
    assert (rows["y"] > rows["x"]).all()


@pytest.mark.parametrize("boundary", ["displacement", "stress"])
def test_one_column_a_damping_ratio(draw, boundary):
    drawn = draw(f"fig{10 if boundary == 'displacement' else 11}_damping_{boundary}")
    ratios = drawn.measured[f"damping_{boundary}"]["damping_ratio"].unique()
    panels = [axes for axes in drawn.figure.axes if any(c.get_gid() == "runs" for c in axes.collections)]
    assert len(panels) == 2 * len(ratios)
    assert 0.0 in ratios


def test_damping_lengthens_the_transition_and_its_speed_explains_it(draw):
    table = draw("fig10_damping_displacement").table
    markers = table[(table["role"] == "marker") & table["panel"].str.startswith("displacement_length")]
    median = {ratio: deviations(rows)[1] for ratio, rows in markers.groupby("damping_ratio")}
    assert median[1.0] > 2.0 * median[0.0]
    corrected = table[table["role"] == "corrected"]
    for ratio, rows in markers.groupby("damping_ratio"):
        theory = corrected[corrected["damping_ratio"] == ratio]
        away = np.nanmedian(np.abs(rows["y"].to_numpy() / theory["y"].to_numpy() - 1.0))
        assert away < 0.25, "with the damped speed each collapse is as good as without damping"
