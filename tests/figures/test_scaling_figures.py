"""Figures 5, 10 and 11: every run is drawn once, at its measured place."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol

from slippulse.figures.shared.scaling import deviations
from slippulse.figures.style import colour_scale


def offsets(axes, gid: str) -> np.ndarray:
    """Places of the markers with a name."""
    return np.concatenate([c.get_offsets() for c in axes.collections if c.get_gid() == gid])


def panels_of(figure) -> list:
    """Panels that show runs."""
    return [axes for axes in figure.axes if any(c.get_gid() == "runs" for c in axes.collections)]


def test_every_run_is_drawn(draw):
    drawn = draw("fig05_scaling")
    panels = panels_of(drawn.figure)
    assert len(panels) == 6
    for axes, boundary in zip(panels[:2], ("displacement", "stress"), strict=True):
        measured = drawn.measured[f"scaling_{boundary}"]
        sound = measured[measured["run_flags"].isna()]
        expected = sound[["transition_length", "transition_time"]].to_numpy().ravel()
        places = np.ma.getdata(offsets(axes, "runs"))[:, 1]
        assert len(places) == 2 * len(sound)
        assert np.allclose(
            np.sort(places[np.isfinite(places)]), np.sort(expected[np.isfinite(expected)]), rtol=1e-6
        )
        assert axes.get_xscale() == axes.get_yscale() == "log"
        (line,) = [line for line in axes.lines if line.get_gid() == "one to one"]
        assert np.array_equal(line.get_xdata(), line.get_ydata())
    for axes, (quantity, boundary) in zip(
        panels[2:],
        [(q, b) for q in ("length", "time") for b in ("displacement", "stress")],
        strict=True,
    ):
        measured = drawn.measured[f"scaling_{boundary}"]
        sound = measured[measured["run_flags"].isna()]
        expected = sound[f"transition_{quantity}"] / sound[f"paper_transition_{quantity}"]
        places = np.ma.getdata(offsets(axes, "runs"))[:, 1]
        assert np.allclose(np.sort(places[np.isfinite(places)]), np.sort(expected.dropna()), rtol=1e-6)
        assert axes.get_yscale() == "linear"


def test_a_level_has_one_colour_in_all_three_figures():
    scale = colour_scale("tau_0")
    assert scale.to_rgba(0.1) != scale.to_rgba(0.9)
    assert scale.to_rgba(0.5) == colour_scale("tau_0").to_rgba(0.5)


def test_lattices_lie_along_the_exact_lines(draw):
    table = draw("fig05_scaling").table
    for _, line in table[(table["role"] == "exact") & (table["panel"] == "displacement_time")].iterrows():
        runs = table[(table["role"] == "marker") & (table["panel"] == line["panel"])]
        (run,) = runs[(runs["left"] == line["left"]) & (runs["gamma"] == line["gamma"])].itertuples()
        assert run.y == pytest.approx(line["y"], rel=tol.DRAFT_TRANSITION)


def test_times_under_stress_exceed_the_papers_estimate(draw):
    rows = draw("fig05_scaling").table
    rows = rows[(rows["role"] == "marker") & (rows["panel"] == "stress_time")].dropna(subset=["y"])
    assert (rows["y"] > rows["x"]).all()


@pytest.mark.parametrize("boundary", ["displacement", "stress"])
def test_every_damping_ratio_has_a_place(draw, boundary):
    drawn = draw(f"fig{10 if boundary == 'displacement' else 11}_damping_{boundary}")
    ratios = np.sort(drawn.measured[f"damping_{boundary}"]["damping_ratio"].unique())
    panels = panels_of(drawn.figure)
    assert len(panels) == 2 and 0.0 in ratios
    for axes in panels:
        assert np.allclose(axes.get_xticks(), ratios)
        assert np.allclose(np.unique(np.ma.getdata(offsets(axes, "runs"))[:, 0]), ratios)


def test_damping_lengthens_the_transition_and_its_speed_explains_it(draw):
    table = draw("fig10_damping_displacement").table
    markers = table[(table["role"] == "marker") & table["panel"].str.startswith("displacement_length")]
    median = {ratio: deviations(rows)[1] for ratio, rows in markers.groupby("damping_ratio")}
    assert median[1.0] > 2.0 * median[0.0]
    exact = table[(table["role"] == "exact") & (table["panel"] == "displacement_length")]
    keys = ["left", "gamma", "damping_ratio"]
    pairs = exact.merge(markers, on=keys, suffixes=("_exact", ""))
    assert len(pairs) == len(exact)
    assert pairs["y"].to_numpy() == pytest.approx(pairs["y_exact"].to_numpy(), rel=tol.DRAFT_TRANSITION)
