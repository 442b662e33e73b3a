"""Figures 3, 8 and 9: simulated pulses lie on the theory."""

from __future__ import annotations

import numpy as np
import pytest


def curves(axes, kind: str) -> dict[str, np.ndarray]:
    """Drawn lines of one kind by what is behind its name."""
    return {
        line.get_gid().removeprefix(f"{kind} "): np.column_stack(line.get_data())
        for line in axes.lines
        if line.get_gid() and line.get_gid().startswith(f"{kind} ")
    }


@pytest.mark.parametrize(
    ("name", "panels"), [("fig03_steady_state", [0]), ("fig08_steady_state_displacement", [0, 1])]
)
def test_displacement_pulses_lie_on_the_theory(draw, name, panels):
    figure = draw(name).figure
    for panel in panels:
        simulated, theory = curves(figure.axes[panel], "simulation"), curves(figure.axes[panel], "theory")
        assert simulated.keys() == theory.keys() and len(simulated) >= 6
        for key, curve in simulated.items():
            expected = np.interp(curve[:, 0], *theory[key].T)
            # The front's layer, a few blocks wide at this coarse lattice, is the difference.
            assert np.median(np.abs(curve[:, 1] - expected)) < 0.03 * theory[key][:, 1].max()


def test_undamped_peaks_are_one_over_the_root_of_gamma(draw):
    drawn = draw("fig03_steady_state")
    rows = drawn.table[drawn.table["role"] == "paper"]
    assert rows.groupby("left")["y"].max().to_numpy() == pytest.approx(
        1.0 / np.sqrt(rows["gamma"].iloc[0]), rel=1e-3
    )
    theory = drawn.table[(drawn.table["role"] == "theory") & (drawn.table["panel"] == "displacement")]
    peaks = theory.groupby(["left", "damping_ratio"])["y"].max().unstack()
    assert (np.diff(peaks.to_numpy(), axis=1) < 0.0).all(), "damping lowers the peak"


def test_stress_pulses_reach_the_exact_peak(draw):
    drawn = draw("fig09_steady_state_stress")
    rows = drawn.table[drawn.table["field"] == "slip_velocity"]
    for _, run in rows.groupby("run"):
        exact = run.loc[run["role"] == "peak", "y"].iloc[0]
        assert run.loc[run["role"] == "simulation", "y"].max() == pytest.approx(exact, rel=0.03)
        assert run.loc[run["role"] == "theory", "y"].max() == pytest.approx(exact, rel=0.01)


def test_slip_never_falls_behind_the_front(draw):
    axes = draw("fig08_steady_state_displacement").figure.axes[0]
    for curve in curves(axes, "simulation").values():
        assert (np.diff(curve[:, 1]) <= 1e-6).all()
