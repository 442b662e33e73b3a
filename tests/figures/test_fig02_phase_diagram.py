"""The phase diagram shows every classified run where it belongs, and examples that are real runs of their class."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from slippulse.data.store import load_table, save_table
from slippulse.figures import fig02_phase_diagram as figure
from slippulse.figures.style import GREY
from slippulse.measure.regime import REGIMES
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.predict.measured import measured_table
from slippulse.simulation.simulate import Samples
from slippulse.simulation.sweep import run_sweep

MEASURE = {
    "share": 0.95,
    "front_window": 0.3,
    "steady_tolerance": 0.02,
    "still": 0.05,
    "trailing_times": [5.0],
}
SETTINGS = {"measure": {name: MEASURE[name] for name in ("still", "steady_tolerance")}}
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
        "regimes_displacement_asymmetric": sweep(
            "displacement",
            [Prestress(left, right) for left in (-0.6, -0.3) for right in (0.0, 0.3, 0.7)],
            14.0,
            (0.3, 1.0),
        ),
        "regimes_stress": sweep("stress", [Prestress(l_, r_) for l_ in levels for r_ in levels], 20.0),
        "regimes_beyond": sweep(
            "stress",
            [Prestress(-0.9, 0.0, steps=((STEP, level),)) for level in (-0.02, 0.0, 0.02)],
            60.0,
        ),
    }
    measured = {name: measured_table(dataset, MEASURE) for name, dataset in data.items()}
    return data, measured | {f"coarser/{name}": table.assign(factor=2.0) for name, table in measured.items()}


@pytest.fixture(scope="module")
def table(inputs, tmp_path_factory):
    return through_csv(figure.table(*inputs, SETTINGS), tmp_path_factory.mktemp("table"))


def through_csv(table, folder):
    save_table(table, folder / "table.csv")
    return load_table(folder / "table.csv")


@pytest.fixture(scope="module")
def drawn(table):
    out = figure.plot(table)
    out.canvas.draw()
    return out


def diagrams(drawn):
    """The axes of the diagrams by letter."""
    return {
        axes.get_title("left").strip("()"): axes
        for axes in drawn.axes
        if axes.get_title("left").startswith("(")
    }


def shapes(axes) -> list:
    """The lines of the markers, without rings."""
    return [line for line in axes.lines if line.get_linestyle() == "None" and line.get_gid() != "ring"]


def marked(axes) -> set:
    """(column, row, regime) of every marker drawn in a diagram."""
    return {
        (round(float(x)), round(float(y)), line.get_label())
        for line in shapes(axes)
        for x, y in line.get_xydata()
    }


def legend(drawn) -> list[str]:
    """The texts of the legend."""
    (found,) = [found for part in drawn.subfigs for found in part.legends]
    return [text.get_text() for text in found.get_texts()]


def belongs(letter: str, runs: pd.DataFrame) -> pd.DataFrame:
    """The runs of a simulation that a diagram shows."""
    if letter == "c":
        return runs[runs["left"] == runs["right"]]
    return runs[runs["left"] < 0.0] if letter == "d" else runs


@pytest.mark.parametrize(("letter", "simulation", "x", "y"), figure.DIAGRAMS)
def test_every_run_has_a_marker_at_its_levels(drawn, table, inputs, letter, simulation, x, y):
    measured = belongs(letter, inputs[1][simulation])
    labels = list(np.unique(measured[x]))
    across = [labels.index(value) for value in measured[x]]
    if letter == "b":
        pairs = sorted(set(zip(measured["left"], measured["gamma"], strict=True)))
        up = [pairs.index(pair) for pair in zip(measured["left"], measured["gamma"], strict=True)]
        lines = [gamma for _, gamma in pairs]
    else:
        lines = list(np.unique(measured[y])) if y else [0]
        up = [lines.index(value) for value in measured[y]] if y else [0] * len(measured)
    axes = diagrams(drawn)[letter]
    assert {(i, j) for i, j, _ in marked(axes)} == set(zip(across, up, strict=True))
    assert ticks(axes.get_xticklabels()) == labels
    if y:
        assert ticks(axes.get_yticklabels()) == lines
    shown = table[(table["panel"] == letter) & (table["role"] == "marker")]
    assert len(shown) == len(measured) == len(marked(axes))


def ticks(labels) -> list[float]:
    return [float(text.get_text().replace("\N{MINUS SIGN}", "-")) for text in labels]


def markers_of(table, letter: str, *keys: str) -> pd.DataFrame:
    rows = table[(table["panel"] == letter) & (table["role"] == "marker")]
    return rows.set_index(list(keys))


def test_cells_are_of_the_regime_that_the_rupture_ends_in(table):
    symmetric = markers_of(table, "a", "left", "gamma")["regime"]
    assert set(symmetric[-0.2]) == {"arrested"}
    # The runs at small gamma end before their transition.
    assert set(symmetric[0.3]) == set(symmetric[0.6]) == {"pulses, two-way"}
    asymmetric = markers_of(table, "b", "right")["regime"]
    assert set(asymmetric[0.7]) == set(asymmetric[0.3]) == {"pulse, one-way, steady"}
    assert set(asymmetric[0.0]) == {"pulse, one-way, decaying"}
    assert markers_of(table, "c", "left")["regime"].to_dict() == {
        -0.5: "arrested", 0.0: "crack-like, two-way", 0.5: "crack-like, two-way",
    }  # fmt: skip
    assert markers_of(table, "d", "right")["regime"].to_dict() == {
        -0.5: "arrested", 0.0: "pulse, one-way, steady", 0.5: "crack-like, one-way",
    }  # fmt: skip
    beyond = markers_of(table, "e", "beyond")["regime"]
    assert [name.rpartition(", ")[2] for name in beyond[[-0.02, 0.0, 0.02]]] == [
        "decaying",
        "steady",
        "growing",
    ]


def test_markers_are_open_where_the_run_ends_too_early(drawn, table):
    rows = markers_of(table, "a", "left", "gamma")
    assert (rows.loc[(0.3, 0.01)]["run"], rows.loc[(0.3, 0.5)]["run"]) == (
        "crack-like, two-way",
        "pulses, two-way",
    )
    faces = {
        tuple(place): line.get_markerfacecolor()
        for line in shapes(diagrams(drawn)["a"])
        for place in line.get_xydata()
    }
    assert faces[1.0, 0.0] == "white" and faces[1.0, 2.0] == figure.LOOKS["pulses, two-way"][0]


def test_rings_are_where_a_coarser_lattice_ends_in_another_regime(inputs, tmp_path):
    data, measured = inputs
    other = measured["coarser/regimes_stress"].copy()
    changed = (other["left"] == -0.5) & (other["right"] == 0.5)
    other.loc[changed, "regime"] = "arrested"
    table = through_csv(figure.table(data, measured | {"coarser/regimes_stress": other}, SETTINGS), tmp_path)
    assert table.loc[(table["coarser"] > 0) & (table["role"] == "marker"), "panel"].tolist() == ["d"]
    drawn = figure.plot(table)
    rings = {letter: rung(axes) for letter, axes in diagrams(drawn).items()}
    assert rings == {"a": [], "b": [], "c": [], "d": [(2.0, 0.0)], "e": []}
    assert any("ringed" in text for text in legend(drawn))


def rung(axes) -> list:
    return [tuple(place) for line in axes.lines if line.get_gid() == "ring" for place in line.get_xydata()]


def test_cells_that_the_exact_solution_does_not_cover_are_hatched(inputs, tmp_path):
    data, measured = inputs
    changed = measured | {
        "regimes_displacement": measured["regimes_displacement"].replace(
            {"left": {-0.2: 0.0}, "right": {-0.2: 0.0}}
        )
    }
    drawn = figure.plot(through_csv(figure.table(data, changed, SETTINGS), tmp_path))
    hatched = {
        letter: [
            path.vertices[:4, 0].mean()
            for cells in axes.collections
            if cells.get_hatch()
            for path in cells.get_paths()
        ]
        for letter, axes in diagrams(drawn).items()
    }
    assert hatched == {"a": [0.0, 0.0, 0.0], "b": [], "c": [], "d": [], "e": []}
    assert any("hatched" in text for text in legend(drawn))


def test_classes_of_the_runs_are_those_of_the_physics(inputs):
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
        text.get_text(): axes.get_title("left")
        for axes in diagrams(drawn).values()
        for text in axes.texts
        if len(text.get_text()) == 1
    }
    assert letters == {name: f"({panel})" for name, panel in examples["panel"].items()}
    _, lower = drawn.subfigs
    strips = [axes for axes in lower.axes if len(axes.lines) == 2 and not axes.get_title("left")]
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
        ("b", ("0,r", r"\gamma")),
        ("c", (r"\tau_0", "")),
        ("d", ("0,r", "0,l")),
        ("e", (f"{STEP:g}", "0,l")),
    ):
        axes = diagrams(drawn)[letter]
        assert symbols[0] in axes.get_xlabel() and symbols[1] in axes.get_ylabel()
    said = legend(drawn)
    present = set(table.loc[table["role"] == "marker", "regime"])
    assert {text for text in said if text in REGIMES} == present
    assert not any(word in text for text in said for word in ("flagged", "ringed", "hatched"))


def test_flagged_runs_are_open_counted_and_no_example(inputs):
    data, measured = inputs
    flagged = {name: frame.copy() for name, frame in measured.items()}
    rows = flagged["regimes_beyond"]["regime"] == "pulse, one-way, growing"
    flagged["regimes_beyond"]["run_flags"] = np.where(rows, "energy", "")
    table = figure.table(data, flagged, SETTINGS)
    assert "pulse, one-way, growing" not in set(table.loc[table["role"] == "example", "regime"])
    drawn = figure.plot(table)
    lines = [line for line in shapes(diagrams(drawn)["e"]) if line.get_label().startswith("flagged")]
    assert sum(len(line.get_xydata()) for line in lines) == rows.sum()
    for line in lines:
        assert line.get_markerfacecolor() == "none" and line.get_markeredgecolor() == GREY
    assert any(f"({rows.sum()})" in text for text in legend(drawn) if "flagged" in text)


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
    markers = pd.DataFrame(
        {
            "x": columns.ravel(),
            "y": rows.ravel(),
            "regime": regime,
            "end": regime,
            "coarser": 0,
            "run_flags": "",
        }
    )
    chosen = markers.iloc[figure.inmost(markers, "crack-like, two-way")]
    assert (chosen["x"], chosen["y"]) == (2, 3)
    assert figure.inmost(markers, "pulses, two-way") is None
