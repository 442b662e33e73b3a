"""The phase diagram shows every run where it belongs, and says what its markers and cells are."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest

from slippulse.data.store import load_table, save_table
from slippulse.figures import fig02_phase_diagram as figure
from slippulse.figures.style import GREY
from slippulse.measure.regime import REGIMES

SETTINGS = {"measure": {"steady_tolerance": 0.02}}
CRACK, TWO, STEADY, ARREST = "crack-like, two-way", "pulses, two-way", "pulse, one-way, steady", "arrested"


def runs(rows: list[tuple]) -> pd.DataFrame:
    columns = ["left", "right", "beyond", "gamma", "exact_regime", "regime"]
    return pd.DataFrame(rows, columns=columns).assign(run_flags=None, largest_velocity_change=0.0)


def tables() -> dict[str, pd.DataFrame]:
    """One undecided cell in (a), one run in (c) that ends too early, a change in (d)."""
    found = {
        "regimes_displacement": runs(
            [(tau, tau, tau, gamma, TWO if tau > 0.0 else ARREST if tau < 0.0 else "undecided", TWO)
             for tau, gamma in product((-0.2, 0.0, 0.3), (0.01, 0.1))]
        ),
        "regimes_displacement_asymmetric": runs(
            [(left, right, right, gamma, STEADY, STEADY)
             for left, right, gamma in product((-0.6, -0.3), (0.1, 0.5, 0.8), (0.3, 1.0))]
        ),
        "regimes_stress": runs(
            [(left, right, right, 0.0, CRACK if min(left, right) >= 0.0 else ARREST, CRACK)
             for left, right in product((-0.5, 0.0, 0.5), repeat=2)]
        ),
        "regimes_beyond": runs(
            [(-0.9, 0.0, level, 0.0, f"pulse, one-way, {kind}", CRACK)
             for level, kind in ((-0.1, "decaying"), (0.0, "steady"), (0.1, "growing"))]
        ).assign(largest_velocity_change=[-1.0, 0.01, 0.3]),
    }  # fmt: skip
    return found | {f"coarser/{name}": table.assign(factor=2.0) for name, table in found.items()}


def drawn(given: dict[str, pd.DataFrame], folder):
    """Through the CSV, as the pipeline does it."""
    save_table(figure.table({}, given, SETTINGS), folder / "table.csv")
    table = load_table(folder / "table.csv")
    out = figure.plot(table)
    out.canvas.draw()
    maps = [axes for axes in out.axes if axes.get_xlabel()]
    (legend,) = out.legends
    return table, dict(zip("abcd", maps, strict=True)), [text.get_text() for text in legend.get_texts()]


def marked(axes, gid: str | None = None) -> dict[tuple, object]:
    """The marker of every run by column and row, or the rings."""
    named = [line for line in axes.lines if line.get_gid() and (line.get_gid() == "ring") == (gid == "ring")]
    return {(int(x), int(y)): line for line in named for x, y in line.get_xydata()}


def ticks(labels) -> list[float]:
    return [float(text.get_text().replace("\N{MINUS SIGN}", "-")) for text in labels]


@pytest.mark.parametrize("letter", "abcd")
def test_every_run_has_a_marker_of_its_regime_at_its_levels(tmp_path, letter):
    table, maps, _ = drawn(tables(), tmp_path)
    rows = table[table["panel"] == letter]
    columns, lines = np.unique(rows["x"]), np.unique(rows["y"])
    expected = {
        (int(np.searchsorted(columns, row.x)), int(np.searchsorted(lines, row.y))): row.regime
        for row in rows.itertuples()
    }
    assert {place: line.get_gid() for place, line in marked(maps[letter]).items()} == expected
    assert ticks(maps[letter].get_xticklabels()) == list(columns)
    shown = list(rows.groupby("y")["gamma"].first()) if letter == "b" else list(lines)
    assert ticks(maps[letter].get_yticklabels()) == shown


def test_the_exact_regime_is_drawn_open_where_the_run_ends_before_and_hatched_where_there_is_none(tmp_path):
    table, maps, said = drawn(tables(), tmp_path)
    assert table[(table["panel"] == "d")]["run"].str.split(", ").str[-1].to_list() == [
        "decaying",
        "steady",
        "growing",
    ]
    faces = {place: line.get_markerfacecolor() for place, line in marked(maps["c"]).items()}
    assert faces[0, 0] == "white" and faces[2, 2] == figure.LOOKS[CRACK][0]
    hatched = [cells for cells in maps["a"].collections if cells.get_hatch()]
    assert [path.vertices[:4, 0].mean() for cells in hatched for path in cells.get_paths()] == [1.0, 1.0]
    assert not any(cells.get_hatch() for letter in "bcd" for cells in maps[letter].collections)
    for word in ("open", "hatched"):
        assert any(text.startswith(word) for text in said)
    assert not any("flagged" in text or "ringed" in text for text in said)
    assert {text for text in said if text in REGIMES} == set(table["regime"])


def test_rings_are_where_a_coarser_lattice_ends_in_another_regime(tmp_path):
    given = tables()
    given["coarser/regimes_stress"].loc[2, "regime"] = ARREST
    table, maps, said = drawn(given, tmp_path)
    assert table.loc[table["coarser"] > 0, "panel"].to_list() == ["c"]
    assert {letter: list(marked(axes, "ring")) for letter, axes in maps.items()} == {
        "a": [], "b": [], "c": [(2, 0)], "d": [],
    }  # fmt: skip
    assert any(text.startswith("ringed") for text in said)


@pytest.mark.parametrize("everything", [False, True])
def test_flagged_runs_are_open_grey_and_counted(tmp_path, everything):
    given = tables()
    for name, table in given.items():
        if everything or name == "regimes_beyond":
            table["run_flags"] = "energy"
    table, maps, said = drawn(given, tmp_path)
    for axes in maps.values() if everything else [maps["d"]]:
        for line in marked(axes).values():
            assert line.get_markerfacecolor() == "none" and line.get_markeredgecolor() == GREY
    assert any(f"({table['run_flags'].notna().sum()})" in text for text in said if "flagged" in text)


def test_looks_tell_all_regimes_apart():
    assert set(figure.LOOKS) == set(REGIMES)
    for looks in zip(*figure.LOOKS.values(), strict=True):
        assert len(set(looks)) == len(REGIMES)
