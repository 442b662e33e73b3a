"""The phase diagram shows every classified run where it belongs, and examples that are real runs of their class."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from slippulse.comparison.table import measured_table
from slippulse.data.store import load_table, save_table
from slippulse.figures import fig02_phase_diagram as figure
from slippulse.figures.style import GREY
from slippulse.measure.regime import REGIMES
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.simulation.simulate import Samples
from slippulse.simulation.sweep import run_sweep

MEASURE = {
    "share": 0.95,
    "front_window": 0.3,
    "steady_tolerance": 0.02,
    "still": 0.05,
    "trailing_times": [5.0],
}
SETTINGS = {"measure": MEASURE}
STEP = 6.0


def sweep(boundary, profiles, duration, gammas=(0.0,)):
    dx = 0.1
    scenes = [
        Scene(
            boundary=boundary,
            prestress=profile,
            duration=duration,
            dx=dx,
            gamma=gamma,
            beta=0.1 * dx,
            max_step=0.5,
        )
        for profile in profiles
        for gamma in gammas
    ]
    reach = 1.3 * duration + 8.0
    samples = Samples(np.linspace(0.0, duration, 10), np.linspace(-reach, reach, 401))
    return run_sweep(scenes, [samples] * len(scenes), ("fronts", "fields", "samples"))


@pytest.fixture(scope="module")
def inputs():
    levels = (-0.5, 0.0, 0.5)
    data = {
        "regimes_displacement": sweep(
            "displacement", [Prestress(tau, tau) for tau in (-0.2, 0.3, 0.6)], 16.0, (0.01, 0.1, 0.5)
        ),
        "regimes_stress": sweep("stress", [Prestress(l_, r_) for l_ in levels for r_ in levels], 20.0),
        "regimes_beyond": sweep(
            "stress",
            [Prestress(-0.9, 0.0, steps=((STEP, level),)) for level in (-0.02, 0.0, 0.02)],
            60.0,
        ),
    }
    return data, {name: measured_table(dataset, MEASURE) for name, dataset in data.items()}


@pytest.fixture(scope="module")
def table(inputs, tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "table.csv"
    save_table(figure.table(*inputs, SETTINGS), path)
    return load_table(path)


@pytest.fixture(scope="module")
def drawn(table):
    out = figure.plot(table)
    out.canvas.draw()
    return out


def diagrams(drawn):
    """The axes of the three diagrams by letter."""
    return {
        axes.get_title("left").strip("()"): axes
        for axes in drawn.axes
        if axes.get_title("left").startswith("(")
    }


def marked(axes) -> set:
    """(column, row, regime) of every marker drawn in a diagram."""
    lines = [line for line in axes.lines if line.get_linestyle() == "None"]
    return {
        (round(float(x)), round(float(y)), line.get_label()) for line in lines for x, y in line.get_xydata()
    }


@pytest.mark.parametrize(("letter", "simulation", "x", "y"), figure.DIAGRAMS)
def test_every_run_has_a_marker_of_its_class_at_its_levels(drawn, inputs, letter, simulation, x, y):
    measured = inputs[1][simulation]
    columns, rows = np.unique(measured[x]), np.unique(measured[y])
    expected = {
        (int(np.flatnonzero(columns == a)[0]), int(np.flatnonzero(rows == b)[0]), regime)
        for a, b, regime in zip(measured[x], measured[y], measured["regime"], strict=True)
    }
    axes = diagrams(drawn)[letter]
    assert marked(axes) == expected
    assert [float(text.get_text().replace("\N{MINUS SIGN}", "-")) for text in axes.get_xticklabels()] == list(
        columns
    )
    assert [float(text.get_text().replace("\N{MINUS SIGN}", "-")) for text in axes.get_yticklabels()] == list(
        rows
    )


def test_classes_are_those_of_the_physics(inputs):
    measured = inputs[1]
    displacement = measured["regimes_displacement"].set_index(["left", "gamma"])["regime"]
    assert set(displacement[-0.2]) == {"arrested"}
    assert displacement[0.3][0.5] == "pulses, two-way"
    assert displacement[0.3][0.01] == "crack-like, two-way"
    stress = measured["regimes_stress"].set_index(["left", "right"])["regime"]
    assert stress[0.5][0.5] == "crack-like, two-way"
    assert stress[-0.5][0.5] == stress[0.5][-0.5] == "crack-like, one-way"
    beyond = measured["regimes_beyond"].set_index("beyond")["regime"]
    assert beyond[0.0] == "pulse, one-way, steady"
    assert beyond[-0.02] == "pulse, one-way, decaying"


def test_theory_line_separates_cracks_from_pulses(drawn, table):
    axes = diagrams(drawn)["a"]
    (line,) = [line for line in axes.lines if line.get_label() == "theory"]
    height = line.get_ydata()[0]
    assert np.ptp(line.get_ydata()) == 0.0
    gamma = table.loc[table["role"] == "line", "y"].iloc[0]
    assert math.pi / math.sqrt(gamma) == pytest.approx(16.0)
    # Between the levels of gamma, in proportion to its logarithm.
    assert height == pytest.approx(math.log(gamma / 0.01) / math.log(0.1 / 0.01), abs=1e-6)
    for _, row, regime in marked(axes):
        if regime == "pulses, two-way":
            assert row > height
        if regime.startswith("crack"):
            assert row < height


def test_theory_line_is_left_out_where_the_levels_do_not_reach(table):
    shifted = table.copy()
    shifted.loc[shifted["role"] == "line", "y"] = 1e-6
    axes = diagrams(figure.plot(shifted))["a"]
    assert not [line for line in axes.lines if line.get_label() == "theory"]


def test_examples_are_runs_of_their_class(table, inputs):
    examples = table[table["role"] == "example"]
    assert list(examples["series"]) == list("ABCDEF"[: len(examples)])
    assert len(examples) >= 5
    for _, example in examples.iterrows():
        row = inputs[1][example["simulation"]].iloc[int(example["point"])]
        assert row["regime"] == example["regime"]
        assert row["left"] == pytest.approx(example["left"])
        profile = table[(table["role"] == "profile") & (table["panel"] == example["series"])]
        curves = {series: part for series, part in profile.groupby("series")}
        assert curves["prestress"]["y"].max() == pytest.approx(1.0)
        assert curves["velocity_end"]["time"].iloc[0] == pytest.approx(row["duration"])
        assert curves["velocity_before"]["time"].iloc[0] == pytest.approx(2.0 * row["duration"] / 3.0)
        centre = np.interp(0.0, curves["velocity_end"]["x"], curves["velocity_end"]["y"])
        share = centre / curves["velocity_end"]["y"].max()
        assert (share >= MEASURE["still"]) == example["regime"].startswith("crack")


def test_examples_are_drawn_and_lettered_in_the_diagrams(drawn, table):
    examples = table[table["role"] == "example"].set_index("series")
    letters = {
        text.get_text(): axes.get_title("left") for axes in diagrams(drawn).values() for text in axes.texts
    }
    assert letters == {name: f"({panel})" for name, panel in examples["panel"].items()}
    strips = [axes for axes in drawn.axes if axes.get_xlabel() == r"$\bar x$"]
    assert len(strips) == len(examples)
    for axes, (name, example) in zip(strips, examples.iterrows(), strict=True):
        earlier, end = axes.lines
        profile = table[(table["panel"] == name) & (table["series"] == "velocity_end")]
        assert np.array_equal(end.get_ydata(), profile["y"])
        assert end.get_color() == figure.LOOKS[example["regime"]][0]
        if example["regime"].endswith("growing"):
            assert end.get_ydata().max() > earlier.get_ydata().max()
        if example["regime"].endswith("decaying"):
            assert end.get_ydata().max() < earlier.get_ydata().max()


def test_looks_tell_all_regimes_apart():
    assert set(figure.LOOKS) == set(REGIMES)
    assert len({colour for colour, _ in figure.LOOKS.values()}) == len(REGIMES)
    assert len({symbol for _, symbol in figure.LOOKS.values()}) == len(REGIMES)


def test_axes_and_legend_say_what_they_show(drawn, table):
    for letter, symbols in (
        ("a", (r"\tau_0", r"\gamma")),
        ("b", ("0,r", "0,l")),
        ("c", (f"{STEP:g}", "0,l")),
    ):
        axes = diagrams(drawn)[letter]
        assert symbols[0] in axes.get_xlabel() and symbols[1] in axes.get_ylabel()
    (legend,) = [axes.get_legend() for axes in drawn.axes if axes.get_legend()]
    said = [text.get_text() for text in legend.get_texts()]
    present = set(table.loc[table["role"] == "marker", "regime"])
    assert {text for text in said if text in REGIMES} == present
    assert not any("flagged" in text for text in said)


def test_flagged_runs_are_open_counted_and_no_example(inputs):
    data, measured = inputs
    flagged = {name: frame.copy() for name, frame in measured.items()}
    rows = flagged["regimes_beyond"]["regime"] == "pulse, one-way, steady"
    flagged["regimes_beyond"]["run_flags"] = np.where(rows, "energy", "")
    table = figure.table(data, flagged, SETTINGS)
    assert "pulse, one-way, steady" not in set(table.loc[table["role"] == "example", "regime"])
    drawn = figure.plot(table)
    axes = diagrams(drawn)["c"]
    (line,) = [line for line in axes.lines if line.get_label().startswith("flagged")]
    assert line.get_markerfacecolor() == "none" and line.get_markeredgecolor() == GREY
    assert len(line.get_xdata()) == rows.sum()
    (legend,) = [axes.get_legend() for axes in drawn.axes if axes.get_legend()]
    assert any(
        f"({rows.sum()})" in text.get_text() for text in legend.get_texts() if "flagged" in text.get_text()
    )


def test_a_diagram_of_flagged_runs_alone_is_still_drawn(inputs):
    data, measured = inputs
    table = figure.table(
        data, {name: frame.assign(run_flags="energy") for name, frame in measured.items()}, SETTINGS
    )
    assert not (table["role"] == "example").any()
    drawn = figure.plot(table)
    for axes in diagrams(drawn).values():
        assert all(label.startswith("flagged") for *_, label in marked(axes))


def test_inmost_run_is_far_from_other_classes_and_from_the_rim():
    columns, rows = np.meshgrid(np.arange(7), np.arange(7), indexing="ij")
    regime = np.where(columns.ravel() < 5, "crack-like, two-way", "arrested")
    markers = pd.DataFrame({"x": columns.ravel(), "y": rows.ravel(), "regime": regime, "run_flags": ""})
    chosen = markers.iloc[figure.inmost(markers, "crack-like, two-way")]
    assert (chosen["x"], chosen["y"]) == (2, 3)
    assert figure.inmost(markers, "pulses, two-way") is None
